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
#include "strainwave/gauge_monitor_config.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// What is remembered of one gauge.
template <class Real>
struct WatchedGauge {
  std::int32_t last_code = 0;
  std::uint16_t at_rail = 0;       ///< samples in a row
  std::uint16_t unchanged = 0;     ///< samples in a row, while another gauge changed
  std::uint16_t at_zero = 0;       ///< samples in a row at the amplifier's zero
  std::uint16_t inconsistent = 0;  ///< samples beyond the limit, less those within it
  Real flat_reference_V = Real(0);
  Real flat_travel_turns = Real(0);
};

template <class Real, std::size_t MaxGauges>
struct GaugeMonitorState {
  WatchedGauge<Real> gauges[MaxGauges] = {};
  Phase last_phase = {};
  bool phase_known = false;
  bool started = false;
  std::uint8_t lost_gauge = 0;  ///< its number, from 1; 0: none
  GaugeFault fault = GaugeFault::none;
  bool more_are_lost = false;
};

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

constexpr void count_in_a_row(std::uint16_t& count, bool again) {
  if (!again) {
    count = 0;
  } else if (count < most_watched_samples) {
    ++count;
  }
}

/// -1 or 1 at the lower or the upper rail, 0 between.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr int rail_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                    const Converter<Real>& converter, ConverterCode code,
                                    Real volts) {
  if (code.value <= converter.lowest_code || volts <= config.lowest_V) {
    return -1;
  }
  return code.value >= highest_code(converter) || volts >= config.highest_V ? 1 : 0;
}

[[nodiscard]] constexpr GaugeFault fault_at_rail(TornGaugeRail torn, int rail) {
  const bool is_torn =
      (torn == TornGaugeRail::upper && rail > 0) || (torn == TornGaugeRail::lower && rail < 0);
  return is_torn ? GaugeFault::open : GaugeFault::saturated;
}

/// The gauges that are wrong in this sample, and those that are lost by it.
struct Suspects {
  std::uint8_t first = 0;  ///< number of the gauge, from 1; 0: none
  bool several = false;
  bool all = false;  ///< what is wrong is not one gauge alone

  constexpr void add(std::size_t gauge) {
    const auto number = static_cast<std::uint8_t>(gauge + 1);
    several = several || (first != 0 && first != number);
    first = first == 0 ? number : first;
  }
};

template <class Real, std::size_t MaxGauges>
constexpr void lose(GaugeMonitorState<Real, MaxGauges>& state, std::size_t gauge,
                    GaugeFault fault) {
  const auto number = static_cast<std::uint8_t>(gauge + 1);
  if (fault == GaugeFault::none) {
    return;
  }
  if (state.lost_gauge == 0) {
    state.lost_gauge = number;
    state.fault = fault;
  } else if (state.lost_gauge != number) {
    state.more_are_lost = true;
  }
}

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

/// What one gauge shows in a sample.
template <class Real>
struct GaugeSight {
  Real volts = Real(0);
  int rail = 0;             ///< -1 or 1 where it is at a rail and should not be
  bool overloaded = false;  ///< at a rail because the torque is too large
  bool changed = true;
  bool others_changed = true;
};

