#include "strainwave/bridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace {

using strainwave::Amplifier;
using strainwave::Converter;
using strainwave::ConverterCode;
using strainwave::Rosette;
using strainwave::RosetteStrain;
using strainwave::SurfaceStrain;

template <class Real>
class Bridge : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Bridge, Precisions);

/// Strain along a direction, n' E n with the strain tensor E in polar axes.
double strain_along(const SurfaceStrain<double>& strain, double angle_rad) {
  const double n[2] = {std::cos(angle_rad), std::sin(angle_rad)};
  const double tensor[2][2] = {{strain.radial, strain.shear / 2.0},
                               {strain.shear / 2.0, strain.circumferential}};
  double sum = 0.0;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      sum += n[i] * tensor[i][j] * n[j];
    }
  }
  return sum;
}

TEST(Bridge, RosetteStrainIsTheTensorAlongItsGauges) {  // Taghirad & Belanger 1999, eq. (1)
  const double pi = std::acos(-1.0);
  const SurfaceStrain<double> strain{3e-4, -1e-4, 5e-4};
  for (const double error_rad : {-3.0, -0.7, -0.02, 0.0, 0.01, 0.3, 1.5}) {
    const Rosette<double> rosette{.orientation_error_rad = error_rad};
    const RosetteStrain<double> gauges = strainwave::rosette_strain(rosette, strain);
    EXPECT_NEAR(gauges.first, strain_along(strain, pi / 4 + error_rad), 1e-18);
    EXPECT_NEAR(gauges.second, strain_along(strain, -pi / 4 + error_rad), 1e-18);
  }
}

TYPED_TEST(Bridge, PureShearHasOppositeStrains) {  // eq. (1) without a wave
  const auto gauges = strainwave::rosette_strain<TypeParam>({}, {.shear = TypeParam(2e-4)});
  EXPECT_EQ(gauges.first, TypeParam(1e-4));
  EXPECT_EQ(gauges.second, TypeParam(-1e-4));
  EXPECT_EQ(strainwave::rosette_difference(gauges), TypeParam(2e-4));  // 2 epsilon_t of eq. (2)
}

/// Output of a Wheatstone bridge of four resistors by Kirchhoff: supply over R1-R2 and R4-R3.
double wheatstone_V(const double (&resistance)[4], double supply_V) {
  return supply_V * (resistance[0] / (resistance[0] + resistance[1]) -
                     resistance[3] / (resistance[2] + resistance[3]));
}

TEST(Bridge, FullBridgeIsTheResistorNetworkToSecondOrder) {  // eq. (4)
  const double K = 2.1;
  const Rosette<double> rosettes[2] = {{.gauge_factor = K}, {.gauge_factor = K}};
  for (const double scale : {1e-3, 3e-4, 1e-4}) {
    const RosetteStrain<double> strains[2] = {{1.0 * scale, -0.6 * scale},
                                              {0.8 * scale, -0.9 * scale}};
    const double resistance[4] = {
        350.0 * (1 + K * strains[0].first), 350.0 * (1 + K * strains[0].second),
        350.0 * (1 + K * strains[1].first), 350.0 * (1 + K * strains[1].second)};
    const double exact_V = wheatstone_V(resistance, 10.0);
    const double linear_V = strainwave::full_bridge_V(rosettes, strains, 2, 10.0);
    const double relative = std::fabs(linear_V / exact_V - 1.0);
    EXPECT_LT(relative, K * scale);
    EXPECT_GT(relative, 1e-3 * K * scale);  // a linear law is not the exact one
  }
}

