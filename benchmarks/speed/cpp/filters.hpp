// SPDX-License-Identifier: Apache-2.0
/// @file filters.hpp
/// Both filters as every case runs them.
#pragma once

#include <cstddef>
#include <vector>

#include "inputs.hpp"
#include "strainwave/oscillator_filter.hpp"
#include "strainwave/ripple_filter.hpp"

namespace speed {

inline constexpr strainwave::Rational ratio = {100, 1};

/// Section VI of the paper: orders 2, 4 and 1/100.
template <class Real>
inline constexpr strainwave::OscillatorFilterConfig<Real, 3> published =
    strainwave::taghirad1999<Real, 3>(ratio);

/// 15 states: load and speed terms for orders 2 and 4, and order 1/100.
template <class Real>
[[nodiscard]] constexpr strainwave::RippleFilterConfig<Real, 7> default_configuration() {
  strainwave::RippleFilterConfig<Real, 7> config;
  config.order_count = 3;
  config.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
  config.orders[1] = {.order = {4, 1}, .with_load = true, .with_speed = true};
  config.orders[2] = {.order = {1, 100}};
  return config;
}
template <class Real>
inline constexpr strainwave::RippleFilterConfig<Real, 7> default_15 =
    default_configuration<Real>();

/// Samples as the filters take them, made before anything is timed, as a driver delivers them.
template <class Real>
std::vector<strainwave::OscillatorSample<Real>> oscillator_samples(const Recording& recording) {
  std::vector<strainwave::OscillatorSample<Real>> samples(recording.samples());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].measured_torque_Nm = static_cast<Real>(recording.torque_Nm[k]);
    samples[k].motor_speed_rad_s = static_cast<Real>(recording.motor_speed_rad_s[k]);
  }
  return samples;
}
template <class Real>
std::vector<strainwave::RippleSample<Real>> ripple_samples(const Recording& recording) {
  std::vector<strainwave::RippleSample<Real>> samples(recording.samples());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].measured_torque_Nm = static_cast<Real>(recording.torque_Nm[k]);
    samples[k].motor_phase = strainwave::phase_from_radians(recording.motor_angle_rad[k]);
    samples[k].interval_s = static_cast<Real>(sample_period_s);
  }
  return samples;
}

}  // namespace speed
