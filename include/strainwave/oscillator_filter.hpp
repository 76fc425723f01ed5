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
///
/// Structure used: the transition is one 2x2 rotation per order, the output row is 1 0 1 0 ..., and
/// the covariance is symmetric because only one triangle of it is stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/gear.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

enum class RotationSource : std::uint8_t {
  speed,  ///< rotation from sample k to k+1 is speed[k] x sample period, as published
  angle,  ///< rotation from sample k-1 to k is the difference of the motor's phases
};

template <class Real, std::size_t MaxOrders>
struct OscillatorFilterConfig {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxOrders > 0, "strainwave: MaxOrders must be at least 1");

  std::size_t order_count = 1;
  Order orders[MaxOrders] = {{2, 1}};  ///< cycles per motor turn
  /// Variance each state of an order gains per sample: Q of eq. (11) is this times the identity in
  /// the order's block.  Equal for both states, because a rotation must not prefer a phase.
  Real process_noise_variance_Nm2[MaxOrders] = {Real(1e-5)};
  Real measurement_noise_variance_Nm2 = Real(1);  ///< R of eq. (11)
  Real initial_variance_Nm2 = Real(1);            ///< P(0) is this times the identity
  Real sample_period_s = Real(1e-3);  ///< T_s of eq. (10); used with RotationSource::speed
  RotationSource rotation_source = RotationSource::speed;
  /// Protection at rest: no update until the motor has travelled this far since the last one.
  /// Without it the covariance grows without bound at standstill, and the first motion afterwards
  /// throws the states.  0: off.
  Real minimum_travel_rad = Real(1e-3);
  /// Protection at rest where the reading of the motor is not still: no update below this speed,
  /// smoothed over 50 ms.  An encoder that dithers between two counts and the noise of a tachometer
  /// travel without moving.  0: off.
  Real minimum_speed_rad_s = Real(0.5);
  /// Protection at crawl: no variance above this many times the order's process noise, nor above
  /// the initial variance where that is more.  0: off.
  Real variance_limit_ratio = Real(1e5);
};

/// x(k) and P(k) of eq. (9) and (14), and what the sample path has to remember.
template <class Real, std::size_t MaxOrders>
struct OscillatorFilterState {
  static constexpr std::size_t max_states = 2 * MaxOrders;

  Real states_Nm[max_states] = {};
  /// Lower triangle of P by rows: element (i, j), j <= i, at i (i + 1) / 2 + j.
  Real covariance_Nm2[max_states * (max_states + 1) / 2] = {};
  /// Rotation of the motor since the frame of `states_Nm`, applied with the next update.
  Real pending_rotation_rad = Real(0);
  Phase frame = {};  ///< motor phase of `states_Nm`, used with RotationSource::angle
  bool frame_known = false;
  std::uint32_t samples_without_update = 0;  ///< rejected or missing since the last update
  Real last_speed_rad_s = Real(0);
  Real smoothed_speed_rad_s = Real(0);
  Phase last_phase = {};                  ///< of the last sample with a phase
  std::uint32_t samples_since_phase = 0;  ///< missing or without a phase since then
  Real last_torque_Nm = Real(0);
  EventCounters counters = {};
};

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

/// Orders in use; never more than there is room for, even in a configuration that nobody checked.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr std::size_t active_orders(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  return config.order_count < MaxOrders ? config.order_count : MaxOrders;
}

