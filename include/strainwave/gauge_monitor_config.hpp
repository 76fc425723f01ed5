// SPDX-License-Identifier: Apache-2.0
/// @file gauge_monitor_config.hpp
/// What the watch over the gauges is told: what a sound gauge does, and the gains without each.
///
/// All of it is found beforehand, by strainwave.calibrate, and stands in the joint file; the sample
/// path compares and selects.  A default configuration is inactive: a chain with it is as without.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/gains.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// What has become of a gauge.  The numbers are stable: logs keep them.
enum class GaugeFault : std::uint8_t {
  none = 0,
  open = 1,          ///< at the rail that a torn gauge drives its amplifier to
  shorted = 2,       ///< at the amplifier's zero, whatever the others say
  stuck = 3,         ///< one code, while others change or the motor turns
  saturated = 4,     ///< at a rail that a torn gauge does not explain
  inconsistent = 5,  ///< inside its range, but not what the others and the angle make it
};

/// The rail to which a torn gauge drives its amplifier: which arm of the bridge it is decides.
enum class TornGaugeRail : std::uint8_t { unknown, lower, upper };

/// Harmonics of the fluctuation that the watch predicts, at most.
inline constexpr std::size_t most_watched_harmonics = 4;
/// Directions of the gauges' signals that say nothing of a fault, at most: torque, and a sine and a
/// cosine for each harmonic that is not predicted.
inline constexpr std::size_t most_signal_directions = 1 + 2 * most_watched_harmonics;
/// Samples in a row that a check can wait for, at most.
inline constexpr std::uint32_t most_watched_samples = 60000;

/// The gains solved beforehand for the loss of one gauge.
template <class Real, std::size_t MaxGauges>
struct GainsWithoutGauge {
  bool available = false;  ///< false: the others cannot replace it, the torque is then invalid
  Gains<Real, MaxGauges> gains = {};  ///< 0 for the one that is lost
  /// Weighted zeros of the gauges less those of the gains of all: with it the calibration's zero
  /// holds for these gains, too.
  Real zero_shift_V = Real(0);
  Real residual_fluctuation_V = Real(0);  ///< rms of the fluctuation these gains leave
};

/// The parity check: torque and the turning wave move the gauges in known directions, and what is
/// left beside them is a fault.
template <class Real, std::size_t MaxGauges>
struct ConsistencyCheck {
  std::uint32_t samples = 0;  ///< this many more beyond the limit than within it; 0: no check
  std::size_t direction_count = 1;
  /// Orthonormal; the first one is that of the torque.
  Real directions[most_signal_directions][MaxGauges] = {};
  std::size_t harmonic_count = 0;  ///< predicted from the angle; 0: no angle is needed
  Rational wave_factor = {1, 1};   ///< factor m of the gear configuration, see gear.hpp
  /// fluctuation_phasor() of each gauge and harmonic, V.
  CosSin<Real> wave_V[MaxGauges][most_watched_harmonics] = {};
  Real zero_V[MaxGauges] = {};   ///< of each gauge without torque, the wave taken out
  Real delay_samples = Real(0);  ///< by which the gauges are behind the angle
  Real limit_V = Real(0);        ///< length of what may be left at no torque
  Real limit_per_V = Real(0);    ///< growth of that with the length of the torque's share
};

template <class Real, std::size_t MaxGauges>
struct GaugeMonitorConfig {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxGauges > 0 && MaxGauges < 256, "strainwave: MaxGauges must be from 1 to 255");

  bool active = false;

  // A rail: a converter code at an end of its range, or a voltage beyond these.
  std::uint32_t rail_samples = 5;  ///< in a row, until the gauge is lost; 0: no check
  Real lowest_V = Real(-1e9F);
  Real highest_V = Real(1e9F);
  TornGaugeRail torn_gauge_rail = TornGaugeRail::unknown;
  /// Mean of the other gauges from which on a gauge at the same rail is an overload and no fault.
  Real overload_V = Real(1e9F);

  /// Equal codes in a row, while another gauge's change; 0: no check.  For converters that show
  /// the noise.
  std::uint32_t stuck_samples = 0;
  /// Travel of the motor over which a sound gauge leaves the band; 0: no check.
  Real flat_travel_turns = Real(0);
  Real flat_band_V = Real(0);
  /// Where a shorted gauge reads: within so much of the amplifier's zero.
  Real amplifier_zero_V = Real(0);
  Real short_band_V = Real(0);

  ConsistencyCheck<Real, MaxGauges> consistency = {};

  Real residual_fluctuation_V = Real(0);  ///< rms that the gains of all gauges leave
  GainsWithoutGauge<Real, MaxGauges> without[MaxGauges] = {};
};

