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
  std::int32_t last_code = 0;      ///< where repeated codes are watched
  std::uint16_t at_rail = 0;       ///< samples in a row
  std::uint16_t unchanged = 0;     ///< samples in a row, while another gauge changed
  std::uint16_t at_zero = 0;       ///< samples in a row at the amplifier's zero, while inconsistent
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
  bool doubted = false;  ///< some gauge counts samples beyond the limit
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

/// Whether a rail can be met inside the converter's range.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool has_rails_inside(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                              const Converter<Real>& converter) {
  return config.lowest_V >= to_volts(converter, {converter.lowest_code}) ||
         config.highest_V <= to_volts(converter, {highest_code(converter)});
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
struct GaugeSight {
  int rail = 0;             ///< -1 or 1 where it is at a rail and should not be
  bool overloaded = false;  ///< at a rail because the torque is too large
};

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool is_at_zero(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                        Real volts) {
  return absolute(volts - config.amplifier_zero_V) <= config.short_band_V;
}

/// Travel in one place: whether the gauge has stayed within the band for as long as none does.
template <class Real, std::size_t MaxGauges>
constexpr bool has_been_flat(const GaugeMonitorConfig<Real, MaxGauges>& config,
                             WatchedGauge<Real>& gauge, Real volts, bool overloaded,
                             Real travel_turns) {
  if (!(config.flat_travel_turns > Real(0))) {
    return false;
  }
  if (overloaded || absolute(volts - gauge.flat_reference_V) > config.flat_band_V) {
    gauge.flat_reference_V = volts;
    gauge.flat_travel_turns = Real(0);
    return false;
  }
  gauge.flat_travel_turns += travel_turns;  // with its sign: an encoder that dithers stands
  return absolute(gauge.flat_travel_turns) >= config.flat_travel_turns;
}

/// Counts what one gauge did, and says what its own signal proves.
template <class Real, std::size_t MaxGauges>
constexpr GaugeFault watch_alone(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                 WatchedGauge<Real>& gauge, Real volts, GaugeSight sight,
                                 Real travel_turns) {
  count_in_a_row(gauge.at_rail, sight.rail != 0);
  if (sight.overloaded) {
    gauge.unchanged = 0;
  }
  const bool flat = has_been_flat(config, gauge, volts, sight.overloaded, travel_turns);
  if (sight.rail != 0) {  // that has its own time
    return config.rail_samples > 0 && gauge.at_rail >= config.rail_samples
               ? fault_at_rail(config.torn_gauge_rail, sight.rail)
               : GaugeFault::none;
  }
  if (config.stuck_samples > 0 && gauge.unchanged >= config.stuck_samples) {
    return GaugeFault::stuck;
  }
  if (flat) {
    return is_at_zero(config, volts) ? GaugeFault::shorted : GaugeFault::stuck;
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

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeVerdict verdict_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                                const GaugeMonitorState<Real, MaxGauges>& state,
                                                const Suspects& suspects) {
  GaugeVerdict verdict;
  if (state.lost_gauge == 0 && suspects.first == 0 && !suspects.all) {
    return verdict;
  }
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
};

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeOverview<Real> overview_of(
    const GaugeMonitorState<Real, MaxGauges>& state, const GaugeSignals<Real>& signals) {
  GaugeOverview<Real> all;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    all.sum_V += signals.volts[j];
  }
  all.in_use = signals.count;
  if (state.lost_gauge != 0) {
    all.sum_V -= signals.volts[state.lost_gauge - 1U];
    --all.in_use;
  }
  return all;
}

/// Whether gauge j is at a rail, and whether the others say that it should be.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeSight sight_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                            const Converter<Real>& converter,
                                            const GaugeSignals<Real>& signals,
                                            const GaugeOverview<Real>& all, std::size_t gauge) {
  const Real volts = signals.volts[gauge];
  const int rail = rail_of(config, converter, signals.codes[gauge], volts);
  if (rail == 0) {
    return {};
  }
  const Real others_V = (all.sum_V - volts) * static_cast<Real>(rail);
  if (others_V >= config.overload_V * static_cast<Real>(all.in_use - 1)) {
    return {0, true};  // a sound gauge is there, too
  }
  return {rail, false};
}