TYPED_TEST(Bridge, IdealFullBridgeDeliversKEpsilonE) {  // eq. (4), second line
  const Rosette<TypeParam> rosettes[4] = {};
  const auto strain = strainwave::rosette_strain<TypeParam>(
      {},
      {.radial = TypeParam(4e-4), .circumferential = TypeParam(1e-4), .shear = TypeParam(3e-4)});
  const RosetteStrain<TypeParam> strains[4] = {strain, strain, strain, strain};
  const double tolerance = sizeof(TypeParam) == 4 ? 3e-9 : 1e-17;
  for (const std::size_t count : {2U, 4U}) {
    // K = 2, epsilon_t = 1.5e-4, 10 V.
    EXPECT_NEAR(
        static_cast<double>(strainwave::full_bridge_V(rosettes, strains, count, TypeParam(10))),
        3e-3, tolerance);
  }
  EXPECT_NEAR(static_cast<double>(strainwave::half_bridge_V(TypeParam(2), strain, TypeParam(10))),
              1.5e-3, tolerance);
}

TEST(Bridge, WeightsRosettesByTheirGaugeFactors) {
  const Rosette<double> rosettes[2] = {{.gauge_factor = 2.0}, {.gauge_factor = 3.0}};
  const RosetteStrain<double> strains[2] = {{1e-4, 0.0}, {0.0, -2e-4}};
  EXPECT_NEAR(strainwave::full_bridge_V(rosettes, strains, 2, 8.0),
              (2.0 * 1e-4 + 3.0 * 2e-4) / 4.0 * 8.0, 1e-18);
}

TYPED_TEST(Bridge, AmplifierEndsAtItsRails) {
  const Amplifier<TypeParam> amplifier{TypeParam(1000), TypeParam(0.5), TypeParam(10)};
  EXPECT_EQ(strainwave::amplified_V(amplifier, TypeParam(0.0078125)), TypeParam(8.3125));
  EXPECT_EQ(strainwave::amplified_V(amplifier, TypeParam(1)), TypeParam(10));
  EXPECT_EQ(strainwave::amplified_V(amplifier, TypeParam(-1)), TypeParam(-10));
}

TYPED_TEST(Bridge, EveryCodeComesBack) {
  for (const std::uint32_t bits : {8U, 12U, 16U}) {
    for (const bool two_complement : {false, true}) {
      const Converter<TypeParam> converter{bits, TypeParam(-10), TypeParam(10),
                                           two_complement ? -(std::int32_t{1} << (bits - 1)) : 0};
      for (std::int32_t i = 0; i < (std::int32_t{1} << bits); ++i) {
        const ConverterCode code{converter.lowest_code + i};
        ASSERT_EQ(strainwave::to_code(converter, strainwave::to_volts(converter, code)), code);
      }
    }
  }
}

TEST(Bridge, EveryCodeOf24BitsComesBack) {
  const Converter<double> converter{24, -10.0, 10.0, -(1 << 23)};
  for (std::int32_t value = -(1 << 23); value < (1 << 23); value += 1009) {
    const ConverterCode code{value};
    ASSERT_EQ(strainwave::to_code(converter, strainwave::to_volts(converter, code)), code);
  }
}

TYPED_TEST(Bridge, RoundsToTheNearestCode) {
  const Converter<TypeParam> converter{8, TypeParam(-128), TypeParam(128), 0};  // 1 V a code
  EXPECT_EQ(strainwave::step_V(converter), TypeParam(1));
  EXPECT_EQ(strainwave::to_code(converter, TypeParam(-127.75)).value, 0);
  EXPECT_EQ(strainwave::to_code(converter, TypeParam(-127.25)).value, 1);
  EXPECT_EQ(strainwave::to_code(converter, TypeParam(0.25)).value, 128);
  EXPECT_EQ(strainwave::to_code(converter, TypeParam(126.75)).value, 255);
  EXPECT_EQ(strainwave::to_volts(converter, {130}), TypeParam(2));
}