/// Counts what one gauge did, and says what its own signal proves.
template <class Real, std::size_t MaxGauges>
constexpr GaugeFault watch_alone(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                 WatchedGauge<Real>& gauge, const GaugeSight<Real>& sight,
                                 Real travel_turns) {
  const bool at_zero = absolute(sight.volts - config.amplifier_zero_V) <= config.short_band_V;
  count_in_a_row(gauge.at_rail, sight.rail != 0);
  count_in_a_row(gauge.at_zero, at_zero);
  if (sight.changed || sight.others_changed) {  // where all repeat their codes, nothing is said
    count_in_a_row(gauge.unchanged, !sight.changed && !sight.overloaded);
  }
  if (sight.overloaded || absolute(sight.volts - gauge.flat_reference_V) > config.flat_band_V) {
    gauge.flat_reference_V = sight.volts;
    gauge.flat_travel_turns = Real(0);
  } else if (absolute(gauge.flat_travel_turns) < Real(1e6F)) {
    gauge.flat_travel_turns += travel_turns;  // with its sign: an encoder that dithers stands
  }
  if (config.rail_samples > 0 && gauge.at_rail >= config.rail_samples) {
    return fault_at_rail(config.torn_gauge_rail, sight.rail);
  }
  if (sight.rail != 0) {
    return GaugeFault::none;  // it stands at its rail: that has its own time
  }
  if (config.stuck_samples > 0 && gauge.unchanged >= config.stuck_samples) {
    return GaugeFault::stuck;
  }
  if (config.flat_travel_turns > Real(0) &&
      absolute(gauge.flat_travel_turns) >= config.flat_travel_turns) {
    return at_zero ? GaugeFault::shorted : GaugeFault::stuck;
  }
  return GaugeFault::none;
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

/// The gauge that disagrees with the others; count where none does.
template <class Real, std::size_t MaxGauges>
constexpr std::size_t find_inconsistent(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                        std::uint8_t lost_gauge, const GaugeSignals<Real>& signals,
                                        Real travel_turns, Suspects& suspects) {
  const ConsistencyCheck<Real, MaxGauges>& parity = config.consistency;
  Real signal_V[MaxGauges] = {};
  take_out_the_known(parity, signals, travel_turns, signal_V);
  Parity<Real, MaxGauges> found = parity_of(parity, signals.count, signal_V);
  if (lost_gauge > 0) {
    leave_out(parity, signals.count, lost_gauge - 1U, found);
  }
  // The limit is that of the torque without the suspect: a fault must not widen its own limit.
  const Real before_V2 = found.squared_V2;
  const std::size_t gauge = likeliest(found, signals.count);
  leave_out(parity, signals.count, gauge, found);
  const Real limit_V2 = squared_limit_V2(parity, found.torque_V);
  if (!(before_V2 > limit_V2)) {
    return signals.count;
  }
  if (found.squared_V2 > limit_V2) {
    suspects.all = true;  // no single gauge explains it: several, or the angle
    return signals.count;
  }
  return gauge;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeVerdict verdict_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                                const GaugeMonitorState<Real, MaxGauges>& state,
                                                const Suspects& suspects) {
  GaugeVerdict verdict;
  const bool is_lost = state.lost_gauge != 0;
  const bool another = suspects.first != 0 && suspects.first != state.lost_gauge;
  verdict.left_out = is_lost ? state.lost_gauge : suspects.first;
  verdict.status |= is_lost ? mask(StatusFlag::gauge_lost) : Status{0};
  verdict.status |= another ? mask(StatusFlag::gauge_suspected) : Status{0};
  verdict.status |= suspects.all ? mask(StatusFlag::gauges_disagree) : Status{0};
  if (verdict.left_out != 0) {
    verdict.usable = config.without[verdict.left_out - 1U].available && !state.more_are_lost &&
                     !suspects.several && !(is_lost && another);
  }
  verdict.status |= verdict.usable ? Status{0} : mask(StatusFlag::gauges_insufficient);
  return verdict;
}

/// All gauges in use, before one of them is looked at.
template <class Real>
struct GaugeOverview {
  Real sum_V = Real(0);
  std::size_t in_use = 0;
  std::size_t changed = 0;  ///< codes that are not those of the sample before
};

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool has_changed(const GaugeMonitorState<Real, MaxGauges>& state,
                                         const GaugeSignals<Real>& signals, std::size_t gauge) {
  return !state.started || signals.codes[gauge].value != state.gauges[gauge].last_code;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeOverview<Real> overview_of(
    const GaugeMonitorState<Real, MaxGauges>& state, const GaugeSignals<Real>& signals) {
  GaugeOverview<Real> all;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    if (j + 1 != state.lost_gauge) {
      all.sum_V += signals.volts[j];
      ++all.in_use;
      all.changed += has_changed(state, signals, j) ? 1U : 0U;
    }
  }
  return all;
}

/// What gauge j shows, seen beside the others.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeSight<Real> sight_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                                  const GaugeMonitorState<Real, MaxGauges>& state,
                                                  const Converter<Real>& converter,
                                                  const GaugeSignals<Real>& signals,
                                                  const GaugeOverview<Real>& all,
                                                  std::size_t gauge) {
  GaugeSight<Real> sight;
  sight.volts = signals.volts[gauge];
  sight.rail = rail_of(config, converter, signals.codes[gauge], sight.volts);
  sight.changed = has_changed(state, signals, gauge);
  sight.others_changed = all.changed > (sight.changed ? 1U : 0U);
  const Real others_V = (all.sum_V - sight.volts) * static_cast<Real>(sight.rail);
  if (others_V >= config.overload_V * static_cast<Real>(all.in_use - 1)) {
    sight.overloaded = sight.rail != 0;  // a sound gauge is there, too
    sight.rail = 0;
  }
  return sight;
}

/// Counts who disagrees with the others, and loses the one for which it has lasted.
template <class Real, std::size_t MaxGauges>
constexpr void compare(const GaugeMonitorConfig<Real, MaxGauges>& config,
                       GaugeMonitorState<Real, MaxGauges>& state, const GaugeSignals<Real>& signals,
                       Real travel_turns, const int* rails, Suspects& suspects) {
  const std::size_t found =
      find_inconsistent(config, state.lost_gauge, signals, travel_turns, suspects);
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    std::uint16_t& count = state.gauges[j].inconsistent;
    if (j != found) {
      count = static_cast<std::uint16_t>(count > 0 ? count - 1 : 0);
      continue;
    }
    suspects.add(j);
    count_in_a_row(count, true);
    if (count >= config.consistency.samples) {
      lose(state, j, name_of_inconsistent(config, state.gauges[j], rails[j]));
    }
  }
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
  const std::uint8_t lost_before = state.lost_gauge;
  detail::Suspects suspects;
  int rails[MaxGauges] = {};
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    if (j + 1 != lost_before) {
      const detail::GaugeSight<Real> sight =
          detail::sight_of(config, state, converter, signals, all, j);
      rails[j] = sight.rail;
      if (sight.rail != 0) {
        suspects.add(j);
      }
      detail::lose(state, j, detail::watch_alone(config, state.gauges[j], sight, travel_turns));
    }
    state.gauges[j].last_code = signals.codes[j].value;
  }
  state.started = true;
  const bool overloaded = absolute(all.sum_V) >= config.overload_V * static_cast<Real>(all.in_use);
  const bool comparable = signals.phase_valid && signals.phase_referenced;
  if (config.consistency.samples > 0 && (!overloaded || suspects.first != 0) &&
      (comparable || config.consistency.harmonic_count == 0)) {
    detail::compare(config, state, signals, travel_turns, rails, suspects);
  }
  return detail::verdict_of(config, state, suspects);
}

}  // namespace strainwave
