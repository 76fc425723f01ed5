// SPDX-License-Identifier: Apache-2.0
/// @file ripple_sample.hpp
/// A sample on its way into the ripple filter: checked, put on the angle axis, freed of the ripple.
///
/// Whatever a sample brings (an angle that is missing or has jumped, a time that stands, a torque
/// that is no number, a row that only repeats the last one) ends here in a status; what goes on to
/// learning is sound.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/oscillator_filter.hpp"
#include "strainwave/ripple_config.hpp"
#include "strainwave/ripple_regressors.hpp"
#include "strainwave/ripple_state.hpp"
#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <class Real>
struct RippleSample {
  Real measured_torque_Nm = Real(0);
  Real expected_torque_Nm = Real(0);  ///< part of the true torque that is known, or 0
  Phase motor_phase = {};
  Real interval_s = Real(1e-3);  ///< time since the sample before; the first one's is not used
  bool torque_valid = true;      ///< false where the caller knows the torque to be wrong
  bool phase_valid = true;       ///< false where the caller has no angle for this sample
  bool phase_referenced = true;  ///< false: angle from an unknown zero, frozen terms wait
};

template <class Real>
struct RippleReading {
  Real torque_Nm = Real(0);  ///< measured minus ripple; the last one for a rejected sample
  Real ripple_Nm = Real(0);  ///< what was removed, from the samples before this one
  Real torque_all_removed_Nm = Real(0);  ///< likewise minus the orders that are kept
  Real torque_state_Nm = Real(0);        ///< the filter's own estimate T, smoother and later
  Real innovation_Nm = Real(0);          ///< 0 where nothing was learned
  Real innovation_variance_Nm2 = Real(0);
  Status status = 0;
};

namespace detail {

/// An interval beyond this is a fault of the clock, s.
inline constexpr float longest_interval_s = 1e6F;
/// A row that repeats the last one for longer than this is a motor that stands.
inline constexpr float longest_hold_s = 0.1F;
inline constexpr float speed_term_smoothing_s = 0.01F;
inline constexpr float load_smoothing_s = 1.0F / (6.2831853F * 15.0F);
/// Travel from one row to the next from which on an angle that stands is a held row, rad.
inline constexpr float least_travel_of_a_held_sample_rad = 0.01F;
/// Speed from one sample to the next beyond which an angle is taken for a fault, rad/s.
inline constexpr float largest_motor_speed_rad_s = 1e4F;

template <class Real>
constexpr Real share_of(Real interval_s, float time_constant_s) {
  return interval_s / (interval_s + static_cast<Real>(time_constant_s));
}

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real highest_order(const RippleFilterConfig<Real, MaxPairs>& config) {
  Real highest = Real(0);
  for (std::size_t a = 0; a < config.order_count && a < MaxPairs; ++a) {
    const Real order = to_real<Real>(config.orders[a].order);
    highest = order > highest ? order : highest;
  }
  return highest;
}

/// Takes in a phase: rotation, speeds and history.
template <class Real, std::size_t MaxPairs>
constexpr Status take_ripple_phase(const RippleFilterConfig<Real, MaxPairs>& config,
                                   RippleFilterState<Real, MaxPairs>& state, Phase now) {
  const Real interval_s = state.time_since_phase_s;
  const Real rotation_rad = to_radians<Real>(now - state.last_phase);
  const bool known = state.phase_known;
  state.phase_known = true;
  state.last_phase = now;
  state.time_since_phase_s = Real(0);
  if (!known) {
    return 0;
  }
  if (absolute(rotation_rad) > static_cast<Real>(largest_motor_speed_rad_s) * interval_s) {
    // A jump: an encoder that was set anew, or a wrong reading.  The way there was not travelled.
    state.history = AngleHistory<Real>{};
    state.learned_phase_known = false;
    return mask(StatusFlag::rotation_invalid);
  }
  const Real speed_rad_s = rotation_rad / interval_s;
  state.speed_rad_s +=
      share_of(interval_s, speed_term_smoothing_s) * (speed_rad_s - state.speed_rad_s);
  state.smoothed_speed_rad_s +=
      share_of(interval_s, speed_smoothing_s) * (speed_rad_s - state.smoothed_speed_rad_s);
  if (config.angle_to_torque_delay_s > Real(0)) {
    remember(state.history, config.angle_to_torque_delay_s, interval_s, rotation_rad);
  }
  const bool above = absolute(highest_order(config) * rotation_rad) > pi<Real>;
  return above ? mask(StatusFlag::order_above_nyquist) : Status{0};
}

/// Angle by which the torque of this moment is ahead of the last phase: back by the delay, and on
/// at the last speed where the angle is missing, because a motor does not stop within a sample.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real torque_offset_rad(const RippleFilterConfig<Real, MaxPairs>& config,
                                               const RippleFilterState<Real, MaxPairs>& state) {
  Real offset_rad = state.speed_rad_s * state.time_since_phase_s;
  if (config.angle_to_torque_delay_s > Real(0)) {
    offset_rad -= rotation_during(state.history, config.angle_to_torque_delay_s, state.speed_rad_s);
  } else {
    offset_rad -= state.speed_rad_s * config.angle_to_torque_delay_s;
  }
  return offset_rad;
}

