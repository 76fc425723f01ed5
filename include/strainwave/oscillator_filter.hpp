// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_filter.hpp
/// The ripple filter as published: a Kalman filter on harmonic oscillators that turn with the
/// motor.
///
/// Taghirad & Belanger 1999, sections V and VI.  Each order (2 and 4 cycles per motor turn for
/// ripple, 1/ratio for misalignment) is an oscillator of two states; the filter predicts the sum of
/// their first states, the ripple, and the sensor's torque is what is measured minus what was
/// predicted.  Offered for comparison and study: with the published tuning it also removes true
/// torque that the expected torque does not contain.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/oscillator_config.hpp"
#include "strainwave/oscillator_state.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <class Real>
struct OscillatorSample {
  Real measured_torque_Nm = Real(0);
  Real expected_torque_Nm =
      Real(0);  ///< T_exp of section V, for example load inertia x acceleration
  Real motor_speed_rad_s = Real(0);  ///< used with RotationSource::speed
  Phase motor_phase = {};            ///< used with RotationSource::angle
  bool torque_valid = true;          ///< false where the caller knows the torque to be wrong
  bool phase_valid = true;           ///< false where the caller has no angle for this sample
};

template <class Real>
struct OscillatorReading {
  Real torque_Nm =
      Real(0);  ///< measured minus predicted ripple; the last one for a rejected sample
  Real ripple_Nm = Real(0);  ///< C x(k), predicted from the samples before this one
  Status status = 0;
};

/// Rotation of an order within one sample beyond which a speed is taken for a fault, rad.
inline constexpr std::int32_t largest_rotation_rad = 10000;

/// Magnitude beyond which a torque is taken for a fault, Nm: far above any gear, and small enough
/// that no product in the filter overflows in float.
inline constexpr float largest_usable_torque_Nm = 1e15F;

template <class Real>
[[nodiscard]] constexpr bool is_usable_torque(Real torque_Nm) {
  return absolute(torque_Nm) <= static_cast<Real>(largest_usable_torque_Nm);
}

namespace detail {

/// Most samples without an update that count; more would only repeat what the limit says.
inline constexpr std::uint32_t most_samples_without_update = 1U << 20U;
/// Most missing samples whose rotation is carried on at the last speed.
inline constexpr std::uint32_t most_carried_samples = 64;

/// Adds samples to a counter that ends at most_samples_without_update.
constexpr void count_up_to(std::uint32_t& counter, std::uint32_t samples) {
  const std::uint32_t room = most_samples_without_update - counter;
  counter += samples < room ? samples : room;
}

/// The output row at the present angle.  An order that is twice another one costs no cosine.
template <class Real, std::size_t MaxOrders>
constexpr void output_now(const OscillatorFilterConfig<Real, MaxOrders>& config,
                          const OscillatorFilterState<Real, MaxOrders>& state, Phase now,
                          CosSin<Real>* output) {
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    if (const std::size_t b = half_of(config, a); b < a) {
      output[a] = doubled(output[b]);
    } else if (config.rotation_source == RotationSource::angle) {
      output[a] = cos_sin_of_fraction<Real>(order_fraction(now, config.orders[a]));
    } else {
      output[a] = turned(state.output[a], cos_sin_of_radians(to_real<Real>(config.orders[a]) *
                                                             state.pending_rotation_rad));
    }
  }
}

/// The output row from here on, and no rotation since it.
template <class Real, std::size_t MaxOrders>
constexpr void take_output(const OscillatorFilterConfig<Real, MaxOrders>& config,
                           OscillatorFilterState<Real, MaxOrders>& state,
                           const CosSin<Real>* output) {
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    state.output[a].cosine = output[a].cosine;
    state.output[a].sine = output[a].sine;
  }
  state.pending_rotation_rad = Real(0);
}

/// Time over which the speed is smoothed before it is compared with minimum_speed_rad_s, s.
inline constexpr float speed_smoothing_s = 0.05F;

template <class Real, std::size_t MaxOrders>
constexpr void smooth_speed(const OscillatorFilterConfig<Real, MaxOrders>& config,
                            OscillatorFilterState<Real, MaxOrders>& state, Real speed_rad_s) {
  const Real share =
      config.sample_period_s / (config.sample_period_s + static_cast<Real>(speed_smoothing_s));
  state.smoothed_speed_rad_s += share * (speed_rad_s - state.smoothed_speed_rad_s);
}

