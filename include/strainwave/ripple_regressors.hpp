// SPDX-License-Identifier: Apache-2.0
/// @file ripple_regressors.hpp
/// The ripple at an angle, load and speed: what each coefficient is multiplied by, and their sum.
#pragma once

#include <cstddef>

#include "strainwave/ripple_config.hpp"
#include "strainwave/ripple_state.hpp"
#include "strainwave/units.hpp"

namespace strainwave::detail {

/// What further pairs may be multiplied by.
template <class Real>
struct RippleFactors {
  Real load = Real(0);
  Real speed = Real(0);
  Real direction = Real(0);
};

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr RippleFactors<Real> factors_now(
    const RippleFilterConfig<Real, MaxPairs>& config,
    const RippleFilterState<Real, MaxPairs>& state) {
  const Real speed_rad_s = absolute(state.speed_rad_s);
  const Real load = state.load_Nm / config.rated_torque_Nm;
  RippleFactors<Real> factors;
  // Growth with load flattens: linear for small loads, half of that at the rated torque.  A load
  // far from those at which the coefficients were learned is then not answered with a ripple that
  // no gear has.
  factors.load = load / (Real(1) + absolute(load));
  factors.speed = speed_rad_s / config.reference_speed_rad_s;
  // Through zero the direction changes over 1 rad/s either way, not from one sample to the next.
  factors.direction = state.speed_rad_s / (speed_rad_s + Real(1));
  return factors;
}

/// Factors of an order's further pairs, in their order.  Each is chosen for its place: put one
/// after the other where there is room, they would be waited for.
template <class Real>
[[nodiscard]] constexpr OrderTerms<Real> terms_of(const RippleOrder& order,
                                                  const RippleFactors<Real>& factors) {
  const Real last = order.with_direction ? factors.direction : Real(0);
  const Real after_load = order.with_speed ? factors.speed : last;
  const Real after_speed = order.with_speed ? last : Real(0);
  OrderTerms<Real> terms;
  terms.factors[0] = order.with_load ? factors.load : after_load;
  terms.factors[1] = order.with_load ? after_load : after_speed;
  terms.factors[2] = order.with_load ? after_speed : Real(0);
  return terms;
}

/// Whether an order is the sum of the one before it and the first, as in 2, 4, 6.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr bool continues_series(const RippleFilterConfig<Real, MaxPairs>& config,
                                              std::size_t index) {
  const Order& first = config.orders[0].order;
  const Order& before = config.orders[index - 1].order;
  const Order& order = config.orders[index].order;
  return first.denominator == order.denominator && before.denominator == order.denominator &&
         first.numerator + before.numerator == order.numerator;
}

/// Cosine and sine of the sum of two angles.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> of_sum(const CosSin<Real>& a, const CosSin<Real>& b) {
  return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}

/// Each order's cosine and sine at a phase.  A series costs one cosine.
template <class Real, std::size_t MaxPairs>
constexpr void waves_at(const RippleFilterConfig<Real, MaxPairs>& config, Phase phase,
                        CosSin<Real>* waves) {
  for (std::size_t a = 0; a < config.order_count && a < MaxPairs; ++a) {
    waves[a] = a > 0 && continues_series(config, a)
                   ? of_sum(waves[a - 1], waves[0])
                   : cos_sin_of_fraction<Real>(order_fraction(phase, config.orders[a].order));
  }
}

/// Each order's wave and factors at a phase, load and speed.
template <class Real, std::size_t MaxPairs>
constexpr void regressors_at(const RippleFilterConfig<Real, MaxPairs>& config,
                             const RippleFilterState<Real, MaxPairs>& state, Phase phase,
                             Regressors<Real, MaxPairs>& sample) {
  const RippleFactors<Real> factors = factors_now(config, state);
  sample.state_count = 1;
  waves_at(config, phase, sample.waves);
  each_order(config, [&](std::size_t a, std::size_t b) {
    sample.terms[a] = terms_of(config.orders[a], factors);
    sample.state_count = 1 + b + 2 * pairs_of(config.orders[a]);
  });
}

/// Ripple as predicted: of orders to be removed, and of those that are kept.
template <class Real>
struct PredictedRipple {
  Real removed_Nm = Real(0);
  Real kept_Nm = Real(0);
};

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr PredictedRipple<Real> predicted_ripple(
    const RippleFilterConfig<Real, MaxPairs>& config,
    const RippleFilterState<Real, MaxPairs>& state, const Regressors<Real, MaxPairs>& sample) {
  PredictedRipple<Real> ripple;
  each_order(config, [&](std::size_t a, std::size_t b) {
    // NOLINTBEGIN(clang-analyzer-security.ArrayBound): each_order() keeps to the capacity.
    const Real* const coefficients_Nm = state.states_Nm + 1 + b;
    Real cosine_Nm = coefficients_Nm[0];
    Real sine_Nm = coefficients_Nm[1];
    for (std::size_t t = 0; t < further_pairs_of(config.orders[a]); ++t) {
      cosine_Nm += sample.terms[a].factors[t] * coefficients_Nm[2 * t + 2];
      sine_Nm += sample.terms[a].factors[t] * coefficients_Nm[2 * t + 3];
    }
    (config.orders[a].keep ? ripple.kept_Nm : ripple.removed_Nm) +=
        sample.waves[a].cosine * cosine_Nm + sample.waves[a].sine * sine_Nm;
    // NOLINTEND(clang-analyzer-security.ArrayBound)
  });
  return ripple;
}

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real frozen_torque_Nm(const RippleFilterConfig<Real, MaxPairs>& config,
                                              Phase phase) {
  Real sum = Real(0);
  for (std::size_t f = 0; f < config.frozen_count && f < largest_frozen_terms; ++f) {
    const CosSin<Real> wave =
        cos_sin_of_fraction<Real>(order_fraction(phase, config.frozen[f].order));
    sum += config.frozen[f].cosine_Nm * wave.cosine + config.frozen[f].sine_Nm * wave.sine;
  }
  return sum;
}

}  // namespace strainwave::detail
