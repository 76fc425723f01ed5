// SPDX-License-Identifier: Apache-2.0
/// @file bridge.hpp
/// From strain in the flexspline to converter codes: rosettes, Wheatstone bridge, amplifier,
/// converter.
///
/// A rosette is a pair of gauges at +45 and -45 degrees on one pad: torque stretches one and
/// compresses the other, so that their difference carries the torque.  The bridge adds such
/// differences, the amplifier lifts millivolts to volts, the converter makes codes of them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// Where and how one rosette is bonded.
template <class Real>
struct Rosette {
  /// Position around the flexspline, rad; counts against the wave-generator angle, see
  /// fluctuation.hpp.
  Real position_rad = Real(0);
  Real radius_m = Real(0.015);
  /// Turn of the pad out of its +-45 degrees, rad.
  Real orientation_error_rad = Real(0);
  Real gauge_factor = Real(2);
};

/// Strain of the flexspline's surface at a rosette, in polar directions; shear is the engineering
/// shear strain.
template <class Real>
struct SurfaceStrain {
  Real radial = Real(0);
  Real circumferential = Real(0);
  Real shear = Real(0);
};

/// Strains along the two gauges of one rosette, epsilon_1 (stretched by positive torque) and
/// epsilon_2.
template <class Real>
struct RosetteStrain {
  Real first = Real(0);
  Real second = Real(0);
};

/// Strains along a rosette's gauges.  Taghirad & Belanger 1999, eq. (1): epsilon_w + epsilon_t and
/// epsilon_w - epsilon_t, with epsilon_t half the shear strain and epsilon_w the mean normal
/// strain.  Strain transformation to +-45 degrees plus the orientation error, which swaps some of
/// the shear for normal strain: an error of the pad's angle lets the wave into the difference.
template <class Real>
[[nodiscard]] constexpr RosetteStrain<Real> rosette_strain(const Rosette<Real>& rosette,
                                                           const SurfaceStrain<Real>& strain) {
  const CosSin<Real> turn = cos_sin_of_radians(Real(2) * rosette.orientation_error_rad);
  const Real mean = (strain.radial + strain.circumferential) / Real(2);
  const Real half_difference =
      (strain.shear * turn.cosine - (strain.radial - strain.circumferential) * turn.sine) / Real(2);
  return {mean + half_difference, mean - half_difference};
}

/// epsilon_1 - epsilon_2 = 2 epsilon_t plus the wave's modulation.  Taghirad & Belanger 1999,
/// eq. (2) and (3).  With the epsilon_w of eq. (1) equal on both gauges, as printed, nothing would
/// be left to modulate; what does is the wave's own shear strain and the orientation error.
template <class Real>
[[nodiscard]] constexpr Real rosette_difference(const RosetteStrain<Real>& strain) {
  return strain.first - strain.second;
}

enum class BridgeWiring : std::uint8_t {
  half_bridge_each,  ///< every rosette in a half bridge with a channel of its own
  full_bridge,       ///< all rosettes share the arms of one full bridge
};

/// Output of one rosette in a half bridge, V: K/4 (epsilon_1 - epsilon_2) E_sup.
template <class Real>
[[nodiscard]] constexpr Real half_bridge_V(Real gauge_factor, const RosetteStrain<Real>& strain,
                                           Real supply_V) {
  return gauge_factor / Real(4) * rosette_difference(strain) * supply_V;
}

/// Output of a full bridge, V: K/4 (epsilon_1 + epsilon_3 - epsilon_2 - epsilon_4) E_sup for two
/// rosettes.  Taghirad & Belanger 1999, eq. (4).  With more rosettes each arm holds several gauges
/// in series and the bridge answers to their mean.  Linear in strain, as printed; the exact bridge
/// differs by K epsilon relative, 0.06 % at 300 microstrain.
template <class Real>
[[nodiscard]] constexpr Real full_bridge_V(const Rosette<Real>* rosettes,
                                           const RosetteStrain<Real>* strains, std::size_t count,
                                           Real supply_V) {
  Real sum = Real(0);
  for (std::size_t j = 0; j < count; ++j) {
    sum += rosettes[j].gauge_factor * rosette_difference(strains[j]);
  }
  return sum * supply_V / (Real(2) * static_cast<Real>(count));
}

/// Instrumentation amplifier with an output that ends at its rails.
template <class Real>
struct Amplifier {
  Real gain = Real(1000);
  Real offset_V = Real(0);  ///< at the output
  Real rail_V = Real(10);   ///< the output stays within +-rail_V
};

template <class Real>
[[nodiscard]] constexpr Real amplified_V(const Amplifier<Real>& amplifier, Real input_V) {
  const Real output_V = amplifier.gain * input_V + amplifier.offset_V;
  if (output_V > amplifier.rail_V) {
    return amplifier.rail_V;
  }
  return output_V < -amplifier.rail_V ? -amplifier.rail_V : output_V;
}

/// What a converter delivers: a whole number that means nothing without its Converter.
struct ConverterCode {
  std::int32_t value = 0;

  [[nodiscard]] constexpr bool operator==(const ConverterCode&) const = default;
};

