// SPDX-License-Identifier: Apache-2.0
/// @file torque_sensor.hpp
/// The chain: converter codes of the gauges in, torque in Nm with the ripple removed out.
///
///     codes -> volts (bridge.hpp) -> weighted sum (gains.hpp) -> torque (calibration.hpp)
///           -> ripple removed (ripple_filter.hpp, or oscillator_filter.hpp)
///
/// With a gauge monitor (gauge_monitor.hpp) a gauge that fails is left out, and the gains solved
/// beforehand without it are used; by default there is none.
///
/// Which filter removes the ripple, the configuration's type says:
///
///     RippleSensorConfig   the ripple filter, strainwave's default: needs the motor's angle
///     TorqueSensorConfig   the oscillator filter as it was published, for comparison and study
///
/// Both are the same chain, TorqueChainConfig, and take the same samples.  What the ripple filter
/// has learned is kept and restored by its own functions (learned_ripple.hpp), on config.filter and
/// state.filter.
///
/// A configuration that is checked once, a state, and a step that never fails: samples that cannot
/// be used are rejected, counted and flagged, and the last good torque is held meanwhile.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/bridge.hpp"
#include "strainwave/calibration.hpp"
#include "strainwave/gains.hpp"
#include "strainwave/gauge_monitor.hpp"
#include "strainwave/oscillator_filter.hpp"
#include "strainwave/ripple_filter.hpp"
#include "strainwave/status.hpp"
#include "strainwave/torque_sensor_config.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <std::size_t MaxGauges, class Real>
struct TorqueSensorSample {
  ConverterCode codes[MaxGauges] = {};
  Real expected_torque_Nm = Real(0);
  Real motor_speed_rad_s = Real(0);  ///< used by the oscillator filter with RotationSource::speed
  Phase motor_phase = {};            ///< used by the ripple filter, and with RotationSource::angle
  bool phase_valid = true;           ///< false where the caller has no angle for this sample
  bool phase_referenced = true;  ///< false: angle from an unknown zero, the ripple filter's frozen
                                 ///< terms wait
  /// Time since the sample before by the caller's clock; 0 where it has none: sample numbers and
  /// sample period then say it.  Below 0, infinite or NaN, the sample is refused.  Used by the
  /// ripple filter; the oscillator filter goes by samples.
  Real interval_s = Real(0);
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
  std::uint8_t left_out_gauge = 0;  ///< number of the gauge that is not used, from 1; 0: none
  GaugeFault gauge_fault = GaugeFault::none;  ///< of the lost gauge; none while it is suspected
  /// rms of the fluctuation that the gains in use leave, as far as the monitor was told; 0 without.
  Real residual_fluctuation_Nm = Real(0);
};

/// What the next sample is compared with: its number.
struct SampleNumber {
  std::uint32_t sequence = 0;
  bool sequence_valid = true;
};

namespace detail {

/// What the chain remembers of a sample: with the oscillator filter all of it, to find rows that
/// the acquisition only repeated; the ripple filter finds these itself.
template <class Real, std::size_t MaxGauges, class FilterConfig>
struct Remembered {
  using Type = TorqueSensorSample<MaxGauges, Real>;
};

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
struct Remembered<Real, MaxGauges, RippleFilterConfig<Real, MaxPairs>> {
  using Type = SampleNumber;
};

template <std::size_t MaxGauges, class Real>
constexpr void keep(SampleNumber& last, const TorqueSensorSample<MaxGauges, Real>& sample) {
  last = {sample.sequence, sample.sequence_valid};
}

template <std::size_t MaxGauges, class Real>
constexpr void keep(TorqueSensorSample<MaxGauges, Real>& last,
                    const TorqueSensorSample<MaxGauges, Real>& sample) {
  last = sample;
}

}  // namespace detail

