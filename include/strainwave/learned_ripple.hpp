// SPDX-License-Identifier: Apache-2.0
/// @file learned_ripple.hpp
/// What a ripple filter has learned: amplitude and phase of each order, and coefficients to keep.
///
/// Coefficients belong to the motor's angle.  Kept over a power cycle and restored where the
/// encoder knows its angle at once (an absolute encoder, or after its reference), they make
/// power-up at standstill clean: the filter starts with the ripple it had.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/ripple_filter.hpp"

namespace strainwave {

/// An order's ripple as it is now: amplitude x cos(order x angle - phase).
template <class Real>
struct OrderRipple {
  Real cosine_Nm = Real(0);
  Real sine_Nm = Real(0);
  Real amplitude_Nm = Real(0);
  Real phase_rad = Real(0);  ///< from -pi to pi
};

/// Ripple of one order at the filter's present load and speed; nothing for an order it has not.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline OrderRipple<Real> order_ripple(
    const RippleFilterConfig<Real, MaxPairs>& config,
    const RippleFilterState<Real, MaxPairs>& state, std::size_t index) {
  OrderRipple<Real> ripple;
  if (index >= config.order_count || index >= MaxPairs) {
    return ripple;
  }
  std::size_t i = 1;
  for (std::size_t a = 0; a < index; ++a) {
    i += 2 * pairs_of(config.orders[a]);
  }
  const auto terms = detail::terms_of(config.orders[index], detail::factors_now(config, state));
  const std::size_t count = further_pairs_of(config.orders[index]);
  if (i + 2 * count + 1 >= RippleFilterState<Real, MaxPairs>::max_states) {
    return ripple;
  }
  ripple.cosine_Nm = state.states_Nm[i];
  ripple.sine_Nm = state.states_Nm[i + 1];
  for (std::size_t t = 0; t < count; ++t) {
    ripple.cosine_Nm += terms.factors[t] * state.states_Nm[i + 2 * t + 2];
    ripple.sine_Nm += terms.factors[t] * state.states_Nm[i + 2 * t + 3];
  }
  ripple.amplitude_Nm =
      square_root(ripple.cosine_Nm * ripple.cosine_Nm + ripple.sine_Nm * ripple.sine_Nm);
  ripple.phase_rad = angle_of(ripple.cosine_Nm, ripple.sine_Nm);
  return ripple;
}

/// Coefficients with their standard deviations, and the orders they belong to.
template <class Real, std::size_t MaxPairs>
struct LearnedRipple {
  std::size_t order_count = 0;
  RippleOrder orders[MaxPairs] = {};
  Real coefficients_Nm[2 * MaxPairs] = {};
  Real standard_deviations_Nm[2 * MaxPairs] = {};
  Real innovation_scale_Nm = Real(0);
};

/// The same coefficients in another precision or capacity; the capacity must hold them.
template <class Real, std::size_t MaxPairs, class FromReal, std::size_t FromMaxPairs>
[[nodiscard]] constexpr LearnedRipple<Real, MaxPairs> converted(
    const LearnedRipple<FromReal, FromMaxPairs>& from) {
  LearnedRipple<Real, MaxPairs> to;
  to.order_count = from.order_count;
  std::size_t i = 0;
  for (std::size_t a = 0; a < from.order_count && a < MaxPairs && a < FromMaxPairs; ++a) {
    to.orders[a] = from.orders[a];
    const std::size_t end = i + 2 * pairs_of(from.orders[a]);
    for (; i < end && i < 2 * MaxPairs && i < 2 * FromMaxPairs; ++i) {
      to.coefficients_Nm[i] = static_cast<Real>(from.coefficients_Nm[i]);
      to.standard_deviations_Nm[i] = static_cast<Real>(from.standard_deviations_Nm[i]);
    }
  }
  to.innovation_scale_Nm = static_cast<Real>(from.innovation_scale_Nm);
  return to;
}