/// Counts for how long each gauge has repeated its code; where all repeat theirs, nothing is said.
template <class Real, std::size_t MaxGauges>
constexpr void count_unchanged(GaugeMonitorState<Real, MaxGauges>& state,
                               const GaugeSignals<Real>& signals) {
  bool changed[MaxGauges] = {};
  bool some_changed = false;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    changed[j] = !state.started || signals.codes[j].value != state.gauges[j].last_code;
    state.gauges[j].last_code = signals.codes[j].value;
    some_changed = some_changed || (changed[j] && j + 1 != state.lost_gauge);
  }
  for (std::size_t j = 0; some_changed && j < MaxGauges && j < signals.count; ++j) {
    count_in_a_row(state.gauges[j].unchanged, !changed[j]);
  }
  state.started = true;
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

/// The gauge that disagrees in this sample: lost, where that has lasted.
template <class Real, std::size_t MaxGauges>
constexpr void accuse(const GaugeMonitorConfig<Real, MaxGauges>& config,
                      GaugeMonitorState<Real, MaxGauges>& state, std::size_t gauge, Real volts,
                      int rail) {
  WatchedGauge<Real>& accused = state.gauges[gauge];
  if (accused.inconsistent == 0) {
    accused.at_zero = is_at_zero(config, volts) ? 1 : 0;
  }
  count_in_a_row(accused.inconsistent, true);
  if (accused.inconsistent >= config.consistency.samples) {
    lose(state, gauge, name_of_inconsistent(config, accused, rail));
  }
}

/// Counts down for the gauges that agree with the others.
template <class Real, std::size_t MaxGauges>
constexpr void trust_again(GaugeMonitorState<Real, MaxGauges>& state, std::size_t count,
                           std::size_t accused) {
  state.doubted = accused < count;
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    std::uint16_t& inconsistent = state.gauges[j].inconsistent;
    if (j != accused && inconsistent > 0) {
      --inconsistent;
      state.doubted = state.doubted || inconsistent > 0;
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
  if (config.stuck_samples > 0) {
    detail::count_unchanged(state, signals);
  }
  if (state.doubted) {
    detail::count_at_zero(config, state, signals);
  }
  const bool some_at_rail = signals.some_at_end || detail::has_rails_inside(config, converter);
  const std::uint8_t lost_before = state.lost_gauge;
  detail::Suspects suspects;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    if (j + 1 == lost_before) {
      continue;
    }
    detail::GaugeSight sight;
    if (some_at_rail) {
      sight = detail::sight_of(config, converter, signals, all, j);
      if (sight.rail != 0) {
        suspects.add(j);
      }
    }
    detail::lose(
        state, j,
        detail::watch_alone(config, state.gauges[j], signals.volts[j], sight, travel_turns));
  }
  const bool overloaded = absolute(all.sum_V) >= config.overload_V * static_cast<Real>(all.in_use);
  const bool comparable = signals.phase_valid && signals.phase_referenced;
  if (config.consistency.samples > 0 && (!overloaded || suspects.first != 0) &&
      (comparable || config.consistency.harmonic_count == 0)) {
    const detail::Disagreement found =
        detail::find_inconsistent(config.consistency, state.lost_gauge, signals, travel_turns);
    suspects.all = found.several;
    if (found.gauge < signals.count) {
      suspects.add(found.gauge);
      const int rail = detail::sight_of(config, converter, signals, all, found.gauge).rail;
      detail::accuse(config, state, found.gauge, signals.volts[found.gauge], rail);
    }
    if (found.gauge < signals.count || state.doubted) {
      detail::trust_again(state, signals.count, found.gauge);
    }
  }
  return detail::verdict_of(config, state, suspects);
}

}  // namespace strainwave
