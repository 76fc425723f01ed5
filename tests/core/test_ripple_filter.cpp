// The whole filter, sample by sample: capacity, long runs, standstill, faults.
#include "strainwave/ripple_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ripple_examples.hpp"

namespace {

using strainwave::has;
using strainwave::RippleFilterConfig;
using strainwave::StatusFlag;

template <class Real>
class RippleFilterOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleFilterOf, Precisions);

template <class Real>
void expect_same_bits(const strainwave::RippleReading<Real>& a,
                      const strainwave::RippleReading<Real>& b, int k) {
  ASSERT_EQ(a.torque_Nm, b.torque_Nm) << k;
  ASSERT_EQ(a.ripple_Nm, b.ripple_Nm) << k;
  ASSERT_EQ(a.torque_all_removed_Nm, b.torque_all_removed_Nm) << k;
  ASSERT_EQ(a.torque_state_Nm, b.torque_state_Nm) << k;
  ASSERT_EQ(a.innovation_variance_Nm2, b.innovation_variance_Nm2) << k;
  ASSERT_EQ(a.status, b.status) << k;
}

TYPED_TEST(RippleFilterOf, ResultDoesNotDependOnTheCapacity) {
  using Real = TypeParam;
  RippleFilterConfig<Real, 3> exact = two_orders<Real, 3>();
  exact.orders[1] = {.order = {4, 1}, .with_load = true};
  exact.angle_to_torque_delay_s = Real(0.0023);
  const auto middle = strainwave::converted<Real, 8>(exact);
  const auto large = strainwave::converted<Real, 32>(exact);
  auto exact_state = strainwave::initial_state(exact);
  auto middle_state = strainwave::initial_state(middle);
  auto large_state = strainwave::initial_state(large);
  Random random(2);
  for (int k = 0; k < 4000; ++k) {
    const double angle_rad = 100.0 * std::sin(0.002 * k);
    const auto sample = ripple_sample<Real>(
        example_ripple_Nm(angle_rad) + 5.0 * std::sin(0.01 * k) + 0.04 * random.gaussian(),
        angle_rad);
    const auto reading = strainwave::step(exact, exact_state, sample);
    expect_same_bits(strainwave::step(middle, middle_state, sample), reading, k);
    expect_same_bits(strainwave::step(large, large_state, sample), reading, k);
  }
}

struct Course {
  double largest_Nm = 0.0;  ///< error of the ripple after 10 s
  double not_positive_s = -1.0;
  std::uint32_t resets = 0;
};

/// A minute one way at one load; then ten seconds to and fro, and another load.
template <class Real>
Course minute_one_way(const RippleFilterConfig<Real, 4>& config) {
  auto state = strainwave::initial_state(config);
  Random random(4);
  double angle_rad = 0.0;
  Course course;
  for (int k = 0; k < 80'000; ++k) {
    const double t = 1e-3 * k;
    const double speed_rad_s =
        t < 60.0 ? std::fmin(1.0, t) * 156.0 : 80.0 * std::cos(2.0 * (t - 60.0));
    angle_rad += 1e-3 * speed_rad_s;
    const double ripple_Nm = example_ripple_Nm(angle_rad);
    const double load_Nm = t < 70.0 ? 12.0 : -8.0;
    const auto reading = strainwave::step(
        config, state,
        ripple_sample<Real>(load_Nm + ripple_Nm + 0.04 * random.gaussian(), angle_rad));
    if (t > 10.0) {
      course.largest_Nm = std::fmax(course.largest_Nm,
                                    std::fabs(static_cast<double>(reading.ripple_Nm) - ripple_Nm));
    }
    if (k % 53 == 0 && course.not_positive_s < 0.0 && smallest_pivot(config, state) <= 0.0) {
      course.not_positive_s = t;
    }
  }
  course.resets = times(state.counters, StatusFlag::covariance_reset);
  return course;
}

TYPED_TEST(RippleFilterOf, PairsThatCannotBeToldApartForAMinute) {
  // One way, a direction pair cannot be told from the constant one, nor at one load a load pair;
  // what they make of their sum must not be rounding's choice when it shows.
  using Real = TypeParam;
  for (const bool by_direction : {false, true}) {
    for (const int memory_turns : {3, 10, 30, 100}) {
      auto config = two_orders<Real, 4>();
      config.memory_turns = static_cast<Real>(memory_turns);
      for (std::size_t a = 0; a < 2; ++a) {
        config.orders[a].with_direction = by_direction;
        config.orders[a].with_load = !by_direction;
      }
      const Course course = minute_one_way(config);
      const char* const pairs = by_direction ? "direction" : "load";
      EXPECT_LT(course.largest_Nm, 0.3) << pairs << ", memory " << memory_turns;
      EXPECT_GT(course.largest_Nm, 0.01) << pairs << ", memory " << memory_turns;
      EXPECT_LT(course.not_positive_s, 0.0) << pairs << ", memory " << memory_turns;
      EXPECT_EQ(course.resets, 0U) << pairs << ", memory " << memory_turns;
    }
  }
}

