// SPDX-License-Identifier: Apache-2.0
/// @file ripple_state.hpp
/// What the ripple filter remembers, and how a measurement changes it.
///
/// State [T; c]: true torque, a random walk in time, and the ripple's coefficients, a random walk
/// in motor angle.  The coefficients belong to the angle, so nothing has to be turned: at rest,
/// through a reversal and across a gap they stay what they are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/angle_history.hpp"
#include "strainwave/ripple_config.hpp"
#include "strainwave/ripple_covariance.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <class Real, std::size_t MaxPairs>
struct RippleFilterState {
  static constexpr std::size_t max_states = 1 + 2 * MaxPairs;

  Real states_Nm[max_states] = {};  ///< T, then cosine and sine of each pair
  RippleCovariance<Real, MaxPairs> covariance = {};
  Real waiting_Nm2[MaxPairs] = {};  ///< process noise that a pair has gained and not yet been given
  std::size_t next_pair = 0;        ///< that is given its process noise; one a sample
  Real innovation_scale_Nm = Real(0);  ///< exceeded by three innovations in ten while moving
  bool torque_known = false;           ///< a first torque has been taken in

  AngleHistory<Real> history = {};
  Phase last_phase = {};  ///< of the last sample with an angle
  bool phase_known = false;
  Real time_since_phase_s = Real(0);
  Real speed_rad_s = Real(0);           ///< smoothed over 10 ms, for the speed terms
  Real smoothed_speed_rad_s = Real(0);  ///< smoothed over 50 ms: is the motor moving?
  Real load_Nm = Real(0);               ///< torque without ripple, low-passed at 15 Hz

  Phase learned_phase = {};                   ///< compensated phase of the last update
  CosSin<Real> learned_waves[MaxPairs] = {};  ///< cosine and sine of each order there
  bool learned_phase_known = false;
  Real time_since_update_s = Real(0);
  Real typical_interval_s = Real(0);  ///< from update to update, smoothed over about 64

  Real measured_Nm = Real(0);    ///< last usable measurement
  Real torque_Nm = Real(0);      ///< last good output
  Real torque_all_Nm = Real(0);  ///< last good output without any ripple
  EventCounters counters = {};
};

namespace detail {

/// An innovation beyond so many scales is taken for a jump of true torque.
inline constexpr float robust_limit = 3.0F;
/// The scale is tracked so that this share of innovations exceeds it, ...
inline constexpr float share_beyond_scale = 0.3F;
/// ... at this rate per radian of motor travel.
inline constexpr float scale_rate_per_rad = 0.06F;
/// Intervals beyond this say no more about the torque's wandering than this one, s.
inline constexpr float longest_torque_walk_s = 0.1F;
/// An interval of so many typical ones is a gap.
inline constexpr float least_gap = 2.0F;

/// What one sample looks like to the states: y - T_exp = x[0] + sum over h[i] x[i], h[0] = 1.
/// Filled as far as the counts say, and read no further: clearing the rest costs a microcontroller
/// more than an order does.
template <class Real, std::size_t MaxPairs>
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
struct Regressors {
  static constexpr std::size_t max_states = 1 + 2 * MaxPairs;