/// Whether the angle that the torque belongs to is on record; at the start and after a jump of the
/// angle it is a guess for the length of the delay, good enough to remove ripple with but not to
/// learn from.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr bool reaches_back(const RippleFilterConfig<Real, MaxPairs>& config,
                                          const RippleFilterState<Real, MaxPairs>& state) {
  return config.angle_to_torque_delay_s <= Real(0) ||
         duration_of(state.history) >= config.angle_to_torque_delay_s;
}

/// True for a row that only repeats the last one: neither angle nor torque have changed although
/// the motor turns.  Equal torques alone prove nothing, a coarse converter repeats them.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr bool is_held(const RippleFilterState<Real, MaxPairs>& state,
                                     const RippleSample<Real>& sample) {
  return state.phase_known && sample.phase_valid && sample.torque_valid &&
         state.time_since_phase_s < static_cast<Real>(longest_hold_s) &&
         sample.motor_phase == state.last_phase && sample.measured_torque_Nm == state.measured_Nm &&
         absolute(state.speed_rad_s) * sample.interval_s >=
             static_cast<Real>(least_travel_of_a_held_sample_rad);
}

/// A sample that has been taken in: whether and what can be learned from it.
template <class Real, std::size_t MaxPairs>
struct RippleIntake {
  bool learnable = false;
  bool torque_usable = false;
  bool moving = false;
  bool held_or_late = false;    ///< the row brought nothing new; its reading is the last one
  Phase phase = {};             ///< that the torque belongs to
  Real rotation_rad = Real(0);  ///< since the last sample that was learned from
  Real rest_Nm = Real(0);       ///< what is left for T: measured less expected less all ripple
  Real expected_torque_Nm = Real(0);
  Regressors<Real, MaxPairs> regressors;
};

/// Sums of intervals end where single ones do: an infinite one would leave no speed.
template <class Real>
constexpr void add_time(Real& sum_s, Real interval_s) {
  sum_s += interval_s;
  if (sum_s > static_cast<Real>(longest_interval_s)) {
    sum_s = static_cast<Real>(longest_interval_s);
  }
}

/// Time and repetition: false where the row brings nothing new.
template <class Real, std::size_t MaxPairs>
constexpr bool take_time(RippleFilterState<Real, MaxPairs>& state, const RippleSample<Real>& sample,
                         RippleReading<Real>& reading) {
  if (!(absolute(sample.interval_s) <= static_cast<Real>(longest_interval_s))) {
    reading.status = mask(StatusFlag::time_not_finite);
    return false;
  }
  const bool first = !state.phase_known && !state.torque_known;
  if (first) {
    return true;
  }
  if (!(sample.interval_s > Real(0))) {
    reading.status = mask(StatusFlag::sample_out_of_order);
    return false;
  }
  add_time(state.time_since_phase_s, sample.interval_s);
  add_time(state.time_since_update_s, sample.interval_s);
  if (is_held(state, sample)) {
    reading.status = mask(StatusFlag::sample_repeated);
    return false;
  }
  return true;
}