/// What to keep over a power cycle.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline LearnedRipple<Real, MaxPairs> learned(
    const RippleFilterConfig<Real, MaxPairs>& config,
    const RippleFilterState<Real, MaxPairs>& state) {
  LearnedRipple<Real, MaxPairs> kept;
  kept.order_count = config.order_count < MaxPairs ? config.order_count : MaxPairs;
  for (std::size_t a = 0; a < kept.order_count; ++a) {
    kept.orders[a] = config.orders[a];
  }
  for (std::size_t i = 0; i < 2 * pair_count(config) && i < 2 * MaxPairs; ++i) {
    kept.coefficients_Nm[i] = state.states_Nm[i + 1];
    const Real variance_Nm2 =
        detail::covariance_of(config, state.covariance, 2 * pair_count(config), i + 1, i + 1);
    kept.standard_deviations_Nm[i] = variance_Nm2 > Real(0) ? square_root(variance_Nm2) : Real(0);
  }
  kept.innovation_scale_Nm = state.innovation_scale_Nm;
  return kept;
}

/// Whether kept coefficients are sound and belong to this configuration.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Violation<Real> check(const RippleFilterConfig<Real, MaxPairs>& config,
                                              const LearnedRipple<Real, MaxPairs>& kept) {
  if (kept.order_count != config.order_count) {
    return {"learned.orders", -1, static_cast<Real>(kept.order_count), "orders",
            "as many as the filter has"};
  }
  for (std::size_t a = 0; a < config.order_count && a < MaxPairs; ++a) {
    const RippleOrder& mine = config.orders[a];
    const RippleOrder& other = kept.orders[a];
    if (!is_valid(other.order) || !detail::is_same_order(mine.order, other.order) ||
        mine.with_load != other.with_load || mine.with_speed != other.with_speed ||
        mine.with_direction != other.with_direction) {
      return {"learned.orders", static_cast<std::int32_t>(a), Real(0), "cycles per motor turn",
              "the filter's own orders and terms, in their order"};
    }
  }
  for (std::size_t i = 0; i < 2 * pair_count(config); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    if (!(absolute(kept.coefficients_Nm[i]) <=
          static_cast<Real>(detail::largest_configured_torque_Nm))) {
      return {"learned.coefficients_Nm", index, kept.coefficients_Nm[i], "Nm",
              "a number from -1e9 to 1e9"};
    }
    if (!detail::is_within(kept.standard_deviations_Nm[i], 0.0,
                           detail::largest_configured_torque_Nm)) {
      return {"learned.standard_deviations_Nm", index, kept.standard_deviations_Nm[i], "Nm",
              "a number from 0 to 1e9"};
    }
  }
  if (!detail::is_within(kept.innovation_scale_Nm, 0.0, detail::largest_configured_torque_Nm)) {
    return {"learned.innovation_scale_Nm", -1, kept.innovation_scale_Nm, "Nm",
            "a number from 0 to 1e9"};
  }
  return {};
}

/// A fresh state that starts with kept coefficients; check() them first.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr RippleFilterState<Real, MaxPairs> restored(
    const RippleFilterConfig<Real, MaxPairs>& config, const LearnedRipple<Real, MaxPairs>& kept) {
  RippleFilterState<Real, MaxPairs> state = initial_state(config);
  // A variance of 0 would never learn again; far below the noise it is as good as 0.
  const Real least_Nm = config.torque_noise_Nm * Real(1e-3);
  for (std::size_t i = 0; i < 2 * pair_count(config); ++i) {
    state.states_Nm[i + 1] = kept.coefficients_Nm[i];
    Real deviation_Nm = kept.standard_deviations_Nm[i];
    deviation_Nm = deviation_Nm > least_Nm ? deviation_Nm : least_Nm;
    deviation_Nm =
        deviation_Nm < config.initial_amplitude_Nm ? deviation_Nm : config.initial_amplitude_Nm;
    detail::set_element(state.covariance, i, i, deviation_Nm * deviation_Nm);
  }
  if (kept.innovation_scale_Nm > Real(0.5) * config.torque_noise_Nm) {
    state.innovation_scale_Nm = kept.innovation_scale_Nm;
  }
  return state;
}

}  // namespace strainwave
