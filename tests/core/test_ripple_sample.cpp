// What a sample becomes before anything is learned from it.
#include "strainwave/ripple_sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>

#include "ripple_examples.hpp"

namespace {

using strainwave::has;
using strainwave::StatusFlag;

template <class Real>
class RippleSampleOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleSampleOf, Precisions);

/// A filter that has learned the example's ripple at 150 rad/s, until angle 1500 rad.
template <class Real>
struct Running {
  strainwave::RippleFilterConfig<Real, 3> config;
  strainwave::RippleFilterState<Real, 3> state;
  double angle_rad = 0.0;

  [[nodiscard]] static strainwave::RippleFilterConfig<Real, 3> with_delay(double delay_s) {
    auto delayed = two_orders<Real, 3>();
    delayed.angle_to_torque_delay_s = static_cast<Real>(delay_s);
    return delayed;
  }

  explicit Running(double delay_s = 0.0)
      : config(with_delay(delay_s)), state(strainwave::initial_state(config)) {
    for (int k = 0; k < 10'000; ++k) {
      angle_rad = 0.15 * k;
      (void)step(sample(angle_rad));
    }
  }
  [[nodiscard]] double ripple_at(double angle) const {
    return example_ripple_Nm(angle - 150.0 * static_cast<double>(config.angle_to_torque_delay_s));
  }
  [[nodiscard]] strainwave::RippleSample<Real> sample(double angle) const {
    return ripple_sample<Real>(5.0 + ripple_at(angle), angle);
  }
  strainwave::RippleReading<Real> step(const strainwave::RippleSample<Real>& sample) {
    return strainwave::step(config, state, sample);
  }
};

TYPED_TEST(RippleSampleOf, WithoutAnAngleTheRippleGoesOnForATurnAndThenStops) {
  for (const double delay_s : {0.0, 0.0023, -0.002}) {
    Running<TypeParam> motor(delay_s);
    bool stopped = false;
    for (int k = 1; k < 100; ++k) {
      auto sample = motor.sample(motor.angle_rad + 0.15 * k);
      sample.phase_valid = false;
      const auto reading = motor.step(sample);
      ASSERT_TRUE(has(reading.status, StatusFlag::rotation_invalid));
      ASSERT_EQ(reading.innovation_Nm, TypeParam(0));
      if (0.15 * k < 6.2) {
        ASSERT_NEAR(reading.torque_Nm, TypeParam(5), TypeParam(0.03)) << k;
      } else if (0.15 * k > 6.4) {
        stopped = true;
        ASSERT_EQ(reading.torque_Nm, sample.measured_torque_Nm);
      }
    }
    EXPECT_TRUE(stopped);
    const auto back = motor.step(motor.sample(motor.angle_rad + 15.0));
    EXPECT_NEAR(back.torque_Nm, TypeParam(5), TypeParam(0.03));
    EXPECT_FALSE(has(back.status, StatusFlag::rotation_invalid));
  }
}

TYPED_TEST(RippleSampleOf, AJumpOfTheAngleIsNamedAndNotLearned) {
  Running<TypeParam> motor;
  const auto before = motor.state;
  const auto jumped = motor.step(motor.sample(motor.angle_rad + 10.5));  // 10,500 rad/s
  EXPECT_TRUE(has(jumped.status, StatusFlag::rotation_invalid));
  EXPECT_NEAR(jumped.torque_Nm, TypeParam(5), TypeParam(0.03));
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(motor.state.states_Nm[i], before.states_Nm[i]);
  }
  EXPECT_EQ(motor.state.speed_rad_s, before.speed_rad_s);
  const auto next = motor.step(motor.sample(motor.angle_rad + 10.65));
  EXPECT_EQ(next.status & strainwave::fault_mask, 0U);
  Running<TypeParam> fast;
  EXPECT_FALSE(
      has(fast.step(fast.sample(fast.angle_rad + 9.9)).status, StatusFlag::rotation_invalid));
}