  std::size_t order_count = 0;
  std::size_t state_count = 1;
  CosSin<Real> waves[MaxPairs];  ///< of each order
  Real h[max_states];
};

template <class Real, std::size_t MaxPairs>
constexpr void set_variances(const RippleFilterConfig<Real, MaxPairs>& config,
                             RippleFilterState<Real, MaxPairs>& state) {
  set_uncorrelated(state.covariance, config.initial_amplitude_Nm * config.initial_amplitude_Nm);
  for (Real& each : state.waiting_Nm2) {
    each = Real(0);
  }
  state.torque_known = false;
}

/// The first torque: T is what the coefficients leave, and as uncertain as they and the noise are.
/// The limit of an infinite variance of T.
template <class Real, std::size_t MaxPairs>
constexpr void start_torque(const RippleFilterConfig<Real, MaxPairs>& config,
                            RippleFilterState<Real, MaxPairs>& state,
                            const Regressors<Real, MaxPairs>& sample, Real torque_Nm) {
  const std::size_t count = sample.state_count - 1;
  RippleCovariance<Real, MaxPairs>& p = state.covariance;
  project(p, count, sample.h + 1, p.torque_row);
  for (std::size_t j = 0; j < count; ++j) {
    p.torque_row[j] = -p.torque_row[j];
  }
  p.torque_variance_Nm2 = config.torque_noise_Nm * config.torque_noise_Nm;
  state.states_Nm[0] = torque_Nm;
  state.torque_known = true;
}

/// Variance that one order's coefficients gain with a rotation, so that the memory is n turns at
/// every speed and order,
///     Q = 2 R_eff (rotation / (2 pi n))^2,  R_eff = R + q_T dt / |wave - last wave|^2.
/// R_eff is the noise and what true torque has at the order's own frequency.  Over a gap it is that
/// of the typical intervals in it: a long way without a sample is not a way of great change.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real gained_variance(const RippleFilterConfig<Real, MaxPairs>& config,
                                             const RippleFilterState<Real, MaxPairs>& state,
                                             const Regressors<Real, MaxPairs>& sample,
                                             std::size_t order, Real rotation_rad) {
  const Real walk_Nm2_per_s = config.torque_walk_Nm_per_sqrt_s * config.torque_walk_Nm_per_sqrt_s;
  Real interval_s = state.time_since_update_s;
  Real intervals = Real(1);
  const Real cosine = sample.waves[order].cosine - state.learned_waves[order].cosine;
  const Real sine = sample.waves[order].sine - state.learned_waves[order].sine;
  Real chord = cosine * cosine + sine * sine;
  Real turned_rad = to_real<Real>(config.orders[order].order) * rotation_rad;
  if (state.typical_interval_s > Real(0) &&
      interval_s > static_cast<Real>(least_gap) * state.typical_interval_s) {
    intervals = interval_s / state.typical_interval_s;
    interval_s = state.typical_interval_s;
    turned_rad /= intervals;
    chord = turned_rad * turned_rad;
  }
  if (absolute(turned_rad) > pi<Real> || chord > Real(4)) {
    chord = Real(4);  // beyond half a cycle the chord says nothing; 4 is what white noise has
  }
  Real share = rotation_rad / (two_pi<Real> * config.memory_turns);
  share = share * share / intervals;
  share = share < Real(1) ? share : Real(1);
  const Real noise_Nm2 = config.torque_noise_Nm * config.torque_noise_Nm;
  // No rotation, no noise: share is 0 with it, and the quotient would be 0 / 0.
  return chord > Real(0) ? Real(2) * share * (noise_Nm2 + walk_Nm2_per_s * interval_s / chord)
                         : Real(0);
}

/// Gives one coefficient its process noise.  Returns whether its variance had to be limited: that
/// acts where a pair is hardly seen, as a load pair at constant load; before the noise, so that a
/// filter which has seen nothing yet is not said to be limited.
template <class Real, std::size_t MaxPairs, class Count>
inline bool give_noise(const RippleFilterConfig<Real, MaxPairs>& config,
                       RippleCovariance<Real, MaxPairs>& p, Count count, std::size_t i,
                       Real noise_Nm2) {
  const Real limit = config.initial_amplitude_Nm * config.initial_amplitude_Nm;
  const Real variance = variance_of(p, i);
  const bool limited = variance > limit;
  if (limited) {
    scale_deviation(p, count, i, square_root(limit / variance));
  }
  add_variance(p, count, i, noise_Nm2);
  return limited;
}