TYPED_TEST(RippleFilterOf, SevenMinutesOfSteadyLoadAndThenAnother) {
  using Real = TypeParam;
  RippleFilterConfig<Real, 6> config = two_orders<Real, 6>();
  for (std::size_t a = 0; a < 2; ++a) {
    config.orders[a].with_load = true;
    config.orders[a].with_speed = true;
  }
  auto state = strainwave::initial_state(config);
  Random random(6);
  double largest_Nm = 0.0;
  double after_Nm = 0.0;
  constexpr int steady = 400'000;
  for (int k = 0; k < steady + 60'000; ++k) {
    const double angle_rad = 0.156 * k;
    const double load_Nm = k < steady ? 12.0 : -8.0;
    const double ripple_Nm = example_ripple_Nm(angle_rad);
    const auto reading = strainwave::step(
        config, state,
        ripple_sample<Real>(load_Nm + ripple_Nm + 0.04 * random.gaussian(), angle_rad));
    const double error_Nm = std::fabs(static_cast<double>(reading.ripple_Nm) - ripple_Nm);
    if (k > 100'000 && k < steady) {
      largest_Nm = std::fmax(largest_Nm, error_Nm);
    }
    if (k > steady + 40'000) {
      after_Nm = std::fmax(after_Nm, error_Nm);
    }
    if (k % 1009 == 0) {
      ASSERT_GT(smallest_pivot(config, state), 0.0) << k;
    }
  }
  EXPECT_LT(largest_Nm, 0.06);
  EXPECT_LT(after_Nm, 0.06);
  EXPECT_GT(largest_Nm, 0.003);
  EXPECT_EQ(times(state.counters, StatusFlag::covariance_reset), 0U);
}

TYPED_TEST(RippleFilterOf, AQuietSensorAndAWideStart) {
  // 4 mNm of noise and torque that hardly wanders: P spans 1e8, which float must bear as well.
  using Real = TypeParam;
  auto config = two_orders<Real, 2>();
  config.torque_noise_Nm = Real(0.004);
  config.torque_walk_Nm_per_sqrt_s = Real(0.04);
  auto state = strainwave::initial_state(config);
  Random random(8);
  double angle_rad = 0.0;
  double largest_Nm = 0.0;
  for (int k = 0; k < 30'000; ++k) {
    angle_rad += 1e-3 * 156.0 * std::fmin(1.0, 1e-3 * k);
    const double ripple_Nm = example_ripple_Nm(angle_rad);
    const auto reading = strainwave::step(
        config, state, ripple_sample<Real>(3.0 + ripple_Nm + 0.004 * random.gaussian(), angle_rad));
    if (k > 300) {  // 7 rad
      largest_Nm =
          std::fmax(largest_Nm, std::fabs(static_cast<double>(reading.ripple_Nm) - ripple_Nm));
    }
    if (k % 101 == 0) {
      ASSERT_GT(smallest_pivot(config, state), 0.0) << k;
    }
  }
  EXPECT_LT(largest_Nm, 0.05);
  EXPECT_GT(largest_Nm, 1e-4);
  EXPECT_EQ(times(state.counters, StatusFlag::covariance_reset), 0U);
}

TYPED_TEST(RippleFilterOf, ContactAtRestLeavesTheRippleAlone) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 3>();
  auto state = strainwave::initial_state(config);
  for (int k = 0; k < 10'000; ++k) {
    (void)strainwave::step(config, state,
                           ripple_sample<Real>(example_ripple_Nm(0.15 * k), 0.15 * k));
  }
  const double stop_rad = 0.15 * 9999;
  Random random(5);
  Real ripple_Nm[2] = {};
  auto touched = state;
  for (int k = 0; k < 5000; ++k) {
    // An encoder of 4096 counts that cannot decide between two.
    const double angle_rad =
        stop_rad + static_cast<double>(random.bits() % 2) * 6.283185307179586 / 4096.0;
    const double contact_Nm = k > 1000 && k < 4000 ? 10.0 : 0.0;
    const double measured_Nm = example_ripple_Nm(stop_rad);
    ripple_Nm[0] =
        strainwave::step(config, state, ripple_sample<Real>(measured_Nm, angle_rad)).ripple_Nm;
    const auto reading =
        strainwave::step(config, touched, ripple_sample<Real>(measured_Nm + contact_Nm, angle_rad));
    ripple_Nm[1] = reading.ripple_Nm;
    if (k > 500) {
      ASSERT_TRUE(has(reading.status, StatusFlag::at_rest));
      ASSERT_EQ(ripple_Nm[0], ripple_Nm[1]) << k;
    }
  }
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_EQ(state.states_Nm[i], touched.states_Nm[i]);
  }
  EXPECT_GT(std::fabs(ripple_Nm[0]), Real(0.1));
}

