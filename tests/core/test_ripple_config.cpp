#include "strainwave/ripple_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ripple_examples.hpp"

namespace {

using strainwave::RippleFilterConfig;

static_assert(check(RippleFilterConfig<float, 1>{}).ok());
static_assert(check(RippleFilterConfig<double, 7>{}).ok());
static_assert(!check([] {
                 RippleFilterConfig<float, 1> config;
                 config.torque_noise_Nm = 0.0F;
                 return config;
               }())
                   .ok());

template <class Real>
class RippleConfigOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleConfigOf, Precisions);

template <class Real>
using Config = RippleFilterConfig<Real, 6>;

template <class Real, class Change>
const char* violated(Change change) {
  Config<Real> config = two_orders<Real, 6>();
  change(config);
  const auto violation = check(config);
  return violation.ok() ? "" : violation.parameter;
}

TYPED_TEST(RippleConfigOf, EveryParameterIsRefusedOutsideItsRangeAndTakenAtItsEnds) {
  using Real = TypeParam;
  struct Case {
    const char* name;
    Real Config<Real>::* member;
    double smallest;
    double largest;
    bool zero_is_smallest;
  };
  const Case cases[] = {
      {"memory_turns", &Config<Real>::memory_turns, 0.1, 1e6, false},
      {"torque_noise_Nm", &Config<Real>::torque_noise_Nm, 1e-9, 1e9, false},
      {"torque_walk_Nm_per_sqrt_s", &Config<Real>::torque_walk_Nm_per_sqrt_s, 1e-9, 1e9, false},
      {"initial_amplitude_Nm", &Config<Real>::initial_amplitude_Nm, 1e-9, 1e9, false},
      {"rated_torque_Nm", &Config<Real>::rated_torque_Nm, 1e-9, 1e9, false},
      {"reference_speed_rad_s", &Config<Real>::reference_speed_rad_s, 1e-3, 1e6, false},
      {"angle_to_torque_delay_s", &Config<Real>::angle_to_torque_delay_s, -0.005, 0.05, false},
      {"minimum_speed_rad_s", &Config<Real>::minimum_speed_rad_s, 0.0, 100.0, true},
  };
  using Limits = std::numeric_limits<Real>;
  for (const Case& each : cases) {
    const auto with = [&](double value) {
      return violated<Real>([&](Config<Real>& c) { c.*each.member = static_cast<Real>(value); });
    };
    EXPECT_STREQ(with(each.smallest), "") << each.name << " at its documented smallest";
    EXPECT_STREQ(with(each.largest), "") << each.name << " at its documented largest";
    const double below =
        each.zero_is_smallest ? -1e-6 : each.smallest * (each.smallest > 0 ? 0.999 : 1.001);
    EXPECT_STREQ(with(below), each.name);
    EXPECT_STREQ(with(each.largest * 1.001), each.name);
    EXPECT_STREQ(with(static_cast<double>(Limits::quiet_NaN())), each.name);
    EXPECT_STREQ(with(INFINITY), each.name);
    EXPECT_STREQ(with(-INFINITY), each.name);
  }
}

TYPED_TEST(RippleConfigOf, OrdersAreChecked) {
  using Real = TypeParam;
  using C = Config<Real>;
  EXPECT_STREQ(violated<Real>([](C&) {}), "");
  EXPECT_STREQ(violated<Real>([](C& c) { c.order_count = 0; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.order_count = 7; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.order_count = SIZE_MAX; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.orders[1].order = {2, 1}; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.orders[1].order = {6, 3}; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.orders[1].order = {0, 1}; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.orders[1].order = {1, 0}; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.orders[1].order = {1001, 1}; }), "orders");
  EXPECT_STREQ(violated<Real>([](C& c) { c.orders[1].order = {1000, 1}; }), "");
  // Two orders of four pairs each are eight, and there is room for six.
  EXPECT_STREQ(
      violated<Real>([](C& c) {
        c.orders[0] = {
            .order = {2, 1}, .with_load = true, .with_speed = true, .with_direction = true};
        c.orders[1] = {
            .order = {4, 1}, .with_load = true, .with_speed = true, .with_direction = true};
      }),
      "orders");
  EXPECT_STREQ(violated<Real>([](C& c) {
                 c.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
                 c.orders[1] = {.order = {4, 1}, .with_speed = true, .with_direction = true};
               }),
               "");
}

TYPED_TEST(RippleConfigOf, FrozenTermsAreChecked) {
  using Real = TypeParam;
  using C = Config<Real>;
  const auto with = [](strainwave::FrozenTerm<Real> term) {
    return violated<Real>([&](C& c) {
      c.frozen_count = 1;
      c.frozen[0] = term;
    });
  };
  EXPECT_STREQ(with({{1, 100}, Real(1), Real(-1)}), "");
  EXPECT_STREQ(with({{1, 100}, Real(1e9), Real(-1e9)}), "");
  EXPECT_STREQ(with({{1, 100}, Real(1.1e9), Real(0)}), "frozen");
  EXPECT_STREQ(with({{1, 100}, Real(0), std::numeric_limits<Real>::quiet_NaN()}), "frozen");
  EXPECT_STREQ(with({{0, 100}, Real(1), Real(1)}), "frozen.order");
  EXPECT_STREQ(with({{1001, 1}, Real(1), Real(1)}), "frozen.order");
  EXPECT_STREQ(violated<Real>([](C& c) { c.frozen_count = 9; }), "frozen");
  EXPECT_STREQ(violated<Real>([](C& c) { c.frozen_count = 8; }), "");
}

