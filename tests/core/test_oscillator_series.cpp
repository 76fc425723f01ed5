// Many samples of one channel in one call against step() after step(): the same readings, states
// and flags, whatever is in them and wherever they are cut.
#include "strainwave/oscillator_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "batch_examples.hpp"

namespace {

using strainwave::OscillatorFilterConfig;
using strainwave::OscillatorFilterState;
using strainwave::OscillatorSeries;
using strainwave::StatusFlag;

template <class Real, std::size_t MaxOrders>
void filter_by_step(const OscillatorFilterConfig<Real, MaxOrders>& config,
                    OscillatorFilterState<Real, MaxOrders>& state, Log<Real>& log) {
  for (std::size_t k = 0; k < log.torque_Nm.size(); ++k) {
    strainwave::OscillatorSample<Real> sample;
    sample.measured_torque_Nm = log.torque_Nm[k];
    sample.motor_speed_rad_s = log.speed_rad_s[k];
    sample.expected_torque_Nm = log.expected_Nm.empty() ? Real(0) : log.expected_Nm[k];
    const auto reading = strainwave::step(config, state, sample);
    log.clean_Nm[k] = reading.torque_Nm;
    log.ripple_Nm[k] = reading.ripple_Nm;
    log.status[k] = reading.status;
  }
}

/// In pieces of so many samples each; the last one is what is left.
template <class Real, std::size_t MaxOrders>
void filter_by_series(const OscillatorFilterConfig<Real, MaxOrders>& config,
                      OscillatorFilterState<Real, MaxOrders>& state, Log<Real>& log,
                      std::size_t piece) {
  for (std::size_t k = 0; k < log.torque_Nm.size(); k += piece) {
    OscillatorSeries<Real> series;
    series.sample_count = std::min(piece, log.torque_Nm.size() - k);
    series.measured_torque_Nm = log.torque_Nm.data() + k;
    series.motor_speed_rad_s = log.speed_rad_s.data() + k;
    series.expected_torque_Nm = log.expected_Nm.empty() ? nullptr : log.expected_Nm.data() + k;
    series.torque_Nm = log.clean_Nm.data() + k;
    series.ripple_Nm = log.ripple_Nm.data() + k;
    series.status = log.status.data() + k;
    strainwave::steps(config, state, series);
  }
}

/// Rounding of some thousand steps in another order, Nm, at a ripple of 9 Nm.
template <class Real>
constexpr double tolerance_Nm = sizeof(Real) == 4 ? 1e-3 : 1e-10;

template <class Real>
void expect_same_log(const Log<Real>& log, const Log<Real>& expected) {
  double worst_Nm = 0.0;
  for (std::size_t k = 0; k < log.clean_Nm.size(); ++k) {
    const auto torque_Nm = static_cast<double>(log.clean_Nm[k] - expected.clean_Nm[k]);
    const auto ripple_Nm = static_cast<double>(log.ripple_Nm[k] - expected.ripple_Nm[k]);
    ASSERT_TRUE(std::isfinite(torque_Nm) && std::isfinite(ripple_Nm)) << k;
    worst_Nm = std::fmax(worst_Nm, std::fmax(std::fabs(torque_Nm), std::fabs(ripple_Nm)));
  }
  EXPECT_LT(worst_Nm, tolerance_Nm<Real>);
  EXPECT_EQ(log.status, expected.status);
}

template <class Real, std::size_t MaxOrders>
void expect_same_state(const OscillatorFilterConfig<Real, MaxOrders>& config,
                       const OscillatorFilterState<Real, MaxOrders>& state,
                       const OscillatorFilterState<Real, MaxOrders>& expected) {
  const std::size_t count = 2 * config.order_count;
  Real scale = Real(0);
  for (std::size_t i = 0; i < count; ++i) {
    scale = std::max(scale, expected.covariance(i, i));
  }
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(state.states_Nm[i], expected.states_Nm[i], tolerance_Nm<Real>) << i;
    for (std::size_t j = 0; j < count; ++j) {
      EXPECT_NEAR(state.covariance(i, j) / scale, expected.covariance(i, j) / scale,
                  tolerance_Nm<Real>)
          << i << ' ' << j;
      EXPECT_EQ(state.covariance_Nm2[j][i], state.covariance_Nm2[i][j]) << i << ' ' << j;
    }
    EXPECT_EQ(state.angle[i / 2], expected.angle[i / 2]) << i;
  }
  EXPECT_EQ(state.travel_rad, expected.travel_rad);
  EXPECT_EQ(state.last_speed_rad_s, expected.last_speed_rad_s);
  EXPECT_EQ(state.smoothed_speed_rad_s, expected.smoothed_speed_rad_s);
  EXPECT_NEAR(state.last_torque_Nm, expected.last_torque_Nm, tolerance_Nm<Real>);
  EXPECT_EQ(state.counters.samples, expected.counters.samples);
  EXPECT_EQ(state.counters.faults, expected.counters.faults);
  for (std::size_t bit = 0; bit < 32; ++bit) {
    EXPECT_EQ(state.counters.by_bit[bit], expected.counters.by_bit[bit]) << bit;
  }
}