/// Analogue-to-digital converter: 2^bits codes over [minimum_V, maximum_V).
template <class Real>
struct Converter {
  std::uint32_t bits = 16;
  Real minimum_V = Real(-10);
  Real maximum_V = Real(10);
  std::int32_t lowest_code = 0;  ///< 0 for straight binary, -2^(bits-1) for two's complement
};

template <class Real>
[[nodiscard]] constexpr Real step_V(const Converter<Real>& converter) {
  return (converter.maximum_V - converter.minimum_V) /
         static_cast<Real>(std::uint32_t{1} << converter.bits);
}

template <class Real>
[[nodiscard]] constexpr std::int32_t highest_code(const Converter<Real>& converter) {
  return converter.lowest_code +
         static_cast<std::int32_t>((std::uint32_t{1} << converter.bits) - 1U);
}

/// Nearest code; the ends of the range hold what lies beyond, and the lowest code what is not a
/// number.
template <class Real>
[[nodiscard]] constexpr ConverterCode to_code(const Converter<Real>& converter, Real input_V) {
  const Real steps = (input_V - converter.minimum_V) / step_V(converter) + Real(0.5);
  if (!(steps >= Real(1))) {
    return {converter.lowest_code};
  }
  const std::int32_t span = highest_code(converter) - converter.lowest_code;
  if (steps >= static_cast<Real>(span)) {
    return {converter.lowest_code + span};
  }
  return {converter.lowest_code + static_cast<std::int32_t>(steps)};
}

template <class Real>
[[nodiscard]] constexpr Real to_volts(const Converter<Real>& converter, ConverterCode code) {
  // What code 0 stands for does not change: a product and a sum are left for each code.
  const Real volts_of_0 =
      converter.minimum_V - static_cast<Real>(converter.lowest_code) * step_V(converter);
  return volts_of_0 + static_cast<Real>(code.value) * step_V(converter);
}

/// True at either end of the range, where the input may lie anywhere beyond, and outside it.
template <class Real>
[[nodiscard]] constexpr bool is_saturated(const Converter<Real>& converter, ConverterCode code) {
  return code.value <= converter.lowest_code || code.value >= highest_code(converter);
}

/// The same converter in another precision.
template <class Real, class FromReal>
[[nodiscard]] constexpr Converter<Real> converted(const Converter<FromReal>& from) {
  return {from.bits, static_cast<Real>(from.minimum_V), static_cast<Real>(from.maximum_V),
          from.lowest_code};
}

template <class Real>
[[nodiscard]] constexpr Violation<Real> check(const Rosette<Real>& rosette) {
  if (!is_finite(rosette.position_rad) || absolute(rosette.position_rad) > Real(1000)) {
    return {"position_rad", -1, rosette.position_rad, "rad", "a finite angle within +-1000"};
  }
  if (!is_finite(rosette.radius_m) || rosette.radius_m <= Real(0)) {
    return {"radius_m", -1, rosette.radius_m, "m", "a finite number above 0"};
  }
  if (!is_finite(rosette.orientation_error_rad) ||
      absolute(rosette.orientation_error_rad) > pi<Real>) {
    return {"orientation_error_rad", -1, rosette.orientation_error_rad, "rad",
            "a finite angle within +-pi"};
  }
  if (!is_finite(rosette.gauge_factor) || rosette.gauge_factor <= Real(0)) {
    return {"gauge_factor", -1, rosette.gauge_factor, "", "a finite number above 0"};
  }
  return {};
}

template <class Real>
[[nodiscard]] constexpr Violation<Real> check(const Amplifier<Real>& amplifier) {
  if (!is_finite(amplifier.gain) || !(amplifier.gain > Real(0))) {
    return {"gain", -1, amplifier.gain, "V/V", "a finite number above 0"};
  }
  if (!is_finite(amplifier.offset_V)) {
    return {"offset_V", -1, amplifier.offset_V, "V", "a finite number"};
  }
  if (!is_finite(amplifier.rail_V) || !(amplifier.rail_V > Real(0))) {
    return {"rail_V", -1, amplifier.rail_V, "V", "a finite number above 0"};
  }
  return {};
}

template <class Real>
[[nodiscard]] constexpr Violation<Real> check(const Converter<Real>& converter) {
  if (converter.bits < 1 || converter.bits > 24) {
    return {"bits", -1, static_cast<Real>(converter.bits), "", "1 to 24"};
  }
  if (!is_finite(converter.minimum_V)) {
    return {"minimum_V", -1, converter.minimum_V, "V", "a finite number"};
  }
  if (!is_finite(converter.maximum_V) || converter.maximum_V <= converter.minimum_V) {
    return {"maximum_V", -1, converter.maximum_V, "V", "a finite number above minimum_V"};
  }
  const std::int32_t twos_complement = -(std::int32_t{1} << (converter.bits - 1));
  if (converter.lowest_code != 0 && converter.lowest_code != twos_complement) {
    return {"lowest_code", -1, static_cast<Real>(converter.lowest_code), "",
            "0 (straight binary) or -2^(bits-1) (two's complement)"};
  }
  return {};
}

}  // namespace strainwave
