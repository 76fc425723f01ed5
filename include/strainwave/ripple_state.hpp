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
  Real innovation_scale_Nm = Real(0);  ///< exceeded by three innovations in ten while moving
  bool torque_known = false;           ///< a first torque has been taken in

  AngleHistory<Real> history = {};
  Phase last_phase = {};  ///< of the last sample with an angle
  bool phase_known = false;
  Real time_since_phase_s = Real(0);
  Real speed_rad_s = Real(0);           ///< smoothed over 10 ms, for the speed terms
  Real smoothed_speed_rad_s = Real(0);  ///< smoothed over 50 ms: is the motor moving?
  Real load_Nm = Real(0);               ///< torque without ripple, low-passed at 15 Hz

  Phase learned_phase = {};  ///< compensated phase of the last update
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

/// What one sample looks like to the states: of each order, cosine and sine at its angle, and what
/// its further pairs are multiplied by.  Filled as far as there are orders, and read no further:
/// clearing the rest costs a microcontroller more than an order does.
template <class Real, std::size_t MaxPairs>
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
struct Regressors {
  std::size_t state_count = 1;
  OrderTerms<Real> terms[MaxPairs];
  CosSin<Real> waves[MaxPairs];
};

template <class Real, std::size_t MaxPairs>
constexpr void set_variances(const RippleFilterConfig<Real, MaxPairs>& config,
                             RippleFilterState<Real, MaxPairs>& state) {
  set_uncorrelated(state.covariance, config.initial_amplitude_Nm * config.initial_amplitude_Nm);
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
  for (Real& each : p.torque_row_Nm2) {
    each = Real(0);
  }
  SeenCovariance<Real, MaxPairs> seen;  // NOLINT(*-member-init): filled by what follows
  follow(config, p, count, sample.terms);
  enter_frame(config, p, sample.terms, sample.waves, seen.h);
  see(p, count, seen);
  Real row_Nm2[RippleCovariance<Real, MaxPairs>::row_length];  // NOLINT(*-member-init)
  measure_torque(p, count, seen, config.torque_noise_Nm * config.torque_noise_Nm, Real(0), row_Nm2);
  state.states_Nm[0] = torque_Nm;
  state.torque_known = true;
}

/// What the process noise of all orders has in common: the way since the last update, as a share of
/// the memory, and the interval.  Over a gap it is that of the typical intervals in it: a long way
/// without a sample is not a way of great change.
template <class Real>
struct Way {
  Real noise_Nm2 = Real(0);             ///< 2 R (rotation / (2 pi n))^2
  Real walk_Nm2 = Real(0);              ///< 2 q_T dt (rotation / (2 pi n))^2
  Real walk_per_square_Nm2 = Real(0);   ///< 2 q_T dt / (2 pi n)^2
  Real rotation_square_rad2 = Real(0);  ///< of one typical interval
};

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Way<Real> way_of(const RippleFilterConfig<Real, MaxPairs>& config,
                                         const RippleFilterState<Real, MaxPairs>& state,
                                         Real rotation_rad) {
  const Real per_memory_rad = Real(1) / (two_pi<Real> * config.memory_turns);
  Real interval_s = state.time_since_update_s;
  Real intervals = Real(1);
  Way<Real> way;
  way.rotation_square_rad2 = rotation_rad * rotation_rad;
  Real share = way.rotation_square_rad2 * (per_memory_rad * per_memory_rad);
  if (state.typical_interval_s > Real(0) &&
      interval_s > static_cast<Real>(least_gap) * state.typical_interval_s) {
    intervals = interval_s / state.typical_interval_s;
    interval_s = state.typical_interval_s;
    way.rotation_square_rad2 /= intervals * intervals;
    share /= intervals;
  }
  share = share < Real(1) ? share : Real(1);
  const Real walk_Nm2 =
      config.torque_walk_Nm_per_sqrt_s * config.torque_walk_Nm_per_sqrt_s * interval_s;
  way.noise_Nm2 = Real(2) * (config.torque_noise_Nm * config.torque_noise_Nm) * share;
  way.walk_Nm2 = Real(2) * walk_Nm2 * share;
  // No rotation, no noise.
  way.walk_per_square_Nm2 = share > Real(0)
                                ? Real(2) * walk_Nm2 * intervals * (per_memory_rad * per_memory_rad)
                                : Real(0);
  return way;
}

