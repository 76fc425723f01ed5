// SPDX-License-Identifier: Apache-2.0
/// @file gauge_consistency.hpp
/// The parity check of the gauges: what is left of their signals beside torque and wave, and which
/// gauge's error explains it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/bridge.hpp"
#include "strainwave/gauge_monitor_config.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// A sample of all gauges, as the chain has it.
template <class Real>
struct GaugeSignals {
  std::size_t count = 0;
  const ConverterCode* codes = nullptr;
  const Real* volts = nullptr;
  Phase motor_phase = {};
  bool phase_valid = true;
  bool phase_referenced = true;  ///< false: angle from an unknown zero, no prediction
  std::uint32_t missing = 0;     ///< samples that never arrived before this one
  /// Codes at an end of the converter's range; more than there are where nobody has counted.
  std::size_t at_end = std::size_t{256};
};

namespace detail {

/// Codes at an end of the range, that of one gauge apart; its number from 1, 0: of none.
template <class Real>
[[nodiscard]] constexpr std::size_t at_end_beside(const Converter<Real>& converter,
                                                  const GaugeSignals<Real>& signals,
                                                  std::uint8_t gauge) {
  const bool counted =
      signals.at_end > 0 && gauge != 0 && is_saturated(converter, signals.codes[gauge - 1U]);
  return signals.at_end - (counted ? 1U : 0U);
}

/// The phase that the gauges answer to, which are behind the angle by the delay.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Phase phase_of_gauges(const ConsistencyCheck<Real, MaxGauges>& parity,
                                              const GaugeSignals<Real>& signals,
                                              Real travel_turns) {
  if (parity.delay_samples == Real(0)) {
    return signals.motor_phase;
  }
  Real behind_turns = travel_turns * parity.delay_samples;
  if (signals.missing > 0) {
    behind_turns /= Real(1) + static_cast<Real>(signals.missing);
  }
  if (behind_turns == Real(0) || absolute(behind_turns) > Real(1e6F)) {
    return signals.motor_phase;
  }
  return signals.motor_phase - phase_from_turns(behind_turns);
}

/// The gauges' signals with what is known of them taken out: zeros, and the wave at its angle.
template <class Real, std::size_t MaxGauges>
constexpr void take_out_the_known(const ConsistencyCheck<Real, MaxGauges>& parity,
                                  const GaugeSignals<Real>& signals, Real travel_turns,
                                  Real* left_V) {
  for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
    left_V[j] = signals.volts[j] - parity.zero_V[j];
  }
  if (parity.harmonic_count == 0) {
    return;
  }
  const Phase phase = phase_of_gauges(parity, signals, travel_turns);
  // The second harmonic of the angle is the first one of the wave.
  const CosSin<Real> first =
      cos_sin_of_fraction<Real>(2U * order_fraction(phase, parity.wave_factor));
  CosSin<Real> wave = first;
  for (std::size_t i = 0; i < most_watched_harmonics && i < parity.harmonic_count; ++i) {
    for (std::size_t j = 0; j < MaxGauges && j < signals.count; ++j) {
      left_V[j] -= parity.wave_V[j][i].cosine * wave.sine + parity.wave_V[j][i].sine * wave.cosine;
    }
    wave = {wave.cosine * first.cosine - wave.sine * first.sine,
            wave.sine * first.cosine + wave.cosine * first.sine};
  }
}

/// What is left of the gauges' signals beside the directions of torque and wave.
template <class Real, std::size_t MaxGauges>
struct Parity {
  Real left_V[MaxGauges] = {};
  Real squared_V2 = Real(0);  ///< of all gauges
  Real torque_V = Real(0);    ///< length along the direction of the torque
};

template <class Real, std::size_t MaxGauges>
constexpr void take_out_directions(const ConsistencyCheck<Real, MaxGauges>& parity,
                                   std::size_t count, const Real* signal_V,
                                   Parity<Real, MaxGauges>& found) {
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    found.left_V[j] = signal_V[j];
  }
  for (std::size_t d = 0; d < most_signal_directions && d < parity.direction_count; ++d) {
    const Real* const direction = parity.directions[d];
    Real along_V = Real(0);
    for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
      along_V += direction[j] * signal_V[j];
    }
    for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
      found.left_V[j] -= direction[j] * along_V;
    }
    found.torque_V = d == 0 ? along_V : found.torque_V;
  }
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    found.squared_V2 += found.left_V[j] * found.left_V[j];
  }
}

/// What of a gauge's own error can be seen, squared: 0 to 1.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Real share_of(const ConsistencyCheck<Real, MaxGauges>& parity,
                                      std::size_t gauge) {
  Real share = Real(1);
  for (std::size_t d = 0; d < most_signal_directions && d < parity.direction_count; ++d) {
    share -= parity.directions[d][gauge] * parity.directions[d][gauge];
  }
  return share;
}

template <class Real, std::size_t MaxGauges>
constexpr void shares_of(const ConsistencyCheck<Real, MaxGauges>& parity, std::size_t count,
                         Real* shares) {
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    shares[j] = share_of(parity, j);
  }
}

/// Share of a gauge's error below which nothing can be told of it.
inline constexpr float least_share = 1e-3F;