TYPED_TEST(RippleSampleOf, AfterAJumpADelayIsStillCompensated) {
  // The motor runs on while its encoder is set anew: a delay of 10 ms is 1.5 rad all the while.
  Running<TypeParam> motor(0.01);
  const double two_pi = 6.28318530717958647693;
  double worst = 0.0;
  for (int k = 1; k <= 40; ++k) {
    auto sample = motor.sample(motor.angle_rad + 0.15 * k);
    sample.motor_phase = strainwave::phase_from_radians(motor.angle_rad + 0.15 * k + 20 * two_pi);
    const auto reading = motor.step(sample);
    worst = std::fmax(worst, std::fabs(static_cast<double>(reading.torque_Nm) - 5.0));
  }
  EXPECT_LT(worst, 0.1);
}

TYPED_TEST(RippleSampleOf, LearningWaitsUntilTheAngleOfTheDelayIsOnRecord) {
  // 10 ms at 1 kHz: eleven points; the last speed stands for what is not on record.
  Running<TypeParam> fresh(0.0);
  fresh.config.angle_to_torque_delay_s = TypeParam(0.0095);
  fresh.state = strainwave::initial_state(fresh.config);
  for (int k = 0; k < 30; ++k) {
    (void)fresh.step(fresh.sample(0.15 * k));
    EXPECT_EQ(fresh.state.torque_known, k >= 10) << k;
  }
  Running<TypeParam> motor(0.0095);
  const double two_pi = 6.28318530717958647693;
  for (int k = 1; k < 30; ++k) {  // row 1 jumps, and the record begins with it
    const auto before = motor.state;
    auto sample = motor.sample(motor.angle_rad + 0.15 * k);
    sample.motor_phase = strainwave::phase_from_radians(motor.angle_rad + 0.15 * k + 20 * two_pi);
    const auto reading = motor.step(sample);
    EXPECT_EQ(has(reading.status, StatusFlag::rotation_invalid), k == 1);
    EXPECT_EQ(reading.innovation_Nm != TypeParam(0), k >= 11) << k;
    EXPECT_EQ(motor.state.states_Nm[0] != before.states_Nm[0], k >= 11) << k;
    // The speed is smoothed, not the true one: 2 mrad of angle here.
    ASSERT_NEAR(reading.torque_Nm, TypeParam(5), TypeParam(0.03)) << k;
  }
}

TYPED_TEST(RippleSampleOf, LongestDelayAtTheSpeedOfAFastMotor) {
  // 50 ms at 1047 rad/s (10,000 rpm) are 52 rad.
  auto config = two_orders<TypeParam, 3>();
  config.angle_to_torque_delay_s = TypeParam(0.05);
  auto state = strainwave::initial_state(config);
  double worst = 0.0;
  for (int k = 0; k < 16'000; ++k) {
    const double angle_rad = 1047.0 / 4000.0 * k;
    const auto reading =
        strainwave::step(config, state,
                         ripple_sample<TypeParam>(example_ripple_Nm(angle_rad - 1047.0 * 0.05),
                                                  angle_rad, 1.0 / 4000.0));
    if (k > 12'000) {
      worst = std::fmax(worst, std::fabs(static_cast<double>(reading.torque_Nm)));
    }
  }
  EXPECT_LT(worst, 0.1);
}

TYPED_TEST(RippleSampleOf, HeldRowsAreNamedOnlyWhileTheMotorTurns) {
  Running<TypeParam> motor;
  const auto last = motor.sample(motor.angle_rad);
  const auto before = motor.state;
  for (int k = 0; k < 3; ++k) {
    const auto held = motor.step(last);
    EXPECT_EQ(held.status, strainwave::mask(StatusFlag::sample_repeated));
    EXPECT_EQ(held.torque_Nm, before.torque_Nm);
    EXPECT_EQ(held.innovation_Nm, TypeParam(0));
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(motor.state.states_Nm[i], before.states_Nm[i]);
  }
  const auto next = motor.step(motor.sample(motor.angle_rad + 0.15 * 4));
  EXPECT_EQ(next.status, 0U);
  EXPECT_NEAR(motor.state.speed_rad_s, TypeParam(150), TypeParam(0.1));
}