/// Variance that one order's ripple gains with a rotation, so that the memory is n turns at every
/// speed and order,
///     Q = 2 R_eff (rotation / (2 pi n))^2,  R_eff = R + q_T dt / (2 sin(x / 2))^2,
/// x the order times the rotation.  R_eff is the noise and what true torque has at the order's own
/// frequency; beyond half a cycle, where x says nothing, that of white noise, R + q_T dt / 4.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real gained_variance(const RippleFilterConfig<Real, MaxPairs>& config,
                                             const Way<Real>& way, std::size_t index) {
  const Real order = to_real<Real>(config.orders[index].order);
  const Real square = (order * order) * way.rotation_square_rad2;
  if (square > pi<Real> * pi<Real>) {
    return way.noise_Nm2 + Real(0.25) * way.walk_Nm2;
  }
  // (x / (2 sin(x / 2)))^2 to 6e-6 of itself up to pi.
  const Real bent =
      Real(1) +
      square *
          (Real(8.33619094e-02) +
           square * (Real(4.12392359e-03) +
                     square * (Real(1.85362645e-04) +
                               square * (Real(1.88781908e-06) + square * Real(4.99873192e-07)))));
  return way.noise_Nm2 + (Real(1) / (order * order)) * way.walk_per_square_Nm2 * bent;
}

/// Process noise of the torque for an interval.
template <class Real, std::size_t MaxPairs>
inline void let_torque_walk(const RippleFilterConfig<Real, MaxPairs>& config,
                            RippleFilterState<Real, MaxPairs>& state) {
  const Real longest_s = static_cast<Real>(longest_torque_walk_s);
  state.covariance.torque_variance_Nm2 +=
      config.torque_walk_Nm_per_sqrt_s * config.torque_walk_Nm_per_sqrt_s *
      (state.time_since_update_s < longest_s ? state.time_since_update_s : longest_s);
}

/// Process noise of the coefficients for a rotation.  An order's is shared among its pairs, so that
/// further terms do not shorten its memory.  Given after the update: single numbers written among
/// rows that are read whole at once would be waited for.
template <class Real, std::size_t MaxPairs>
inline Status let_ripple_walk(const RippleFilterConfig<Real, MaxPairs>& config,
                              RippleFilterState<Real, MaxPairs>& state,
                              const OrderTerms<Real>* terms, Real rotation_rad) {
  const Real limit_Nm2 = config.initial_amplitude_Nm * config.initial_amplitude_Nm;
  const Way<Real> way = way_of(config, state, rotation_rad);
  bool limited = false;
  each_order(config, [&](std::size_t a, std::size_t b) {
    const std::size_t its_terms = further_pairs_of(config.orders[a]);
    Real each_Nm2 = gained_variance(config, way, a);
    if (its_terms > 0) {
      Real weight = Real(1);
      for (std::size_t t = 0; t < its_terms; ++t) {
        weight += terms[a].factors[t] * terms[a].factors[t];
      }
      each_Nm2 /= weight;
    }
    limited = add_noise(state.covariance, a, b, its_terms, each_Nm2, limit_Nm2) || limited;
  });
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
  SeenCovariance<Real, MaxPairs> seen;  // NOLINT(*-member-init): filled by what follows
  follow(config, p, count, sample.terms);
  enter_frame(config, p, sample.terms, sample.waves, seen.h);
  see(p, count, seen);
  const Real shared_with_torque_Nm2 = p.torque_variance_Nm2 + seen.shared_Nm2;
  Real variance_Nm2 =
      noise_Nm2 + seen.ripple_variance_Nm2 + seen.shared_Nm2 + shared_with_torque_Nm2;
  Innovation<Real, MaxPairs> result;
  if (!is_finite(variance_Nm2) || !(variance_Nm2 > Real(0)) ||
      !(seen.ripple_variance_Nm2 > -noise_Nm2)) {
    set_variances(config, state);
    result.status = mask(StatusFlag::covariance_reset);
    return result;
  }
  result.innovation_Nm = innovation_Nm;
  result.variance_Nm2 = variance_Nm2;
  if (moving) {
    result.jump_variance_Nm2 =
        jump_variance(state, innovation_Nm, variance_Nm2, seen.ripple_variance_Nm2);
    variance_Nm2 += result.jump_variance_Nm2;
  }
  const Real per_variance = Real(1) / variance_Nm2;
  result.gains[0] = (shared_with_torque_Nm2 + result.jump_variance_Nm2) * per_variance;
  state.states_Nm[0] += result.gains[0] * innovation_Nm;
  Real row_Nm2[RippleCovariance<Real, MaxPairs>::row_length];  // NOLINT(*-member-init)
  measure_torque(p, count, seen, noise_Nm2, per_variance, row_Nm2);
  if (!moving) {
    return result;
  }
  measure_coefficients(p, count, row_Nm2, square_root(per_variance));
  leave_frame(config, p, row_Nm2);
  repeat(count, [&](auto j) {
    result.gains[j + 1] = row_Nm2[j] * per_variance;
    state.states_Nm[j + 1] += result.gains[j + 1] * innovation_Nm;
  });
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
