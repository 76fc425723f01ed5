// A golden chain's filter in lanes, on threads, in time chunks and in series, held to step() and to
// the golden answers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "golden_logs.hpp"
#include "strainwave/batch_long.hpp"
#include "strainwave/batch_ripple_long.hpp"
#include "strainwave/oscillator_series.hpp"

namespace golden {

/// How far from step() and from the golden torques a way may come out, FS; and how far it has to
/// be, so that a comparison of step() with itself is seen.
struct Tolerance {
  double least_FS = 0.0;
  double most_FS = 0.0;
};

/// What any torque may differ from the golden one in double, FS.
inline constexpr double double_tolerance_FS = 1e-4;

template <class Real, std::size_t MaxOrders>
[[nodiscard]] strainwave::OscillatorChannel<Real> channel_of(
    const strainwave::OscillatorFilterConfig<Real, MaxOrders>& /*config*/,
    const Signals<Real>& signals, Outputs<Real>& outputs) {
  return {.sample_count = signals.size(),
          .measured_torque_Nm = signals.measured_Nm.data(),
          .motor_speed_rad_s = signals.speed_rad_s.data(),
          .motor_angle_rad = signals.angle_rad.data(),
          .expected_torque_Nm = signals.expected_Nm.data(),
          .torque_Nm = outputs.torque_Nm.data(),
          .ripple_Nm = outputs.ripple_Nm.data(),
          .status = outputs.status.data()};
}

template <class Real, std::size_t MaxPairs>
[[nodiscard]] strainwave::RippleChannel<Real> channel_of(
    const strainwave::RippleFilterConfig<Real, MaxPairs>& /*config*/, const Signals<Real>& signals,
    Outputs<Real>& outputs) {
  strainwave::RippleChannel<Real> channel;
  channel.sample_count = signals.size();
  channel.measured_torque_Nm = signals.measured_Nm.data();
  channel.motor_angle_rad = signals.angle_rad.data();
  channel.interval_s = signals.interval_s.data();
  channel.expected_torque_Nm = signals.expected_Nm.data();
  channel.output(strainwave::RippleOutput::torque) = outputs.torque_Nm.data();
  channel.output(strainwave::RippleOutput::ripple) = outputs.ripple_Nm.data();
  channel.status = outputs.status.data();
  return channel;
}

/// A joint like the golden one that is not it.
template <class Real, std::size_t Max>
void change(strainwave::OscillatorFilterConfig<Real, Max>& config, std::size_t number) {
  config.measurement_noise_variance_Nm2 *= static_cast<Real>(2 + number);
}
template <class Real, std::size_t Max>
void change(strainwave::RippleFilterConfig<Real, Max>& config, std::size_t number) {
  config.memory_turns += static_cast<Real>(1 + number);
}

/// One chain: its filter, what that is fed, and what step() makes of it.
template <class Real, template <class, std::size_t> class FilterConfig, std::size_t Max>
class ChainRun {
 public:
  using Config = FilterConfig<Real, Max>;
  using State = decltype(strainwave::initial_state(Config{}));

  ChainRun(const Golden& expected, const Config& config, Signals<Real> signals)
      : expected_(expected),
        config_(config),
        signals_(std::move(signals)),
        by_step_(signals_.size()),
        state_(strainwave::initial_state(config_)) {
    strainwave::detail::filter_one(config_, state_, channel_of(config_, signals_, by_step_));
  }

  [[nodiscard]] const Config& config() const { return config_; }

  /// step() over the log has the golden bits: the log is what the chain hands to its filter.
  void expect_step_is_golden() const {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      if ((signals_.sample[i] + 1) % every == 0) {
        ++kept;
        ASSERT_EQ(static_cast<double>(by_step_.torque_Nm[i]), golden_Nm(i)) << i;
      }
    }
    EXPECT_GT(kept, sample_count / every * 99 / 100);
  }

