// SPDX-License-Identifier: Apache-2.0
/// @file config_checksum.hpp
/// The checksum of a joint's configuration, value by value in the order of declaration.
///
/// An exported joint header states it and recomputes it: when it is compiled, so that a digit
/// changed by hand does not compile, and at start-up from memory, so that an image with flipped
/// bits is found before the first torque.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/checksum.hpp"
#include "strainwave/gear.hpp"
#include "strainwave/learned_ripple.hpp"
#include "strainwave/torque_sensor.hpp"

namespace strainwave {

constexpr void take(Checksum& checksum, const Rational& ratio) {
  take(checksum, ratio.numerator);
  take(checksum, ratio.denominator);
}

template <class Real>
constexpr void take(Checksum& checksum, const CosSin<Real>& pair) {
  take(checksum, pair.cosine);
  take(checksum, pair.sine);
}

constexpr void take(Checksum& checksum, const RippleOrder& order) {
  take(checksum, order.order);
  take(checksum, order.with_load);
  take(checksum, order.with_speed);
  take(checksum, order.with_direction);
  take(checksum, order.keep);
}

template <class Real>
constexpr void take(Checksum& checksum, const FrozenTerm<Real>& term) {
  take(checksum, term.order);
  take(checksum, term.cosine_Nm);
  take(checksum, term.sine_Nm);
}

/// Takes in every element of an array, those without a use included.
template <class Element, std::size_t count>
constexpr void take_each(Checksum& checksum, const Element (&elements)[count]) {
  for (const Element& element : elements) {
    take(checksum, element);
  }
}

template <class Element, std::size_t rows, std::size_t columns>
constexpr void take_each(Checksum& checksum, const Element (&elements)[rows][columns]) {
  for (const auto& row : elements) {
    take_each(checksum, row);
  }
}

template <class Real>
constexpr void take(Checksum& checksum, const GearConfig<Real>& gear) {
  take(checksum, gear.configuration);
  take(checksum, gear.ratio);
  take(checksum, gear.output_direction);
  take(checksum, gear.rated_torque_Nm);
}

template <class Real>
constexpr void take(Checksum& checksum, const Converter<Real>& converter) {
  take(checksum, converter.bits);
  take(checksum, converter.minimum_V);
  take(checksum, converter.maximum_V);
  take(checksum, converter.lowest_code);
}

template <class Real, std::size_t MaxGauges>
constexpr void take(Checksum& checksum, const Gains<Real, MaxGauges>& gains) {
  take_count(checksum, gains.count);
  take_each(checksum, gains.values);
}

template <class Real>
constexpr void take(Checksum& checksum, const TorqueCalibration<Real>& calibration) {
  take(checksum, calibration.gain_Nm_per_V);
  take(checksum, calibration.zero_V);
  take(checksum, calibration.full_scale_Nm);
  take_each(checksum, calibration.linearisation);
  take(checksum, calibration.reference_temperature_degC);
  take(checksum, calibration.zero_drift_V_per_K);
  take(checksum, calibration.gain_drift_per_K);
  take(checksum, calibration.minimum_temperature_degC);
  take(checksum, calibration.maximum_temperature_degC);
}

template <class Real, std::size_t MaxPairs>
constexpr void take(Checksum& checksum, const RippleFilterConfig<Real, MaxPairs>& filter) {
  take_count(checksum, filter.order_count);
  take_each(checksum, filter.orders);
  take(checksum, filter.memory_turns);
  take(checksum, filter.torque_noise_Nm);
  take(checksum, filter.torque_walk_Nm_per_sqrt_s);
  take(checksum, filter.initial_amplitude_Nm);
  take(checksum, filter.rated_torque_Nm);
  take(checksum, filter.reference_speed_rad_s);
  take(checksum, filter.angle_to_torque_delay_s);
  take(checksum, filter.minimum_speed_rad_s);
  take_count(checksum, filter.frozen_count);
  take_each(checksum, filter.frozen);
}

template <class Real, std::size_t MaxOrders>
constexpr void take(Checksum& checksum, const OscillatorFilterConfig<Real, MaxOrders>& filter) {
  take_count(checksum, filter.order_count);
  take_each(checksum, filter.orders);
  take_each(checksum, filter.process_noise_variance_Nm2);
  take(checksum, filter.measurement_noise_variance_Nm2);
  take(checksum, filter.initial_variance_Nm2);
  take(checksum, filter.sample_period_s);
  take(checksum, filter.rotation_source);
  take(checksum, filter.minimum_travel_rad);
  take(checksum, filter.minimum_speed_rad_s);
  take(checksum, filter.variance_limit_ratio);
}

template <class Real, std::size_t MaxGauges>
constexpr void take(Checksum& checksum, const ConsistencyCheck<Real, MaxGauges>& parity) {
  take(checksum, parity.samples);
  take_count(checksum, parity.direction_count);
  take_each(checksum, parity.directions);
  take_count(checksum, parity.harmonic_count);
  take(checksum, parity.wave_factor);
  take_each(checksum, parity.wave_V);
  take_each(checksum, parity.zero_V);
  take(checksum, parity.delay_samples);
  take(checksum, parity.limit_V);
  take(checksum, parity.limit_per_V);
}

template <class Real, std::size_t MaxGauges>
constexpr void take(Checksum& checksum, const GainsWithoutGauge<Real, MaxGauges>& set) {
  take(checksum, set.available);
  take(checksum, set.gains);
  take(checksum, set.zero_shift_V);
  take(checksum, set.residual_fluctuation_V);
}

template <class Real, std::size_t MaxGauges>
constexpr void take(Checksum& checksum, const GaugeMonitorConfig<Real, MaxGauges>& monitor) {
  take(checksum, monitor.active);
  take(checksum, monitor.rail_samples);
  take(checksum, monitor.lowest_V);
  take(checksum, monitor.highest_V);
  take(checksum, monitor.torn_gauge_rail);
  take(checksum, monitor.overload_V);
  take(checksum, monitor.stuck_samples);
  take(checksum, monitor.flat_travel_turns);
  take(checksum, monitor.flat_band_V);
  take(checksum, monitor.amplifier_zero_V);
  take(checksum, monitor.short_band_V);
  take(checksum, monitor.consistency);
  take(checksum, monitor.residual_fluctuation_V);
  take_each(checksum, monitor.without);
}

template <class Real, std::size_t MaxGauges, std::size_t MaxPairs>
constexpr void take(Checksum& checksum,
                    const RippleSensorConfig<Real, MaxGauges, MaxPairs>& config) {
  take(checksum, config.converter);
  take(checksum, config.gains);
  take(checksum, config.calibration);
  take(checksum, config.filter);
  take(checksum, config.sample_period_s);
  take(checksum, config.monitor);
}

template <class Real, std::size_t MaxGauges, std::size_t MaxOrders>
constexpr void take(Checksum& checksum,
                    const TorqueSensorConfig<Real, MaxGauges, MaxOrders>& config) {
  take(checksum, config.converter);
  take(checksum, config.gains);
  take(checksum, config.calibration);
  take(checksum, config.filter);
  take(checksum, config.monitor);
}

template <class Real, std::size_t MaxPairs>
constexpr void take(Checksum& checksum, const LearnedRipple<Real, MaxPairs>& kept) {
  take_count(checksum, kept.order_count);
  take_each(checksum, kept.orders);
  take_each(checksum, kept.coefficients_Nm);
  take_each(checksum, kept.standard_deviations_Nm);
  take(checksum, kept.innovation_scale_Nm);
}

/// The checksum of all of these, one after the other.
template <class... Parts>
[[nodiscard]] constexpr std::uint32_t checksum_of(const Parts&... parts) {
  Checksum checksum;
  (take(checksum, parts), ...);
  return value_of(checksum);
}

/// Whether parts in memory still have the checksum that was stored beside them.
template <class... Parts>
[[nodiscard]] inline bool is_intact(const std::uint32_t& stored, const Parts&... parts) {
  return checksum_of(parts...) == *static_cast<const volatile std::uint32_t*>(&stored);
}

}  // namespace strainwave