namespace detail {

/// Most samples without an update that count; more would only repeat what the limit says.
inline constexpr std::uint32_t most_samples_without_update = 1U << 20U;
/// Most missing samples whose rotation is carried on at the last speed.
inline constexpr std::uint32_t most_carried_samples = 64;

/// Variances beyond these would overflow or vanish in float, in either precision's configuration.
inline constexpr float smallest_variance_Nm2 = 1e-30F;
inline constexpr float largest_variance_Nm2 = 1e30F;
/// A turn of the motor at this order, and a sample's rotation, stay within what can be reduced.
inline constexpr std::int32_t largest_order = 1000;

template <class Real>
[[nodiscard]] constexpr bool is_usable_variance(Real variance_Nm2) {
  return variance_Nm2 >= Real(smallest_variance_Nm2) && variance_Nm2 <= Real(largest_variance_Nm2);
}

/// Adds samples to a counter that ends at most_samples_without_update.
constexpr void count_up_to(std::uint32_t& counter, std::uint32_t samples) {
  const std::uint32_t room = most_samples_without_update - counter;
  counter += samples < room ? samples : room;
}

[[nodiscard]] constexpr std::size_t packed_index(std::size_t row, std::size_t column) {
  return row * (row + 1) / 2 + column;
}

/// Phi_i of eq. (10) applied to one order's pair of states.
template <class Real>
constexpr void rotate_pair(Real& first, Real& second, const CosSin<Real>& turn) {
  const Real rotated = turn.cosine * first + turn.sine * second;
  second = turn.cosine * second - turn.sine * first;
  first = rotated;
}

/// x <- Phi x and P <- Phi P Phi', block by block.
template <class Real, std::size_t MaxOrders>
constexpr void rotate(std::size_t order_count, OscillatorFilterState<Real, MaxOrders>& state,
                      const CosSin<Real>* turns) {
  Real* const p = state.covariance_Nm2;
  for (std::size_t a = 0; a < order_count; ++a) {
    const CosSin<Real> turn = turns[a];
    rotate_pair(state.states_Nm[2 * a], state.states_Nm[2 * a + 1], turn);
    Real* const upper = p + packed_index(2 * a, 0);
    Real* const lower = p + packed_index(2 * a + 1, 0);
    for (std::size_t b = 0; b < a; ++b) {
      rotate_pair(upper[2 * b], lower[2 * b], turn);
      rotate_pair(upper[2 * b + 1], lower[2 * b + 1], turn);
      rotate_pair(upper[2 * b], upper[2 * b + 1], turns[b]);
      rotate_pair(lower[2 * b], lower[2 * b + 1], turns[b]);
    }
    const Real p00 = upper[2 * a];
    const Real p10 = lower[2 * a];
    const Real p11 = lower[2 * a + 1];
    const Real cc = turn.cosine * turn.cosine;
    const Real cs = turn.cosine * turn.sine;
    const Real ss = turn.sine * turn.sine;
    upper[2 * a] = cc * p00 + Real(2) * cs * p10 + ss * p11;
    lower[2 * a] = (cc - ss) * p10 + cs * (p11 - p00);
    lower[2 * a + 1] = ss * p00 - Real(2) * cs * p10 + cc * p11;
  }
}

/// Scales an order's rows and columns of P so that its variances end at the limit; a congruence,
/// which leaves P positive definite.
template <class Real, std::size_t MaxOrders>
inline bool limit_variance(const OscillatorFilterConfig<Real, MaxOrders>& config,
                           OscillatorFilterState<Real, MaxOrders>& state) {
  bool limited = false;
  Real* const p = state.covariance_Nm2;
  const std::size_t state_count = 2 * active_orders(config);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    Real limit = config.variance_limit_ratio * config.process_noise_variance_Nm2[a];
    limit = limit > config.initial_variance_Nm2 ? limit : config.initial_variance_Nm2;
    const Real first = p[packed_index(2 * a, 2 * a)];
    const Real second = p[packed_index(2 * a + 1, 2 * a + 1)];
    const Real larger = first > second ? first : second;
    if (!(larger > limit)) {
      continue;
    }
    limited = true;
    const Real scale = square_root(limit / larger);
    for (std::size_t i = 2 * a; i < 2 * a + 2; ++i) {
      for (std::size_t j = 0; j < state_count; ++j) {
        p[i >= j ? packed_index(i, j) : packed_index(j, i)] *= scale;
      }
      p[packed_index(i, i)] *= scale;
    }
    // The element shared by both rows was scaled with each of them, as it has to be.
  }
  return limited;
}

template <class Real, std::size_t MaxOrders>
constexpr void reset_covariance(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                OscillatorFilterState<Real, MaxOrders>& state) {
  const std::size_t state_count = 2 * active_orders(config);
  for (std::size_t i = 0; i < state_count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      state.covariance_Nm2[packed_index(i, j)] = i == j ? config.initial_variance_Nm2 : Real(0);
    }
  }
}

