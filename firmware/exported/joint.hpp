// SPDX-License-Identifier: Apache-2.0
/// @file joint.hpp
/// The joint of the complete image, as `strainwave export` wrote it for firmware/joint.toml.
#pragma once

#include "elbow.hpp"

namespace joint {

namespace exported = strainwave::joints::elbow;

using SensorConfig = exported::Config;
using SensorState = exported::State;
using Sample = exported::Sample;

inline constexpr std::size_t gauge_count = exported::gauge_capacity;
inline constexpr std::size_t pairs = exported::pair_capacity;
inline constexpr const SensorConfig& sensor = exported::config;
inline constexpr auto sample_rate_Hz =
    static_cast<std::uint32_t>(1.0F / sensor.sample_period_s + 0.5F);
inline constexpr std::uint32_t counts_per_turn = 16384;

// What the simulated gauges read is what the joint file says of the real ones.
inline constexpr float torque_Nm_per_V =
    sensor.calibration.gain_Nm_per_V * static_cast<float>(gauge_count);
inline constexpr float wave_V = sensor.monitor.consistency.wave_V[0][0].cosine;
static_assert(wave_V > 0.0F && sensor.monitor.consistency.wave_V[0][0].sine == 0.0F,
              "strainwave: the simulated gauges' first signal begins with a rising zero");

/// The misalignment's share of the torque measured, for the simulated gauges.
constexpr float misalignment_Nm(strainwave::Phase motor) {
  return strainwave::detail::frozen_torque_Nm(sensor.filter, motor);
}

}  // namespace joint
