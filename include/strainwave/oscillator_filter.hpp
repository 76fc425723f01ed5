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

template <class Real>
inline constexpr Real largest_rotation_turns = Real(largest_rotation_rad) / two_pi<Real>;

/// Most samples at once whose process noise counts; more would only repeat what the limit says.
inline constexpr std::uint32_t most_samples_without_update = 1U << 20U;
/// Most missing samples whose rotation is carried on at the last speed.
inline constexpr std::uint32_t most_carried_samples = 64;

[[nodiscard]] constexpr std::uint32_t at_most(std::uint32_t limit, std::uint32_t value) {
  return value < limit ? value : limit;
}

/// Adds samples to a counter that ends at most_samples_without_update.
constexpr void count_up_to(std::uint32_t& counter, std::uint32_t samples) {
  counter += at_most(most_samples_without_update - counter, samples);
}

/// The output row at the present angle.  An order that is twice another one costs no cosine.
template <class Real, std::size_t MaxOrders>
constexpr void output_now(const OscillatorFilterConfig<Real, MaxOrders>& config,
                          const OscillatorFilterState<Real, MaxOrders>& state, Phase now,
                          Real* output) {
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    CosSin<Real> wave = {};
    if (const std::size_t b = half_of(config, a); b < a) {
      wave = doubled(CosSin<Real>{output[2 * b], output[2 * b + 1]});
    } else if (config.rotation_source == RotationSource::angle) {
      wave = cos_sin_of_fraction<Real>(order_fraction(now, config.orders[a]));
    } else {
      wave = cos_sin_of_fraction<Real>(state.angle[a]);
    }
    output[2 * a] = wave.cosine;
    output[2 * a + 1] = wave.sine;
  }
}

/// Time over which the speed is smoothed before it is compared with minimum_speed_rad_s, s.
inline constexpr float speed_smoothing_s = 0.05F;

template <class Real, std::size_t MaxOrders>
constexpr void smooth_speed(const OscillatorFilterConfig<Real, MaxOrders>& config,
                            OscillatorFilterState<Real, MaxOrders>& state, Real speed_rad_s) {
  if (config.minimum_speed_rad_s == Real(0)) {  // nobody waits for it to be still
    state.smoothed_speed_rad_s = speed_rad_s;
    return;
  }
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

/// Rotation of the motor from a sample to the next, turns.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real turns_of(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                      Real speed_rad_s) {
  return speed_rad_s * (config.sample_period_s / two_pi<Real>);
}

/// Turns every order's angle on by a rotation of the motor; `short_of_a_cycle` where no order turns
/// a whole cycle.
template <class Real, std::size_t MaxOrders>
constexpr void turn_on(const OscillatorFilterConfig<Real, MaxOrders>& config,
                       OscillatorFilterState<Real, MaxOrders>& state, Real motor_turns,
                       bool short_of_a_cycle) {
  using Fraction = OscillatorFilterState<Real, MaxOrders>::Fraction;
  using Signed = std::make_signed_t<Fraction>;
  constexpr Real half_range = Real(2) * static_cast<Real>(Fraction{1} << (sizeof(Real) * 8 - 2));
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    if (half_of(config, a) < a) {
      continue;
    }
    Real cycles = to_real<Real>(config.orders[a]) * motor_turns;
    if (!short_of_a_cycle) {
      cycles -= static_cast<Real>(static_cast<std::int32_t>(cycles));
    }
    state.angle[a] += 2U * static_cast<Fraction>(static_cast<Signed>(cycles * half_range));
  }
}

/// Adds samples at the last speed to the travel, where somebody asks for it.
template <class Real, std::size_t MaxOrders>
constexpr void add_travel(const OscillatorFilterConfig<Real, MaxOrders>& config,
                          OscillatorFilterState<Real, MaxOrders>& state, Real samples) {
  if (config.minimum_travel_rad > Real(0)) {
    state.travel_rad += samples * (state.last_speed_rad_s * config.sample_period_s);
  }
}

/// Whether a magnitude reaches a limit; 0 is no limit.
template <class Real>
[[nodiscard]] constexpr bool is_at_least(Real limit, Real value) {
  return limit == Real(0) || absolute(value) >= limit;
}

/// Carries the rotation on at the last speed over samples that never arrived, all at once, so that
/// a long gap costs no more than a short one.
template <class Real, std::size_t MaxOrders>
constexpr void carry_rotation(const OscillatorFilterConfig<Real, MaxOrders>& config,
                              OscillatorFilterState<Real, MaxOrders>& state,
                              std::uint32_t samples) {
  // Past the first few the phase is a guess.
  const auto carried = static_cast<Real>(at_most(most_carried_samples, samples));
  const Real motor_turns = carried * turns_of(config, state.last_speed_rad_s);
  if (absolute(highest_order(config) * motor_turns) <= largest_rotation_turns<Real>) {
    turn_on(config, state, motor_turns, false);
    add_travel(config, state, carried);
  }
  const Real gap_s = carried * config.sample_period_s;
  state.smoothed_speed_rad_s += gap_s / (gap_s + static_cast<Real>(speed_smoothing_s)) *
                                (state.last_speed_rad_s - state.smoothed_speed_rad_s);
}

