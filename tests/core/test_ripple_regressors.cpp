// The ripple at an angle, load and speed.
#include "strainwave/ripple_regressors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "ripple_examples.hpp"

namespace {

template <class Real>
class RippleRegressorsOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RippleRegressorsOf, Precisions);

TYPED_TEST(RippleRegressorsOf, PairsAreCosineAndSineTimesTheirFactors) {
  using Real = TypeParam;
  strainwave::RippleFilterConfig<Real, 8> config;
  config.order_count = 3;
  config.orders[0] = {
      .order = {2, 1}, .with_load = true, .with_speed = true, .with_direction = true};
  config.orders[1] = {.order = {7, 2}};
  config.orders[2] = {.order = {1, 100}, .with_direction = true};
  auto state = strainwave::initial_state(config);
  const double angle_rad = 1234.567;
  for (const double speed_rad_s : {-75.0, 0.0, 0.5, 300.0}) {
    for (const double load_Nm : {-40.0, 0.0, 10.0, 120.0}) {
      state.speed_rad_s = static_cast<Real>(speed_rad_s);
      state.load_Nm = static_cast<Real>(load_Nm);
      strainwave::detail::Regressors<Real, 8> sample;
      strainwave::detail::regressors_at(config, state, strainwave::phase_from_radians(angle_rad),
                                        sample);
      ASSERT_EQ(sample.state_count, 15U);
      const double share = load_Nm / 40.0;
      const double load = share / (1.0 + std::fabs(share));
      const double speed = std::fabs(speed_rad_s) / 150.0;
      const double direction = speed_rad_s / (std::fabs(speed_rad_s) + 1.0);
      const double terms[3][3] = {{load, speed, direction}, {}, {direction}};
      const double orders[3] = {2.0, 3.5, 0.01};
      for (std::size_t a = 0; a < 3; ++a) {
        const double tolerance = sizeof(Real) == 4 ? 1e-6 : 1e-8;  // a phase's unit is 1.5e-9 rad
        EXPECT_NEAR(static_cast<double>(sample.waves[a].cosine), std::cos(orders[a] * angle_rad),
                    tolerance);
        EXPECT_NEAR(static_cast<double>(sample.waves[a].sine), std::sin(orders[a] * angle_rad),
                    tolerance);
        for (std::size_t t = 0; t + 1 < strainwave::pairs_of(config.orders[a]); ++t) {
          EXPECT_NEAR(static_cast<double>(sample.terms[a].factors[t]), terms[a][t], tolerance);
        }
      }
    }
  }
}

TYPED_TEST(RippleRegressorsOf, ASeriesOfOrdersIsAsGoodAsEachAlone) {
  using Real = TypeParam;
  strainwave::RippleFilterConfig<Real, 6> config;
  const strainwave::Order series[6] = {{2, 3}, {4, 3}, {6, 3}, {8, 3}, {1, 100}, {2, 161}};
  config.order_count = 6;
  for (std::size_t a = 0; a < 6; ++a) {
    config.orders[a].order = series[a];
  }
  double worst = 0.0;
  for (int k = -500; k < 500; ++k) {
    const strainwave::Phase phase = strainwave::phase_from_radians(7.77 * k);
    strainwave::CosSin<Real> waves[6] = {};
    strainwave::detail::waves_at(config, phase, waves);
    for (std::size_t a = 0; a < 6; ++a) {
      const auto alone =
          strainwave::cos_sin_of_fraction<double>(strainwave::order_fraction(phase, series[a]));
      worst = std::fmax(worst, std::fabs(static_cast<double>(waves[a].cosine) - alone.cosine));
      worst = std::fmax(worst, std::fabs(static_cast<double>(waves[a].sine) - alone.sine));
    }
  }
  // A phase is given to 2^-32 of a turn, and a sum of four of them to four times that.
  EXPECT_LT(worst, sizeof(Real) == 4 ? 6e-7 : 1e-8);
  EXPECT_GT(worst, 0.0);
}

TYPED_TEST(RippleRegressorsOf, RippleIsTheSumOverItsPairs) {
  using Real = TypeParam;
  strainwave::RippleFilterConfig<Real, 4> config;
  config.order_count = 2;
  config.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
  config.orders[1] = {.order = {7, 2}};
  auto state = strainwave::initial_state(config);
  state.speed_rad_s = Real(75);
  state.load_Nm = Real(40);  // factors 0.5 and 0.5
  for (std::size_t i = 0; i < 9; ++i) {
    state.states_Nm[i] = static_cast<Real>(i);
  }
  strainwave::detail::Regressors<Real, 4> sample;
  strainwave::detail::regressors_at(config, state, strainwave::phase_from_radians(0.4), sample);
  const double expected = (1.0 + 0.5 * 3.0 + 0.5 * 5.0) * std::cos(0.8) +
                          (2.0 + 0.5 * 4.0 + 0.5 * 6.0) * std::sin(0.8) + 7.0 * std::cos(1.4) +
                          8.0 * std::sin(1.4);
  const auto ripple = strainwave::detail::predicted_ripple(config, state, sample);
  EXPECT_NEAR(static_cast<double>(ripple.removed_Nm), expected, 2e-6);
  EXPECT_EQ(ripple.kept_Nm, Real(0));
}

TYPED_TEST(RippleRegressorsOf, KeptOrdersAreApartFromThoseRemoved) {
  using Real = TypeParam;
  auto config = two_orders<Real, 2>();
  auto state = strainwave::initial_state(config);
  const Real coefficients[5] = {Real(9), Real(1), Real(2), Real(-3), Real(0.5)};
  for (std::size_t i = 0; i < 5; ++i) {
    state.states_Nm[i] = coefficients[i];
  }
  const double angle_rad = 0.7;
  const double two = std::cos(1.4) + 2.0 * std::sin(1.4);
  const double four = -3.0 * std::cos(2.8) + 0.5 * std::sin(2.8);
  for (const bool keep : {false, true}) {
    config.orders[0].keep = keep;
    strainwave::detail::Regressors<Real, 2> sample;
    strainwave::detail::regressors_at(config, state, strainwave::phase_from_radians(angle_rad),
                                      sample);
    const auto ripple = strainwave::detail::predicted_ripple(config, state, sample);
    EXPECT_NEAR(static_cast<double>(ripple.removed_Nm), keep ? four : two + four, 1e-6);
    EXPECT_NEAR(static_cast<double>(ripple.kept_Nm), keep ? two : 0.0, 1e-6);
  }
}

TYPED_TEST(RippleRegressorsOf, FrozenTermsAreTheirFormula) {
  using Real = TypeParam;
  auto config = two_orders<Real, 2>();
  config.frozen_count = 2;
  config.frozen[0] = {{1, 100}, Real(2), Real(-1)};
  config.frozen[1] = {{2, 161}, Real(0), Real(0.5)};
  for (const double angle_rad : {0.0, 12.5, -700.0, 1e6}) {
    const double expected = 2.0 * std::cos(angle_rad / 100.0) - std::sin(angle_rad / 100.0) +
                            0.5 * std::sin(angle_rad * 2.0 / 161.0);
    EXPECT_NEAR(static_cast<double>(strainwave::detail::frozen_torque_Nm(
                    config, strainwave::phase_from_radians(angle_rad))),
                expected, 2e-6);
  }
}

}  // namespace
