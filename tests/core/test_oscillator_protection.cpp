// What protects the published filter on the sample path: missing samples, limits, rest and crawl.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "strainwave/oscillator_filter.hpp"

namespace {

using strainwave::has;
using strainwave::OscillatorFilterConfig;
using strainwave::OscillatorFilterState;
using strainwave::OscillatorSample;
using strainwave::RotationSource;
using strainwave::StatusFlag;

template <class Real>
class OscillatorProtection : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(OscillatorProtection, Precisions);

template <class Real>
Real variance_of(const OscillatorFilterState<Real, 3>& state, std::size_t i) {
  return state.covariance(i, i);
}

TYPED_TEST(OscillatorProtection, MissingSamplesBringTheirProcessNoise) {
  // At standstill nothing rotates, and the quadrature of order 2 is never seen: its variance is
  // P(0) plus Q for every sample that has passed, missing ones included.
  using Real = TypeParam;
  const auto config = strainwave::taghirad1999<Real, 3>({100, 1});
  auto state = strainwave::initial_state(config);
  (void)strainwave::step(config, state, {});
  EXPECT_FLOAT_EQ(static_cast<float>(variance_of(state, 1)), 2e3F);
  strainwave::skip(config, state, 5);
  (void)strainwave::step(config, state, {});
  EXPECT_FLOAT_EQ(static_cast<float>(variance_of(state, 1)), 8e3F);
}

TYPED_TEST(OscillatorProtection, LimitedVarianceKeepsItsCorrelations) {
  using Real = TypeParam;
  auto config = strainwave::taghirad1999<Real, 3>({100, 1});
  config.variance_limit_ratio = Real(100);
  auto state = strainwave::initial_state(config);
  // Variances 4e5 and 1e5 in the second block, correlated with each other and with the first.
  const auto at = [&state](std::size_t i, std::size_t j) -> Real& {
    return state.covariance_Nm2[j][i];
  };
  at(2, 2) = Real(4e5);
  at(3, 3) = Real(1e5);
  at(3, 2) = Real(5e4);
  at(2, 0) = Real(3e3);
  at(3, 1) = Real(2e3);
  const auto correlation = [&at](std::size_t i, std::size_t j) {
    return at(i, j) / std::sqrt(at(i, i) * at(j, j));
  };
  const Real before[3] = {correlation(3, 2), correlation(2, 0), correlation(3, 1)};
  EXPECT_TRUE(strainwave::detail::limit_variance(config, state));
  EXPECT_NEAR(at(2, 2) / Real(101e3), Real(1), Real(1e-5));    // P(0) + 100 Q
  EXPECT_NEAR(at(3, 3) / Real(25.25e3), Real(1), Real(1e-5));  // in proportion
  EXPECT_NEAR(correlation(3, 2), before[0], Real(1e-6));
  EXPECT_NEAR(correlation(2, 0), before[1], Real(1e-6));
  EXPECT_NEAR(correlation(3, 1), before[2], Real(1e-6));
  EXPECT_FALSE(strainwave::detail::limit_variance(config, state) && at(2, 2) < Real(1e5));
}

TYPED_TEST(OscillatorProtection, LimitIsNeverBelowTheInitialVariance) {
  using Real = TypeParam;
  OscillatorFilterConfig<Real, 3> config;
  config.process_noise_variance_Nm2[0] = Real(1e-9);
  config.initial_variance_Nm2 = Real(1);  // 1e4 times what the ratio would allow
  auto state = strainwave::initial_state(config);
  OscillatorSample<Real> sample;
  sample.motor_speed_rad_s = Real(156);
  (void)strainwave::step(config, state, sample);
  EXPECT_FALSE(has(strainwave::step(config, state, sample).status, StatusFlag::variance_limited));
  EXPECT_GT(variance_of(state, 1), Real(0.5));
}

TYPED_TEST(OscillatorProtection, GapIsNoRaceOfTheMotor) {
  // 1 rad a sample is within reach of order 2; 40 samples' worth of it at once is not a speed.
  using Real = TypeParam;
  OscillatorFilterConfig<Real, 3> config;
  config.rotation_source = RotationSource::angle;
  auto state = strainwave::initial_state(config);
  OscillatorSample<Real> sample;
  for (int k = 0; k < 2000; ++k) {
    sample.motor_phase = strainwave::phase_from_radians(1.0 * k);
    (void)strainwave::step(config, state, sample);
  }
  const Real speed_before = state.smoothed_speed_rad_s;
  strainwave::skip(config, state, 39);
  sample.motor_phase = strainwave::phase_from_radians(2039.0);
  const auto reading = strainwave::step(config, state, sample);
  EXPECT_FALSE(has(reading.status, StatusFlag::order_above_nyquist));
  EXPECT_NEAR(state.smoothed_speed_rad_s / speed_before, Real(1), Real(1e-3));
}

TYPED_TEST(OscillatorProtection, LearningBeginsWhenTheSmoothedSpeedPassesTheLimit) {
  // 1 rad/s against a limit of 0.5 rad/s over a time constant of 50 ms: 50 ln 2 = 34.7 ms.
  using Real = TypeParam;
  const OscillatorFilterConfig<Real, 3> config;
  auto state = strainwave::initial_state(config);
  OscillatorSample<Real> sample;
  sample.measured_torque_Nm = Real(1);
  sample.motor_speed_rad_s = Real(1);
  int k = 0;
  while (has(strainwave::step(config, state, sample).status, StatusFlag::at_rest)) {
    ASSERT_LT(++k, 1000);
  }
  EXPECT_GE(k, 33);
  EXPECT_LE(k, 38);
}

TYPED_TEST(OscillatorProtection, EverySampleInMotionIsLearnedFrom) {
  using Real = TypeParam;
  for (const RotationSource source : {RotationSource::speed, RotationSource::angle}) {
    OscillatorFilterConfig<Real, 3> config;
    config.rotation_source = source;
    auto state = strainwave::initial_state(config);
    for (int k = 0; k < 2000; ++k) {
      OscillatorSample<Real> sample;
      sample.measured_torque_Nm = Real(1);
      sample.motor_speed_rad_s = Real(1.5);  // 1.5 mrad a sample, and 1 mrad is asked for
      sample.motor_phase = strainwave::phase_from_radians(1.5e-3 * k);
      const auto reading = strainwave::step(config, state, sample);
      ASSERT_EQ(has(reading.status, StatusFlag::at_rest), k < 21) << k;  // 50 ln 1.5 = 20.3 ms
    }
  }
}

TYPED_TEST(OscillatorProtection, TenMinutesOfCrawlKeepThePhase) {
  // Learned at speed, then 0.4 rad/s, below the speed at which it learns: what it learned must turn
  // with the motor for 240 rad, in float too.
  using Real = TypeParam;
  const OscillatorFilterConfig<Real, 3> config;
  auto state = strainwave::initial_state(config);
  double angle_rad = 0.0;
  double worst_Nm = 0.0;
  for (int k = 0; k < 620'000; ++k) {
    const double speed_rad_s = k < 20'000 ? 156.0 : 0.4;
    OscillatorSample<Real> sample;
    sample.measured_torque_Nm = static_cast<Real>(std::cos(2.0 * angle_rad));
    sample.motor_speed_rad_s = static_cast<Real>(speed_rad_s);
    const auto reading = strainwave::step(config, state, sample);
    if (k > 21'000) {
      worst_Nm = std::fmax(worst_Nm, std::fabs(static_cast<double>(reading.torque_Nm)));
    }
    angle_rad += speed_rad_s * 1e-3;
  }
  EXPECT_LT(worst_Nm, 0.02);
  EXPECT_GT(worst_Nm, 0.0);
}

TYPED_TEST(OscillatorProtection, AngleLostAtACrawlLeavesTheRippleWhereItWas) {
  // Learned at speed, then a crawl at which nothing is learned: the states' frame stays behind
  // while the motor goes on by half a radian. A sample without an angle must not fall back to that
  // frame.
  using Real = TypeParam;
  OscillatorFilterConfig<Real, 3> config;
  config.rotation_source = RotationSource::angle;
  auto state = strainwave::initial_state(config);
  double angle_rad = 0.0;
  for (int k = 0; k < 22'000; ++k) {
    OscillatorSample<Real> sample;
    sample.measured_torque_Nm = static_cast<Real>(std::cos(2.0 * angle_rad));
    sample.motor_phase = strainwave::phase_from_radians(angle_rad);
    sample.phase_valid = k < 21'999;
    const auto reading = strainwave::step(config, state, sample);
    if (!sample.phase_valid) {
      ASSERT_TRUE(has(reading.status, StatusFlag::rotation_invalid));
      EXPECT_NEAR(reading.torque_Nm, Real(0), Real(0.02));
      EXPECT_NE(state.frame, state.last_phase);
    }
    angle_rad += k < 20'000 ? 0.156 : 0.00025;
  }
}

TYPED_TEST(OscillatorProtection, MonthsOfCrawlStayDefined) {
  // The largest order and the longest sum: nothing overflows (checked by the sanitizers), and the
  // angle is that of all rotations together.
  using Real = TypeParam;
  OscillatorFilterConfig<Real, 3> config;
  config.orders[0] = {1000, 1};
  auto state = strainwave::initial_state(config);
  OscillatorSample<Real> sample;
  sample.measured_torque_Nm = Real(1);
  sample.motor_speed_rad_s = Real(0.49);
  constexpr int samples = 300'000;
  for (int k = 0; k < samples; ++k) {
    const auto reading = strainwave::step(config, state, sample);
    ASSERT_TRUE(std::isfinite(reading.torque_Nm));
  }
  const double turns =
      static_cast<double>(state.angle[0]) * (sizeof(Real) == 4 ? 0x1p-32 : 0x1p-64);
  const double expected = 1000.0 * static_cast<double>(sample.motor_speed_rad_s) * 1e-3 * samples /
                          (2.0 * std::numbers::pi);
  const double deviation = std::remainder(turns - expected, 1.0);
  EXPECT_LT(std::fabs(deviation), sizeof(Real) == 4 ? 5e-3 : 1e-9);
  EXPECT_NEAR(state.travel_rad / Real(147), Real(1), Real(1e-2));  // 0.49 rad/s for 300 s, as a sum
}

}  // namespace