TYPED_TEST(RippleFilterOf, NoInputLeavesAnythingButNumbersAndAllIsForgotten) {
  using Real = TypeParam;
  using Limits = std::numeric_limits<Real>;
  const Real wild[] = {Limits::quiet_NaN(),
                       Limits::infinity(),
                       -Limits::infinity(),
                       Limits::max(),
                       Limits::lowest(),
                       Real(1e30),
                       Real(-9e14),
                       Limits::denorm_min(),
                       Real(0),
                       Real(-1e-3),
                       Real(50),
                       Real(1e-3)};
  constexpr std::size_t wilds = sizeof(wild) / sizeof(wild[0]);
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    Random random(seed);
    auto config = two_orders<Real, 8>();
    config.memory_turns = Real(10);
    config.orders[0].with_load = seed % 2 == 0;
    config.orders[0].with_speed = seed % 3 == 0;
    config.orders[1].with_direction = seed % 4 == 0;
    config.frozen_count = seed % 2;
    config.frozen[0] = {{1, 100}, Real(0), Real(0)};
    const Real delays[] = {Real(0), Real(0.0023), Real(0.05), Real(-0.004)};
    config.angle_to_torque_delay_s = delays[seed % 4];
    ASSERT_TRUE(check(config).ok());
    auto state = strainwave::initial_state(config);
    double worst = 0.0;
    for (int k = 0; k < 14'000; ++k) {
      const double angle_rad = 0.15 * k;
      const double there_rad =
          angle_rad - 150.0 * static_cast<double>(config.angle_to_torque_delay_s);
      auto sample = ripple_sample<Real>(example_ripple_Nm(there_rad), angle_rad);
      if (k < 2000 && random.bits() % 4 == 0) {
        const Real value = wild[random.bits() % wilds];
        switch (random.bits() % 6) {
          case 0:
            sample.measured_torque_Nm = value;
            break;
          case 1:
            sample.expected_torque_Nm = value;
            break;
          case 2:
            sample.interval_s = value;
            break;
          case 3:
            sample.phase_valid = false;
            break;
          case 4:
            sample.torque_valid = false;
            sample.measured_torque_Nm = value;
            break;
          default:
            sample.motor_phase.turns =
                static_cast<std::int64_t>(random.bits() >> 23U) - (std::int64_t{1} << 40);
            sample.motor_phase.fraction = static_cast<std::uint32_t>(random.bits());
        }
      }
      const auto reading = strainwave::step(config, state, sample);
      const Real outputs[] = {reading.torque_Nm,       reading.ripple_Nm,
                              reading.torque_state_Nm, reading.torque_all_removed_Nm,
                              reading.innovation_Nm,   reading.innovation_variance_Nm2};
      for (const Real output : outputs) {
        ASSERT_TRUE(strainwave::is_finite(output)) << seed << " " << k;
      }
      if (k > 13'000) {
        worst = std::fmax(worst, std::fabs(static_cast<double>(reading.torque_Nm)));
      }
    }
    EXPECT_LT(worst, 0.05) << seed;
    EXPECT_EQ(state.counters.samples, 14'000U);
    EXPECT_GT(smallest_pivot(config, state), 0.0) << seed;
  }
}

TYPED_TEST(RippleFilterOf, TorqueFarBeyondAnyGearDoesNotBlindTheFilter) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 3>();
  auto state = strainwave::initial_state(config);
  double worst = 0.0;
  for (int k = 0; k < 30'000; ++k) {
    const double torque_Nm = k == 5000 ? 1e14 : example_ripple_Nm(0.15 * k);
    const auto reading = strainwave::step(config, state, ripple_sample<Real>(torque_Nm, 0.15 * k));
    if (k > 20'000) {
      worst = std::fmax(worst, std::fabs(static_cast<double>(reading.torque_Nm)));
    }
  }
  EXPECT_LT(worst, 0.02);
}

TYPED_TEST(RippleFilterOf, ExpectedTorqueIsNotLearnedAsRipple) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 3>();
  auto told = strainwave::initial_state(config);
  auto not_told = strainwave::initial_state(config);
  double learned_told = 0.0;
  double learned_not = 0.0;
  for (int k = 0; k < 10'000; ++k) {
    const double torque_Nm = 3.0 * std::cos(0.3 * k);  // true torque at order 2, for once
    auto sample = ripple_sample<Real>(torque_Nm, 0.15 * k);
    learned_not = static_cast<double>(strainwave::step(config, not_told, sample).ripple_Nm);
    sample.expected_torque_Nm = static_cast<Real>(torque_Nm);
    const auto reading = strainwave::step(config, told, sample);
    learned_told = static_cast<double>(reading.ripple_Nm);
    ASSERT_NEAR(static_cast<double>(reading.torque_state_Nm), torque_Nm, 1e-3);
  }
  EXPECT_LT(std::fabs(learned_told), 1e-3);
  EXPECT_GT(std::fabs(learned_not), 0.1);
}

}  // namespace
