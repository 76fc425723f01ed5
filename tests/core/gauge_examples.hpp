// Five gauges with a fluctuation, and a chain that watches over them: for the monitor's tests.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "strainwave/torque_sensor.hpp"

namespace gauge_examples {

using strainwave::GaugeFault;
using strainwave::TornGaugeRail;

inline constexpr std::size_t gauge_count = 5;
inline constexpr double amplitude_V = 1.7;
inline constexpr double pi = 3.14159265358979323846;
inline constexpr std::uint32_t detection_samples = 10;

/// Twice the position of gauge j of five equally spaced ones: its phase in the first harmonic.
inline double phase_rad(std::size_t j) { return 2 * pi * static_cast<double>(j) / 5; }

/// Five ideal gauges of 1 V at 10 Nm each, with a fluctuation of one harmonic.
template <class Real>
strainwave::RippleSensorConfig<Real, gauge_count, 3> five_gauges() {
  strainwave::RippleSensorConfig<Real, gauge_count, 3> config;
  config.converter = {16, Real(-10), Real(10), -32768};
  config.gains.count = gauge_count;
  config.calibration.gain_Nm_per_V = Real(2);
  auto& monitor = config.monitor;
  monitor.active = true;
  monitor.rail_samples = detection_samples;
  monitor.torn_gauge_rail = TornGaugeRail::upper;
  monitor.overload_V = Real(7);
  monitor.stuck_samples = 12;
  monitor.flat_travel_turns = Real(0.5);
  monitor.flat_band_V = Real(0.01);
  monitor.short_band_V = Real(0.01);
  auto& parity = monitor.consistency;
  parity.samples = detection_samples;
  parity.harmonic_count = 1;
  parity.limit_V = Real(0.05);
  parity.limit_per_V = Real(0.02);
  for (std::size_t j = 0; j < gauge_count; ++j) {
    config.gains.values[j] = Real(1);
    parity.directions[0][j] = static_cast<Real>(1 / std::sqrt(5.0));
    parity.wave_V[j][0] = {static_cast<Real>(amplitude_V * std::cos(phase_rad(j))),
                           static_cast<Real>(amplitude_V * std::sin(phase_rad(j)))};
    // Of all gains that cancel the first harmonic and have no weight at gauge j, the quietest.
    auto& without = monitor.without[j];
    without.available = true;
    without.gains.count = gauge_count;
    for (std::size_t i = 0; i < gauge_count; ++i) {
      without.gains.values[i] =
          static_cast<Real>(i == j ? 0.0 : 1 - std::cos(2 * (phase_rad(i) - phase_rad(j))));
    }
    without.residual_fluctuation_V = static_cast<Real>(0.01 * static_cast<double>(j + 1));
  }
  return config;
}

/// Noise of about a normal distribution, the same in every run.
class Noise {
 public:
  double next() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
      seed_ = seed_ * 6364136223846793005U + 1442695040888963407U;
      sum += static_cast<double>(seed_ >> 40U) / 16777216.0;
    }
    return sum;
  }
  std::uint32_t bits() {
    seed_ = seed_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::uint32_t>(seed_ >> 32U);
  }

 private:
  std::uint64_t seed_ = 12345;
};

/// A joint with a chain behind it; what its gauges read can be changed before the chain sees it.
template <class RealT>
struct Joint {
  using Real = RealT;
  strainwave::RippleSensorConfig<Real, gauge_count, 3> config = five_gauges<Real>();
  strainwave::RippleSensorState<Real, gauge_count, 3> state = strainwave::initial_state(config);
  Noise noise;
  double speed_rad_s = 20;
  double torque_Nm = 12;
  double angle_rad = 0.1;
  std::uint32_t k = 0;
  strainwave::TorqueSensorSample<gauge_count, Real> sample;

  [[nodiscard]] double volts(std::size_t j) const {
    return torque_Nm / 10 + amplitude_V * std::sin(2 * angle_rad + phase_rad(j));
  }
  strainwave::ConverterCode code(double input_V) {
    return strainwave::to_code(config.converter, static_cast<Real>(input_V));
  }
  void advance() {
    angle_rad += speed_rad_s * 1e-3;
    for (std::size_t j = 0; j < gauge_count; ++j) {
      sample.codes[j] = code(volts(j) + 0.001 * noise.next());
    }
    sample.motor_phase = strainwave::phase_from_radians(angle_rad);
    sample.sequence = ++k;
  }
  auto take() { return strainwave::step(config, state, sample); }
  auto next() {
    advance();
    return take();
  }
  /// The first of so many samples in which sound gauges were doubted; 0 where none was.
  int run(int samples) {
    for (int i = 1; i <= samples; ++i) {
      const auto reading = next();
      if (reading.left_out_gauge != 0 || (reading.status & strainwave::fault_mask) != 0U) {
        return i;
      }
    }
    return 0;
  }
  /// The reading of gauge j after a fault, in place of its code.
  void fail(std::size_t j, GaugeFault fault, strainwave::ConverterCode before) {
    switch (fault) {
      case GaugeFault::open:
        sample.codes[j] = code(11);
        break;
      case GaugeFault::saturated:
        sample.codes[j] = code(-11);
        break;
      case GaugeFault::shorted:
        sample.codes[j] = code(0.001 * noise.next());
        break;
      case GaugeFault::stuck:
        sample.codes[j] = before;
        break;
      case GaugeFault::inconsistent:
        sample.codes[j] = code(0.5 * volts(j) + 0.001 * noise.next());
        break;
      case GaugeFault::none:
        break;
    }
  }
};

}  // namespace gauge_examples
