// SPDX-License-Identifier: Apache-2.0
/// @file bind_oscillator_filter.hpp
/// The filter's configuration as Python holds it, shared with the sensor's.
#pragma once

#include "common.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace strainwave::bindings {

using OscillatorConfigD = OscillatorFilterConfig<double, most_orders>;

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
