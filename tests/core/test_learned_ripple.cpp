// What a filter has learned: amplitude and phase, and coefficients over a power cycle.
#include "strainwave/learned_ripple.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>

#include "ripple_examples.hpp"

namespace {

template <class Real>
class LearnedRippleOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(LearnedRippleOf, Precisions);

/// A filter that has learned the example's ripple.
template <class Real>
strainwave::RippleFilterState<Real, 4> taught(
    const strainwave::RippleFilterConfig<Real, 4>& config) {
  auto state = strainwave::initial_state(config);
  Random random(9);
  for (int k = 0; k < 20'000; ++k) {
    const double torque_Nm = example_ripple_Nm(0.15 * k) + 5.0 * std::sin(2e-3 * k);
    (void)strainwave::step(config, state,
                           ripple_sample<Real>(torque_Nm + 0.04 * random.gaussian(), 0.15 * k));
  }
  return state;
}

TYPED_TEST(LearnedRippleOf, AmplitudeAndPhaseAreTheTrueOnes) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 4>();
  const auto state = taught(config);
  const auto two = strainwave::order_ripple(config, state, 0);
  EXPECT_NEAR(two.amplitude_Nm, Real(1.6), Real(0.01));
  EXPECT_NEAR(two.phase_rad, Real(-0.3), Real(0.01));  // cos(2 angle + 0.3)
  EXPECT_NEAR(two.cosine_Nm, Real(1.6 * std::cos(0.3)), Real(0.01));
  EXPECT_NEAR(two.sine_Nm, Real(-1.6 * std::sin(0.3)), Real(0.01));
  const auto four = strainwave::order_ripple(config, state, 1);
  EXPECT_NEAR(four.amplitude_Nm, Real(0.6), Real(0.01));
  EXPECT_NEAR(four.phase_rad, Real(1.5707963), Real(0.02));  // a sine
  for (const std::size_t none : {std::size_t{2}, std::size_t{4}, std::size_t{1000}}) {
    EXPECT_EQ(strainwave::order_ripple(config, state, none).amplitude_Nm, Real(0));
  }
}

TYPED_TEST(LearnedRippleOf, PowerUpAtStandstillIsCleanWithKeptCoefficients) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 4>();
  const auto kept = strainwave::learned(config, taught(config));
  ASSERT_TRUE(check(config, kept).ok());
  for (int at = 0; at < 20; ++at) {
    const double angle_rad = 0.3 * at + 1e4;
    auto restored = strainwave::restored(config, kept);
    auto fresh = strainwave::initial_state(config);
    for (int k = 0; k < 200; ++k) {
      const auto sample = ripple_sample<Real>(7.0 + example_ripple_Nm(angle_rad), angle_rad);
      const auto clean = strainwave::step(config, restored, sample);
      ASSERT_NEAR(clean.torque_Nm, Real(7), Real(0.01 * 2.2)) << at;
      ASSERT_EQ(strainwave::step(config, fresh, sample).ripple_Nm, Real(0));
    }
  }
}

TYPED_TEST(LearnedRippleOf, KeptAndRestoredIsTheSameAgain) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 4>();
  const auto state = taught(config);
  const auto kept = strainwave::learned(config, state);
  const auto again = strainwave::learned(config, strainwave::restored(config, kept));
  ASSERT_EQ(again.order_count, 2U);
  EXPECT_EQ(again.orders[1], config.orders[1]);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(kept.coefficients_Nm[i], state.states_Nm[i + 1]);
    EXPECT_EQ(again.coefficients_Nm[i], kept.coefficients_Nm[i]);
    EXPECT_NEAR(again.standard_deviations_Nm[i], kept.standard_deviations_Nm[i],
                4 * std::numeric_limits<Real>::epsilon());
    EXPECT_GT(kept.standard_deviations_Nm[i], Real(1e-4));
    EXPECT_LT(kept.standard_deviations_Nm[i], Real(0.02));
  }
  EXPECT_EQ(again.innovation_scale_Nm, kept.innovation_scale_Nm);
  EXPECT_GT(kept.innovation_scale_Nm, Real(0.03));
  EXPECT_LT(kept.innovation_scale_Nm, Real(0.3));
}

TYPED_TEST(LearnedRippleOf, DeviationsAreKeptWithinWhatCanBeLearnedFrom) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 4>();
  auto kept = strainwave::learned(config, strainwave::initial_state(config));
  kept.standard_deviations_Nm[0] = Real(0);
  kept.standard_deviations_Nm[1] = Real(1e6);
  kept.innovation_scale_Nm = Real(0);
  ASSERT_TRUE(check(config, kept).ok());
  const auto state = strainwave::restored(config, kept);
  EXPECT_GT(strainwave::detail::element_of(state.covariance, 0, 0), Real(0));
  EXPECT_LT(strainwave::detail::element_of(state.covariance, 0, 0), Real(1e-8));
  EXPECT_EQ(strainwave::detail::element_of(state.covariance, 1, 1), Real(4));
  EXPECT_GT(state.innovation_scale_Nm, Real(0.01));
}

TYPED_TEST(LearnedRippleOf, WhatDoesNotBelongIsRefused) {
  using Real = TypeParam;
  const auto config = two_orders<Real, 4>();
  const auto good = strainwave::learned(config, strainwave::initial_state(config));
  const auto violated = [&](auto change) {
    auto kept = good;
    change(kept);
    const auto violation = check(config, kept);
    return violation.ok() ? "" : violation.parameter;
  };
  using Kept = strainwave::LearnedRipple<Real, 4>;
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_STREQ(violated([](Kept&) {}), "");
  EXPECT_STREQ(violated([](Kept& k) { k.order_count = 1; }), "learned.orders");
  EXPECT_STREQ(violated([](Kept& k) { k.orders[1].order = {5, 1}; }), "learned.orders");
  EXPECT_STREQ(violated([](Kept& k) { k.orders[1].order = {0, 0}; }), "learned.orders");
  EXPECT_STREQ(violated([](Kept& k) { k.orders[1].with_load = true; }), "learned.orders");
  EXPECT_STREQ(violated([](Kept& k) { k.orders[0].with_speed = true; }), "learned.orders");
  EXPECT_STREQ(violated([](Kept& k) { k.orders[0].with_direction = true; }), "learned.orders");
  EXPECT_STREQ(violated([](Kept& k) { k.orders[1].order = {8, 2}; }), "");  // 4 all the same
  EXPECT_STREQ(violated([](Kept& k) { k.orders[1].keep = true; }), "");
  EXPECT_STREQ(violated([&](Kept& k) { k.coefficients_Nm[3] = nan; }), "learned.coefficients_Nm");
  EXPECT_STREQ(violated([](Kept& k) { k.coefficients_Nm[0] = Real(-2e9); }),
               "learned.coefficients_Nm");
  EXPECT_STREQ(violated([](Kept& k) { k.standard_deviations_Nm[3] = Real(-1); }),
               "learned.standard_deviations_Nm");
  EXPECT_STREQ(violated([&](Kept& k) { k.standard_deviations_Nm[3] = nan; }),
               "learned.standard_deviations_Nm");
  EXPECT_STREQ(violated([&](Kept& k) { k.innovation_scale_Nm = nan; }),
               "learned.innovation_scale_Nm");
  EXPECT_STREQ(violated([](Kept& k) { k.innovation_scale_Nm = Real(-1); }),
               "learned.innovation_scale_Nm");
}

}  // namespace