/// Eq. (12) to (14) without the rotation, which comes with the next sample: gain, states and
/// covariance after the measurement, plus the process noise.  Returns limits that acted.
template <class Real, std::size_t MaxOrders>
inline Status update(const OscillatorFilterConfig<Real, MaxOrders>& config,
                     OscillatorFilterState<Real, MaxOrders>& state, Real innovation_Nm) {
  const std::size_t state_count = 2 * active_orders(config);
  Real* const p = state.covariance_Nm2;
  Real covariance_with_output[2 * MaxOrders] = {};  // P C'
  for (std::size_t i = 0; i < state_count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const Real element = p[packed_index(i, j)];
      if (i % 2 == 0) {
        covariance_with_output[j] += element;
      }
      if (j % 2 == 0 && j != i) {
        covariance_with_output[i] += element;
      }
    }
  }
  Real innovation_variance = config.measurement_noise_variance_Nm2;
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    innovation_variance += covariance_with_output[2 * a];
  }
  if (!(innovation_variance >= config.measurement_noise_variance_Nm2) ||
      !is_finite(innovation_variance)) {
    // C P C' < 0: rounding has cost P its sign.  The states are kept.
    reset_covariance(config, state);
    return mask(StatusFlag::covariance_reset);
  }
  const Real per_variance = Real(1) / innovation_variance;
  for (std::size_t i = 0; i < state_count; ++i) {
    const Real gain = covariance_with_output[i] * per_variance;
    state.states_Nm[i] += gain * innovation_Nm;
    for (std::size_t j = 0; j <= i; ++j) {
      p[packed_index(i, j)] -= gain * covariance_with_output[j];
    }
  }
  const Real samples = static_cast<Real>(state.samples_without_update) + Real(1);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const Real gained = samples * config.process_noise_variance_Nm2[a];
    p[packed_index(2 * a, 2 * a)] += gained;
    p[packed_index(2 * a + 1, 2 * a + 1)] += gained;
  }
  if (config.variance_limit_ratio > Real(0) && limit_variance(config, state)) {
    return mask(StatusFlag::variance_limited);
  }
  return 0;
}

/// Rotation of every order since the frame of the states.
template <class Real, std::size_t MaxOrders>
constexpr void turns_since_frame(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                 const OscillatorFilterState<Real, MaxOrders>& state, Phase now,
                                 CosSin<Real>* turns) {
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    if (config.rotation_source == RotationSource::angle) {
      // Differences of exact phases: what one rounds down, the next rounds up; nothing drifts.
      turns[a] = cos_sin_of_fraction<Real>(order_fraction(now, config.orders[a]) -
                                           order_fraction(state.frame, config.orders[a]));
    } else {
      turns[a] = cos_sin_of_radians(to_real<Real>(config.orders[a]) * state.pending_rotation_rad);
    }
  }
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

/// Says where an order turns over half a cycle from one sample to the next.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Status nyquist_status(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                              Real rotation_rad) {
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    if (absolute(to_real<Real>(config.orders[a]) * rotation_rad) > pi<Real>) {
      return mask(StatusFlag::order_above_nyquist);
    }
  }
  return 0;
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
  bool usable = is_finite(speed_rad_s);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const Real turned_rad =
        absolute(to_real<Real>(config.orders[a]) * (speed_rad_s * config.sample_period_s));
    usable = usable && turned_rad <= Real(largest_rotation_rad);
  }
  if (usable) {
    state.last_speed_rad_s = speed_rad_s;
  }
  // A motor does not stop within a sample: the last known speed is the better guess.
  const Real rotation_rad = state.last_speed_rad_s * config.sample_period_s;
  state.pending_rotation_rad += rotation_rad;
  smooth_speed(config, state, state.last_speed_rad_s);
  return usable ? nyquist_status(config, rotation_rad) : mask(StatusFlag::rotation_invalid);
}