TYPED_TEST(RippleSampleOf, AMotorThatStopsDeadIsNotHeldForLong) {
  Running<TypeParam> motor;
  const auto last = motor.sample(motor.angle_rad);
  int held = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto reading = motor.step(last);
    held += has(reading.status, StatusFlag::sample_repeated) ? 1 : 0;
    ASSERT_NEAR(reading.torque_Nm, TypeParam(5), TypeParam(0.03));
  }
  EXPECT_LT(held, 250);  // 0.1 s, and again until the speed has faded
  EXPECT_GT(held, 50);
  EXPECT_NEAR(motor.state.smoothed_speed_rad_s, TypeParam(0), TypeParam(0.1));
}

TYPED_TEST(RippleSampleOf, UnusableIntervalsAreRefused) {
  using Limits = std::numeric_limits<TypeParam>;
  Running<TypeParam> motor;
  const auto before = motor.state;
  const auto with = [&](TypeParam interval_s) {
    auto sample = motor.sample(motor.angle_rad + 0.15);
    sample.interval_s = interval_s;
    return motor.step(sample).status;
  };
  EXPECT_EQ(with(TypeParam(0)), strainwave::mask(StatusFlag::sample_out_of_order));
  EXPECT_EQ(with(TypeParam(-1e-3)), strainwave::mask(StatusFlag::sample_out_of_order));
  EXPECT_EQ(with(Limits::quiet_NaN()), strainwave::mask(StatusFlag::time_not_finite));
  EXPECT_EQ(with(Limits::infinity()), strainwave::mask(StatusFlag::time_not_finite));
  EXPECT_EQ(motor.state.speed_rad_s, before.speed_rad_s);
  EXPECT_EQ(motor.state.time_since_phase_s, before.time_since_phase_s);
  EXPECT_EQ(motor.state.last_phase, before.last_phase);
  EXPECT_EQ(motor.step(motor.sample(motor.angle_rad + 0.15)).status, 0U);
}

TYPED_TEST(RippleSampleOf, IntervalsThatNoClockHasAreRefusedFromTheFirstRowOn) {
  using Limits = std::numeric_limits<TypeParam>;
  const auto config = two_orders<TypeParam, 3>();
  auto state = strainwave::initial_state(config);
  for (const TypeParam interval_s :
       {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), TypeParam(1.001e6)}) {
    const auto reading = strainwave::step(
        config, state, ripple_sample<TypeParam>(5.0, 1.0, static_cast<double>(interval_s)));
    EXPECT_EQ(reading.status, strainwave::mask(StatusFlag::time_not_finite));
    EXPECT_FALSE(state.phase_known);
    EXPECT_FALSE(state.torque_known);
    EXPECT_EQ(reading.torque_Nm, TypeParam(0));
  }
  // The first row's interval is not used, and 1e6 s are 11 days, not a fault.
  (void)strainwave::step(config, state, ripple_sample<TypeParam>(5.0, 1.0, 0.0));
  EXPECT_TRUE(state.torque_known);
  const auto late = strainwave::step(config, state, ripple_sample<TypeParam>(5.0, 1.0, 1e6));
  EXPECT_EQ(late.status & strainwave::fault_mask, 0U);
  EXPECT_EQ(strainwave::step(config, state, ripple_sample<TypeParam>(5.0, 1.0, 1.001e6)).status,
            strainwave::mask(StatusFlag::time_not_finite));
}

TYPED_TEST(RippleSampleOf, TheLoadIsLowPassedOverAllTimeSinceTheLastUpdate) {
  // Three rows without torque between: four intervals, to the last bit of the formula.
  Running<TypeParam> motor;
  const TypeParam load_Nm = motor.state.load_Nm;
  for (int k = 1; k <= 3; ++k) {
    auto sample = motor.sample(motor.angle_rad + 0.15 * k);
    sample.torque_valid = false;
    (void)motor.step(sample);
    EXPECT_EQ(motor.state.load_Nm, load_Nm);
  }
  auto sample = motor.sample(motor.angle_rad + 0.6);
  sample.measured_torque_Nm += TypeParam(2);
  const auto reading = motor.step(sample);
  const auto share = static_cast<TypeParam>(0.004 / (0.004 + 1.0 / (6.2831853 * 15.0)));
  EXPECT_NEAR(motor.state.load_Nm, load_Nm + share * (reading.torque_all_removed_Nm - load_Nm),
              sizeof(TypeParam) == 4 ? 2e-6 : 1e-7);  // the time constant is a float
  EXPECT_GT(motor.state.load_Nm, load_Nm + TypeParam(0.4));
}