template <class Real, std::size_t MaxOrders>
void expect_as_by_step(const OscillatorFilterConfig<Real, MaxOrders>& config,
                       const OscillatorFilterState<Real, MaxOrders>& start, const Log<Real>& log,
                       std::size_t piece) {
  Log<Real> stepped = log;
  Log<Real> series = log;
  auto stepped_state = start;
  auto series_state = start;
  filter_by_step(config, stepped_state, stepped);
  filter_by_series(config, series_state, series, piece);
  expect_same_log(series, stepped);
  expect_same_state(config, series_state, stepped_state);
}

template <class Real>
class OscillatorSeriesOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(OscillatorSeriesOf, Precisions);

TYPED_TEST(OscillatorSeriesOf, IsStepAfterStepWhateverItIsFed) {
  using Real = TypeParam;
  for (std::size_t i = 0; i < 24; ++i) {
    const auto config = joint<Real>(i);
    for (const auto& log : {wild_log<Real>(i, 1500 + 37 * i), quiet_log<Real>(i, 4000)}) {
      SCOPED_TRACE(i);
      expect_as_by_step(config, strainwave::initial_state(config), log, log.torque_Nm.size());
    }
  }
}

TYPED_TEST(OscillatorSeriesOf, IsTheSameWhereverItIsCut) {
  using Real = TypeParam;
  const auto config = joint<Real>(0);
  for (const std::size_t piece : {1U, 31U, 32U, 33U, 64U, 95U, 1000U}) {
    SCOPED_TRACE(piece);
    expect_as_by_step(config, strainwave::initial_state(config), quiet_log<Real>(2, 2000), piece);
  }
}

TYPED_TEST(OscillatorSeriesOf, CapacityInUseAndToSpare) {
  using Real = TypeParam;
  const auto log = quiet_log<Real>(4, 2000);
  const auto six_states = strainwave::taghirad1999<Real, 3>({100, 1});
  expect_as_by_step(six_states, strainwave::initial_state(six_states), log, 2000);
  const auto four_of_six = strainwave::taghirad1999_4<Real, 3>();
  expect_as_by_step(four_of_six, strainwave::initial_state(four_of_six), log, 2000);
  const auto two_of_four = tuned<Real, 2>(1);
  expect_as_by_step(two_of_four, strainwave::initial_state(two_of_four), log, 2000);
}

TYPED_TEST(OscillatorSeriesOf, VariancesAreLimitedAsByStep) {
  using Real = TypeParam;
  auto config = strainwave::taghirad1999_4<Real, 3>();
  config.variance_limit_ratio = Real(100);
  Log<Real> log = quiet_log<Real>(4, 3000);
  for (std::size_t k = 1500; k < 3000; ++k) {
    log.speed_rad_s[k] *= Real(0.02);
  }
  Log<Real> stepped = log;
  auto stepped_state = strainwave::initial_state(config);
  filter_by_step(config, stepped_state, stepped);
  Log<Real> series = log;
  auto state = strainwave::initial_state(config);
  filter_by_series(config, state, series, 3000);
  const auto bit = strainwave::lowest_bit(mask(StatusFlag::variance_limited));
  EXPECT_GT(stepped_state.counters.by_bit[bit], 100U);
  EXPECT_LT(stepped_state.counters.by_bit[bit], 2900U);
  // A variance that rounding puts on the other side of its limit is limited a sample later.
  EXPECT_NEAR(state.counters.by_bit[bit], stepped_state.counters.by_bit[bit], 5);
  for (std::size_t k = 0; k < 3000; ++k) {
    ASSERT_NEAR(series.ripple_Nm[k], stepped.ripple_Nm[k], sizeof(Real) == 4 ? 1e-2 : 1e-8) << k;
  }
}

