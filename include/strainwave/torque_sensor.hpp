// SPDX-License-Identifier: Apache-2.0
/// @file torque_sensor.hpp
/// The chain: converter codes of the gauges in, torque in Nm with the ripple removed out.
///
///     codes -> volts (bridge.hpp) -> weighted sum (gains.hpp) -> torque (calibration.hpp)
///           -> ripple removed (oscillator_filter.hpp)
///
/// A configuration that is checked once, a state, and a step that never fails: samples that cannot
/// be used are rejected, counted and flagged, and the last good torque is held meanwhile.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/bridge.hpp"
#include "strainwave/calibration.hpp"
#include "strainwave/gains.hpp"
#include "strainwave/oscillator_filter.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
struct TorqueSensorConfig {
  Converter<Real> converter = {};
  Gains<Real, MaxGauges> gains = {};  ///< one gain per channel; a full bridge is one channel
  TorqueCalibration<Real> calibration = {};
  OscillatorFilterConfig<Real, MaxOrders> filter = {};
};

template <std::size_t MaxGauges, class Real>
struct TorqueSensorSample {
  ConverterCode codes[MaxGauges] = {};
  Real expected_torque_Nm = Real(0);
  Real motor_speed_rad_s = Real(0);
  Phase motor_phase = {};
  bool phase_valid = true;
  Real temperature_degC = Real(20);
  /// Counts samples as the converter took them; wraps at 32 bits.  The same number again is a
  /// repeated sample, a larger step a gap.
  std::uint32_t sequence = 0;
  /// False where the caller has no sample numbers: a sample then counts as held where codes, phase
  /// and speed are those of the last one although the motor turns.
  bool sequence_valid = true;
};

template <class Real>
struct TorqueReading {
  Real torque_measured_Nm = Real(0);  ///< calibrated, ripple included
  Real torque_Nm = Real(0);           ///< ripple removed
  Real ripple_Nm = Real(0);
  Status status = 0;
};

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
struct TorqueSensorState {
  OscillatorFilterState<Real, MaxOrders> filter = {};
  TorqueReading<Real> last_reading = {};
  TorqueSensorSample<MaxGauges, Real> last_sample = {};
  bool started = false;
  std::uint32_t older_in_a_row = 0;  ///< samples refused as older since the last one taken
  Real last_temperature_degC = Real(20);
  EventCounters counters = {};
};

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
[[nodiscard]] constexpr TorqueSensorState<Real, MaxGauges, MaxOrders> initial_state(
    const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config) {
  TorqueSensorState<Real, MaxGauges, MaxOrders> state;
  state.filter = initial_state(config.filter);
  state.last_temperature_degC = config.calibration.reference_temperature_degC;
  return state;
}

/// So many samples in a row that are older than the last one taken mean that the counter was wrong
/// or has started again: the sensor goes on with it.
inline constexpr std::uint32_t most_older_in_a_row = 10;

/// Travel from one sample to the next from which on an encoder that stands is a held sample, rad;
/// some counts of a coarse one.
inline constexpr float least_travel_of_a_new_sample_rad = 0.01F;

namespace detail {

/// How a sample follows the last one: its status, and how many are missing between them.
struct Succession {
  Status status = 0;
  std::uint32_t missing = 0;
};

template <std::size_t MaxGauges, class Real>
[[nodiscard]] constexpr bool same_content(std::size_t gauge_count,
                                          const TorqueSensorSample<MaxGauges, Real>& a,
                                          const TorqueSensorSample<MaxGauges, Real>& b) {
  for (std::size_t j = 0; j < gauge_count; ++j) {
    if (a.codes[j] != b.codes[j]) {
      return false;
    }
  }
  // Equal codes prove nothing, a coarse converter repeats them; an encoder that stands while the
  // motor turns does.
  return a.phase_valid && b.phase_valid && a.motor_phase == b.motor_phase &&
         a.motor_speed_rad_s == b.motor_speed_rad_s;
}

[[nodiscard]] constexpr Succession succession(std::uint32_t last, std::uint32_t now) {
  const std::uint32_t step_size = now - last;  // right across the wrap
  if (step_size == 0) {
    return {mask(StatusFlag::sample_repeated), 0};
  }
  if (step_size >= 0x80000000U) {
    return {mask(StatusFlag::sample_out_of_order), 0};
  }
  if (step_size > 1) {
    return {mask(StatusFlag::samples_missing), step_size - 1};
  }
  return {};
}

}  // namespace detail