/// Process noise of the torque for an interval, and of the coefficients for a rotation.  An order's
/// is shared among its pairs, so that further terms do not shorten its memory.  One pair in turn is
/// given what it has gained since its last turn: the sum is the same, and a sample costs one change
/// of the factors and not one for each coefficient.
template <class Real, std::size_t MaxPairs>
inline Status predict(const RippleFilterConfig<Real, MaxPairs>& config,
                      RippleFilterState<Real, MaxPairs>& state,
                      const Regressors<Real, MaxPairs>& sample, Real rotation_rad, bool moving) {
  const Real longest_s = static_cast<Real>(longest_torque_walk_s);
  state.covariance.torque_variance_Nm2 +=
      config.torque_walk_Nm_per_sqrt_s * config.torque_walk_Nm_per_sqrt_s *
      (state.time_since_update_s < longest_s ? state.time_since_update_s : longest_s);
  if (!moving || !state.learned_phase_known) {
    return 0;
  }
  std::size_t pair = 0;
  for (std::size_t a = 0; a < sample.order_count; ++a) {
    const Real gained = gained_variance(config, state, sample, a, rotation_rad);
    const std::size_t its_end = pair + pairs_of(config.orders[a]);
    const std::size_t end = its_end < MaxPairs ? its_end : MaxPairs;
    Real weight = Real(0);
    for (std::size_t i = 2 * pair; i < 2 * end; ++i) {
      weight += sample.h[i + 1] * sample.h[i + 1];
    }
    for (const Real each = gained / weight; pair < end; ++pair) {
      state.waiting_Nm2[pair] += each;
    }
  }
  state.next_pair = state.next_pair + 1 < pair ? state.next_pair + 1 : 0;
  const std::size_t i = 2 * state.next_pair;
  const Real noise_Nm2 = state.waiting_Nm2[state.next_pair];
  const bool limited = with_count<2 * MaxPairs>(sample.state_count - 1, [&](auto count) {
    const bool first = give_noise(config, state.covariance, count, i, noise_Nm2);
    const bool second = give_noise(config, state.covariance, count, i + 1, noise_Nm2);
    return first || second;
  });
  state.waiting_Nm2[state.next_pair] = Real(0);
  return limited ? mask(StatusFlag::variance_limited) : Status{0};
}

/// What an update found and did, for diagnosis, for likelihoods and for the smoother.
template <class Real, std::size_t MaxPairs>
struct Innovation {
  Real innovation_Nm = Real(0);
  Real variance_Nm2 = Real(0);       ///< as expected, h'P h + R
  Real jump_variance_Nm2 = Real(0);  ///< by which T's was raised
  Real gains[1 + 2 * MaxPairs] = {};
  Status status = 0;
};

/// By how much T's variance is raised so that an innovation, in standard deviations of what is
/// expected, is at the limit.  The limit follows the innovations met lately, or what the
/// coefficients may still be wrong by where that is more: coefficients that are not known yet are
/// no contact.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real jump_variance(const RippleFilterState<Real, MaxPairs>& state,
                                           Real innovation_Nm, Real variance_Nm2,
                                           Real ripple_variance_Nm2) {
  const Real tracked_Nm2 = state.innovation_scale_Nm * state.innovation_scale_Nm;
  const Real limit_Nm2 = static_cast<Real>(robust_limit * robust_limit) *
                         (tracked_Nm2 > ripple_variance_Nm2 ? tracked_Nm2 : ripple_variance_Nm2);
  const Real ratio = (innovation_Nm / limit_Nm2) * innovation_Nm;
  if (!(ratio > Real(1))) {
    return Real(0);
  }
  // Beyond this nothing is left of the coefficients' gain, and float would overflow.
  const Real most = Real(1e12);
  return variance_Nm2 * ((ratio < most ? ratio : most) - Real(1));
}