/// The highest order: what is small enough for it is so for the others.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real highest_order(const OscillatorFilterConfig<Real, MaxOrders>& config) {
  Real highest = Real(0);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const Real order = to_real<Real>(config.orders[a]);
    highest = order > highest ? order : highest;
  }
  return highest;
}

/// Says where an order turns over half a cycle from one sample to the next.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Status nyquist_status(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                              Real rotation_rad) {
  return absolute(highest_order(config) * rotation_rad) > pi<Real>
             ? mask(StatusFlag::order_above_nyquist)
             : Status{0};
}

/// Takes in a phase: how far the motor has turned since the last one says how fast it turns.
template <class Real, std::size_t MaxOrders>
constexpr Status take_phase(const OscillatorFilterConfig<Real, MaxOrders>& config,
                            OscillatorFilterState<Real, MaxOrders>& state, Phase now) {
  if (!state.frame_known) {
    state.frame = now;
    state.last_phase = now;
    state.frame_known = true;
  }
  const Real samples = static_cast<Real>(state.samples_since_phase) + Real(1);
  const Real rotation_rad = to_radians<Real>(now - state.last_phase) / samples;
  smooth_speed(config, state, rotation_rad / config.sample_period_s);
  state.last_phase = now;
  state.samples_since_phase = 0;
  return nyquist_status(config, rotation_rad);
}

/// Takes in the rotation from this sample to the next, eq. (10) with speed[k] T_s.
template <class Real, std::size_t MaxOrders>
constexpr Status take_rotation(const OscillatorFilterConfig<Real, MaxOrders>& config,
                               OscillatorFilterState<Real, MaxOrders>& state, Real speed_rad_s) {
  const Real turned_rad = highest_order(config) * (speed_rad_s * config.sample_period_s);
  const bool usable = absolute(turned_rad) <= Real(largest_rotation_rad);  // and not NaN
  if (usable) {
    state.last_speed_rad_s = speed_rad_s;
  }
  // A motor does not stop within a sample: the last known speed is the better guess.
  const Real rotation_rad = state.last_speed_rad_s * config.sample_period_s;
  state.pending_rotation_rad += rotation_rad;
  smooth_speed(config, state, state.last_speed_rad_s);
  return usable ? nyquist_status(config, rotation_rad) : mask(StatusFlag::rotation_invalid);
}

/// Whether a magnitude reaches a limit; 0 is no limit.
template <class Real>
[[nodiscard]] constexpr bool is_at_least(Real limit, Real value) {
  return limit == Real(0) || absolute(value) >= limit;
}

/// Longest rotation that waits for an update, rad.  A longer sum would lose the digits of a crawl's
/// steps in float.
inline constexpr float longest_pending_rotation_rad = 0.1F;

/// Takes a long pending rotation into the output row without an update, so that it stays small
/// however long samples are rejected or the motor crawls.
template <class Real, std::size_t MaxOrders>
constexpr void take_long_rotation(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                  OscillatorFilterState<Real, MaxOrders>& state,
                                  const CosSin<Real>* output) {
  if (absolute(state.pending_rotation_rad) > static_cast<Real>(longest_pending_rotation_rad)) {
    take_output(config, state, output);
    state.rotated_without_update = true;
  }
}

/// Carries the rotation on at the last speed over samples that never arrived, all at once, so that
/// a long gap costs no more than a short one.
template <class Real, std::size_t MaxOrders>
constexpr void carry_rotation(const OscillatorFilterConfig<Real, MaxOrders>& config,
                              OscillatorFilterState<Real, MaxOrders>& state,
                              std::uint32_t samples) {
  // Past the first few the phase is a guess.
  const auto carried =
      static_cast<Real>(samples < most_carried_samples ? samples : most_carried_samples);
  const Real rotation_rad = carried * (state.last_speed_rad_s * config.sample_period_s);
  if (absolute(highest_order(config) * rotation_rad) <= Real(largest_rotation_rad)) {
    state.pending_rotation_rad += rotation_rad;
  }
  const Real gap_s = carried * config.sample_period_s;
  state.smoothed_speed_rad_s += gap_s / (gap_s + static_cast<Real>(speed_smoothing_s)) *
                                (state.last_speed_rad_s - state.smoothed_speed_rad_s);
  CosSin<Real> output[MaxOrders] = {};
  output_now(config, state, Phase{}, output);
  take_long_rotation(config, state, output);
}

}  // namespace detail

