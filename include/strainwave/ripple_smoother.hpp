// SPDX-License-Identifier: Apache-2.0
/// @file ripple_smoother.hpp
/// For recordings: the ripple filter's model run forwards, then backwards.
///
/// A filter knows what came before a sample, a smoother also what came after it.  The same model is
/// filtered forwards, leaving a trace of each sample, and the trace is read backwards (the
/// Bryson-Frazier form of the Rauch-Tung-Striebel smoother, which inverts no matrix).  The caller
/// owns the memory for the traces; blocks with some memories of overlap give what the whole log
/// would.
#pragma once

#include <cstddef>

#include "strainwave/ripple_filter.hpp"

namespace strainwave {

/// What the way back needs to know of one sample.
template <class Real, std::size_t MaxPairs>
struct SmootherTrace {
  static constexpr std::size_t max_states = 1 + 2 * MaxPairs;

  Real gain[max_states] = {};                    ///< of this sample's update; zeros without one
  Real h[max_states] = {};                       ///< its regressors
  Real covariance_with_ripple[max_states] = {};  ///< P h before the update, removed orders alone
  Real innovation_per_variance = Real(0);
  Real measured_Nm = Real(0);
  Real ripple_Nm = Real(0);  ///< as the forward pass predicted it, frozen terms included
  bool holds = false;        ///< the row brought nothing usable: its torque is the last one's
  Status status = 0;
};

/// The adjoint state of the way back; starts with zeros after the last sample.
template <class Real, std::size_t MaxPairs>
struct SmootherState {
  Real adjoint[1 + 2 * MaxPairs] = {};
};

namespace detail {

/// P h of the removed orders' coefficients, T first: what the smoothed ripple needs of P.
template <class Real, std::size_t MaxPairs>
constexpr void covariance_with_removed(const RippleFilterConfig<Real, MaxPairs>& config,
                                       RippleCovariance<Real, MaxPairs>& p,
                                       const Regressors<Real, MaxPairs>& sample, Real* result) {
  const std::size_t count = sample.state_count - 1;
  SeenCovariance<Real, MaxPairs> seen;  // NOLINT(*-member-init): filled by what follows
  follow(config, p, count, sample.terms);
  enter_frame(config, p, sample.terms, sample.waves, seen.h);
  each_order(config, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = b; i < b + 2 * pairs_of(config.orders[a]) && config.orders[a].keep; ++i) {
      seen.h[i] = Real(0);
    }
  });
  project(p, count, seen.h, seen.ripple_row_Nm2);
  result[0] = product_sum(count, seen.h, p.torque_row_Nm2);
  leave_frame(config, p, seen.ripple_row_Nm2);
  for (std::size_t j = 0; j < count; ++j) {
    result[j + 1] = seen.ripple_row_Nm2[j];
  }
}

/// What each state is multiplied by, T first.
template <class Real, std::size_t MaxPairs>
constexpr void regressors_of(const RippleFilterConfig<Real, MaxPairs>& config,
                             const Regressors<Real, MaxPairs>& sample, Real* h) {
  h[0] = Real(1);
  // NOLINTBEGIN(clang-analyzer-security.ArrayBound): each_order() keeps to the capacity.
  each_order(config, [&](std::size_t a, std::size_t b) {
    Real* const its = h + 1 + b;
    its[0] = sample.waves[a].cosine;
    its[1] = sample.waves[a].sine;
    for (std::size_t t = 0; t < further_pairs_of(config.orders[a]); ++t) {
      its[2 * t + 2] = sample.terms[a].factors[t] * its[0];
      its[2 * t + 3] = sample.terms[a].factors[t] * its[1];
    }
  });
  // NOLINTEND(clang-analyzer-security.ArrayBound)
}

/// Update with one sample of a moving motor, leaving its trace.
template <class Real, std::size_t MaxPairs>
constexpr void learn_with_trace(const RippleFilterConfig<Real, MaxPairs>& config,
                                RippleFilterState<Real, MaxPairs>& state,
                                const RippleIntake<Real, MaxPairs>& intake,
                                SmootherTrace<Real, MaxPairs>& trace) {
  if (!state.torque_known) {
    // T's variance was infinite: it takes all of the sample, the coefficients nothing.
    start_torque(config, state, intake.regressors, intake.rest_Nm);
    trace.gain[0] = Real(1);
    return;
  }
  const Real innovation_Nm = intake.rest_Nm - state.states_Nm[0];
  const auto found = update(config, state, intake.regressors, innovation_Nm, true);
  trace.status |= found.status;
  if (has(found.status, StatusFlag::covariance_reset)) {
    return;  // nothing was learned, and there is no variance to divide by
  }
  for (std::size_t i = 0; i < intake.regressors.state_count; ++i) {
    trace.gain[i] = found.gains[i];
  }
  trace.innovation_per_variance = innovation_Nm / (found.variance_Nm2 + found.jump_variance_Nm2);
  track_scale(config, state, innovation_Nm, intake.rotation_rad);
  if (state.learned_phase_known) {
    trace.status |= let_ripple_walk(config, state, intake.regressors.terms, intake.rotation_rad);
  }
}

}  // namespace detail

/// The way forward: like step(), and leaves the sample's trace.  At rest nothing is learned, and T
/// starts anew with the motion: what happened to it meanwhile says nothing about the ripple.
template <class Real, std::size_t MaxPairs>
inline RippleReading<Real> step_forward(const RippleFilterConfig<Real, MaxPairs>& config,
                                        RippleFilterState<Real, MaxPairs>& state,
                                        const RippleSample<Real>& sample,
                                        SmootherTrace<Real, MaxPairs>& trace) {
  RippleReading<Real> reading;
  // All of it: a sample that is not taken in leaves regressors that are copied nevertheless.
  detail::RippleIntake<Real, MaxPairs> intake{};
  detail::take_in(config, state, sample, intake, reading);
  trace = SmootherTrace<Real, MaxPairs>{};
  trace.ripple_Nm = reading.ripple_Nm;
  trace.measured_Nm = state.measured_Nm;
  trace.holds = intake.held_or_late || !intake.torque_usable;
  const bool learns = intake.learnable && intake.moving;
  if (learns) {
    detail::let_torque_walk(config, state);
  }
  detail::covariance_with_removed(config, state.covariance, intake.regressors,
                                  trace.covariance_with_ripple);
  detail::regressors_of(config, intake.regressors, trace.h);
  if (learns) {
    detail::learn_with_trace(config, state, intake, trace);
  } else if (intake.learnable) {
    state.torque_known = false;
  }
  if (intake.learnable) {
    detail::finish_learning(state, intake, reading);
  }
  reading.status |= trace.status;
  trace.status = reading.status;
  record(state.counters, reading.status);
  return reading;
}

/// The way back, sample by sample from the last to the first: the ripple that all samples together
/// make likely at this one.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real step_backward(SmootherState<Real, MaxPairs>& state,
                                           const SmootherTrace<Real, MaxPairs>& trace) {
  constexpr std::size_t count = SmootherTrace<Real, MaxPairs>::max_states;
  Real expected = trace.innovation_per_variance;
  for (std::size_t i = 0; i < count; ++i) {
    expected += trace.gain[i] * state.adjoint[i];
  }
  Real ripple_Nm = trace.ripple_Nm;
  for (std::size_t i = 0; i < count; ++i) {
    state.adjoint[i] -= trace.h[i] * expected;
    ripple_Nm -= trace.covariance_with_ripple[i] * state.adjoint[i];
  }
  return ripple_Nm;
}

}  // namespace strainwave
