// SPDX-License-Identifier: Apache-2.0
/// @file gear.hpp
/// The strain wave gear: which part is fixed, its ratio, its factor m, its rated torque.
///
/// A ratio here is a magnitude, motor turns per output turn; the direction of the output is a
/// field of its own.  Factor m says how often the wave passes a gauge on the flexspline: 2 m times
/// per motor turn.
#pragma once

#include <cstdint>

#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

enum class GearConfiguration : std::uint8_t {
  fixed_circular_spline,  ///< the flexspline is the output and turns against the motor
  fixed_flexspline,       ///< the circular spline is the output and turns with the motor
};

template <class Real>
struct GearConfig {
  GearConfiguration configuration = GearConfiguration::fixed_circular_spline;
  Rational ratio = {100, 1};           ///< motor turns per output turn, a magnitude
  std::int32_t output_direction = -1;  ///< +1: output turns with the motor, -1: against it
  Real rated_torque_Nm = Real(40);     ///< full scale (FS) of every figure in %FS
};

/// Nominal ratio R = z_f / (z_c - z_f) of the tooth counts.  Godler 2000, eq. (1).
/// {0, 0}, which is_valid() refuses, where the circular spline has not the larger count.
[[nodiscard]] constexpr Rational nominal_ratio(std::uint32_t flexspline_teeth,
                                               std::uint32_t circular_spline_teeth) {
  if (circular_spline_teeth <= flexspline_teeth) {
    return {0, 0};
  }
  return reduced(flexspline_teeth, circular_spline_teeth - flexspline_teeth);
}

/// Ratio of a configuration with its sign: R_c = -R with the circular spline fixed, R_f = R + 1
/// with the flexspline fixed.  Godler 2000, eq. (2).
template <class Real>
[[nodiscard]] constexpr Real signed_reduction_ratio(GearConfiguration configuration,
                                                    Rational nominal) {
  const Real ratio = to_real<Real>(nominal);
  return configuration == GearConfiguration::fixed_circular_spline ? -ratio : ratio + Real(1);
}

/// A gear from its tooth counts: magnitude and direction of Godler 2000, eq. (2).
template <class Real>
[[nodiscard]] constexpr GearConfig<Real> gear_from_teeth(GearConfiguration configuration,
                                                         std::uint32_t flexspline_teeth,
                                                         std::uint32_t circular_spline_teeth,
                                                         Real rated_torque_Nm) {
  const Rational nominal = nominal_ratio(flexspline_teeth, circular_spline_teeth);
  if (configuration == GearConfiguration::fixed_circular_spline) {
    return {configuration, nominal, -1, rated_torque_Nm};
  }
  return {configuration,
          reduced(std::uint64_t{nominal.numerator} + nominal.denominator, nominal.denominator), 1,
          rated_torque_Nm};
}

/// Factor m: turns of the wave against the flexspline per motor turn.  1 with the flexspline
/// fixed; (R + 1)/R with the circular spline fixed, where the flexspline turns against the wave
/// generator.  Godler 2000 prints (R_c + 1)/R_c, which is this only if R_c is taken positive; with
/// the paper's own sign R_c = -R it would be (R - 1)/R.
template <class Real>
[[nodiscard]] constexpr Rational wave_factor(const GearConfig<Real>& gear) {
  if (gear.configuration == GearConfiguration::fixed_flexspline) {
    return {1, 1};
  }
  return reduced(std::uint64_t{gear.ratio.numerator} + gear.ratio.denominator,
                 gear.ratio.numerator);
}

/// Order of the misalignment torque: once per output turn, 1/ratio cycles per motor turn.
template <class Real>
[[nodiscard]] constexpr Order misalignment_order(const GearConfig<Real>& gear) {
  return inverse(gear.ratio);
}

template <class Real>
[[nodiscard]] constexpr Violation<Real> check(const GearConfig<Real>& gear) {
  if (!is_valid(gear.ratio) || gear.ratio.numerator < gear.ratio.denominator) {
    return {"ratio", -1, is_valid(gear.ratio) ? to_real<Real>(gear.ratio) : Real(0),
            "motor turns per output turn", "a magnitude of at least 1"};
  }
  if (!is_valid(wave_factor(gear))) {
    return {"ratio", -1, to_real<Real>(gear.ratio), "motor turns per output turn",
            "a ratio whose numerator and denominator add up to less than 2^31"};
  }
  if (gear.output_direction != 1 && gear.output_direction != -1) {
    return {"output_direction", -1, static_cast<Real>(gear.output_direction), "", "+1 or -1"};
  }
  if (!is_finite(gear.rated_torque_Nm) || gear.rated_torque_Nm <= Real(0)) {
    return {"rated_torque_Nm", -1, gear.rated_torque_Nm, "Nm", "a finite number above 0"};
  }
  return {};
}

}  // namespace strainwave