/// x(0) = 0, P(0) = initial variance x I.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterState<Real, MaxOrders> initial_state(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  OscillatorFilterState<Real, MaxOrders> state;
  detail::reset_covariance(config, state);
  for (CosSin<Real>& each : state.output) {
    each = {Real(1), Real(0)};
  }
  return state;
}

/// Passes over samples that never arrived: with RotationSource::speed the last speed carries on.
template <class Real, std::size_t MaxOrders>
constexpr void skip(const OscillatorFilterConfig<Real, MaxOrders>& config,
                    OscillatorFilterState<Real, MaxOrders>& state, std::uint32_t samples) {
  detail::count_up_to(state.samples_without_update, samples);
  detail::count_up_to(state.samples_since_phase, samples);
  if (config.rotation_source == RotationSource::speed) {
    detail::carry_rotation(config, state, samples);
  }
}

/// One sample: predicts the ripple, then learns from the sample.  Never fails; see the status.
template <class Real, std::size_t MaxOrders>
inline OscillatorReading<Real> step(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                    OscillatorFilterState<Real, MaxOrders>& state,
                                    const OscillatorSample<Real>& sample) {
  OscillatorReading<Real> reading;
  const bool by_angle = config.rotation_source == RotationSource::angle;
  const bool angle_known = !by_angle || sample.phase_valid;
  const Phase& now = by_angle && angle_known ? sample.motor_phase : state.last_phase;
  if (!angle_known) {
    reading.status |= mask(StatusFlag::rotation_invalid);
    detail::count_up_to(state.samples_since_phase, 1);
  } else if (by_angle) {
    reading.status |= detail::take_phase(config, state, sample.motor_phase);
  }
  CosSin<Real> output[MaxOrders] = {};
  detail::output_now(config, state, now, output);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    reading.ripple_Nm +=
        output[a].cosine * state.states_Nm[2 * a] + output[a].sine * state.states_Nm[2 * a + 1];
  }

  const bool torque_usable = sample.torque_valid && is_usable_torque(sample.measured_torque_Nm);
  if (torque_usable) {
    state.last_torque_Nm = sample.measured_torque_Nm - reading.ripple_Nm;
  } else if (sample.torque_valid) {
    reading.status |= mask(StatusFlag::torque_not_finite);
  }
  reading.torque_Nm = state.last_torque_Nm;
  const bool expected_usable = is_usable_torque(sample.expected_torque_Nm);
  if (!expected_usable) {
    reading.status |= mask(StatusFlag::expected_torque_not_finite);
  }

  const Real travel_rad =
      by_angle ? to_radians<Real>(now - state.frame) : state.pending_rotation_rad;
  const bool moving = (state.rotated_without_update ||
                       detail::is_at_least(config.minimum_travel_rad, travel_rad)) &&
                      detail::is_at_least(config.minimum_speed_rad_s, state.smoothed_speed_rad_s);
  if (!torque_usable || !expected_usable || !angle_known) {
    detail::count_up_to(state.samples_without_update, 1);
    detail::take_long_rotation(config, state, output);
  } else if (!moving) {
    reading.status |= mask(StatusFlag::at_rest);
    detail::take_long_rotation(config, state, output);
  } else {
    detail::take_output(config, state, output);
    if (by_angle) {
      state.frame = now;
    }
    reading.status |=
        detail::update(config, state, output,
                       sample.measured_torque_Nm - sample.expected_torque_Nm - reading.ripple_Nm);
    state.samples_without_update = 0;
    state.rotated_without_update = false;
  }
  if (!by_angle) {
    reading.status |= detail::take_rotation(config, state, sample.motor_speed_rad_s);
  }
  record(state.counters, reading.status);
  return reading;
}

/// The state in the paper's frame, its pending rotation applied: x(k+1) and P(k+1) of eq. (12) and
/// (14) after step k with RotationSource::speed.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterState<Real, MaxOrders> predicted(
    const OscillatorFilterConfig<Real, MaxOrders>& config,
    OscillatorFilterState<Real, MaxOrders> state) {
  CosSin<Real> output[MaxOrders] = {};
  detail::output_now(config, state, state.frame, output);
  detail::rotate(active_orders(config), state, output);
  for (CosSin<Real>& each : output) {
    each = {Real(1), Real(0)};
  }
  detail::take_output(config, state, output);
  return state;
}

}  // namespace strainwave
