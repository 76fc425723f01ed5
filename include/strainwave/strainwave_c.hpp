// SPDX-License-Identifier: Apache-2.0
/// @file strainwave_c.hpp
/// The functions of strainwave.h for one exported joint.
///
/// Included once, by the strainwave_joint.cpp that `strainwave export` writes, after the joint's
/// header, with STRAINWAVE_JOINT defined as its namespace.
#pragma once

#if !defined(STRAINWAVE_JOINT)
#error "strainwave_c.hpp: compile the strainwave_joint.cpp that strainwave export writes"
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "strainwave/learned_block.hpp"
#include "strainwave/strainwave.h"

namespace strainwave::c_interface {

namespace joint = ::STRAINWAVE_JOINT;

/// What lies in a strainwave_state.
struct Storage {
  std::uint32_t mark = 0;  ///< started_mark once initialised
  joint::State state = {};
};

static_assert(std::is_same_v<strainwave_real, joint::Real>,
              "strainwave: strainwave_joint.h and the joint's header differ in precision");
static_assert(STRAINWAVE_GAUGES == joint::gauge_capacity,
              "strainwave: strainwave_joint.h and the joint's header differ in gauges");
static_assert(sizeof(Storage) <= sizeof(strainwave_state) &&
                  alignof(Storage) <= alignof(strainwave_state),
              "strainwave: STRAINWAVE_STATE_BYTES is too small; export the joint again");
// The caller's bytes become a Storage by being used as one.
static_assert(std::is_trivially_copyable_v<Storage> && std::is_aggregate_v<Storage>);

#define STRAINWAVE_SAME(name, flag)                                                      \
  static_assert(static_cast<std::uint32_t>(STRAINWAVE_##name) == mask(StatusFlag::flag), \
                "strainwave: strainwave.h and status.hpp differ in " #flag)
STRAINWAVE_SAME(TORQUE_NOT_FINITE, torque_not_finite);
STRAINWAVE_SAME(ROTATION_INVALID, rotation_invalid);
STRAINWAVE_SAME(EXPECTED_TORQUE_NOT_FINITE, expected_torque_not_finite);
STRAINWAVE_SAME(GAUGE_SATURATED, gauge_saturated);
STRAINWAVE_SAME(TEMPERATURE_NOT_FINITE, temperature_not_finite);
STRAINWAVE_SAME(SAMPLE_REPEATED, sample_repeated);
STRAINWAVE_SAME(SAMPLE_OUT_OF_ORDER, sample_out_of_order);
STRAINWAVE_SAME(TIME_NOT_FINITE, time_not_finite);
STRAINWAVE_SAME(GAUGES_INSUFFICIENT, gauges_insufficient);
STRAINWAVE_SAME(VARIANCE_LIMITED, variance_limited);
STRAINWAVE_SAME(COVARIANCE_RESET, covariance_reset);
STRAINWAVE_SAME(AT_REST, at_rest);
STRAINWAVE_SAME(SAMPLES_MISSING, samples_missing);
STRAINWAVE_SAME(ORDER_ABOVE_NYQUIST, order_above_nyquist);
STRAINWAVE_SAME(TEMPERATURE_OUT_OF_RANGE, temperature_out_of_range);
STRAINWAVE_SAME(GAUGE_LOST, gauge_lost);
STRAINWAVE_SAME(GAUGE_SUSPECTED, gauge_suspected);
STRAINWAVE_SAME(GAUGES_DISAGREE, gauges_disagree);
#undef STRAINWAVE_SAME
static_assert(STRAINWAVE_FAULTS == fault_mask && STRAINWAVE_LIMITS == limit_mask &&
              STRAINWAVE_WARNINGS == warning_mask);

#define STRAINWAVE_SAME(name, fault)                                                  \
  static_assert(STRAINWAVE_GAUGE_FAULT_##name == static_cast<int>(GaugeFault::fault), \
                "strainwave: strainwave.h and gauge_monitor_config.hpp differ in " #fault)
STRAINWAVE_SAME(NONE, none);
STRAINWAVE_SAME(OPEN, open);
STRAINWAVE_SAME(SHORTED, shorted);
STRAINWAVE_SAME(STUCK, stuck);
STRAINWAVE_SAME(SATURATED, saturated);
STRAINWAVE_SAME(INCONSISTENT, inconsistent);
#undef STRAINWAVE_SAME

/// Another joint's state, or memory that was never initialised, has another mark.
inline constexpr std::uint32_t started_mark = joint::checksum ^ 0x53574A31U;

// NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast) - bytes are all that C can hold
[[nodiscard]] inline Storage* storage_of(strainwave_state* state) {
  return reinterpret_cast<Storage*>(state->bytes);
}
[[nodiscard]] inline const Storage* storage_of(const strainwave_state* state) {
  return reinterpret_cast<const Storage*>(state->bytes);
}
// NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)

/// What forbids to use a state with the other arguments; STRAINWAVE_OK where nothing does.
[[nodiscard]] inline strainwave_result usability(const strainwave_state* state, const void* other) {
  if (state == nullptr || other == nullptr) {
    return STRAINWAVE_NULL_POINTER;
  }
  return storage_of(state)->mark == started_mark ? STRAINWAVE_OK : STRAINWAVE_NOT_STARTED;
}

[[nodiscard]] inline joint::Sample sample_of(const strainwave_inputs& inputs) {
  joint::Sample sample;
  for (std::size_t j = 0; j < joint::gauge_capacity; ++j) {
    sample.codes[j] = {inputs.codes[j]};
  }
  sample.expected_torque_Nm = inputs.expected_torque_Nm;
  sample.motor_speed_rad_s = inputs.motor_speed_rad_s;
  sample.motor_phase = {inputs.motor_phase.turns, inputs.motor_phase.fraction};
  sample.phase_valid = inputs.phase_valid;
  sample.phase_referenced = inputs.phase_referenced;
  sample.interval_s = inputs.interval_s;
  sample.temperature_degC = inputs.temperature_degC;
  sample.sequence = inputs.sequence;
  sample.sequence_valid = inputs.sequence_valid;
  return sample;
}

[[nodiscard]] inline strainwave_outputs outputs_of(const joint::Reading& reading) {
  strainwave_outputs outputs = {};
  outputs.torque_measured_Nm = reading.torque_measured_Nm;
  outputs.torque_Nm = reading.torque_Nm;
  outputs.ripple_Nm = reading.ripple_Nm;
  outputs.residual_fluctuation_Nm = reading.residual_fluctuation_Nm;
  outputs.status = reading.status;
  outputs.left_out_gauge = reading.left_out_gauge;
  outputs.gauge_fault = static_cast<std::uint8_t>(reading.gauge_fault);
  return outputs;
}

/// What is learned, for joints whose filter keeps coefficients; the published filter keeps none.
template <class FilterConfig>
struct Keeper {
  static strainwave_result save(const joint::State& /*state*/, strainwave_learned& /*block*/) {
    return STRAINWAVE_NOTHING_LEARNED;
  }
  static strainwave_result restore(joint::State& /*state*/, const strainwave_learned& /*block*/) {
    return STRAINWAVE_NOTHING_LEARNED;
  }
};

template <class Real, std::size_t MaxPairs>
struct Keeper<RippleFilterConfig<Real, MaxPairs>> {
  using Block = LearnedBlock<Real, MaxPairs>;
  static_assert(STRAINWAVE_LEARNED_WORDS == Block::size,
                "strainwave: strainwave_joint.h and the joint's header differ in coefficients");

  template <class State>
  static strainwave_result save(const State& state, strainwave_learned& block) {
    Block packed;
    save_learned(joint::config, state, packed);
    for (std::size_t i = 0; i < Block::size; ++i) {
      block.words[i] = packed.words[i];
    }
    return STRAINWAVE_OK;
  }

  template <class State>
  static strainwave_result restore(State& state, const strainwave_learned& block) {
    Block packed;
    for (std::size_t i = 0; i < Block::size; ++i) {
      packed.words[i] = block.words[i];
    }
    switch (restore_learned(joint::config, state, packed)) {
      case BlockFault::none:
        return STRAINWAVE_OK;
      case BlockFault::other_format:
        return STRAINWAVE_BLOCK_OTHER_FORMAT;
      case BlockFault::other_filter:
        return STRAINWAVE_BLOCK_OTHER_FILTER;
      default:
        return STRAINWAVE_BLOCK_DAMAGED;
    }
  }
};

using JointKeeper = Keeper<std::remove_const_t<decltype(joint::config.filter)>>;

}  // namespace strainwave::c_interface

// NOLINTBEGIN(misc-definitions-in-headers) - this file is compiled once, by strainwave_joint.cpp
extern "C" {

bool strainwave_joint_is_intact(void) { return strainwave::c_interface::joint::joint_is_intact(); }

const char* strainwave_joint_hash(void) { return strainwave::c_interface::joint::joint_hash; }

const char* strainwave_joint_version(void) {
  return strainwave::c_interface::joint::software_version;
}

strainwave_result strainwave_init(strainwave_state* state) {
  namespace c = strainwave::c_interface;
  if (state == nullptr) {
    return STRAINWAVE_NULL_POINTER;
  }
  c::Storage* const storage = c::storage_of(state);
  storage->mark = 0;
  if (!c::joint::joint_is_intact()) {
    return STRAINWAVE_JOINT_CORRUPT;
  }
  storage->state = c::joint::power_up_state();
  storage->mark = c::started_mark;
  return STRAINWAVE_OK;
}

void strainwave_default_inputs(strainwave_inputs* inputs) {
  namespace c = strainwave::c_interface;
  if (inputs == nullptr) {
    return;
  }
  *inputs = strainwave_inputs{};
  inputs->temperature_degC = c::joint::config.calibration.reference_temperature_degC;
  inputs->sequence_valid = true;
  inputs->phase_valid = true;
  inputs->phase_referenced = true;
}

strainwave_result strainwave_step(strainwave_state* state, const strainwave_inputs* inputs,
                                  strainwave_outputs* outputs) {
  namespace c = strainwave::c_interface;
  if (outputs == nullptr) {
    return STRAINWAVE_NULL_POINTER;
  }
  const strainwave_result usable = c::usability(state, inputs);
  if (usable != STRAINWAVE_OK) {
    *outputs = strainwave_outputs{};
    return usable;
  }
  *outputs = c::outputs_of(
      strainwave::step(c::joint::config, c::storage_of(state)->state, c::sample_of(*inputs)));
  return STRAINWAVE_OK;
}

strainwave_result strainwave_save_learned(const strainwave_state* state,
                                          strainwave_learned* block) {
  namespace c = strainwave::c_interface;
  const strainwave_result usable = c::usability(state, block);
  return usable != STRAINWAVE_OK ? usable
                                 : c::JointKeeper::save(c::storage_of(state)->state, *block);
}

strainwave_result strainwave_restore_learned(strainwave_state* state,
                                             const strainwave_learned* block) {
  namespace c = strainwave::c_interface;
  const strainwave_result usable = c::usability(state, block);
  return usable != STRAINWAVE_OK ? usable
                                 : c::JointKeeper::restore(c::storage_of(state)->state, *block);
}

strainwave_result strainwave_clear_lost_gauge(strainwave_state* state) {
  namespace c = strainwave::c_interface;
  const strainwave_result usable = c::usability(state, state);
  if (usable == STRAINWAVE_OK) {
    strainwave::clear_lost_gauge(c::storage_of(state)->state.monitor);
  }
  return usable;
}

std::uint32_t strainwave_event_count(const strainwave_state* state, std::uint32_t flag) {
  namespace c = strainwave::c_interface;
  if (c::usability(state, state) != STRAINWAVE_OK) {
    return 0;
  }
  const strainwave::EventCounters& counters = c::storage_of(state)->state.counters;
  for (std::size_t bit = 0; bit < 32; ++bit) {
    if (flag == std::uint32_t{1} << bit) {
      return counters.by_bit[bit];
    }
  }
  return flag == 0 ? counters.samples : 0;
}

strainwave_phase strainwave_phase_of_counts(std::int64_t counts, std::uint32_t counts_per_turn) {
  if (counts_per_turn == 0) {
    return {0, 0};
  }
  const strainwave::Phase phase = strainwave::phase_from_counts(counts, counts_per_turn);
  return {phase.turns, phase.fraction};
}

strainwave_phase strainwave_encoder_phase(strainwave_encoder* encoder, std::uint32_t raw,
                                          std::uint32_t counts_per_turn) {
  if (encoder == nullptr) {
    return {0, 0};
  }
  strainwave::EncoderCounter counter = {encoder->counts, encoder->last_raw, encoder->started};
  const std::int64_t counts = counter.update(raw);
  *encoder = {counter.counts, counter.last_raw, counter.started};
  return strainwave_phase_of_counts(counts, counts_per_turn);
}

}  // extern "C"
// NOLINTEND(misc-definitions-in-headers)