TYPED_TEST(OscillatorSeriesOf, LossOfTheCovariancesSignIsMetAsByStep) {
  using Real = TypeParam;
  const auto config = joint<Real>(0);
  for (const Real bad : {Real(-1e6), std::numeric_limits<Real>::quiet_NaN()}) {
    auto state = strainwave::initial_state(config);
    Log<Real> before = quiet_log<Real>(4, 100);
    filter_by_step(config, state, before);
    state.covariance_Nm2[1][1] = bad;
    Log<Real> after = quiet_log<Real>(8, 300);
    Log<Real> stepped = after;
    auto stepped_state = state;
    filter_by_step(config, stepped_state, stepped);
    filter_by_series(config, state, after, 300);
    expect_same_log(after, stepped);
    expect_same_state(config, state, stepped_state);
    const auto bit = strainwave::lowest_bit(mask(StatusFlag::covariance_reset));
    EXPECT_EQ(state.counters.by_bit[bit], 1U);
  }
}

TYPED_TEST(OscillatorSeriesOf, EveryVarianceThatIsAllowedGivesNumbers) {
  using Real = TypeParam;
  for (const Real process : {Real(0), Real(1e-20), Real(1e30)}) {
    for (const Real measurement : {Real(1e-20), Real(1), Real(1e30)}) {
      for (const Real initial : {Real(1e-20), Real(1e30)}) {
        auto config = strainwave::taghirad1999<Real, 3>({100, 1});
        config.measurement_noise_variance_Nm2 = measurement;
        config.initial_variance_Nm2 = initial;
        for (Real& each : config.process_noise_variance_Nm2) {
          each = process;
        }
        ASSERT_TRUE(check(config).ok());
        auto state = strainwave::initial_state(config);
        Log<Real> log = quiet_log<Real>(1, 3000);
        filter_by_series(config, state, log, 3000);
        for (const Real ripple_Nm : log.ripple_Nm) {
          ASSERT_TRUE(std::isfinite(ripple_Nm)) << process << ' ' << measurement << ' ' << initial;
        }
      }
    }
  }
}

TYPED_TEST(OscillatorSeriesOf, WhatIsNotWantedIsNotWritten) {
  using Real = TypeParam;
  const auto config = joint<Real>(0);
  Log<Real> log = quiet_log<Real>(0, 500);
  Log<Real> all = log;
  auto state = strainwave::initial_state(config);
  filter_by_series(config, state, all, 500);
  auto again = strainwave::initial_state(config);
  strainwave::steps(config, again,
                    OscillatorSeries<Real>{.sample_count = 500,
                                           .measured_torque_Nm = log.torque_Nm.data(),
                                           .motor_speed_rad_s = log.speed_rad_s.data(),
                                           .ripple_Nm = log.ripple_Nm.data()});
  EXPECT_EQ(log.ripple_Nm, all.ripple_Nm);
  EXPECT_EQ(log.clean_Nm[0], Real(-99));
  EXPECT_EQ(log.status[0], 0xFFFFFFFFU);
}

TYPED_TEST(OscillatorSeriesOf, HalfAMillionSamplesStayWithStepInDouble) {
  using Real = TypeParam;
  // Both beside step() in double: no rounding grows with time, neither in P nor in the angles.
  const auto config = strainwave::taghirad1999<Real, 3>({100, 1});
  const auto reference = strainwave::taghirad1999<double, 3>({100, 1});
  auto state = strainwave::initial_state(config);
  auto expected_state = strainwave::initial_state(reference);
  Log<Real> log = quiet_log<Real>(4, 5000);
  Log<double> expected = quiet_log<double>(4, 5000);
  for (std::size_t k = 0; k < 5000; ++k) {  // the same numbers in both
    expected.torque_Nm[k] = static_cast<double>(log.torque_Nm[k]);
    expected.speed_rad_s[k] = static_cast<double>(log.speed_rad_s[k]);
  }
  double worst_Nm = 0.0;
  for (int round = 0; round < 100; ++round) {
    filter_by_series(config, state, log, 5000);
    filter_by_step(reference, expected_state, expected);
    if (round >= 90) {
      for (std::size_t k = 0; k < 5000; ++k) {
        const auto ripple_Nm = static_cast<double>(log.ripple_Nm[k]);
        worst_Nm = std::fmax(worst_Nm, std::fabs(ripple_Nm - expected.ripple_Nm[k]));
      }
    }
  }
  EXPECT_LT(worst_Nm, sizeof(Real) == 4 ? 2e-4 : 1e-11);
  EXPECT_GT(worst_Nm, 0.0);
}

}  // namespace