  /// Alone in its block or the last of so many channels.
  void expect_in_lanes(const strainwave::BatchOptions& options, std::size_t channel_count,
                       Tolerance tolerance) const {
    std::vector<Config> configs(channel_count, config_);
    std::vector<State> states;
    std::vector<Outputs<Real>> outputs(channel_count, Outputs<Real>(signals_.size()));
    std::vector<decltype(channel_of(config_, signals_, outputs[0]))> channels;
    for (std::size_t i = 0; i < channel_count; ++i) {
      channels.push_back(channel_of(config_, signals_, outputs[i]));
      if (i + 1 < channel_count) {  // another joint, later in the same motion, and not for as long
        change(configs[i], i);
        const std::size_t start = 1000 * i + 2500;
        channels.back() =
            strainwave::detail::part_of(channels.back(), start, 5000 + 4000 * (i % 3));
      }
      states.push_back(strainwave::initial_state(configs[i]));
    }
    strainwave::process_batch<Real, Max>(configs, states, channels, options);
    expect_golden(outputs.back(), tolerance);
    expect_counters(states.back());
  }

  /// In calls of so many samples; of the published filter alone.
  void expect_in_series(std::size_t samples, Tolerance tolerance) const {
    Outputs<Real> outputs(signals_.size());
    State state = strainwave::initial_state(config_);
    for (std::size_t start = 0; start < signals_.size(); start += samples) {
      strainwave::steps(config_, state,
                        {.sample_count = std::min(samples, signals_.size() - start),
                         .measured_torque_Nm = signals_.measured_Nm.data() + start,
                         .motor_speed_rad_s = signals_.speed_rad_s.data() + start,
                         .expected_torque_Nm = signals_.expected_Nm.data() + start,
                         .torque_Nm = outputs.torque_Nm.data() + start,
                         .ripple_Nm = outputs.ripple_Nm.data() + start,
                         .status = outputs.status.data() + start});
    }
    expect_golden(outputs, tolerance);
    expect_counters(state);
  }

  /// In time chunks; returns what was reported.
  strainwave::LongReport expect_in_chunks(const strainwave::LongOptions& options,
                                          Tolerance tolerance) const {
    Outputs<Real> outputs(signals_.size());
    State state = strainwave::initial_state(config_);
    const auto report =
        strainwave::process_long(config_, state, channel_of(config_, signals_, outputs), options);
    expect_golden(outputs, tolerance);
    expect_counters(state);
    return report;
  }

 private:
  [[nodiscard]] double golden_Nm(std::size_t i) const {
    const std::size_t kept = signals_.sample[i] / every;
    return std::is_same_v<Real, float> ? expected_.float_Nm[kept] : expected_.double_Nm[kept];
  }

  void expect_golden(const Outputs<Real>& outputs, Tolerance tolerance) const {
    double furthest_Nm = 0.0;
    double from_golden_Nm = 0.0;
    double from_double_Nm = 0.0;
    std::size_t other_statuses = 0;
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      const auto torque_Nm = static_cast<double>(outputs.torque_Nm[i]);
      const auto ripple_Nm = static_cast<double>(outputs.ripple_Nm[i] - by_step_.ripple_Nm[i]);
      ASSERT_TRUE(std::isfinite(torque_Nm) && std::isfinite(ripple_Nm)) << i;
      furthest_Nm = std::max({furthest_Nm, std::abs(ripple_Nm),
                              std::abs(torque_Nm - static_cast<double>(by_step_.torque_Nm[i]))});
      other_statuses += outputs.status[i] == by_step_.status[i] ? 0U : 1U;
      if ((signals_.sample[i] + 1) % every == 0) {
        const double golden_double_Nm = expected_.double_Nm[signals_.sample[i] / every];
        from_golden_Nm = std::max(from_golden_Nm, std::abs(torque_Nm - golden_Nm(i)));
        from_double_Nm = std::max(from_double_Nm, std::abs(torque_Nm - golden_double_Nm));
      }
    }
    EXPECT_EQ(other_statuses, 0U);
    EXPECT_LE(furthest_Nm, tolerance.most_FS * full_scale_Nm);
    EXPECT_GE(furthest_Nm, tolerance.least_FS * full_scale_Nm);
    EXPECT_LE(from_golden_Nm, tolerance.most_FS * full_scale_Nm);
    EXPECT_LE(from_double_Nm, double_tolerance_FS * full_scale_Nm);
  }

  void expect_counters(const State& state) const {
    EXPECT_EQ(state.counters.samples, state_.counters.samples);
    EXPECT_EQ(state.counters.faults, state_.counters.faults);
    for (std::size_t bit = 0; bit < 32; ++bit) {
      EXPECT_EQ(state.counters.by_bit[bit], state_.counters.by_bit[bit]) << bit;
    }
  }

  const Golden& expected_;
  Config config_;
  Signals<Real> signals_;
  Outputs<Real> by_step_;
  State state_;
};

}  // namespace golden
