// SPDX-License-Identifier: Apache-2.0
/// @file joint.hpp
/// The joint whose cost is measured: four gauges, three orders, load and speed terms, misalignment.
///
/// By hand, so that it has what the budget says and no more; the complete image's joint is
/// exported.
#pragma once

#include "strainwave/torque_sensor.hpp"

namespace joint {

inline constexpr std::size_t gauge_count = 4;
/// Orders 2, 4 and 6; the first of them grows with load and speed.  All of the capacity is in use,
/// so that the compiler can write out the filter's loops.
inline constexpr std::size_t pairs = 5;
inline constexpr std::uint32_t sample_rate_Hz = 8000;
inline constexpr std::uint32_t counts_per_turn = 16384;
/// Amplitude of the wave's first harmonic at a gauge, V.  Gauge j stands at (j - 1) 45 degrees, so
/// that its signal is a quarter of a cycle ahead of the gauge before.
inline constexpr float wave_V = 1.5F;
inline constexpr float torque_Nm_per_V = 10.0F;  ///< of one gauge

/// Once per output turn, from a commissioning run.
inline constexpr strainwave::FrozenTerm<float> misalignment = {{1, 100}, 0.3F, 0.2F};

using SensorConfig = strainwave::RippleSensorConfig<float, gauge_count, pairs>;
using SensorState = strainwave::RippleSensorState<float, gauge_count, pairs>;
using Sample = strainwave::TorqueSensorSample<gauge_count, float>;

/// The watch: gauges without noise in their converter's last bits would be stuck, so that the check
/// for repeated codes is off.
constexpr strainwave::GaugeMonitorConfig<float, gauge_count> monitor() {
  strainwave::GaugeMonitorConfig<float, gauge_count> watch;
  watch.active = true;
  watch.rail_samples = 8;
  watch.torn_gauge_rail = strainwave::TornGaugeRail::upper;
  watch.overload_V = 7.0F;
  watch.flat_travel_turns = 0.5F;
  watch.flat_band_V = 0.01F;
  watch.short_band_V = 0.01F;
  watch.consistency.samples = 80;  // 10 ms
  watch.consistency.harmonic_count = 1;
  watch.consistency.limit_V = 0.1F;
  watch.consistency.limit_per_V = 0.02F;
  for (std::size_t j = 0; j < gauge_count; ++j) {
    const bool upright = j % 2 == 0;
    const float sign = j < 2 ? 1.0F : -1.0F;
    watch.consistency.directions[0][j] = 0.5F;
    watch.consistency.wave_V[j][0] = {upright ? sign * wave_V : 0.0F,
                                      upright ? 0.0F : sign * wave_V};
    // Of two gauges half a cycle apart, either replaces what the other pair gave.
    watch.without[j].available = true;
    watch.without[j].gains.count = gauge_count;
    for (std::size_t i = 0; i < gauge_count; ++i) {
      watch.without[j].gains.values[i] = (i + j) % 2 == 1 ? 2.0F : 0.0F;
    }
    watch.without[j].residual_fluctuation_V = 0.02F;
  }
  return watch;
}

constexpr SensorConfig made_up_sensor() {
  SensorConfig config;
  config.converter = {16, -10.0F, 10.0F, -32768};
  config.gains.count = gauge_count;
  for (float& each : config.gains.values) {
    each = 1.0F;
  }
  config.calibration.gain_Nm_per_V = torque_Nm_per_V / static_cast<float>(gauge_count);
  config.calibration.linearisation[1] = 0.01F;
  config.calibration.zero_drift_V_per_K = 1e-4F;
  config.calibration.gain_drift_per_K = 2e-4F;
  config.filter.order_count = 3;
  for (std::uint32_t a = 0; a < 3; ++a) {
    config.filter.orders[a].order = {2 * (a + 1), 1};
  }
  config.filter.orders[0].with_load = true;
  config.filter.orders[0].with_speed = true;
  config.filter.frozen_count = 1;
  config.filter.frozen[0] = misalignment;
  config.sample_period_s = 1.0F / static_cast<float>(sample_rate_Hz);
  config.monitor = monitor();
  return config;
}

inline constexpr SensorConfig sensor = made_up_sensor();
static_assert(check(sensor).ok(), "strainwave: the joint's configuration is wrong");

/// The misalignment's share of the torque measured, for the simulated gauges.
constexpr float misalignment_Nm(strainwave::Phase motor) {
  return strainwave::detail::frozen_torque_Nm(sensor.filter, motor);
}

}  // namespace joint