/// Applies the pending rotation without an update once it passes a turn, so that it stays small
/// however many samples are rejected in a row.
template <class Real, std::size_t MaxOrders>
constexpr void apply_long_rotation(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                   OscillatorFilterState<Real, MaxOrders>& state) {
  if (absolute(state.pending_rotation_rad) > two_pi<Real>) {
    CosSin<Real> turns[MaxOrders] = {};
    turns_since_frame(config, state, Phase{}, turns);
    rotate(active_orders(config), state, turns);
    state.pending_rotation_rad = Real(0);
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
  detail::count_up_to(state.samples_without_update, samples);
  detail::count_up_to(state.samples_since_phase, samples);
  if (config.rotation_source == RotationSource::speed) {
    // Past the first few the phase is a guess; bounded, so that a gap costs bounded time.
    const std::uint32_t carried =
        samples < detail::most_carried_samples ? samples : detail::most_carried_samples;
    for (std::uint32_t i = 0; i < carried; ++i) {
      (void)detail::take_rotation(config, state, state.last_speed_rad_s);
      detail::apply_long_rotation(config, state);
    }
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
  if (!angle_known) {
    reading.status |= mask(StatusFlag::rotation_invalid);
    detail::count_up_to(state.samples_since_phase, 1);
  } else if (by_angle) {
    reading.status |= detail::take_phase(config, state, sample.motor_phase);
  }
  const Phase now = angle_known ? sample.motor_phase : state.frame;
  CosSin<Real> turns[MaxOrders] = {};
  detail::turns_since_frame(config, state, now, turns);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    reading.ripple_Nm +=
        turns[a].cosine * state.states_Nm[2 * a] + turns[a].sine * state.states_Nm[2 * a + 1];
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
  const bool moving = absolute(travel_rad) >= config.minimum_travel_rad &&
                      absolute(state.smoothed_speed_rad_s) >= config.minimum_speed_rad_s;
  if (!torque_usable || !expected_usable || !angle_known) {
    detail::count_up_to(state.samples_without_update, 1);
    detail::apply_long_rotation(config, state);
  } else if (!moving) {
    reading.status |= mask(StatusFlag::at_rest);
  } else {
    detail::rotate(active_orders(config), state, turns);
    state.frame = now;
    state.pending_rotation_rad = Real(0);
    reading.status |= detail::update(
        config, state, sample.measured_torque_Nm - sample.expected_torque_Nm - reading.ripple_Nm);
    state.samples_without_update = 0;
  }
  if (!by_angle) {
    reading.status |= detail::take_rotation(config, state, sample.motor_speed_rad_s);
  }
  record(state.counters, reading.status);
  return reading;
}

/// The state with its pending rotation applied: x(k+1) and P(k+1) of eq. (12) and (14) after step k
/// with RotationSource::speed.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterState<Real, MaxOrders> predicted(
    const OscillatorFilterConfig<Real, MaxOrders>& config,
    OscillatorFilterState<Real, MaxOrders> state) {
  if (config.rotation_source == RotationSource::speed) {
    CosSin<Real> turns[MaxOrders] = {};
    detail::turns_since_frame(config, state, Phase{}, turns);
    detail::rotate(active_orders(config), state, turns);
    state.pending_rotation_rad = Real(0);
  }
  return state;
}

/// The same configuration in another precision or capacity; the capacity must hold its orders.
template <class Real, std::size_t MaxOrders, class FromReal, std::size_t FromMaxOrders>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, MaxOrders> converted(
    const OscillatorFilterConfig<FromReal, FromMaxOrders>& from) {
  OscillatorFilterConfig<Real, MaxOrders> to;
  to.order_count = from.order_count;
  for (std::size_t a = 0; a < from.order_count && a < MaxOrders; ++a) {
    to.orders[a] = from.orders[a];
    to.process_noise_variance_Nm2[a] = static_cast<Real>(from.process_noise_variance_Nm2[a]);
  }
  to.measurement_noise_variance_Nm2 = static_cast<Real>(from.measurement_noise_variance_Nm2);
  to.initial_variance_Nm2 = static_cast<Real>(from.initial_variance_Nm2);
  to.sample_period_s = static_cast<Real>(from.sample_period_s);
  to.rotation_source = from.rotation_source;
  to.minimum_travel_rad = static_cast<Real>(from.minimum_travel_rad);
  to.minimum_speed_rad_s = static_cast<Real>(from.minimum_speed_rad_s);
  to.variance_limit_ratio = static_cast<Real>(from.variance_limit_ratio);
  return to;
}

/// A configuration for a list of orders, each with the default tuning:
/// `with_orders<float>({{2, 1}, {4, 1}})`.
template <class Real, std::size_t Count>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, Count> with_orders(
    const Order (&orders)[Count]) {
  OscillatorFilterConfig<Real, Count> config;
  const Real process_noise_variance_Nm2 = config.process_noise_variance_Nm2[0];
  config.order_count = Count;
  for (std::size_t a = 0; a < Count; ++a) {
    config.orders[a] = orders[a];
    config.process_noise_variance_Nm2[a] = process_noise_variance_Nm2;
  }
  return config;
}

/// The filter of section V and nothing else: orders 2 and 4, Q = 1e3 I, R = 1, P(0) = 1e3 I,
/// x(0) = 0, T_s = 1 ms, rotation by speed[k] T_s, no protection.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, MaxOrders> taghirad1999_4() {
  static_assert(MaxOrders >= 2, "strainwave: taghirad1999-4 needs MaxOrders of at least 2");
  OscillatorFilterConfig<Real, MaxOrders> config;
  config.order_count = 2;
  config.orders[0] = {2, 1};
  config.orders[1] = {4, 1};
  config.process_noise_variance_Nm2[0] = Real(1e3);
  config.process_noise_variance_Nm2[1] = Real(1e3);
  config.initial_variance_Nm2 = Real(1e3);
  config.minimum_travel_rad = Real(0);
  config.minimum_speed_rad_s = Real(0);
  config.variance_limit_ratio = Real(0);
  return config;
}

