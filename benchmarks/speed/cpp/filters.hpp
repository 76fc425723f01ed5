// SPDX-License-Identifier: Apache-2.0
/// @file filters.hpp
/// Both filters as every case runs them.
#pragma once

#include <cstddef>
#include <vector>

#include "case.hpp"
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
  config.memory_turns = Real(300);  // three turns of the output, so that order 1/100 is seen
  config.order_count = 3;
  config.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
  config.orders[1] = {.order = {4, 1}, .with_load = true, .with_speed = true};
  config.orders[2] = {.order = {1, 100}};
  return config;
}
template <class Real>
inline constexpr strainwave::RippleFilterConfig<Real, 7> default_15 = default_configuration<Real>();

/// Angles as an encoder delivers them.
inline std::vector<strainwave::Phase> phases(const Recording& recording) {
  std::vector<strainwave::Phase> phases;
  for (const double angle_rad : recording.motor_angle_rad) {
    phases.push_back(strainwave::phase_from_radians(angle_rad));
  }
  return phases;
}

/// The published filter over arrays, sample by sample, as a control loop calls it.
template <class Config, class Real>
void filter_published(const Config& config, const Real* torque_Nm, const Real* speed_rad_s,
                      std::size_t samples, Real* ripple_Nm) {
  auto state = strainwave::initial_state(config);
  for (std::size_t k = 0; k < samples; ++k) {
    strainwave::OscillatorSample<Real> sample;
    sample.measured_torque_Nm = torque_Nm[k];
    sample.motor_speed_rad_s = speed_rad_s[k];
    ripple_Nm[k] = strainwave::step(config, state, sample).ripple_Nm;
  }
}

/// The default filter, likewise.
template <class Config, class Real>
void filter_default(const Config& config, const Real* torque_Nm, const strainwave::Phase* phases,
                    std::size_t samples, Real* ripple_Nm) {
  auto state = strainwave::initial_state(config);
  for (std::size_t k = 0; k < samples; ++k) {
    strainwave::RippleSample<Real> sample;
    sample.measured_torque_Nm = torque_Nm[k];
    sample.motor_phase = phases[k];
    sample.interval_s = static_cast<Real>(sample_period_s);
    ripple_Nm[k] = strainwave::step(config, state, sample).ripple_Nm;
  }
}

/// A case of one channel with the published filter.  `config_of()` returns the configuration: a
/// constant known to the compiler, or one that is not.
template <class Real, class ConfigOf>
Case published_case(const Recording& recording, const ConfigOf& config_of) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [config_of, torque = converted<Real>(recording.torque_Nm),
       speed = converted<Real>(recording.motor_speed_rad_s)](std::size_t samples, Real* ripple_Nm) {
        filter_published(config_of(), torque.data(), speed.data(), samples, ripple_Nm);
      });
}

/// A case of one channel with the default filter.
template <class Real, class ConfigOf>
Case default_case(const Recording& recording, const ConfigOf& config_of) {
  return single_channel(std::vector<Real>(recording.samples()),
                        [config_of, torque = converted<Real>(recording.torque_Nm),
                         angle = phases(recording)](std::size_t samples, Real* ripple_Nm) {
                          filter_default(config_of(), torque.data(), angle.data(), samples,
                                         ripple_Nm);
                        });
}

}  // namespace speed
