// SPDX-License-Identifier: Apache-2.0
/// @file gauge_monitor.hpp
/// The watch over the gauges: finds the one that is open, shorted, stuck, saturated or not what the
/// others make it, and says which gains to go on with.
///
/// A sample in which one gauge is seen to be wrong does without it at once.  Only when that has
/// lasted is the gauge lost, and stays so until clear_lost_gauge(): a broken bond that makes
/// contact now and then shall not switch the gains back and forth.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/bridge.hpp"
#include "strainwave/gauge_consistency.hpp"
#include "strainwave/gauge_counts.hpp"
#include "strainwave/gauge_monitor_config.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// What the chain is to do with the sample.
struct GaugeVerdict {
  std::uint8_t left_out = 0;  ///< number of the gauge to do without, from 1; 0: none
  bool usable = true;         ///< false: no gains do without what is wrong
  Status status = 0;
};

/// Forget the loss: the gauge was repaired, or the fault is known to be over.
template <class Real, std::size_t MaxGauges>
constexpr void clear_lost_gauge(GaugeMonitorState<Real, MaxGauges>& state) {
  state = GaugeMonitorState<Real, MaxGauges>();
}

namespace detail {

/// Travel of the motor since the last sample, turns; 0 where it is not known.
template <class Real, std::size_t MaxGauges>
constexpr Real take_phase(GaugeMonitorState<Real, MaxGauges>& state,
                          const GaugeSignals<Real>& signals) {
  if (!signals.phase_valid) {
    state.phase_known = false;
    return Real(0);
  }
  const Real travel =
      state.phase_known ? to_turns<Real>(signals.motor_phase - state.last_phase) : Real(0);
  state.last_phase = signals.motor_phase;
  state.phase_known = true;
  return travel;
}

/// Name of a fault that the others found: by what the gauge has read meanwhile.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeFault name_of_inconsistent(
    const GaugeMonitorConfig<Real, MaxGauges>& config, const WatchedGauge<Real>& gauge, int rail) {
  if (rail != 0) {
    return fault_at_rail(config.torn_gauge_rail, rail);
  }
  if (gauge.at_zero >= config.consistency.samples) {
    return GaugeFault::shorted;
  }
  return config.stuck_samples > 0 && 2U * gauge.unchanged >= config.stuck_samples
             ? GaugeFault::stuck
             : GaugeFault::inconsistent;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeVerdict verdict_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                                const GaugeMonitorState<Real, MaxGauges>& state,
                                                const Suspects& suspects) {
  GaugeVerdict verdict;
  if (state.lost_gauge == 0 && suspects.first == 0 && !suspects.all) {
    return verdict;
  }
  verdict.status = suspects.all ? mask(StatusFlag::gauges_disagree) : Status{0};
  verdict.left_out = suspects.first;
  bool another = suspects.first != 0;
  verdict.usable = !suspects.several;
  if (state.lost_gauge != 0) {
    another = another && suspects.first != state.lost_gauge;
    verdict.left_out = state.lost_gauge;
    verdict.status |= mask(StatusFlag::gauge_lost);
    verdict.usable = verdict.usable && !another && !state.more_are_lost;
  }
  verdict.status |= another ? mask(StatusFlag::gauge_suspected) : Status{0};
  if (verdict.left_out != 0 && !config.without[verdict.left_out - 1U].available) {
    verdict.usable = false;
  }
  verdict.status |= verdict.usable ? Status{0} : mask(StatusFlag::gauges_insufficient);
  return verdict;
}

/// Counts for how long the gauges that are doubted have been at the amplifier's zero.
template <class Real, std::size_t MaxGauges>
constexpr void count_at_zero(const GaugeMonitorConfig<Real, MaxGauges>& config,
                             GaugeMonitorState<Real, MaxGauges>& state,
                             const GaugeSignals<Real>& signals) {
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    if (state.gauges[j].inconsistent > 0) {
      count_in_a_row(state.gauges[j].at_zero, is_at_zero(config, signals.volts[j]));
    }
  }
}

/// Counts for the gauge that disagrees in this sample; whether that has lasted.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool accuse(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                    WatchedGauge<Real>& gauge, Real volts) {
  if (gauge.inconsistent == 0) {
    gauge.at_zero = is_at_zero(config, volts) ? 1 : 0;
  }
  count_in_a_row(gauge.inconsistent, true);
  return gauge.inconsistent >= config.consistency.samples;
}

/// Counts down for the gauges that agree with the others.
template <class Real, std::size_t MaxGauges>
constexpr void trust_again(GaugeMonitorState<Real, MaxGauges>& state, std::size_t count,
                           std::size_t accused) {
  state.doubted = false;
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    std::uint16_t& inconsistent = state.gauges[j].inconsistent;
    if (j != accused && inconsistent > 0) {
      --inconsistent;
      state.doubted = state.doubted || inconsistent > 0;
    }
  }
}

/// Compares the gauges: counts for the one that disagrees, and loses it where that has lasted.
template <class Real, std::size_t MaxGauges>
constexpr void compare(const GaugeMonitorConfig<Real, MaxGauges>& config,
                       GaugeMonitorState<Real, MaxGauges>& state, const Converter<Real>& converter,
                       const GaugeSignals<Real>& signals, const GaugeOverview<Real>& all,
                       Real travel_turns, Suspects& suspects) {
  const std::size_t suspect =
      suspects.first == 0 || suspects.several ? signals.count : suspects.first - 1U;
  const Disagreement found =
      find_inconsistent(config.consistency, state.lost_gauge, suspect, signals, travel_turns);
  suspects.all = found.several;
  if (found.gauge < signals.count) {
    if (found.gauge != suspect) {
      suspects.add(found.gauge);
    }
    WatchedGauge<Real>& accused = state.gauges[found.gauge];
    if (accuse(config, accused, signals.volts[found.gauge])) {
      const int rail = faulty_rail_of(config, converter, signals, all, found.gauge);
      lose(state, found.gauge, name_of_inconsistent(config, accused, rail));
    }
  }
  if (state.doubted) {
    trust_again(state, signals.count, found.gauge);
  }
  state.doubted = state.doubted || found.gauge < signals.count;
}

}  // namespace detail

/// One sample of all gauges: which gauge to do without, if any.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeVerdict watch(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                           GaugeMonitorState<Real, MaxGauges>& state,
                                           const Converter<Real>& converter,
                                           const GaugeSignals<Real>& signals) {
  const Real travel_turns = detail::take_phase(state, signals);
  const detail::GaugeOverview<Real> all = detail::overview_of(state, signals);
  if (state.doubted) {
    detail::count_at_zero(config, state, signals);
  }
  detail::Suspects suspects;
  detail::watch_alone(config, state, converter, signals, all, travel_turns, suspects);
  const bool overloaded = absolute(all.sum_V) >= config.overload_V * static_cast<Real>(all.in_use);
  const bool comparable = signals.phase_valid && signals.phase_referenced;
  if (config.consistency.samples > 0 && (!overloaded || suspects.first != 0) &&
      (comparable || config.consistency.harmonic_count == 0)) {
    detail::compare(config, state, converter, signals, all, travel_turns, suspects);
  }
  return detail::verdict_of(config, state, suspects);
}

}  // namespace strainwave