/// The same in another precision or capacity; the capacity must hold it.
template <class Real, std::size_t MaxGauges, class FromReal, std::size_t FromMaxGauges>
[[nodiscard]] constexpr ConsistencyCheck<Real, MaxGauges> converted(
    const ConsistencyCheck<FromReal, FromMaxGauges>& from) {
  ConsistencyCheck<Real, MaxGauges> to;
  to.samples = from.samples;
  to.direction_count = from.direction_count;
  to.harmonic_count = from.harmonic_count;
  to.wave_factor = from.wave_factor;
  to.delay_samples = static_cast<Real>(from.delay_samples);
  to.limit_V = static_cast<Real>(from.limit_V);
  to.limit_per_V = static_cast<Real>(from.limit_per_V);
  constexpr std::size_t shared = MaxGauges < FromMaxGauges ? MaxGauges : FromMaxGauges;
  for (std::size_t j = 0; j < shared; ++j) {
    for (std::size_t d = 0; d < most_signal_directions; ++d) {
      to.directions[d][j] = static_cast<Real>(from.directions[d][j]);
    }
    for (std::size_t i = 0; i < most_watched_harmonics; ++i) {
      to.wave_V[j][i] = {static_cast<Real>(from.wave_V[j][i].cosine),
                         static_cast<Real>(from.wave_V[j][i].sine)};
    }
    to.zero_V[j] = static_cast<Real>(from.zero_V[j]);
  }
  return to;
}

template <class Real, std::size_t MaxGauges, class FromReal, std::size_t FromMaxGauges>
[[nodiscard]] constexpr GaugeMonitorConfig<Real, MaxGauges> converted(
    const GaugeMonitorConfig<FromReal, FromMaxGauges>& from) {
  GaugeMonitorConfig<Real, MaxGauges> to;
  to.active = from.active;
  to.rail_samples = from.rail_samples;
  to.lowest_V = static_cast<Real>(from.lowest_V);
  to.highest_V = static_cast<Real>(from.highest_V);
  to.torn_gauge_rail = from.torn_gauge_rail;
  to.overload_V = static_cast<Real>(from.overload_V);
  to.stuck_samples = from.stuck_samples;
  to.flat_travel_turns = static_cast<Real>(from.flat_travel_turns);
  to.flat_band_V = static_cast<Real>(from.flat_band_V);
  to.amplifier_zero_V = static_cast<Real>(from.amplifier_zero_V);
  to.short_band_V = static_cast<Real>(from.short_band_V);
  to.consistency = converted<Real, MaxGauges>(from.consistency);
  to.residual_fluctuation_V = static_cast<Real>(from.residual_fluctuation_V);
  constexpr std::size_t shared = MaxGauges < FromMaxGauges ? MaxGauges : FromMaxGauges;
  for (std::size_t j = 0; j < shared; ++j) {
    to.without[j] = {from.without[j].available, converted<Real, MaxGauges>(from.without[j].gains),
                     static_cast<Real>(from.without[j].zero_shift_V),
                     static_cast<Real>(from.without[j].residual_fluctuation_V)};
  }
  return to;
}