/// Kalman update.  An unlikely innovation is taken for a jump of true torque, a contact: T's
/// variance is raised for this sample, T takes the jump at once, and the coefficients' gain falls
/// with the square of the excess.  At rest T alone is updated,
///     P <- P - g (P h)' - (P h) g' + s g g',  g = [P h / s of T; 0],
/// the covariance of exactly this gain: T's row as always, the coefficients' block untouched.
template <class Real, std::size_t MaxPairs, class Count>
constexpr Innovation<Real, MaxPairs> update_of(const RippleFilterConfig<Real, MaxPairs>& config,
                                               RippleFilterState<Real, MaxPairs>& state,
                                               const Regressors<Real, MaxPairs>& sample,
                                               Count count, Real innovation_Nm, bool moving) {
  RippleCovariance<Real, MaxPairs>& p = state.covariance;
  const Real noise_Nm2 = config.torque_noise_Nm * config.torque_noise_Nm;
  Real projected[RippleCovariance<Real, MaxPairs>::max_coefficients];
  project(p, count, sample.h + 1, projected);
  Real variance_Nm2 = noise_Nm2 + p.torque_variance_Nm2;
  Real torque_covariance_Nm2 = p.torque_variance_Nm2;
  Real ripple_variance_Nm2 = Real(0);
  for (std::size_t j = 0; j < count; ++j) {
    const Real seen = projected[j] + p.torque_row[j];
    variance_Nm2 += p.variances_Nm2[j] * seen * seen;
    torque_covariance_Nm2 += p.variances_Nm2[j] * p.torque_row[j] * seen;
    ripple_variance_Nm2 += p.variances_Nm2[j] * projected[j] * projected[j];
  }
  Innovation<Real, MaxPairs> result;
  if (!is_finite(variance_Nm2) || !(variance_Nm2 > Real(0))) {
    set_variances(config, state);
    result.status = mask(StatusFlag::covariance_reset);
    return result;
  }
  result.innovation_Nm = innovation_Nm;
  result.variance_Nm2 = variance_Nm2;
  if (moving) {
    result.jump_variance_Nm2 =
        jump_variance(state, innovation_Nm, variance_Nm2, ripple_variance_Nm2);
    p.torque_variance_Nm2 += result.jump_variance_Nm2;
    (void)measure(p, count, projected, noise_Nm2, result.gains);
    for (std::size_t i = 0; i <= count; ++i) {
      state.states_Nm[i] += result.gains[i] * innovation_Nm;
    }
    return result;
  }
  const Real gain = torque_covariance_Nm2 / variance_Nm2;
  result.gains[0] = gain;
  state.states_Nm[0] += gain * innovation_Nm;
  for (std::size_t j = 0; j < count; ++j) {
    p.torque_row[j] -= gain * (projected[j] + p.torque_row[j]);
  }
  const Real left = Real(1) - gain;
  p.torque_variance_Nm2 = left * left * p.torque_variance_Nm2 + gain * gain * noise_Nm2;
  return result;
}

template <class Real, std::size_t MaxPairs>
constexpr Innovation<Real, MaxPairs> update(const RippleFilterConfig<Real, MaxPairs>& config,
                                            RippleFilterState<Real, MaxPairs>& state,
                                            const Regressors<Real, MaxPairs>& sample,
                                            Real innovation_Nm, bool moving) {
  return with_count<2 * MaxPairs>(sample.state_count - 1, [&](auto count) {
    return update_of(config, state, sample, count, innovation_Nm, moving);
  });
}

/// Follows the scale of the innovations, per travelled angle, so that no change of it locks out.
template <class Real, std::size_t MaxPairs>
constexpr void track_scale(const RippleFilterConfig<Real, MaxPairs>& config,
                           RippleFilterState<Real, MaxPairs>& state, Real innovation_Nm,
                           Real rotation_rad) {
  const Real travel_rad = absolute(rotation_rad) < Real(3) ? absolute(rotation_rad) : Real(3);
  const bool beyond = absolute(innovation_Nm) > state.innovation_scale_Nm;
  const Real change = static_cast<Real>(scale_rate_per_rad) * travel_rad *
                      ((beyond ? Real(1) : Real(0)) - static_cast<Real>(share_beyond_scale));
  // exp(change) for |change| < 0.07
  state.innovation_scale_Nm *= Real(1) + change * (Real(1) + Real(0.5) * change);
  // A recording without noise would take the scale to 0, from where nothing comes back.
  const Real least_Nm = Real(0.5) * config.torque_noise_Nm;
  if (!(state.innovation_scale_Nm > least_Nm)) {
    state.innovation_scale_Nm = least_Nm;
  }
}

}  // namespace detail

}  // namespace strainwave
