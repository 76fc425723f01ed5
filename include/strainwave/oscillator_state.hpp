// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_state.hpp
/// What the published ripple filter remembers, and how rotation and measurement change it.
///
/// Structure used: the transition is one 2x2 rotation per order, and process noise of one variance
/// for both states of an order is the same in every frame.  The oscillators are therefore described
/// in a frame that turns with them: states and covariance then stand still, and it is the output
/// row 1 0 1 0 ... that turns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "strainwave/oscillator_config.hpp"
#include "strainwave/oscillator_covariance.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// x(k) and P(k) of eq. (9) and (14) in the turning frame, and what the sample path has to
/// remember. predicted() has them in the paper's frame.
template <class Real, std::size_t MaxOrders>
struct OscillatorFilterState {
  static constexpr std::size_t max_states = 2 * MaxOrders;
  static constexpr std::size_t column_length = detail::column_length(max_states);
  /// An angle as a fraction of a turn, the whole range of the number being one turn: finer than
  /// the last place of a sample's rotation.
  using Fraction = std::conditional_t<std::is_same_v<Real, float>, std::uint32_t, std::uint64_t>;

  /// P by columns: element (i, j), j <= i, at [j][i].  See covariance().
  Real covariance_Nm2[max_states][column_length] = {};
  Real states_Nm[column_length] = {};
  /// Each order's angle, of which the output row C of eq. (9) has cosine and sine; used with
  /// RotationSource::speed, and not for an order that is twice another one.
  Fraction angle[MaxOrders] = {};
  /// Of the motor since the last update, used with RotationSource::speed and minimum_travel_rad.
  Real travel_rad = Real(0);
  Phase frame = {};  ///< motor phase at the last update, used with RotationSource::angle
  bool frame_known = false;
  Real last_speed_rad_s = Real(0);
  Real smoothed_speed_rad_s = Real(0);
  Phase last_phase = {};                  ///< of the last sample with a phase
  std::uint32_t samples_since_phase = 0;  ///< missing or without a phase since then
  Real last_torque_Nm = Real(0);
  EventCounters counters = {};

  /// Element (i, j) of P.
  [[nodiscard]] constexpr Real covariance(std::size_t i, std::size_t j) const {
    return i < j ? covariance_Nm2[i][j] : covariance_Nm2[j][i];
  }
};

namespace detail {

/// Phi_i of eq. (10) applied to one order's pair of states.
template <class Real>
constexpr void rotate_pair(Real& first, Real& second, const CosSin<Real>& turn) {
  const Real rotated = turn.cosine * first + turn.sine * second;
  second = turn.cosine * second - turn.sine * first;
  first = rotated;
}

/// Cosine and sine of the double angle.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> doubled(const CosSin<Real>& wave) {
  return {wave.cosine * wave.cosine - wave.sine * wave.sine, Real(2) * (wave.cosine * wave.sine)};
}

/// The order before this one that is half of it; the order's own index where there is none.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr std::size_t half_of(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                            std::size_t order) {
  std::size_t b = 0;
  while (b < order && !is_half(config.orders[b], config.orders[order])) {
    ++b;
  }
  return b;
}

/// x <- Phi x and P <- Phi P Phi', an order's rows and columns at a time.
template <class Real, std::size_t MaxOrders>
constexpr void rotate(std::size_t order_count, OscillatorFilterState<Real, MaxOrders>& state,
                      const Real* output) {
  auto& p = state.covariance_Nm2;
  const std::size_t count = 2 * order_count;
  for (std::size_t a = 0; a < order_count; ++a) {
    const std::size_t i = 2 * a;
    const CosSin<Real> turn = {output[i], output[i + 1]};
    rotate_pair(state.states_Nm[i], state.states_Nm[i + 1], turn);
    for (std::size_t j = 0; j < i; ++j) {
      rotate_pair(p[j][i], p[j][i + 1], turn);
    }
    for (std::size_t j = i + 2; j < count; ++j) {
      rotate_pair(p[i][j], p[i + 1][j], turn);
    }
    const CosSin<Real> twice = doubled(turn);
    const Real mean = Real(0.5) * (p[i][i] + p[i + 1][i + 1]);
    Real difference = Real(0.5) * (p[i][i] - p[i + 1][i + 1]);
    rotate_pair(difference, p[i][i + 1], twice);
    p[i][i] = mean + difference;
    p[i + 1][i + 1] = mean - difference;
  }
  mirror(count, p);
}

