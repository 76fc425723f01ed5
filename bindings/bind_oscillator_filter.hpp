// SPDX-License-Identifier: Apache-2.0
/// @file bind_oscillator_filter.hpp
/// The filter's configuration as Python holds it, shared with the sensor's.
#pragma once

#include "common.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace strainwave::bindings {

using OscillatorConfigD = OscillatorFilterConfig<double, most_orders>;

/// Refuses a call without the array that the configuration turns by.
template <class Speed, class Angle>
void require_rotation(RotationSource source, const Speed& speed_rad_s, const Angle& angle_rad) {
  if (source == RotationSource::angle && !angle_rad) {
    raise_input_error("motor_angle_rad is missing: rotation_source is angle; give the array");
  }
  if (source == RotationSource::speed && !speed_rad_s) {
    raise_input_error("motor_speed_rad_s is missing: rotation_source is speed; give the array");
  }
}

/// Arrays of samples as the filter's step takes them; an absent one is null.
template <class Real>
struct RotationArrays {
  const Real* speed_rad_s = nullptr;
  const double* angle_rad = nullptr;  ///< always double: a float angle loses digits within hours

  /// Puts sample k's rotation into a sample of the filter or of the sensor.
  template <class Sample>
  void put(std::size_t k, Sample& sample) const {
    if (speed_rad_s != nullptr) {
      sample.motor_speed_rad_s = speed_rad_s[k];
    }
    sample.phase_valid = angle_rad != nullptr && is_representable_angle(angle_rad[k]);
    if (sample.phase_valid) {
      sample.motor_phase = phase_from_radians(angle_rad[k]);
    }
  }
};

}  // namespace strainwave::bindings
