// SPDX-License-Identifier: Apache-2.0
/// @file ripple_regressors.hpp
/// The ripple at an angle, load and speed: what each coefficient is multiplied by, and their sum.
#pragma once

#include <cstddef>

#include "strainwave/ripple_config.hpp"
#include "strainwave/ripple_state.hpp"
#include "strainwave/units.hpp"

namespace strainwave::detail {

/// What the pairs of an order are multiplied by: 1, load, speed, direction.
template <class Real>
struct Factors {
  static constexpr std::size_t count = 4;
  Real values[count] = {};
};

[[nodiscard]] constexpr bool has_factor(const RippleOrder& order, std::size_t factor) {
  switch (factor) {
    case 0:
      return true;
    case 1:
      return order.with_load;
    case 2:
      return order.with_speed;
    default:
      return order.with_direction;
  }
}

template <class Real, std::size_t MaxPairs>
constexpr void factors_now(const RippleFilterConfig<Real, MaxPairs>& config,
                           const RippleFilterState<Real, MaxPairs>& state, Factors<Real>& factors) {
  const Real speed_rad_s = absolute(state.speed_rad_s);
  factors.values[0] = Real(1);
  // Growth with load flattens: linear for small loads, half of that at the rated torque.  A load
  // far from those at which the coefficients were learned is then not answered with a ripple that
  // no gear has.
  const Real load = state.load_Nm / config.rated_torque_Nm;
  factors.values[1] = load / (Real(1) + absolute(load));
  factors.values[2] = speed_rad_s / config.reference_speed_rad_s;
  // Through zero the direction changes over 1 rad/s either way, not from one sample to the next.
  factors.values[3] = state.speed_rad_s / (speed_rad_s + Real(1));
}

/// Cosines and sines of all pairs at a phase, load and speed.
template <class Real, std::size_t MaxPairs>
constexpr void regressors_at(const RippleFilterConfig<Real, MaxPairs>& config,
                             const RippleFilterState<Real, MaxPairs>& state, Phase phase,
                             Regressors<Real, MaxPairs>& sample) {
  sample.order_count = config.order_count < MaxPairs ? config.order_count : MaxPairs;
  sample.h[0] = Real(1);
  Factors<Real> factors;
  factors_now(config, state, factors);
  std::size_t i = 1;
  for (std::size_t a = 0; a < sample.order_count; ++a) {
    const RippleOrder& order = config.orders[a];
    const CosSin<Real> wave = cos_sin_of_fraction<Real>(order_fraction(phase, order.order));
    sample.waves[a] = wave;
    for (std::size_t f = 0; f < Factors<Real>::count; ++f) {
      if (has_factor(order, f) && i + 1 < Regressors<Real, MaxPairs>::max_states) {
        sample.h[i] = factors.values[f] * wave.cosine;
        sample.h[i + 1] = factors.values[f] * wave.sine;
        i += 2;
      }
    }
  }
  sample.state_count = i;
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
  std::size_t i = 1;
  for (std::size_t a = 0; a < sample.order_count; ++a) {
    Real sum = Real(0);
    for (const std::size_t end = i + 2 * pairs_of(config.orders[a]); i < end; ++i) {
      sum += sample.h[i] * state.states_Nm[i];
    }
    (config.orders[a].keep ? ripple.kept_Nm : ripple.removed_Nm) += sum;
  }
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