/// Takes in the rotation from this sample to the next, eq. (10) with speed[k] T_s.
template <class Real, std::size_t MaxOrders>
constexpr Status take_rotation(const OscillatorFilterConfig<Real, MaxOrders>& config,
                               OscillatorFilterState<Real, MaxOrders>& state, Real speed_rad_s) {
  const Real motor_turns = turns_of(config, speed_rad_s);
  const Real highest_turns = absolute(highest_order(config) * motor_turns);
  if (highest_turns <= Real(0.5)) [[likely]] {
    state.last_speed_rad_s = speed_rad_s;
    turn_on(config, state, motor_turns, true);
    return 0;
  }
  if (highest_turns <= largest_rotation_turns<Real>) {
    state.last_speed_rad_s = speed_rad_s;
    turn_on(config, state, motor_turns, false);
    return mask(StatusFlag::order_above_nyquist);
  }
  // Or not a number.  A motor does not stop within a sample: the last known speed is the better
  // guess.
  turn_on(config, state, turns_of(config, state.last_speed_rad_s), false);
  return mask(StatusFlag::rotation_invalid);
}

/// Whether both torques are usable, in one comparison; false says nothing yet.
template <class Real>
[[nodiscard]] constexpr bool are_sound(Real measured_torque_Nm, Real expected_torque_Nm) {
  return is_usable_torque(absolute(measured_torque_Nm) + absolute(expected_torque_Nm));
}

/// What is wrong with a sample's torques.
template <class Real>
[[nodiscard]] constexpr Status torque_status(const OscillatorSample<Real>& sample) {
  Status status = 0;
  if (sample.torque_valid && !is_usable_torque(sample.measured_torque_Nm)) {
    status |= mask(StatusFlag::torque_not_finite);
  }
  if (!is_usable_torque(sample.expected_torque_Nm)) {
    status |= mask(StatusFlag::expected_torque_not_finite);
  }
  return status;
}

/// Whether the motor has moved since the last update, and still does.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr bool is_moving(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                       const OscillatorFilterState<Real, MaxOrders>& state,
                                       Phase now) {
  const Real travel_rad = config.rotation_source == RotationSource::angle
                              ? to_radians<Real>(now - state.frame)
                              : state.travel_rad;
  return is_at_least(config.minimum_travel_rad, travel_rad) &&
         is_at_least(config.minimum_speed_rad_s, state.smoothed_speed_rad_s);
}

/// Travel is measured from here on.
template <class Real, std::size_t MaxOrders>
constexpr void begin_travel(const OscillatorFilterConfig<Real, MaxOrders>& config,
                            OscillatorFilterState<Real, MaxOrders>& state, Phase now) {
  if (config.rotation_source == RotationSource::angle) {
    state.frame = now;
  } else if (config.minimum_travel_rad > Real(0)) {
    state.travel_rad = Real(0);
  }
}

}  // namespace detail

/// x(0) = 0, P(0) = initial variance x I.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterState<Real, MaxOrders> initial_state(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  OscillatorFilterState<Real, MaxOrders> state;
  detail::reset_covariance(config, state);
  return state;
}

/// Passes over samples that never arrived: with RotationSource::speed the last speed carries on.
template <class Real, std::size_t MaxOrders>
constexpr void skip(const OscillatorFilterConfig<Real, MaxOrders>& config,
                    OscillatorFilterState<Real, MaxOrders>& state, std::uint32_t samples) {
  detail::add_process_noise(
      config, state,
      static_cast<Real>(detail::at_most(detail::most_samples_without_update, samples)));
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
  Real output[detail::column_length(2 * MaxOrders)] = {};
  detail::output_now(config, state, now, output);
  Real states_Nm[2 * MaxOrders] = {};
  for (std::size_t i = 0; i < 2 * active_orders(config); ++i) {
    states_Nm[i] = detail::passing(state.states_Nm[i]);
  }
  reading.ripple_Nm =
      detail::sum_of_products(2 * active_orders(config), states_Nm, output, Real(0));
  const bool moving = detail::is_moving(config, state, now);
  if (!by_angle) {
    reading.status |= detail::take_rotation(config, state, sample.motor_speed_rad_s);
    detail::smooth_speed(config, state, state.last_speed_rad_s);
  }
  bool learns = sample.torque_valid && (reading.status & fault_mask) == 0U;
  if (!detail::are_sound(sample.measured_torque_Nm, sample.expected_torque_Nm)) [[unlikely]] {
    reading.status |= detail::torque_status(sample);
    learns = learns && (reading.status & fault_mask) == 0U;
  }
  if (learns) [[likely]] {
    state.last_torque_Nm = sample.measured_torque_Nm - reading.ripple_Nm;
    if (moving) {
      detail::begin_travel(config, state, now);
      reading.status |=
          detail::update(config, state, output, state.last_torque_Nm - sample.expected_torque_Nm);
    } else {
      reading.status |= mask(StatusFlag::at_rest);
    }
  } else {
    if (sample.torque_valid && !has(reading.status, StatusFlag::torque_not_finite)) {
      state.last_torque_Nm = sample.measured_torque_Nm - reading.ripple_Nm;
    }
    detail::add_process_noise(config, state, Real(1));
  }
  if (!by_angle) {
    detail::add_travel(config, state, Real(1));  // of the rotation to the next sample
  }
  reading.torque_Nm = state.last_torque_Nm;
  record(state.counters, reading.status);
  return reading;
}

/// The state in the paper's frame: x(k+1) and P(k+1) of eq. (12) and (14) after step k with
/// RotationSource::speed.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterState<Real, MaxOrders> predicted(
    const OscillatorFilterConfig<Real, MaxOrders>& config,
    OscillatorFilterState<Real, MaxOrders> state) {
  Real output[2 * MaxOrders] = {};
  detail::output_now(config, state, state.frame, output);
  detail::rotate(active_orders(config), state, output);
  for (auto& each : state.angle) {
    each = 0;
  }
  return state;
}

}  // namespace strainwave