/// Everything before learning: the reading is complete but for what learning adds.
template <class Real, std::size_t MaxPairs>
constexpr void take_in(const RippleFilterConfig<Real, MaxPairs>& config,
                       RippleFilterState<Real, MaxPairs>& state, const RippleSample<Real>& sample,
                       RippleIntake<Real, MaxPairs>& intake, RippleReading<Real>& reading) {
  reading.torque_Nm = state.torque_Nm;
  reading.torque_all_removed_Nm = state.torque_all_Nm;
  reading.ripple_Nm = state.measured_Nm - state.torque_Nm;
  reading.torque_state_Nm = state.states_Nm[0];
  intake.held_or_late = !take_time(state, sample, reading);
  if (intake.held_or_late) {
    return;
  }
  if (sample.phase_valid) {
    reading.status |= take_ripple_phase(config, state, sample.motor_phase);
  } else {
    reading.status |= mask(StatusFlag::rotation_invalid);
  }
  const bool phase_usable = !has(reading.status, StatusFlag::rotation_invalid);

  const Real offset_rad = torque_offset_rad(config, state);
  // Over a turn without an angle: to remove nothing is better than to remove at a guessed angle.
  const bool lost = state.time_since_phase_s > Real(0) &&
                    absolute(state.speed_rad_s * state.time_since_phase_s) > two_pi<Real>;
  Real kept_Nm = Real(0);
  reading.ripple_Nm = Real(0);
  if (state.phase_known && !lost) {
    intake.phase = offset_rad == Real(0) ? state.last_phase
                                         : state.last_phase + phase_from_radians(offset_rad);
    regressors_at(config, state, intake.phase, intake.regressors);
    const auto ripple = predicted_ripple(config, state, intake.regressors);
    kept_Nm = ripple.kept_Nm;
    reading.ripple_Nm = ripple.removed_Nm;
    if (sample.phase_referenced) {
      reading.ripple_Nm += frozen_torque_Nm(config, intake.phase);
    }
  }

  const bool torque_usable = sample.torque_valid && is_usable_torque(sample.measured_torque_Nm);
  const bool expected_usable = is_usable_torque(sample.expected_torque_Nm);
  if (sample.torque_valid && !torque_usable) {
    reading.status |= mask(StatusFlag::torque_not_finite);
  }
  if (!expected_usable) {
    reading.status |= mask(StatusFlag::expected_torque_not_finite);
  }
  if (!torque_usable) {
    return;
  }
  intake.torque_usable = true;
  state.measured_Nm = sample.measured_torque_Nm;
  state.torque_Nm = sample.measured_torque_Nm - reading.ripple_Nm;
  state.torque_all_Nm = state.torque_Nm - kept_Nm;
  reading.torque_Nm = state.torque_Nm;
  reading.torque_all_removed_Nm = state.torque_all_Nm;
  intake.learnable = expected_usable && phase_usable && reaches_back(config, state);
  intake.moving = absolute(state.smoothed_speed_rad_s) >= config.minimum_speed_rad_s;
  intake.expected_torque_Nm = sample.expected_torque_Nm;
  intake.rest_Nm = state.torque_all_Nm - sample.expected_torque_Nm;
  if (state.learned_phase_known) {
    intake.rotation_rad = to_radians<Real>(intake.phase - state.learned_phase);
  }
}

/// What the next sample's learning has to know about this one.
template <class Real, std::size_t MaxPairs>
constexpr void finish_learning(RippleFilterState<Real, MaxPairs>& state,
                               const RippleIntake<Real, MaxPairs>& intake,
                               RippleReading<Real>& reading) {
  if (!intake.moving) {
    reading.status |= mask(StatusFlag::at_rest);
  }
  reading.torque_state_Nm = state.states_Nm[0] + intake.expected_torque_Nm;
  state.learned_phase = intake.phase;
  const Real interval_s = state.time_since_update_s;
  state.time_since_update_s = Real(0);
  if (!state.learned_phase_known) {  // the first: what came before it was waiting
    state.learned_phase_known = true;
    state.load_Nm = state.torque_all_Nm;
    return;
  }
  state.load_Nm += share_of(interval_s, load_smoothing_s) * (state.torque_all_Nm - state.load_Nm);
  const Real longest_s = Real(2) * state.typical_interval_s;
  if (state.typical_interval_s > Real(0)) {
    const Real counted_s = interval_s < longest_s ? interval_s : longest_s;
    state.typical_interval_s += (counted_s - state.typical_interval_s) / Real(64);
  } else {
    state.typical_interval_s = interval_s;
  }
}

}  // namespace detail

}  // namespace strainwave