/// The largest variance that an order's states may have; see variance_limit_ratio.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real variance_limit(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                            std::size_t order) {
  return config.initial_variance_Nm2 +
         config.variance_limit_ratio * config.process_noise_variance_Nm2[order];
}

/// Scales an order's rows and columns of P so that its variances end at the limit; a congruence,
/// which leaves P positive definite.
template <class Real, std::size_t MaxOrders>
inline bool limit_variance(const OscillatorFilterConfig<Real, MaxOrders>& config,
                           OscillatorFilterState<Real, MaxOrders>& state) {
  bool limited = false;
  auto& p = state.covariance_Nm2;
  const std::size_t state_count = 2 * active_orders(config);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const Real limit = variance_limit(config, a);
    const Real first = p[2 * a][2 * a];
    const Real second = p[2 * a + 1][2 * a + 1];
    const Real larger = first > second ? first : second;
    if (!(larger > limit)) {
      continue;
    }
    limited = true;
    const Real scale = square_root(limit / larger);
    for (std::size_t i = 2 * a; i < 2 * a + 2; ++i) {
      for (std::size_t j = 0; j < state_count; ++j) {
        (i < j ? p[i][j] : p[j][i]) *= scale;
      }
      p[i][i] *= scale;
    }
    // The element shared by both rows was scaled with each of them, as it has to be.
  }
  if (limited) {
    mirror(state_count, p);
  }
  return limited;
}

template <class Real, std::size_t MaxOrders>
constexpr void reset_covariance(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                OscillatorFilterState<Real, MaxOrders>& state) {
  const std::size_t state_count = 2 * active_orders(config);
  for (std::size_t j = 0; j < state_count; ++j) {
    for (std::size_t i = j; i < state_count; ++i) {
      state.covariance_Nm2[j][i] = i == j ? config.initial_variance_Nm2 : Real(0);
    }
  }
  mirror(state_count, state.covariance_Nm2);
}

/// The process noise of samples that pass without an update.
template <class Real, std::size_t MaxOrders>
constexpr void add_process_noise(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                 OscillatorFilterState<Real, MaxOrders>& state, Real samples) {
  for (std::size_t i = 0; i < 2 * active_orders(config); ++i) {
    state.covariance_Nm2[i][i] += samples * config.process_noise_variance_Nm2[i / 2];
  }
}

/// Whether a number is between two positive ones, whatever it is.  The bits of positive numbers are
/// in their order, and one comparison of whole numbers does for both limits and NaN.
template <class Real>
[[nodiscard]] constexpr bool is_between(Real least, Real value, Real most) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  const Bits from = __builtin_bit_cast(Bits, least);
  return __builtin_bit_cast(Bits, value) - from <= __builtin_bit_cast(Bits, most) - from;
}

/// Eq. (12) to (14): gain, states and covariance after the measurement, plus the process noise; the
/// rotation is in the output row.  Returns limits that acted.
template <class Real, std::size_t MaxOrders>
inline Status update(const OscillatorFilterConfig<Real, MaxOrders>& config,
                     OscillatorFilterState<Real, MaxOrders>& state, const Real* output,
                     Real innovation_Nm) {
  const std::size_t state_count = 2 * active_orders(config);
  CovarianceWithOutput<Real, column_length(2 * MaxOrders)> covariance_with_output = {};
  const Real innovation_variance =
      project(state_count, state.covariance_Nm2, output, config.measurement_noise_variance_Nm2,
              covariance_with_output);
  if (!is_between(config.measurement_noise_variance_Nm2, innovation_variance,
                  std::numeric_limits<Real>::max())) {
    // C P C' < 0: rounding has cost P its sign.  The states are kept.
    reset_covariance(config, state);
    return mask(StatusFlag::covariance_reset);
  }
  learn(state_count, state.covariance_Nm2, state.states_Nm, config.process_noise_variance_Nm2,
        covariance_with_output, Real(1) / innovation_variance, innovation_Nm);
  if (config.variance_limit_ratio > Real(0) && limit_variance(config, state)) {
    return mask(StatusFlag::variance_limited);
  }
  return 0;
}

}  // namespace detail

}  // namespace strainwave
