// SPDX-License-Identifier: Apache-2.0
/// @file ripple_filter.hpp
/// The ripple filter: coefficients in the angle domain, learned as the motor travels.
///
/// A Kalman filter on true torque (a random walk in time) and on the ripple's coefficients (a
/// random walk in motor angle).  What is handed out is measured torque minus ripple: no delay, no
/// loss of bandwidth.  Learning goes by travelled angle and is frozen at rest, where a constant
/// ripple and a constant torque cannot be told apart.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/ripple_config.hpp"
#include "strainwave/ripple_sample.hpp"
#include "strainwave/ripple_state.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

namespace detail {

/// Prediction and update with one usable sample.
template <class Real, std::size_t MaxPairs>
inline void learn(const RippleFilterConfig<Real, MaxPairs>& config,
                  RippleFilterState<Real, MaxPairs>& state,
                  const RippleIntake<Real, MaxPairs>& intake, RippleReading<Real>& reading) {
  if (!state.torque_known) {
    start_torque(config, state, intake.regressors, intake.rest_Nm);
  } else {
    let_torque_walk(config, state);
    const Innovation<Real, MaxPairs> found = update(
        config, state, intake.regressors, intake.rest_Nm - state.states_Nm[0], intake.moving);
    reading.innovation_Nm = found.innovation_Nm;
    reading.innovation_variance_Nm2 = found.variance_Nm2;
    reading.status |= found.status;
    if (intake.moving) {
      track_scale(config, state, found.innovation_Nm, intake.rotation_rad);
      if (state.learned_phase_known) {
        reading.status |=
            let_ripple_walk(config, state, intake.regressors.terms, intake.rotation_rad);
      }
    }
  }
  finish_learning(state, intake, reading);
}

}  // namespace detail

/// c(0) = 0 with the configured uncertainty; T starts with the first torque.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr RippleFilterState<Real, MaxPairs> initial_state(
    const RippleFilterConfig<Real, MaxPairs>& config) {
  RippleFilterState<Real, MaxPairs> state;
  detail::set_variances(config, state);
  state.innovation_scale_Nm = Real(3) * config.torque_noise_Nm;
  return state;
}

/// One sample: removes the ripple, then learns from the sample.  Never fails; see the status.
template <class Real, std::size_t MaxPairs>
inline RippleReading<Real> step(const RippleFilterConfig<Real, MaxPairs>& config,
                                RippleFilterState<Real, MaxPairs>& state,
                                const RippleSample<Real>& sample) {
  RippleReading<Real> reading;
  detail::RippleIntake<Real, MaxPairs> intake;
  detail::take_in(config, state, sample, intake, reading);
  if (intake.learnable) {
    detail::learn(config, state, intake, reading);
  }
  record(state.counters, reading.status);
  return reading;
}

}  // namespace strainwave
