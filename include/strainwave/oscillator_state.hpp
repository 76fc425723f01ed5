// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_state.hpp
/// What the published ripple filter remembers, and how rotation and measurement change it.
///
/// Structure used: the transition is one 2x2 rotation per order, and process noise of one variance
/// for both states of an order is the same in every frame.  The oscillators are therefore described
/// in a frame that turns with them: states and covariance then stand still, and it is the output
/// row 1 0 1 0 ... that turns.  The covariance is symmetric because only one triangle of it is
/// stored.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/oscillator_config.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// x(k) and P(k) of eq. (9) and (14) in the turning frame, and what the sample path has to
/// remember. predicted() has them in the paper's frame.
template <class Real, std::size_t MaxOrders>
struct OscillatorFilterState {
  static constexpr std::size_t max_states = 2 * MaxOrders;

  Real states_Nm[max_states] = {};
  /// Lower triangle of P by rows: element (i, j), j <= i, at i (i + 1) / 2 + j.
  Real covariance_Nm2[max_states * (max_states + 1) / 2] = {};
  /// Output row C of eq. (9) in the turning frame: cosine and sine of each order's angle.
  CosSin<Real> output[MaxOrders] = {};
  /// Rotation of the motor since `output`, used with RotationSource::speed.
  Real pending_rotation_rad = Real(0);
  bool rotated_without_update = false;  ///< part of the rotation was applied since the last update
  Phase frame = {};  ///< motor phase of `output`, used with RotationSource::angle
  bool frame_known = false;
  std::uint32_t samples_without_update = 0;  ///< rejected or missing since the last update
  Real last_speed_rad_s = Real(0);
  Real smoothed_speed_rad_s = Real(0);
  Phase last_phase = {};                  ///< of the last sample with a phase
  std::uint32_t samples_since_phase = 0;  ///< missing or without a phase since then
  Real last_torque_Nm = Real(0);
  EventCounters counters = {};
};

namespace detail {

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

/// An output row turned on.  Its length is put back to 1 to first order: rounding would let it
/// drift.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> turned(const CosSin<Real>& output, const CosSin<Real>& turn) {
  const Real cosine = output.cosine * turn.cosine - output.sine * turn.sine;
  const Real sine = output.sine * turn.cosine + output.cosine * turn.sine;
  const Real scale = Real(1.5) - Real(0.5) * (cosine * cosine + sine * sine);
  return {scale * cosine, scale * sine};
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
    const Real limit = config.initial_variance_Nm2 +
                       config.variance_limit_ratio * config.process_noise_variance_Nm2[a];
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

/// P C', and C P C' + R, which is returned.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real project(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                     const OscillatorFilterState<Real, MaxOrders>& state,
                                     const CosSin<Real>* output, Real* covariance_with_output) {
  const std::size_t state_count = 2 * active_orders(config);
  const Real* const p = state.covariance_Nm2;
  Real c[2 * MaxOrders] = {};
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    c[2 * a] = output[a].cosine;
    c[2 * a + 1] = output[a].sine;
  }
  for (std::size_t i = 0; i < state_count; ++i) {
    covariance_with_output[i] = p[packed_index(i, i)] * c[i];
    for (std::size_t j = 0; j < i; ++j) {
      const Real element = p[packed_index(i, j)];
      covariance_with_output[i] += element * c[j];
      covariance_with_output[j] += element * c[i];
    }
  }
  Real variance = config.measurement_noise_variance_Nm2;
  for (std::size_t i = 0; i < state_count; ++i) {
    variance += covariance_with_output[i] * c[i];
  }
  return variance;
}

/// Eq. (12) to (14): gain, states and covariance after the measurement, plus the process noise; the
/// rotation is in the output row.  Returns limits that acted.
template <class Real, std::size_t MaxOrders>
inline Status update(const OscillatorFilterConfig<Real, MaxOrders>& config,
                     OscillatorFilterState<Real, MaxOrders>& state, const CosSin<Real>* output,
                     Real innovation_Nm) {
  const std::size_t state_count = 2 * active_orders(config);
  Real* const p = state.covariance_Nm2;
  Real covariance_with_output[2 * MaxOrders];  // NOLINT(*-member-init): project() fills it
  const Real innovation_variance = project(config, state, output, covariance_with_output);
  if (!(innovation_variance >= config.measurement_noise_variance_Nm2) ||
      !is_finite(innovation_variance)) {
    // C P C' < 0: rounding has cost P its sign.  The states are kept.
    reset_covariance(config, state);
    return mask(StatusFlag::covariance_reset);
  }
  const Real per_variance = Real(1) / innovation_variance;
  const Real samples = static_cast<Real>(state.samples_without_update) + Real(1);
  for (std::size_t i = 0; i < state_count; ++i) {
    const Real gain = covariance_with_output[i] * per_variance;
    state.states_Nm[i] += gain * innovation_Nm;
    p[packed_index(i, i)] += samples * config.process_noise_variance_Nm2[i / 2];
    for (std::size_t j = 0; j <= i; ++j) {
      p[packed_index(i, j)] -= gain * covariance_with_output[j];
    }
  }
  if (config.variance_limit_ratio > Real(0) && limit_variance(config, state)) {
    return mask(StatusFlag::variance_limited);
  }
  return 0;
}

}  // namespace detail

}  // namespace strainwave