TYPED_TEST(RippleConfigOf, ConvertedKeepsEverything) {
  using Real = TypeParam;
  Config<Real> from = two_orders<Real, 6>();
  from.orders[1] = {.order = {9, 2}, .with_load = true, .with_direction = true, .keep = true};
  from.memory_turns = Real(7);
  from.torque_noise_Nm = Real(0.25);
  from.torque_walk_Nm_per_sqrt_s = Real(0.5);
  from.initial_amplitude_Nm = Real(3);
  from.rated_torque_Nm = Real(100);
  from.reference_speed_rad_s = Real(50);
  from.angle_to_torque_delay_s = Real(0.03125);
  from.minimum_speed_rad_s = Real(4);
  from.frozen_count = 2;
  from.frozen[1] = {{3, 161}, Real(0.5), Real(-0.75)};
  const auto there = strainwave::converted<double, 32>(from);
  const auto back = strainwave::converted<Real, 6>(there);
  EXPECT_EQ(back.order_count, from.order_count);
  EXPECT_EQ(back.orders[0], from.orders[0]);
  EXPECT_EQ(back.orders[1], from.orders[1]);
  EXPECT_EQ(back.memory_turns, from.memory_turns);
  EXPECT_EQ(back.torque_noise_Nm, from.torque_noise_Nm);
  EXPECT_EQ(back.torque_walk_Nm_per_sqrt_s, from.torque_walk_Nm_per_sqrt_s);
  EXPECT_EQ(back.initial_amplitude_Nm, from.initial_amplitude_Nm);
  EXPECT_EQ(back.rated_torque_Nm, from.rated_torque_Nm);
  EXPECT_EQ(back.reference_speed_rad_s, from.reference_speed_rad_s);
  EXPECT_EQ(back.angle_to_torque_delay_s, from.angle_to_torque_delay_s);
  EXPECT_EQ(back.minimum_speed_rad_s, from.minimum_speed_rad_s);
  ASSERT_EQ(back.frozen_count, 2U);
  EXPECT_EQ(back.frozen[1].order, from.frozen[1].order);
  EXPECT_EQ(back.frozen[1].cosine_Nm, from.frozen[1].cosine_Nm);
  EXPECT_EQ(back.frozen[1].sine_Nm, from.frozen[1].sine_Nm);
  EXPECT_EQ(strainwave::pair_count(back), 4U);
}

TYPED_TEST(RippleConfigOf, WhatPassesItsCheckStaysFinite) {
  using Real = TypeParam;
  int accepted = 0;
  for (const double noise : {1e-9, 1e-3, 1.0, 1e9}) {
    for (const double amplitude : {1e-9, 1.0, 1e9}) {
      for (const double walk : {1e-9, 1.0, 1e9}) {
        for (const double memory : {0.1, 1e6}) {
          Config<Real> config = two_orders<Real, 6>();
          config.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
          config.torque_noise_Nm = static_cast<Real>(noise);
          config.initial_amplitude_Nm = static_cast<Real>(amplitude);
          config.torque_walk_Nm_per_sqrt_s = static_cast<Real>(walk);
          config.memory_turns = static_cast<Real>(memory);
          if (!check(config).ok()) {
            continue;
          }
          ++accepted;
          auto state = strainwave::initial_state(config);
          bool finite = true;
          for (int k = 0; k < 300; ++k) {
            const double torque_Nm = k % 37 == 0 ? 9e14 : std::cos(0.3 * k);
            const auto reading =
                strainwave::step(config, state, ripple_sample<Real>(torque_Nm, 0.15 * k));
            finite = finite && strainwave::is_finite(reading.torque_Nm) &&
                     strainwave::is_finite(reading.ripple_Nm) &&
                     strainwave::is_finite(reading.torque_state_Nm) &&
                     strainwave::is_finite(reading.innovation_variance_Nm2);
          }
          const std::size_t states = 1 + 2 * strainwave::pair_count(config);
          for (std::size_t i = 0; i < states; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
              finite = finite && strainwave::is_finite(strainwave::detail::covariance_of(
                                     config, state.covariance, states - 1, i, j));
            }
          }
          EXPECT_TRUE(finite) << "noise " << noise << " amplitude " << amplitude << " walk " << walk
                              << " memory " << memory;
        }
      }
    }
  }
  EXPECT_EQ(accepted, 72);
}

}  // namespace