template <class Real, std::size_t MaxGauges, class FilterConfig>
struct TorqueChainState {
  decltype(initial_state(FilterConfig{})) filter = {};
  TorqueReading<Real> last_reading = {};
  detail::Remembered<Real, MaxGauges, FilterConfig>::Type last_sample = {};
  bool started = false;
  std::uint32_t older_in_a_row = 0;   ///< samples refused as older since the last one taken
  Real refused_interval_s = Real(0);  ///< of samples refused by number since the last one taken
  Real last_temperature_degC = Real(20);
  EventCounters counters = {};
  GaugeMonitorState<Real, MaxGauges> monitor = {};
};

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
using RippleSensorState = TorqueChainState<Real, MaxGauges, RippleFilterConfig<Real, MaxPairs>>;

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
using TorqueSensorState =
    TorqueChainState<Real, MaxGauges, OscillatorFilterConfig<Real, MaxOrders>>;

template <class Real, std::size_t MaxGauges, class FilterConfig>
[[nodiscard]] constexpr TorqueChainState<Real, MaxGauges, FilterConfig> initial_state(
    const TorqueChainConfig<Real, MaxGauges, FilterConfig>& config) {
  TorqueChainState<Real, MaxGauges, FilterConfig> state;
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

/// Whether a sample is new by its number, and how many are missing before it.
template <class Real, std::size_t MaxGauges, class FilterConfig>
constexpr Succession take_number(TorqueChainState<Real, MaxGauges, FilterConfig>& state,
                                 const TorqueSensorSample<MaxGauges, Real>& sample) {
  Succession next;
  if (sample.sequence_valid && state.last_sample.sequence_valid) {
    next = succession(state.last_sample.sequence, sample.sequence);
  }
  if (has(next.status, StatusFlag::sample_out_of_order) &&
      ++state.older_in_a_row > most_older_in_a_row) {
    next = {mask(StatusFlag::samples_missing), most_older_in_a_row};
  }
  if ((next.status & fault_mask) == 0U) {
    state.older_in_a_row = 0;
  } else if (sample.interval_s > Real(0) && is_finite(sample.interval_s)) {
    // The caller's clock has gone on; the next sample's interval begins at this one.
    state.refused_interval_s += sample.interval_s;
  }
  return next;
}

template <class Real>
[[nodiscard]] constexpr Status take_temperature(const TorqueCalibration<Real>& calibration,
                                                Real& last_temperature_degC,
                                                Real temperature_degC) {
  const Real lowest_degC = calibration.minimum_temperature_degC;
  const Real highest_degC = calibration.maximum_temperature_degC;
  if (temperature_degC >= lowest_degC && temperature_degC <= highest_degC) {
    last_temperature_degC = temperature_degC;
    return 0;
  }
  if (!is_finite(temperature_degC)) {
    return mask(StatusFlag::temperature_not_finite);
  }
  last_temperature_degC = temperature_degC < lowest_degC ? lowest_degC : highest_degC;
  return mask(StatusFlag::temperature_out_of_range);
}

// What the filters take differently follows, an overload for each.

/// Samples that never arrived.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
constexpr void pass_over(const RippleSensorConfig<Real, MaxGauges, MaxPairs>& /*config*/,
                         RippleSensorState<Real, MaxGauges, MaxPairs>& /*state*/,
                         std::uint32_t /*samples*/) {
  // The interval that comes with the next sample says it all.
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
constexpr void pass_over(const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config,
                         TorqueSensorState<Real, MaxGauges, MaxOrders>& state,
                         std::uint32_t samples) {
  skip(config.filter, state.filter, samples);
}

/// True for a row that the acquisition only repeated: time has passed, but nothing was measured.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
[[nodiscard]] constexpr bool is_held(
    const RippleSensorConfig<Real, MaxGauges, MaxPairs>& /*config*/,
    const RippleSensorState<Real, MaxGauges, MaxPairs>& /*state*/,
    const TorqueSensorSample<MaxGauges, Real>& /*sample*/) {
  return false;  // the ripple filter finds such rows itself
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
[[nodiscard]] constexpr bool is_held(const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config,
                                     const TorqueSensorState<Real, MaxGauges, MaxOrders>& state,
                                     const TorqueSensorSample<MaxGauges, Real>& sample) {
  const Real travel_rad =
      absolute(state.filter.smoothed_speed_rad_s) * config.filter.sample_period_s;
  return !sample.sequence_valid &&
         travel_rad >= static_cast<Real>(least_travel_of_a_new_sample_rad) &&
         same_content(active_gauges(config.gains), sample, state.last_sample);
}

/// The filter's sample but for the torque and what both filters take.
template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
[[nodiscard]] constexpr RippleSample<Real> filter_sample(
    const RippleSensorConfig<Real, MaxGauges, MaxPairs>& config,
    RippleSensorState<Real, MaxGauges, MaxPairs>& state,
    const TorqueSensorSample<MaxGauges, Real>& sample, std::uint32_t missing) {
  RippleSample<Real> to;
  to.phase_referenced = sample.phase_referenced;
  to.interval_s = sample.interval_s;
  if (sample.interval_s == Real(0)) {
    to.interval_s = (Real(1) + static_cast<Real>(missing)) * config.sample_period_s;
  } else if (sample.interval_s > Real(0) && is_finite(sample.interval_s)) {
    to.interval_s += state.refused_interval_s;
  } else {
    return to;  // no time: the filter refuses it, and the clock has not gone on
  }
  state.refused_interval_s = Real(0);
  return to;
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorSample<Real> filter_sample(
    const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& /*config*/,
    TorqueSensorState<Real, MaxGauges, MaxOrders>& /*state*/,
    const TorqueSensorSample<MaxGauges, Real>& sample, std::uint32_t /*missing*/) {
  OscillatorSample<Real> to;
  to.motor_speed_rad_s = sample.motor_speed_rad_s;
  return to;
}

/// What the gains in use make of the gauges.
template <class Real>
struct GaugeSum {
  Real volts = Real(0);
  bool saturated = false;  ///< of the gauges in use
  bool usable = true;
  Status status = 0;
};

/// The sum of the gauges without the one that the monitor leaves out.
template <class Real, std::size_t MaxGauges, class FilterConfig>
constexpr GaugeSum<Real> watched_sum(const TorqueChainConfig<Real, MaxGauges, FilterConfig>& config,
                                     TorqueChainState<Real, MaxGauges, FilterConfig>& state,
                                     const GaugeSignals<Real>& signals) {
  const GaugeMonitorConfig<Real, MaxGauges>& monitor = config.monitor;
  Real volts = weighted_sum(config.gains, signals.volts);
  Real residual_V = monitor.residual_fluctuation_V;
  const GaugeVerdict verdict = watch(monitor, state.monitor, config.converter, signals);
  if (verdict.left_out != 0 && verdict.usable) {
    const GainsWithoutGauge<Real, MaxGauges>& others = monitor.without[verdict.left_out - 1U];
    volts = weighted_sum(others.gains.values, signals.count, signals.volts) - others.zero_shift_V;
    residual_V = others.residual_fluctuation_V;
  }
  state.last_reading.left_out_gauge = verdict.left_out;
  state.last_reading.gauge_fault = state.monitor.fault;
  state.last_reading.residual_fluctuation_Nm =
      residual_V * absolute(config.calibration.gain_Nm_per_V);
  const bool saturated = at_end_beside(config.converter, signals, verdict.left_out) > 0;
  return {volts, saturated, verdict.usable, verdict.status};
}

/// Codes to volts; how many of them are at an end of the range.
template <class Real, std::size_t MaxGauges, class FilterConfig>
[[nodiscard]] constexpr std::size_t read_gauges(
    const TorqueChainConfig<Real, MaxGauges, FilterConfig>& config,
    const TorqueSensorSample<MaxGauges, Real>& sample, Real* volts) {
  std::size_t at_end = 0;
  for (std::size_t j = 0; j < active_gauges(config.gains); ++j) {
    const ConverterCode code = sample.codes[j];
    // NOLINTNEXTLINE(clang-analyzer-security.ArrayBound): active_gauges() keeps to the capacity
    volts[j] = to_volts(config.converter, code);
    if (is_saturated(config.converter, code)) {
      ++at_end;
    }
  }
  return at_end;
}

/// The gauges' part: the sum of their voltages, and what the reading says of them.
template <class Real, std::size_t MaxGauges, class FilterConfig>
constexpr GaugeSum<Real> sum_of_gauges(
    const TorqueChainConfig<Real, MaxGauges, FilterConfig>& config,
    TorqueChainState<Real, MaxGauges, FilterConfig>& state,
    const TorqueSensorSample<MaxGauges, Real>& sample, const Real* volts, std::size_t at_end,
    std::uint32_t missing) {
  if (!config.monitor.active) {
    return {weighted_sum(config.gains, volts), at_end > 0, true, 0};
  }
  GaugeSignals<Real> signals;
  signals.count = active_gauges(config.gains);
  signals.codes = sample.codes;
  signals.volts = volts;
  signals.motor_phase = sample.motor_phase;
  signals.phase_valid = sample.phase_valid;
  signals.phase_referenced = sample.phase_referenced;
  signals.at_end = at_end;
  signals.missing = missing;
  return watched_sum(config, state, signals);
}

/// The last reading again, for a sample that is not taken.
template <class Real, std::size_t MaxGauges, class FilterConfig>
[[nodiscard]] constexpr TorqueReading<Real> refused(
    TorqueChainState<Real, MaxGauges, FilterConfig>& state, Status status) {
  TorqueReading<Real> reading = state.last_reading;
  reading.status = status;
  record(state.counters, status);
  return reading;
}

/// Faults for which the filter has not used a torque that was valid.
inline constexpr Status torque_unused_mask =
    mask(StatusFlag::sample_repeated) | mask(StatusFlag::sample_out_of_order) |
    mask(StatusFlag::time_not_finite) | mask(StatusFlag::torque_not_finite);

}  // namespace detail

/// One sample through the whole chain.
template <class Real, std::size_t MaxGauges, class FilterConfig>
inline TorqueReading<Real> step(const TorqueChainConfig<Real, MaxGauges, FilterConfig>& config,
                                TorqueChainState<Real, MaxGauges, FilterConfig>& state,
                                const TorqueSensorSample<MaxGauges, Real>& sample) {
  Real volts[MaxGauges] = {};
  const std::size_t at_end = detail::read_gauges(config, sample, volts);
  detail::Succession next;
  if (state.started) {
    next = detail::take_number(state, sample);
    if ((next.status & fault_mask) != 0U) {
      return detail::refused(state, next.status);
    }
    detail::pass_over(config, state, next.missing);
    if (at_end == 0 && detail::is_held(config, state, sample)) {
      detail::pass_over(config, state, 1);
      state.last_sample.sequence = sample.sequence;
      return detail::refused(state, next.status | mask(StatusFlag::sample_repeated));
    }
  }
  state.started = true;
  detail::keep(state.last_sample, sample);
  const detail::GaugeSum<Real> sum =
      detail::sum_of_gauges(config, state, sample, volts, at_end, next.missing);
  Status status = next.status | sum.status;
  status |= sum.saturated ? mask(StatusFlag::gauge_saturated) : Status{0};
  status |= detail::take_temperature(config.calibration, state.last_temperature_degC,
                                     sample.temperature_degC);

  auto input = detail::filter_sample(config, state, sample, next.missing);
  input.torque_valid = !sum.saturated && sum.usable;
  input.measured_torque_Nm =
      torque_of_volts_Nm(config.calibration, sum.volts, state.last_temperature_degC);
  input.expected_torque_Nm = sample.expected_torque_Nm;
  input.motor_phase = sample.motor_phase;
  input.phase_valid = sample.phase_valid;
  const auto filtered = step(config.filter, state.filter, input);
  TorqueReading<Real>& reading = state.last_reading;
  if (input.torque_valid && (filtered.status & detail::torque_unused_mask) == 0U) {
    reading.torque_measured_Nm = input.measured_torque_Nm;
  }
  reading.torque_Nm = filtered.torque_Nm;
  reading.ripple_Nm = filtered.ripple_Nm;
  reading.status = status | filtered.status;
  record(state.counters, reading.status);
  return reading;
}

}  // namespace strainwave
