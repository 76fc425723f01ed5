// What the published filter can be told: presets, and the check of everything else.
#include "strainwave/oscillator_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "oscillator_examples.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace {

using strainwave::OscillatorFilterConfig;
using strainwave::OscillatorSample;
using strainwave::RotationSource;

TEST(OscillatorConfig, PresetsAreThePaperAndNothingElse) {
  const auto six = strainwave::taghirad1999<double, 3>({241, 2});
  ASSERT_EQ(six.order_count, 3U);
  EXPECT_EQ(six.orders[0], (strainwave::Order{2, 1}));
  EXPECT_EQ(six.orders[1], (strainwave::Order{4, 1}));
  EXPECT_EQ(six.orders[2], (strainwave::Order{2, 241}));
  const auto four = strainwave::taghirad1999_4<double, 3>();
  EXPECT_EQ(four.order_count, 2U);
  for (const auto& config : {six, four}) {
    for (std::size_t a = 0; a < config.order_count; ++a) {
      EXPECT_EQ(config.process_noise_variance_Nm2[a], 1e3);
    }
    EXPECT_EQ(config.measurement_noise_variance_Nm2, 1.0);
    EXPECT_EQ(config.initial_variance_Nm2, 1e3);
    EXPECT_EQ(config.sample_period_s, 1e-3);
    EXPECT_EQ(config.rotation_source, RotationSource::speed);
    EXPECT_EQ(config.minimum_travel_rad, 0.0);
    EXPECT_EQ(config.variance_limit_ratio, 0.0);
    EXPECT_TRUE(check(config).ok());
  }
  const OscillatorFilterConfig<double, 3> standard;
  EXPECT_GT(standard.minimum_travel_rad, 0.0);  // protection is on by default
  EXPECT_GT(standard.variance_limit_ratio, 0.0);
}

template <class Real>
class OscillatorConfigOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(OscillatorConfigOf, Precisions);

TYPED_TEST(OscillatorConfigOf, OrdersBeyondTheReductionAreRefused) {
  OscillatorFilterConfig<TypeParam, 1> config;
  config.orders[0] = {2'000'000'000, 1};
  EXPECT_STREQ(check(config).parameter, "orders");
}

TYPED_TEST(OscillatorConfigOf, EveryConfigurationThatPassesItsCheckStaysFinite) {
  using Real = TypeParam;
  using Limits = std::numeric_limits<Real>;
  const Real sizes[] = {Limits::denorm_min(), Limits::min(), Real(1e-20), Real(1),
                        Real(1e30),           Limits::max()};
  int accepted = 0;
  for (const Real r : sizes) {
    for (const Real p0 : sizes) {
      for (const Real q :
           {Real(0), Limits::denorm_min(), Real(1e-20), Real(1), Real(1e30), Limits::max()}) {
        for (const Real ratio : {Real(0), Real(100), Limits::max()}) {
          OscillatorFilterConfig<Real, 2> config;
          config.order_count = 2;
          config.orders[1] = {1, 100};
          config.process_noise_variance_Nm2[0] = q;
          config.process_noise_variance_Nm2[1] = q;
          config.measurement_noise_variance_Nm2 = r;
          config.initial_variance_Nm2 = p0;
          config.variance_limit_ratio = ratio;
          if (!check(config).ok()) {
            continue;
          }
          ++accepted;
          auto state = strainwave::initial_state(config);
          bool finite = true;
          for (int k = 0; k < 50; ++k) {
            OscillatorSample<Real> sample;
            sample.measured_torque_Nm = k % 2 == 0 ? Real(1e15) : Real(-3);
            sample.motor_speed_rad_s = static_cast<Real>(20 * k);
            const auto reading = strainwave::step(config, state, sample);
            finite = finite && strainwave::is_finite(reading.torque_Nm) &&
                     strainwave::is_finite(reading.ripple_Nm);
          }
          EXPECT_TRUE(finite) << "R " << r << " P(0) " << p0 << " Q " << q << " limit " << ratio;
        }
      }
    }
  }
  EXPECT_GT(accepted, 20);
}

TYPED_TEST(OscillatorConfigOf, CheckNamesEveryParameter) {
  using Real = TypeParam;
  using Config = OscillatorFilterConfig<Real, 3>;
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  const auto parameter = [](auto change) {
    Config config = tuned<Real, 3>(3);
    change(config);
    const auto violation = check(config);
    return violation.ok() ? "" : violation.parameter;
  };
  EXPECT_STREQ(parameter([](Config&) {}), "");
  EXPECT_STREQ(parameter([](Config& c) { c.order_count = 0; }), "orders");
  EXPECT_STREQ(parameter([](Config& c) { c.order_count = 4; }), "orders");
  EXPECT_STREQ(parameter([](Config& c) { c.orders[1] = {0, 1}; }), "orders");
  EXPECT_STREQ(parameter([](Config& c) { c.orders[1] = {1, 0}; }), "orders");
  EXPECT_STREQ(parameter([](Config& c) { c.orders[1] = {2, 1}; }), "orders");
  EXPECT_STREQ(parameter([](Config& c) { c.orders[1] = {4, 2}; }), "orders");  // 2, not reduced
  for (const Real wrong : {nan, Real(-1), std::numeric_limits<Real>::infinity()}) {
    EXPECT_STREQ(parameter([&](Config& c) { c.process_noise_variance_Nm2[2] = wrong; }),
                 "process_noise_variance_Nm2");
    EXPECT_STREQ(parameter([&](Config& c) { c.measurement_noise_variance_Nm2 = wrong; }),
                 "measurement_noise_variance_Nm2");
    EXPECT_STREQ(parameter([&](Config& c) { c.initial_variance_Nm2 = wrong; }),
                 "initial_variance_Nm2");
    EXPECT_STREQ(parameter([&](Config& c) { c.sample_period_s = wrong; }), "sample_period_s");
    EXPECT_STREQ(parameter([&](Config& c) { c.minimum_travel_rad = wrong; }), "minimum_travel_rad");
    EXPECT_STREQ(parameter([&](Config& c) { c.variance_limit_ratio = wrong; }),
                 "variance_limit_ratio");
  }
}

}  // namespace