TYPED_TEST(Bridge, CodesOfEveryWildInputStayInRange) {
  const Converter<TypeParam> converter{16, TypeParam(-10), TypeParam(10), -32768};
  using Limits = std::numeric_limits<TypeParam>;
  for (const TypeParam high : {TypeParam(10), TypeParam(11), Limits::max(), Limits::infinity()}) {
    EXPECT_EQ(strainwave::to_code(converter, high).value, 32767);
    EXPECT_EQ(strainwave::to_code(converter, -high).value, -32768);
  }
  EXPECT_EQ(strainwave::to_code(converter, Limits::quiet_NaN()).value, -32768);
}

TYPED_TEST(Bridge, SaturationAtAndBeyondBothEnds) {
  const Converter<TypeParam> converter{16, TypeParam(-10), TypeParam(10), -32768};
  for (const std::int32_t code : {-32768, 32767, 32768, -32769, 1 << 30, -(1 << 30)}) {
    EXPECT_TRUE(strainwave::is_saturated(converter, ConverterCode{code})) << code;
  }
  for (const std::int32_t code : {-32767, 0, 32766}) {
    EXPECT_FALSE(strainwave::is_saturated(converter, ConverterCode{code})) << code;
  }
}

TYPED_TEST(Bridge, VoltsOfTheWildestCodesAreDefined) {
  // Codes reach the sample path unchecked; their difference must not overflow.
  const Converter<TypeParam> converter{16, TypeParam(-10), TypeParam(10), -32768};
  EXPECT_GT(strainwave::to_volts(converter, {std::numeric_limits<std::int32_t>::max()}),
            TypeParam(1e5));
  const Converter<TypeParam> shifted{16, TypeParam(-10), TypeParam(10), 1000};
  EXPECT_LT(strainwave::to_volts(shifted, {std::numeric_limits<std::int32_t>::min()}),
            TypeParam(-1e5));
}

TYPED_TEST(Bridge, CheckNamesTheParameter) {
  const TypeParam nan = std::numeric_limits<TypeParam>::quiet_NaN();
  EXPECT_TRUE(check(Rosette<TypeParam>{}).ok());
  EXPECT_STREQ(check(Rosette<TypeParam>{.position_rad = nan}).parameter, "position_rad");
  EXPECT_STREQ(check(Rosette<TypeParam>{.radius_m = TypeParam(0)}).parameter, "radius_m");
  EXPECT_STREQ(check(Rosette<TypeParam>{.orientation_error_rad = TypeParam(4)}).parameter,
               "orientation_error_rad");
  EXPECT_STREQ(check(Rosette<TypeParam>{.gauge_factor = -nan}).parameter, "gauge_factor");
  EXPECT_TRUE(check(Amplifier<TypeParam>{}).ok());
  EXPECT_STREQ(check(Amplifier<TypeParam>{.gain = TypeParam(0)}).parameter, "gain");
  EXPECT_STREQ(check(Amplifier<TypeParam>{.offset_V = nan}).parameter, "offset_V");
  EXPECT_STREQ(check(Amplifier<TypeParam>{.rail_V = TypeParam(-1)}).parameter, "rail_V");
  EXPECT_TRUE(check(Converter<TypeParam>{}).ok());
  EXPECT_STREQ(check(Converter<TypeParam>{.bits = 0}).parameter, "bits");
  EXPECT_STREQ(check(Converter<TypeParam>{.bits = 25}).parameter, "bits");
  EXPECT_STREQ(check(Converter<TypeParam>{.minimum_V = nan}).parameter, "minimum_V");
  EXPECT_STREQ(check(Converter<TypeParam>{.maximum_V = TypeParam(-10)}).parameter, "maximum_V");
  EXPECT_STREQ(check(Converter<TypeParam>{.lowest_code = 1 << 30}).parameter, "lowest_code");
}

TYPED_TEST(Bridge, CheckRefusesTheLowestOfAllCodes) {
  const Converter<TypeParam> converter{.lowest_code = std::numeric_limits<std::int32_t>::min()};
  EXPECT_STREQ(check(converter).parameter, "lowest_code");
}

}  // namespace