namespace detail {

/// Whether the directions are of unit length and at right angles to each other.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr bool are_orthonormal(const ConsistencyCheck<Real, MaxGauges>& parity,
                                             std::size_t gauge_count) {
  for (std::size_t d = 0; d < parity.direction_count; ++d) {
    for (std::size_t e = 0; e <= d; ++e) {
      Real product = d == e ? Real(-1) : Real(0);
      for (std::size_t j = 0; j < MaxGauges && j < gauge_count; ++j) {
        product += parity.directions[d][j] * parity.directions[e][j];
      }
      if (!(absolute(product) <= Real(1e-4F))) {
        return false;
      }
    }
  }
  return true;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Violation<Real> check_consistency(
    const ConsistencyCheck<Real, MaxGauges>& parity, std::size_t gauge_count) {
  if (parity.samples == 0) {
    return {};
  }
  if (parity.samples > most_watched_samples) {
    return {"consistency_samples", -1, static_cast<Real>(parity.samples), "samples",
            "at most 60000"};
  }
  if (parity.direction_count < 1 || parity.direction_count > most_signal_directions ||
      parity.direction_count + 2 > gauge_count) {
    return {"signal_directions", -1, static_cast<Real>(parity.direction_count), "directions",
            "1 to 9, and at least two fewer than gauges: one less cannot tell which gauge it is"};
  }
  if (!are_orthonormal(parity, gauge_count)) {
    return {"signal_directions", -1, static_cast<Real>(parity.direction_count), "directions",
            "directions of unit length at right angles to each other"};
  }
  if (parity.harmonic_count > most_watched_harmonics) {
    return {"fluctuation_V", -1, static_cast<Real>(parity.harmonic_count), "harmonics",
            "at most 4"};
  }
  if (!is_valid(parity.wave_factor)) {
    return {"wave_factor", -1, Real(0), "wave turns per motor turn",
            "a ratio of whole numbers from 1 to 2^31 - 1"};
  }
  for (std::size_t j = 0; j < MaxGauges && j < gauge_count; ++j) {
    if (parity.directions[0][j] == Real(0)) {
      return {"signal_directions", static_cast<std::int32_t>(j), Real(0), "",
              "a direction of torque, the first, in which every gauge takes part"};
    }
    for (std::size_t i = 0; i < parity.harmonic_count; ++i) {
      if (!(absolute(parity.wave_V[j][i].cosine) <= Real(1e6F)) ||
          !(absolute(parity.wave_V[j][i].sine) <= Real(1e6F))) {
        return {"fluctuation_V", static_cast<std::int32_t>(j), parity.wave_V[j][i].cosine, "V",
                "numbers within +-1e6"};
      }
    }
    if (!(absolute(parity.zero_V[j]) <= Real(1e6F))) {
      return {"gauge_zero_V", static_cast<std::int32_t>(j), parity.zero_V[j], "V",
              "a number within +-1e6"};
    }
  }
  if (!(absolute(parity.delay_samples) <= Real(1e4F))) {
    return {"delay_samples", -1, parity.delay_samples, "samples", "a number within +-10000"};
  }
  if (!(parity.limit_V > Real(0)) || parity.limit_V > Real(1e6F)) {
    return {"consistency_limit_V", -1, parity.limit_V, "V", "a number above 0, at most 1e6"};
  }
  if (!(parity.limit_per_V >= Real(0)) || parity.limit_per_V > Real(1e3F)) {
    return {"consistency_limit_per_V", -1, parity.limit_per_V, "V/V", "a number from 0 to 1000"};
  }
  return {};
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Violation<Real> check_gains_without(
    const GaugeMonitorConfig<Real, MaxGauges>& config, std::size_t gauge_count) {
  for (std::size_t j = 0; j < MaxGauges && j < gauge_count; ++j) {
    const GainsWithoutGauge<Real, MaxGauges>& set = config.without[j];
    const auto index = static_cast<std::int32_t>(j);
    if (!set.available) {
      continue;
    }
    if (set.gains.count != gauge_count || !check(set.gains).ok()) {
      return {"gains_without", index, static_cast<Real>(set.gains.count), "gains",
              "a finite gain for every gauge, not all 0"};
    }
    if (set.gains.values[j] != Real(0)) {
      return {"gains_without", index, set.gains.values[j], "", "0 for the gauge that is lost"};
    }
    if (!(absolute(set.zero_shift_V) <= Real(1e6F))) {
      return {"zero_shift_V", index, set.zero_shift_V, "V", "a number within +-1e6"};
    }
    if (!(set.residual_fluctuation_V >= Real(0)) || set.residual_fluctuation_V > Real(1e6F)) {
      return {"residual_fluctuation_V", index, set.residual_fluctuation_V, "V",
              "a number from 0 to 1e6"};
    }
  }
  return {};
}

}  // namespace detail

/// What is wrong with the configuration for so many gauges; nothing where it is inactive.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Violation<Real> check(const GaugeMonitorConfig<Real, MaxGauges>& config,
                                              std::size_t gauge_count) {
  if (!config.active) {
    return {};
  }
  if (config.rail_samples > most_watched_samples) {
    return {"rail_samples", -1, static_cast<Real>(config.rail_samples), "samples", "at most 60000"};
  }
  if (config.stuck_samples > most_watched_samples || config.stuck_samples == 1) {
    return {"stuck_samples", -1, static_cast<Real>(config.stuck_samples), "samples",
            "0 for no check, or 2 to 60000"};
  }
  if (!is_finite(config.lowest_V)) {
    return {"lowest_V", -1, config.lowest_V, "V", "a finite number"};
  }
  if (!is_finite(config.highest_V) || !(config.highest_V > config.lowest_V)) {
    return {"highest_V", -1, config.highest_V, "V", "a finite number above lowest_V"};
  }
  if (!is_finite(config.overload_V) || !(config.overload_V > Real(0))) {
    return {"overload_V", -1, config.overload_V, "V", "a finite number above 0"};
  }
  if (!(config.flat_travel_turns >= Real(0)) || config.flat_travel_turns > Real(1e6F)) {
    return {"flat_travel_turns", -1, config.flat_travel_turns, "turns",
            "0 for no check, or a travel up to 1e6"};
  }
  if (!(config.flat_band_V >= Real(0)) || !is_finite(config.flat_band_V)) {
    return {"flat_band_V", -1, config.flat_band_V, "V", "a finite number of at least 0"};
  }
  if (!is_finite(config.amplifier_zero_V)) {
    return {"amplifier_zero_V", -1, config.amplifier_zero_V, "V", "a finite number"};
  }
  if (!(config.short_band_V >= Real(0)) || !is_finite(config.short_band_V)) {
    return {"short_band_V", -1, config.short_band_V, "V", "a finite number of at least 0"};
  }
  if (!(config.residual_fluctuation_V >= Real(0)) || config.residual_fluctuation_V > Real(1e6F)) {
    return {"residual_fluctuation_V", -1, config.residual_fluctuation_V, "V",
            "a number from 0 to 1e6"};
  }
  if (const auto violation = detail::check_consistency(config.consistency, gauge_count);
      !violation.ok()) {
    return violation;
  }
  return detail::check_gains_without(config, gauge_count);
}

}  // namespace strainwave
