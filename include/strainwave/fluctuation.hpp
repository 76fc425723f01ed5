// SPDX-License-Identifier: Apache-2.0
/// @file fluctuation.hpp
/// The signal fluctuation: what the turning wave adds to a gauge's signal.
///
/// The wave generator bends the flexspline into an ellipse that passes every gauge twice per turn
/// of the wave, so each gauge sees harmonics of twice the wave's angle.  One model holds for two
/// gauges at 90 degrees, four at 45 degrees and M anywhere: amplitude, phase error and position
/// are the gauge's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// Harmonic i of one gauge: amplitude a_ij (in any unit) and phase error psi_ij.
template <class Real>
struct FluctuationHarmonic {
  Real amplitude = Real(0);
  Real phase_error_rad = Real(0);
};

/// One gauge's fluctuation in up to MaxHarmonics harmonics.
template <class Real, std::size_t MaxHarmonics>
struct GaugeFluctuation {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxHarmonics > 0, "strainwave: MaxHarmonics must be at least 1");

  std::size_t harmonic_count = 1;
  FluctuationHarmonic<Real> harmonics[MaxHarmonics] = {};
  /// Position of the gauge on the flexspline.  It counts against the wave-generator angle: gauge j
  /// of M equally spaced ones stands at pi (j-1)/M and leads by 2 i pi (j-1)/M in harmonic i.
  Real position_rad = Real(0);
  Rational wave_factor = {1, 1};  ///< factor m of the gear configuration, see gear.hpp
};

/// Position of gauge j = 1..count among equally spaced ones over half a turn, rad.
template <class Real>
[[nodiscard]] constexpr Real equally_spaced_position_rad(std::size_t gauge, std::size_t count) {
  return pi<Real> * static_cast<Real>(gauge - 1) / static_cast<Real>(count);
}

/// e_j = sum_i a_ij sin(2 i (m beta + position) + psi_ij).
///
/// Godler 2000, eq. (6), with factor m at beta only: as printed, m multiplies the gauge's position
/// too, which leaves 0.072 a of ideal gauges uncancelled at R = 50.  Eq. (3) is this with one
/// harmonic and two gauges at 0 and pi/2, eq. (4) with two harmonics, eq. (5) with four gauges;
/// Taghirad & Belanger 1999, eq. (2) and (3), are its first harmonic at 0 and pi/2.
template <class Real, std::size_t MaxHarmonics>
[[nodiscard]] constexpr Real signal_fluctuation(const GaugeFluctuation<Real, MaxHarmonics>& gauge,
                                                Phase wave_generator) {
  const std::uint32_t wave = order_fraction(wave_generator, gauge.wave_factor);
  const std::uint32_t position = phase_from_radians(gauge.position_rad).fraction;
  Real sum = Real(0);
  for (std::size_t i = 0; i < gauge.harmonic_count && i < MaxHarmonics; ++i) {
    const FluctuationHarmonic<Real>& harmonic = gauge.harmonics[i];
    const auto order = static_cast<std::uint32_t>(2 * (i + 1));
    const std::uint32_t error = phase_from_radians(harmonic.phase_error_rad).fraction;
    sum += harmonic.amplitude * cos_sin_of_fraction<Real>(order * (wave + position) + error).sine;
  }
  return sum;
}

/// The same sum split into what multiplies sin(2 i m beta) and cos(2 i m beta), which is what
/// gains can cancel.  Godler 2000, eq. (8): a cos(2 i position + psi), a sin(2 i position + psi).
template <class Real, std::size_t MaxHarmonics>
[[nodiscard]] constexpr CosSin<Real> fluctuation_phasor(
    const GaugeFluctuation<Real, MaxHarmonics>& gauge, std::size_t harmonic_index) {
  const FluctuationHarmonic<Real>& harmonic = gauge.harmonics[harmonic_index];
  const auto order = static_cast<std::uint32_t>(2 * (harmonic_index + 1));
  const std::uint32_t angle = order * phase_from_radians(gauge.position_rad).fraction +
                              phase_from_radians(harmonic.phase_error_rad).fraction;
  const CosSin<Real> unit = cos_sin_of_fraction<Real>(angle);
  return {harmonic.amplitude * unit.cosine, harmonic.amplitude * unit.sine};
}

template <class Real, std::size_t MaxHarmonics>
[[nodiscard]] constexpr Violation<Real> check(const GaugeFluctuation<Real, MaxHarmonics>& gauge) {
  if (gauge.harmonic_count < 1 || gauge.harmonic_count > MaxHarmonics) {
    return {"harmonic_count", -1, static_cast<Real>(gauge.harmonic_count), "harmonics",
            "at least one, and no more than the compiled capacity"};
  }
  for (std::size_t i = 0; i < gauge.harmonic_count; ++i) {
    if (!is_finite(gauge.harmonics[i].amplitude)) {
      return {"amplitudes", static_cast<std::int32_t>(i), gauge.harmonics[i].amplitude, "",
              "a finite number"};
    }
    if (!is_representable_angle(gauge.harmonics[i].phase_error_rad)) {
      return {"phase_errors_rad", static_cast<std::int32_t>(i), gauge.harmonics[i].phase_error_rad,
              "rad", "a finite angle within +-6.9e12"};
    }
  }
  if (!is_representable_angle(gauge.position_rad)) {
    return {"position_rad", -1, gauge.position_rad, "rad", "a finite angle within +-6.9e12"};
  }
  if (!is_valid(gauge.wave_factor)) {
    return {"wave_factor", -1, Real(0), "wave turns per motor turn",
            "a ratio of whole numbers from 1 to 2^31 - 1"};
  }
  return {};
}

}  // namespace strainwave