TYPED_TEST(RippleSampleOf, TheTypicalIntervalIsThatOf64UpdatesAndGapsMoveItLittle) {
  Running<TypeParam> motor;
  EXPECT_NEAR(motor.state.typical_interval_s, TypeParam(1e-3), TypeParam(1e-8));
  const auto with = [&](double interval_s, int rows) {
    for (int k = 0; k < rows; ++k) {
      motor.angle_rad += 150.0 * interval_s;
      auto sample = motor.sample(motor.angle_rad);
      sample.interval_s = static_cast<TypeParam>(interval_s);
      (void)motor.step(sample);
    }
    return static_cast<double>(motor.state.typical_interval_s);
  };
  EXPECT_NEAR(with(0.5, 1), 1e-3 * (1.0 + 1.0 / 64.0), 1e-8);
  EXPECT_NEAR(with(1e-3, 64), 1e-3 * (1.0 + std::pow(63.0 / 64.0, 64) / 64.0), 1e-8);
  EXPECT_NEAR(with(2e-3, 64) / 2e-3, 1.0 - 0.5 * std::pow(63.0 / 64.0, 64), 0.01);
  EXPECT_NEAR(with(2e-3, 1000), 2e-3, 1e-7);
}

TYPED_TEST(RippleSampleOf, IntervalsOfAnyLengthLeaveNumbers) {
  using Limits = std::numeric_limits<TypeParam>;
  Running<TypeParam> motor(0.0023);
  auto sample = motor.sample(motor.angle_rad + 0.15);
  sample.interval_s = Limits::max();
  sample.phase_valid = false;
  (void)motor.step(sample);
  (void)motor.step(sample);  // their sum is infinite
  sample.phase_valid = true;
  (void)motor.step(sample);
  for (int k = 2; k < 6000; ++k) {
    const auto reading = motor.step(motor.sample(motor.angle_rad + 0.15 * k));
    ASSERT_TRUE(strainwave::is_finite(reading.ripple_Nm)) << k;
    ASSERT_TRUE(strainwave::is_finite(motor.state.speed_rad_s)) << k;
    if (k > 5000) {
      ASSERT_NEAR(reading.torque_Nm, TypeParam(5), TypeParam(0.05)) << k;
    }
  }
}

TYPED_TEST(RippleSampleOf, AboveNyquistIsSaid) {
  Running<TypeParam> motor;
  EXPECT_FALSE(has(motor.step(motor.sample(motor.angle_rad + 0.78)).status,
                   StatusFlag::order_above_nyquist));
  EXPECT_TRUE(has(motor.step(motor.sample(motor.angle_rad + 0.78 + 0.79)).status,
                  StatusFlag::order_above_nyquist));
}

TYPED_TEST(RippleSampleOf, TorqueKnownToBeWrongIsHeldWithoutAFlag) {
  Running<TypeParam> motor;
  const auto before = motor.state;
  auto sample = motor.sample(motor.angle_rad + 0.15);
  sample.torque_valid = false;
  sample.measured_torque_Nm = std::numeric_limits<TypeParam>::quiet_NaN();
  const auto reading = motor.step(sample);
  EXPECT_EQ(reading.status, 0U);  // the caller knows why and says so
  EXPECT_EQ(reading.torque_Nm, before.torque_Nm);
  EXPECT_NEAR(reading.ripple_Nm, static_cast<TypeParam>(motor.ripple_at(motor.angle_rad + 0.15)),
              TypeParam(0.03));
}

}  // namespace
