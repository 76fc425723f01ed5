// SPDX-License-Identifier: Apache-2.0
/// @file log_signals.hpp
/// What each filter reads of a log, as the core's batches take it.
#pragma once

#include <cstddef>
#include <vector>

#include "filters.hpp"
#include "long_signals.hpp"
#include "strainwave/batch_oscillator.hpp"
#include "strainwave/batch_ripple.hpp"

namespace speed {

/// The published filter's: torque and speed.
struct PublishedSignals {
  static constexpr const auto& config = published<float>;

  std::vector<float> torque_Nm;
  std::vector<float> motor_speed_rad_s;

  /// The recording repeated up to a length, from a sample of it on.
  void prepare(const Recording& recording, std::size_t samples, std::size_t from) {
    repeat(recording.torque_Nm, samples, torque_Nm, from);
    repeat(recording.motor_speed_rad_s, samples, motor_speed_rad_s, from);
  }
  [[nodiscard]] strainwave::OscillatorChannel<float> channel(std::vector<float>& ripple_Nm) const {
    strainwave::OscillatorChannel<float> channel;
    channel.sample_count = ripple_Nm.size();
    channel.measured_torque_Nm = torque_Nm.data();
    channel.motor_speed_rad_s = motor_speed_rad_s.data();
    channel.ripple_Nm = ripple_Nm.data();
    return channel;
  }
};

/// The default filter's: torque and angle.
struct DefaultSignals {
  static constexpr const auto& config = default_15<float>;

  std::vector<float> torque_Nm;
  std::vector<double> motor_angle_rad;

  void prepare(const Recording& recording, std::size_t samples, std::size_t from) {
    repeat(recording.torque_Nm, samples, torque_Nm, from);
    repeat(recording.motor_angle_rad, samples, motor_angle_rad, from);
  }
  [[nodiscard]] strainwave::RippleChannel<float> channel(std::vector<float>& ripple_Nm) const {
    strainwave::RippleChannel<float> channel;
    channel.sample_count = ripple_Nm.size();
    channel.measured_torque_Nm = torque_Nm.data();
    channel.motor_angle_rad = motor_angle_rad.data();
    channel.sample_period_s = static_cast<float>(sample_period_s);
    channel.output(strainwave::RippleOutput::ripple) = ripple_Nm.data();
    return channel;
  }
};

}  // namespace speed