/// The filter of section VI: that of section V and the misalignment at order 1/ratio.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorFilterConfig<Real, MaxOrders> taghirad1999(Rational ratio) {
  static_assert(MaxOrders >= 3, "strainwave: taghirad1999 needs MaxOrders of at least 3");
  OscillatorFilterConfig<Real, MaxOrders> config = taghirad1999_4<Real, MaxOrders>();
  config.order_count = 3;
  config.orders[2] = inverse(ratio);
  config.process_noise_variance_Nm2[2] = Real(1e3);
  return config;
}

template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Violation<Real> check(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  if (config.order_count < 1 || config.order_count > MaxOrders) {
    return {"orders", -1, static_cast<Real>(config.order_count), "orders",
            "at least one, and no more than the compiled capacity"};
  }
  for (std::size_t a = 0; a < config.order_count; ++a) {
    const auto index = static_cast<std::int32_t>(a);
    if (!is_valid(config.orders[a])) {
      return {"orders", index, Real(0), "cycles per motor turn",
              "a ratio of whole numbers from 1 to 2^31 - 1"};
    }
    if (to_real<Real>(config.orders[a]) > Real(detail::largest_order)) {
      return {"orders", index, to_real<Real>(config.orders[a]), "cycles per motor turn",
              "at most 1000"};
    }
    for (std::size_t b = 0; b < a; ++b) {
      if (std::uint64_t{config.orders[b].numerator} * config.orders[a].denominator ==
          std::uint64_t{config.orders[a].numerator} * config.orders[b].denominator) {
        return {"orders", index, to_real<Real>(config.orders[a]), "cycles per motor turn",
                "each order once"};
      }
    }
    const Real variance = config.process_noise_variance_Nm2[a];
    if (!(variance >= Real(0)) || variance > Real(detail::largest_variance_Nm2)) {
      return {"process_noise_variance_Nm2", index, variance, "Nm^2", "a number from 0 to 1e30"};
    }
  }
  if (!detail::is_usable_variance(config.measurement_noise_variance_Nm2)) {
    return {"measurement_noise_variance_Nm2", -1, config.measurement_noise_variance_Nm2, "Nm^2",
            "a number from 1e-30 to 1e30"};
  }
  if (!detail::is_usable_variance(config.initial_variance_Nm2)) {
    return {"initial_variance_Nm2", -1, config.initial_variance_Nm2, "Nm^2",
            "a number from 1e-30 to 1e30"};
  }
  if (!(config.sample_period_s >= Real(1e-9F)) || config.sample_period_s > Real(1e3F)) {
    return {"sample_period_s", -1, config.sample_period_s, "s", "a number from 1e-9 to 1000"};
  }
  if (!is_finite(config.minimum_travel_rad) || config.minimum_travel_rad < Real(0) ||
      config.minimum_travel_rad > Real(1)) {
    return {"minimum_travel_rad", -1, config.minimum_travel_rad, "rad", "0 (off) to 1"};
  }
  if (!is_finite(config.minimum_speed_rad_s) || config.minimum_speed_rad_s < Real(0) ||
      config.minimum_speed_rad_s > Real(100)) {
    return {"minimum_speed_rad_s", -1, config.minimum_speed_rad_s, "rad/s", "0 (off) to 100"};
  }
  if (!is_finite(config.variance_limit_ratio) ||
      (config.variance_limit_ratio < Real(100) && config.variance_limit_ratio != Real(0))) {
    return {"variance_limit_ratio", -1, config.variance_limit_ratio, "", "0 (off) or at least 100"};
  }
  return {};
}

}  // namespace strainwave
