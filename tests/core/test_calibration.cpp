#include "strainwave/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace {

using strainwave::torque_of_volts_Nm;
using strainwave::TorqueCalibration;

template <class Real>
class Calibration : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Calibration, Precisions);

TYPED_TEST(Calibration, GainOfTableI) {  // Taghirad & Belanger 1999: 6.60 Nm/V
  TorqueCalibration<TypeParam> calibration;
  calibration.gain_Nm_per_V = TypeParam(6.60);
  EXPECT_NEAR(torque_of_volts_Nm(calibration, TypeParam(1), TypeParam(20)), TypeParam(6.60),
              TypeParam(1e-6));
  EXPECT_NEAR(torque_of_volts_Nm(calibration, TypeParam(-6), TypeParam(90)), TypeParam(-39.6),
              TypeParam(1e-5));
}

TYPED_TEST(Calibration, PolynomialAgainstPowers) {
  TorqueCalibration<TypeParam> calibration;
  calibration.gain_Nm_per_V = TypeParam(6.6);
  calibration.zero_V = TypeParam(0.125);
  calibration.full_scale_Nm = TypeParam(40);
  const double c[4] = {0.02, -0.03, 0.01, 0.004};
  for (int n = 0; n < 4; ++n) {
    calibration.linearisation[n] = static_cast<TypeParam>(c[n]);
  }
  for (int i = -19; i <= 19; ++i) {
    const double volts = 0.37 * i;
    const double u = 6.6 * (volts - 0.125);
    double expected = u;
    for (int n = 0; n < 4; ++n) {
      expected += 40.0 * c[n] * std::pow(u / 40.0, n + 2);
    }
    const double tolerance = sizeof(TypeParam) == 4 ? 2e-5 : 2e-14;
    EXPECT_NEAR(static_cast<double>(
                    torque_of_volts_Nm(calibration, static_cast<TypeParam>(volts), TypeParam(20))),
                expected, tolerance)
        << volts;
  }
}

TYPED_TEST(Calibration, TemperatureMovesZeroAndGain) {
  TorqueCalibration<TypeParam> calibration;
  calibration.gain_Nm_per_V = TypeParam(8);
  calibration.zero_drift_V_per_K = TypeParam(0.0625);
  calibration.gain_drift_per_K = TypeParam(-0.03125);
  // 4 K warmer: zero 0.25 V, gain 8 (1 - 0.125) = 7; all numbers exact.
  EXPECT_EQ(torque_of_volts_Nm(calibration, TypeParam(1.25), TypeParam(24)), TypeParam(7));
  EXPECT_EQ(torque_of_volts_Nm(calibration, TypeParam(1.25), TypeParam(20)), TypeParam(10));
}

TYPED_TEST(Calibration, ConvertedKeepsEveryField) {
  const TorqueCalibration<double> from{2, 3, 4, {.1, .2, .3, .4}, 5, 6, 7, 8, 9};
  const auto to = strainwave::converted<TypeParam>(from);
  EXPECT_EQ(to.gain_Nm_per_V, TypeParam(2));
  EXPECT_EQ(to.zero_V, TypeParam(3));
  EXPECT_EQ(to.full_scale_Nm, TypeParam(4));
  for (int n = 0; n < 4; ++n) {
    EXPECT_EQ(to.linearisation[n], static_cast<TypeParam>(from.linearisation[n]));
  }
  EXPECT_EQ(to.reference_temperature_degC, TypeParam(5));
  EXPECT_EQ(to.zero_drift_V_per_K, TypeParam(6));
  EXPECT_EQ(to.gain_drift_per_K, TypeParam(7));
  EXPECT_EQ(to.minimum_temperature_degC, TypeParam(8));
  EXPECT_EQ(to.maximum_temperature_degC, TypeParam(9));
}

TYPED_TEST(Calibration, CheckNamesEveryParameter) {
  struct Case {
    const char* name;
    TypeParam TorqueCalibration<TypeParam>::* field;
  };
  using C = TorqueCalibration<TypeParam>;
  const Case cases[] = {{"gain_Nm_per_V", &C::gain_Nm_per_V},
                        {"zero_V", &C::zero_V},
                        {"full_scale_Nm", &C::full_scale_Nm},
                        {"reference_temperature_degC", &C::reference_temperature_degC},
                        {"zero_drift_V_per_K", &C::zero_drift_V_per_K},
                        {"gain_drift_per_K", &C::gain_drift_per_K},
                        {"minimum_temperature_degC", &C::minimum_temperature_degC},
                        {"maximum_temperature_degC", &C::maximum_temperature_degC}};
  EXPECT_TRUE(check(C{}).ok());
  for (const Case& each : cases) {
    for (const TypeParam wrong : {std::numeric_limits<TypeParam>::quiet_NaN(),
                                  std::numeric_limits<TypeParam>::infinity()}) {
      C calibration;
      calibration.*each.field = wrong;
      ASSERT_FALSE(check(calibration).ok()) << each.name;
      EXPECT_STREQ(check(calibration).parameter, each.name);
    }
  }
  C calibration;
  calibration.gain_Nm_per_V = TypeParam(0);
  EXPECT_STREQ(check(calibration).parameter, "gain_Nm_per_V");
  calibration = {};
  calibration.full_scale_Nm = TypeParam(-40);
  EXPECT_STREQ(check(calibration).parameter, "full_scale_Nm");
  calibration = {};
  calibration.linearisation[2] = TypeParam(1.5);
  EXPECT_STREQ(check(calibration).parameter, "linearisation");
  EXPECT_EQ(check(calibration).index, 2);
  calibration = {};
  calibration.maximum_temperature_degC = calibration.minimum_temperature_degC;
  EXPECT_STREQ(check(calibration).parameter, "maximum_temperature_degC");
}

}  // namespace