/// One sample through the whole chain.
template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
inline TorqueReading<Real> step(const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config,
                                TorqueSensorState<Real, MaxGauges, MaxOrders>& state,
                                const TorqueSensorSample<MaxGauges, Real>& sample) {
  const std::size_t gauge_count = active_gauges(config.gains);
  bool saturated = false;
  for (std::size_t j = 0; j < gauge_count; ++j) {
    saturated = saturated || is_saturated(config.converter, sample.codes[j]);
  }
  TorqueReading<Real> reading = state.last_reading;
  reading.status = 0;
  if (state.started) {
    detail::Succession next;
    if (sample.sequence_valid && state.last_sample.sequence_valid) {
      next = detail::succession(state.last_sample.sequence, sample.sequence);
    }
    if (has(next.status, StatusFlag::sample_out_of_order)) {
      if (++state.older_in_a_row > most_older_in_a_row) {
        next = {mask(StatusFlag::samples_missing), most_older_in_a_row};
      }
    }
    reading.status |= next.status;
    if ((next.status & fault_mask) != 0U) {
      record(state.counters, reading.status);
      return reading;
    }
    state.older_in_a_row = 0;
    skip(config.filter, state.filter, next.missing);
    const Real travel_rad =
        absolute(state.filter.smoothed_speed_rad_s) * config.filter.sample_period_s;
    if (!sample.sequence_valid && !saturated &&
        travel_rad >= static_cast<Real>(least_travel_of_a_new_sample_rad) &&
        detail::same_content(gauge_count, sample, state.last_sample)) {
      // Held by the acquisition: time has passed, but nothing was measured.
      reading.status |= mask(StatusFlag::sample_repeated);
      skip(config.filter, state.filter, 1);
      state.last_sample.sequence = sample.sequence;
      record(state.counters, reading.status);
      return reading;
    }
  }
  state.started = true;
  state.last_sample = sample;

  if (saturated) {
    reading.status |= mask(StatusFlag::gauge_saturated);
  }
  const TorqueCalibration<Real>& calibration = config.calibration;
  if (is_finite(sample.temperature_degC)) {
    Real temperature_degC = sample.temperature_degC;
    if (temperature_degC < calibration.minimum_temperature_degC) {
      temperature_degC = calibration.minimum_temperature_degC;
      reading.status |= mask(StatusFlag::temperature_out_of_range);
    } else if (temperature_degC > calibration.maximum_temperature_degC) {
      temperature_degC = calibration.maximum_temperature_degC;
      reading.status |= mask(StatusFlag::temperature_out_of_range);
    }
    state.last_temperature_degC = temperature_degC;
  } else {
    reading.status |= mask(StatusFlag::temperature_not_finite);
  }

  Real volts[MaxGauges] = {};
  for (std::size_t j = 0; j < gauge_count; ++j) {
    volts[j] = to_volts(config.converter, sample.codes[j]);
  }
  OscillatorSample<Real> filter_sample;
  filter_sample.torque_valid = !saturated;
  filter_sample.measured_torque_Nm = torque_of_volts_Nm(
      calibration, weighted_sum(config.gains, volts), state.last_temperature_degC);
  filter_sample.expected_torque_Nm = sample.expected_torque_Nm;
  filter_sample.motor_speed_rad_s = sample.motor_speed_rad_s;
  filter_sample.motor_phase = sample.motor_phase;
  filter_sample.phase_valid = sample.phase_valid;
  const OscillatorReading<Real> filtered = step(config.filter, state.filter, filter_sample);
  if (!saturated && is_usable_torque(filter_sample.measured_torque_Nm)) {
    reading.torque_measured_Nm = filter_sample.measured_torque_Nm;
  }
  reading.torque_Nm = filtered.torque_Nm;
  reading.ripple_Nm = filtered.ripple_Nm;
  reading.status |= filtered.status;
  state.last_reading = reading;
  record(state.counters, reading.status);
  return reading;
}

/// The same configuration in another precision or capacity; the capacities must hold it.
template <class Real, std::size_t MaxGauges, std::size_t MaxOrders, class FromReal,
          std::size_t FromMaxGauges, std::size_t FromMaxOrders>
[[nodiscard]] constexpr TorqueSensorConfig<Real, MaxGauges, MaxOrders> converted(
    const TorqueSensorConfig<FromReal, FromMaxGauges, FromMaxOrders>& from) {
  return {converted<Real>(from.converter), converted<Real, MaxGauges>(from.gains),
          converted<Real>(from.calibration), converted<Real, MaxOrders>(from.filter)};
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
[[nodiscard]] constexpr Violation<Real> check(
    const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config) {
  if (const auto violation = check(config.converter); !violation.ok()) {
    return violation;
  }
  if (const auto violation = check(config.gains); !violation.ok()) {
    return violation;
  }
  if (const auto violation = check(config.calibration); !violation.ok()) {
    return violation;
  }
  return check(config.filter);
}

}  // namespace strainwave
