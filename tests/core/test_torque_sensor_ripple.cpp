// What the chain has with the ripple filter alone: time, held rows, frozen terms, what was learned.
// What it has with either filter is in test_torque_sensor.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "strainwave/learned_ripple.hpp"
#include "strainwave/torque_sensor.hpp"

namespace {

using strainwave::has;
using strainwave::mask;
using strainwave::StatusFlag;

constexpr double speed_rad_s = 150.0;
constexpr double period_s = 1e-3;
constexpr double torque_Nm = 13.2;
constexpr double ripple_Nm = 2.64;

/// Statuses that say that the angle between two rows is large; no fault of a row after a gap.
constexpr strainwave::Status beside_the_point = mask(StatusFlag::order_above_nyquist);

template <class Real>
class RippleSensor : public testing::Test {
 protected:
  using Config = strainwave::RippleSensorConfig<Real, 4, 3>;
  using Sample = strainwave::TorqueSensorSample<4, Real>;
  using Reading = strainwave::TorqueReading<Real>;

  Config config = one_gauge();
  strainwave::RippleSensorState<Real, 4, 3> state = strainwave::initial_state(config);
  int k = 0;  ///< of the next sample

  static Config one_gauge() {
    Config config;
    config.converter = {24, Real(-10), Real(10), 0};
    config.calibration.gain_Nm_per_V = Real(6.6);
    config.filter.order_count = 2;
    config.filter.orders[1].order = {4, 1};
    return config;
  }
  [[nodiscard]] Sample sample_at(int n) const {
    Sample sample;
    const double angle_rad = speed_rad_s * period_s * n;
    const double volts = (torque_Nm + ripple_Nm * std::cos(2 * angle_rad)) / 6.6;
    sample.codes[0] = strainwave::to_code(config.converter, static_cast<Real>(volts));
    sample.expected_torque_Nm = static_cast<Real>(torque_Nm);
    sample.motor_phase = strainwave::phase_from_radians(angle_rad);
    sample.sequence = static_cast<std::uint32_t>(n);
    return sample;
  }
  /// Sample k, with an interval of so many periods; 0 for none.
  Sample next(int periods) {
    Sample sample = sample_at(k++);
    sample.interval_s = static_cast<Real>(periods * period_s);
    return sample;
  }
  Reading take(const Sample& sample) { return strainwave::step(config, state, sample); }
  void settle(int periods) {
    while (k < 3000) {
      (void)take(next(periods));
    }
  }
  /// Clean, and at the motor's speed: no interval was too short or too long.
  void expect_clean(const Reading& reading, double speed_tolerance_rad_s = 0.1) {
    EXPECT_EQ(reading.status & strainwave::fault_mask, 0U);
    EXPECT_NEAR(static_cast<double>(reading.torque_Nm), torque_Nm, 0.01);
    EXPECT_NEAR(static_cast<double>(state.filter.speed_rad_s), speed_rad_s, speed_tolerance_rad_s);
  }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleSensor, Precisions);

TYPED_TEST(RippleSensor, WithoutIntervalsTheSamplePeriodCounts) {
  this->settle(0);
  this->expect_clean(this->take(this->next(0)));
  this->config.sample_period_s = TypeParam(2e-3);  // as fast by the numbers, half by the clock
  for (int i = 0; i < 500; ++i) {
    (void)this->take(this->next(0));
  }
  EXPECT_NEAR(static_cast<double>(this->state.filter.speed_rad_s), 0.5 * speed_rad_s, 0.1);
}

TYPED_TEST(RippleSensor, TheCallersIntervalsGoBeforeTheSamplePeriod) {
  this->config.sample_period_s = TypeParam(1);
  this->settle(1);
  this->expect_clean(this->take(this->next(1)));
}

TYPED_TEST(RippleSensor, GapIsBridgedByNumbersOrByTheClock) {
  this->settle(0);
  this->k += 20;
  auto reading = this->take(this->next(0));
  EXPECT_EQ(reading.status & ~beside_the_point, mask(StatusFlag::samples_missing));
  this->expect_clean(reading);

  this->k += 20;
  auto sample = this->next(21);
  sample.sequence_valid = false;
  reading = this->take(sample);
  EXPECT_EQ(reading.status & ~beside_the_point, 0U);
  this->expect_clean(reading);
}

TYPED_TEST(RippleSensor, IntervalsOfRefusedRowsCountForTheNext) {
  this->settle(1);
  for (const int back : {0, 3}) {  // a row that came twice, a row that came late
    auto refused = this->sample_at(this->k - 1 - back);
    refused.interval_s = static_cast<TypeParam>(period_s);
    const auto status = this->take(refused).status;
    EXPECT_TRUE(
        has(status, back == 0 ? StatusFlag::sample_repeated : StatusFlag::sample_out_of_order));
  }
  this->k += 2;
  const auto reading = this->take(this->next(1));  // 3 ms after the last one that was taken
  this->expect_clean(reading);
  this->expect_clean(this->take(this->next(1)));
}

TYPED_TEST(RippleSensor, RowsWithoutATimeAreRefusedAndTheReadingIsHeld) {
  using Limits = std::numeric_limits<TypeParam>;
  this->settle(1);
  const auto before = this->take(this->next(1));
  struct Wrong {
    TypeParam interval_s;
    StatusFlag flag;
  };
  for (const Wrong wrong : {Wrong{TypeParam(-1e-3), StatusFlag::sample_out_of_order},
                            Wrong{Limits::quiet_NaN(), StatusFlag::time_not_finite},
                            Wrong{Limits::infinity(), StatusFlag::time_not_finite},
                            Wrong{-Limits::infinity(), StatusFlag::time_not_finite}}) {
    auto sample = this->next(1);
    sample.interval_s = wrong.interval_s;
    const auto reading = this->take(sample);
    EXPECT_EQ(reading.status, mask(wrong.flag));
    EXPECT_EQ(reading.torque_measured_Nm, before.torque_measured_Nm);
    EXPECT_EQ(reading.torque_Nm, before.torque_Nm);
  }
  this->expect_clean(this->take(this->next(5)));
}

TYPED_TEST(RippleSensor, HeldRowsAreFoundWithAndWithoutNumbers) {
  this->settle(0);
  for (const bool numbered : {true, false}) {
    auto sample = this->next(0);
    sample.sequence_valid = numbered;
    const auto before = this->take(sample);
    sample.sequence = static_cast<std::uint32_t>(this->k++);
    const auto reading = this->take(sample);
    EXPECT_EQ(reading.status, mask(StatusFlag::sample_repeated));
    EXPECT_EQ(reading.torque_Nm, before.torque_Nm);
    EXPECT_EQ(reading.torque_measured_Nm, before.torque_measured_Nm);
    sample = this->next(0);
    sample.sequence_valid = numbered;
    this->expect_clean(this->take(sample));
  }
}

TYPED_TEST(RippleSensor, AMissingAngleIsCarriedOn) {
  this->settle(0);
  auto sample = this->next(0);
  sample.motor_phase = {};
  sample.phase_valid = false;
  const auto reading = this->take(sample);
  EXPECT_EQ(reading.status, mask(StatusFlag::rotation_invalid));
  EXPECT_NEAR(static_cast<double>(reading.torque_Nm), torque_Nm, 0.02);
  this->expect_clean(this->take(this->next(0)));
}

TYPED_TEST(RippleSensor, FrozenTermsWaitForTheReference) {
  this->config.filter.frozen_count = 1;
  this->config.filter.frozen[0] = {{1, 100}, TypeParam(1.5), TypeParam(0)};
  this->settle(0);
  auto sample = this->next(0);
  auto referenced = this->state;
  const auto with = strainwave::step(this->config, referenced, sample);
  sample.phase_referenced = false;
  const auto without = this->take(sample);
  const double angle_rad = speed_rad_s * period_s * (this->k - 1);
  EXPECT_NEAR(static_cast<double>(with.ripple_Nm - without.ripple_Nm),
              1.5 * std::cos(angle_rad / 100), 1e-4);
}

TYPED_TEST(RippleSensor, WhatWasLearnedMakesAStartClean) {
  this->settle(0);
  const auto kept = strainwave::learned(this->config.filter, this->state.filter);
  ASSERT_TRUE(check(this->config.filter, kept).ok());
  this->state = strainwave::initial_state(this->config);
  this->k = 12'345;
  const auto cold = this->take(this->next(0));
  EXPECT_GT(std::fabs(static_cast<double>(cold.torque_Nm) - torque_Nm), 0.1);
  this->state = strainwave::initial_state(this->config);
  this->state.filter = strainwave::restored(this->config.filter, kept);
  const auto warm = this->take(this->next(0));
  EXPECT_NEAR(static_cast<double>(warm.torque_Nm), torque_Nm, 0.01);
}

TYPED_TEST(RippleSensor, CapacityChangesNothing) {
  const auto large = strainwave::converted<TypeParam, 8, 32>(this->config);
  auto large_state = strainwave::initial_state(large);
  EXPECT_EQ(large.sample_period_s, this->config.sample_period_s);
  for (int n = 0; n < 2000; ++n) {
    const auto sample = this->next(0);
    strainwave::TorqueSensorSample<8, TypeParam> same;
    same.codes[0] = sample.codes[0];
    same.expected_torque_Nm = sample.expected_torque_Nm;
    same.motor_phase = sample.motor_phase;
    same.sequence = sample.sequence;
    const auto a = this->take(sample);
    const auto b = strainwave::step(large, large_state, same);
    ASSERT_EQ(a.torque_Nm, b.torque_Nm) << n;
    ASSERT_EQ(a.status, b.status) << n;
  }
}

TYPED_TEST(RippleSensor, CheckLimitsTheSamplePeriod) {
  EXPECT_TRUE(check(this->config).ok());
  for (const TypeParam wrong : {TypeParam(0), TypeParam(-1e-3), TypeParam(2e3),
                                std::numeric_limits<TypeParam>::quiet_NaN()}) {
    this->config.sample_period_s = wrong;
    EXPECT_STREQ(check(this->config).parameter, "sample_period_s");
  }
}

}  // namespace
