// SPDX-License-Identifier: Apache-2.0
/// @file gauge_counts.hpp
/// What the watch remembers of each gauge, and what a gauge's own signal proves: how long it has
/// stood at a rail, repeated its code, or stayed where it was while the motor turned.
///
/// Most samples of sound gauges set a count to 0 or leave it; what a full count is called is asked
/// only where there is one.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/bridge.hpp"
#include "strainwave/gauge_consistency.hpp"
#include "strainwave/gauge_monitor_config.hpp"
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

namespace detail {

constexpr void count_in_a_row(std::uint16_t& count, bool again) {
  if (!again) {
    count = 0;
  } else if (count < most_watched_samples) {
    ++count;
  }
}

/// Whether a rail can be met inside the converter's range.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool has_rails_inside(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                              const Converter<Real>& converter) {
  return config.lowest_V >= to_volts(converter, {converter.lowest_code}) ||
         config.highest_V <= to_volts(converter, {highest_code(converter)});
}

/// -1 or 1 at the lower or the upper rail, 0 between.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr int rail_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                    const Converter<Real>& converter, ConverterCode code,
                                    Real volts) {
  const bool by_volts = has_rails_inside(config, converter);
  if (!by_volts && !is_saturated(converter, code)) {
    return 0;
  }
  if (code.value <= converter.lowest_code || (by_volts && volts <= config.lowest_V)) {
    return -1;
  }
  return code.value >= highest_code(converter) || (by_volts && volts >= config.highest_V) ? 1 : 0;
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

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool is_at_zero(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                        Real volts) {
  return absolute(volts - config.amplifier_zero_V) <= config.short_band_V;
}

/// What a gauge's own signal proves, from what was counted; `rail`: at which it stands.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr GaugeFault fault_alone(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                               const WatchedGauge<Real>& gauge, Real volts,
                                               int rail) {
  if (rail != 0) {  // that has its own time
    return config.rail_samples > 0 && gauge.at_rail >= config.rail_samples
               ? fault_at_rail(config.torn_gauge_rail, rail)
               : GaugeFault::none;
  }
  if (config.stuck_samples > 0 && gauge.unchanged >= config.stuck_samples) {
    return GaugeFault::stuck;
  }
  if (config.flat_travel_turns > Real(0) &&
      absolute(gauge.flat_travel_turns) >= config.flat_travel_turns) {
    return is_at_zero(config, volts) ? GaugeFault::shorted : GaugeFault::stuck;
  }
  return GaugeFault::none;
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

/// Whether the others say that gauge j, which is at a rail, should be there.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool is_overload(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                         const GaugeSignals<Real>& signals,
                                         const GaugeOverview<Real>& all, std::size_t gauge,
                                         int rail) {
  const Real others_V = all.sum_V - signals.volts[gauge];
  return (rail > 0 ? others_V : -others_V) >= config.overload_V * static_cast<Real>(all.in_use - 1);
}

/// -1 or 1 where gauge j is at a rail and should not be, 0 otherwise.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr int faulty_rail_of(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                           const Converter<Real>& converter,
                                           const GaugeSignals<Real>& signals,
                                           const GaugeOverview<Real>& all, std::size_t gauge) {
  const int rail = rail_of(config, converter, signals.codes[gauge], signals.volts[gauge]);
  return rail != 0 && is_overload(config, signals, all, gauge, rail) ? 0 : rail;
}

// What follows counts, and says whether some gauge has come to its limit: what it is called is
// asked then only.

/// How long each gauge has repeated its code; where all repeat theirs, nothing is said.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool count_unchanged(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                             GaugeMonitorState<Real, MaxGauges>& state,
                                             const GaugeSignals<Real>& signals) {
  bool changed[MaxGauges] = {};
  bool some_changed = false;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    changed[j] = !state.started || signals.codes[j].value != state.gauges[j].last_code;
    state.gauges[j].last_code = signals.codes[j].value;
    some_changed = some_changed || (changed[j] && j + 1 != state.lost_gauge);
  }
  bool stuck = false;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    if (some_changed) {
      count_in_a_row(state.gauges[j].unchanged, !changed[j]);
    }
    stuck =
        stuck || (state.gauges[j].unchanged >= config.stuck_samples && j + 1 != state.lost_gauge);
  }
  state.started = true;
  return stuck;
}

/// How far the motor has turned while each gauge stayed within its band.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool count_flat(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                        GaugeMonitorState<Real, MaxGauges>& state,
                                        const GaugeSignals<Real>& signals, Real travel_turns) {
  bool flat = false;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    WatchedGauge<Real>& gauge = state.gauges[j];
    if (absolute(signals.volts[j] - gauge.flat_reference_V) > config.flat_band_V) {
      gauge.flat_reference_V = signals.volts[j];
      gauge.flat_travel_turns = Real(0);
    } else {
      gauge.flat_travel_turns += travel_turns;  // with its sign: an encoder that dithers stands
      flat = flat || (absolute(gauge.flat_travel_turns) >= config.flat_travel_turns &&
                      j + 1 != state.lost_gauge);
    }
  }
  return flat;
}

/// How long each gauge has stood at a rail.  In an overload it is neither stuck nor flat.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool count_at_rail(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                           GaugeMonitorState<Real, MaxGauges>& state,
                                           const Converter<Real>& converter,
                                           const GaugeSignals<Real>& signals,
                                           const GaugeOverview<Real>& all, Suspects& suspects) {
  bool for_good = false;
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    WatchedGauge<Real>& gauge = state.gauges[j];
    const int rail = rail_of(config, converter, signals.codes[j], signals.volts[j]);
    if (rail == 0 || j + 1 == state.lost_gauge) {
      gauge.at_rail = 0;
    } else if (is_overload(config, signals, all, j, rail)) {
      gauge.at_rail = 0;
      gauge.unchanged = 0;
      gauge.flat_reference_V = signals.volts[j];
      gauge.flat_travel_turns = Real(0);
    } else {
      count_in_a_row(gauge.at_rail, true);
      suspects.add(j);
      if (gauge.at_rail >= config.rail_samples) {
        for_good = true;
      }
    }
  }
  return for_good;
}

/// Each gauge by itself: counts what it did, and loses those of which that proves a fault.
template <class Real, std::size_t MaxGauges>
constexpr void watch_alone(const GaugeMonitorConfig<Real, MaxGauges>& config,
                           GaugeMonitorState<Real, MaxGauges>& state,
                           const Converter<Real>& converter, const GaugeSignals<Real>& signals,
                           const GaugeOverview<Real>& all, Real travel_turns, Suspects& suspects) {
  bool proven = config.stuck_samples > 0 && count_unchanged(config, state, signals);
  if (config.flat_travel_turns > Real(0)) {
    proven = count_flat(config, state, signals, travel_turns) || proven;
  }
  if (at_end_beside(converter, signals, state.lost_gauge) > 0 ||
      has_rails_inside(config, converter)) {
    proven = count_at_rail(config, state, converter, signals, all, suspects) || proven;
  } else {
    for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
      state.gauges[j].at_rail = 0;
    }
  }
  const std::uint8_t lost_before = state.lost_gauge;
  for (std::size_t j = 0; proven && j < MaxGauges && j < signals.count; ++j) {
    if (j + 1 != lost_before) {
      const int rail = faulty_rail_of(config, converter, signals, all, j);
      lose(state, j, fault_alone(config, state.gauges[j], signals.volts[j], rail));
    }
  }
}

}  // namespace detail

}  // namespace strainwave