/// What would be left without one gauge, whose share is known.
template <class Real>
struct Remainder {
  Real error_V = Real(0);  ///< of the gauge
  Real squared_V2 = Real(0);
  Real torque_V = Real(0);
};

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Remainder<Real> remainder_without(
    const ConsistencyCheck<Real, MaxGauges>& parity, std::size_t gauge,
    const Parity<Real, MaxGauges>& found, Real share) {
  if (!(share > static_cast<Real>(least_share))) {
    return {Real(0), found.squared_V2, found.torque_V};
  }
  const Real error_V = found.left_V[gauge] * (Real(1) / share);
  return {error_V, found.squared_V2 - found.left_V[gauge] * error_V,
          found.torque_V - parity.directions[0][gauge] * error_V};
}

/// Replaces a gauge by what the others say of it: nothing of its own error is left.
template <class Real, std::size_t MaxGauges>
constexpr void leave_out(const ConsistencyCheck<Real, MaxGauges>& parity, std::size_t count,
                         std::size_t gauge, const Remainder<Real>& remainder,
                         Parity<Real, MaxGauges>& found, Real* shares) {
  found.squared_V2 = remainder.squared_V2;
  found.torque_V = remainder.torque_V;
  if (!(shares[gauge] > static_cast<Real>(least_share))) {
    return;
  }
  const Real of_gauge = Real(1) / shares[gauge];
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    Real coupling = Real(0);
    for (std::size_t d = 0; d < most_signal_directions && d < parity.direction_count; ++d) {
      coupling -= parity.directions[d][j] * parity.directions[d][gauge];
    }
    found.left_V[j] -= coupling * remainder.error_V;
    shares[j] -= coupling * coupling * of_gauge;
  }
  found.left_V[gauge] = Real(0);
  shares[gauge] = Real(0);
}

/// The gauge whose error explains the most of what is left; count where there is none.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr std::size_t likeliest(const Parity<Real, MaxGauges>& found,
                                              const Real* shares, std::size_t count) {
  std::size_t best = count;
  Real best_square = Real(0);
  Real best_share = Real(1);
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    const Real square = found.left_V[j] * found.left_V[j];
    if (shares[j] > static_cast<Real>(least_share) &&
        square * best_share > best_square * shares[j]) {
      best = j;
      best_square = square;
      best_share = shares[j];
    }
  }
  return best;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Real squared_limit_V2(const ConsistencyCheck<Real, MaxGauges>& parity,
                                              Real torque_V) {
  const Real limit_V = parity.limit_V + parity.limit_per_V * absolute(torque_V);
  return limit_V * limit_V;
}

/// The gauge that disagrees with the others.
struct Disagreement {
  std::size_t gauge = 0;  ///< count of the gauges where none does
  bool several = false;   ///< no single gauge explains it: several, or the angle
};

/// Whether too much is left, and whether one gauge's error explains it.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Disagreement explained_by(const ConsistencyCheck<Real, MaxGauges>& parity,
                                                  std::size_t count, std::size_t gauge,
                                                  const Parity<Real, MaxGauges>& found,
                                                  Real share) {
  // The limit is that of the torque without the suspect: a fault must not widen its own limit.
  const Remainder<Real> remainder = remainder_without(parity, gauge, found, share);
  const Real limit_V2 = squared_limit_V2(parity, remainder.torque_V);
  if (!(found.squared_V2 > limit_V2)) {
    return {count, false};
  }
  if (remainder.squared_V2 > limit_V2) {
    return {count, true};
  }
  return {gauge, false};
}

/// The gauge that explains the most of what is left, where that is too much.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Disagreement disagreement_of(
    const ConsistencyCheck<Real, MaxGauges>& parity, std::size_t count,
    const Parity<Real, MaxGauges>& found, const Real* shares) {
  const std::size_t gauge = likeliest(found, shares, count);
  if (gauge == count) {
    return {count, found.squared_V2 > squared_limit_V2(parity, found.torque_V)};
  }
  return explained_by(parity, count, gauge, found, shares[gauge]);
}

/// Looks for the gauge that disagrees; `lost_gauge`, from 1, is one to do without, `suspect` one
/// whose own signal is wrong, count where there is none: that one is asked first.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Disagreement find_inconsistent(
    const ConsistencyCheck<Real, MaxGauges>& parity, std::uint8_t lost_gauge, std::size_t suspect,
    const GaugeSignals<Real>& signals, Real travel_turns) {
  Real signal_V[MaxGauges] = {};
  take_out_the_known(parity, signals, travel_turns, signal_V);
  Parity<Real, MaxGauges> found;
  take_out_directions(parity, signals.count, signal_V, found);
  // Without a gauge less is left, and torque only widens the limit: most samples end here.
  const Real least_limit_V2 = squared_limit_V2(parity, Real(0));
  if (!(found.squared_V2 > least_limit_V2)) {
    return {signals.count, false};
  }
  Real shares[MaxGauges];
  if (lost_gauge > 0) {
    const std::size_t lost = lost_gauge - 1U;
    const Remainder<Real> remainder =
        remainder_without(parity, lost, found, share_of(parity, lost));
    if (!(remainder.squared_V2 > least_limit_V2)) {
      return {signals.count, false};
    }
    shares_of(parity, signals.count, shares);
    leave_out(parity, signals.count, lost, remainder, found, shares);
    return disagreement_of(parity, signals.count, found, shares);
  }
  if (suspect < signals.count) {
    const Disagreement by_suspect =
        explained_by(parity, signals.count, suspect, found, share_of(parity, suspect));
    if (!by_suspect.several) {
      return by_suspect;
    }
  }
  shares_of(parity, signals.count, shares);
  return disagreement_of(parity, signals.count, found, shares);
}

}  // namespace detail

}  // namespace strainwave
