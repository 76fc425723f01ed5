/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file strainwave.h
 * The sensor for firmware in C (C11 or C++20): one exported joint, from converter codes to torque.
 *
 * Include strainwave_joint.h, which `strainwave export` writes beside the joint's C++ header; it
 * says how many gauges there are and how large the state is, and includes this file.  Compile
 * strainwave_joint.cpp, written there too, as C++20, and link it; it needs no C++ library.
 *
 * No function allocates, blocks or keeps a state of its own; all take the caller's state and may be
 * called for several states.  A state must not be used by two interrupts at once.
 */
#ifndef STRAINWAVE_STRAINWAVE_H
#define STRAINWAVE_STRAINWAVE_H

#if !defined(STRAINWAVE_GAUGES) || !defined(STRAINWAVE_STATE_BYTES) || \
    !defined(STRAINWAVE_LEARNED_WORDS)
#error "strainwave.h: include strainwave_joint.h instead, which strainwave export writes"
#endif

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef STRAINWAVE_DOUBLE
typedef double strainwave_real;
#else
typedef float strainwave_real;
#endif

/* NOLINTBEGIN(cppcoreguidelines-use-enum-class) - C has no other */
/** What a function did.  Everything but STRAINWAVE_OK changed nothing. */
enum {
  STRAINWAVE_OK = 0,
  STRAINWAVE_JOINT_CORRUPT = 1,      /**< the image's configuration is not what was exported */
  STRAINWAVE_NOT_STARTED = 2,        /**< strainwave_init() has not succeeded on this state */
  STRAINWAVE_NULL_POINTER = 3,       /**< an argument is a null pointer */
  STRAINWAVE_BLOCK_DAMAGED = 4,      /**< erased, cut short, or bits have flipped */
  STRAINWAVE_BLOCK_OTHER_FORMAT = 5, /**< of another precision, capacity or version */
  STRAINWAVE_BLOCK_OTHER_FILTER = 6, /**< of other orders, or values out of range */
  STRAINWAVE_NOTHING_LEARNED = 7     /**< the joint's filter keeps no coefficients */
};
typedef int32_t strainwave_result;

/** Bits of a reading's status; strainwave/status.hpp has the same and says more. */
enum {
  STRAINWAVE_TORQUE_NOT_FINITE = 1 << 0,
  STRAINWAVE_ROTATION_INVALID = 1 << 1,
  STRAINWAVE_EXPECTED_TORQUE_NOT_FINITE = 1 << 2,
  STRAINWAVE_GAUGE_SATURATED = 1 << 3,
  STRAINWAVE_TEMPERATURE_NOT_FINITE = 1 << 4,
  STRAINWAVE_SAMPLE_REPEATED = 1 << 5,
  STRAINWAVE_SAMPLE_OUT_OF_ORDER = 1 << 6,
  STRAINWAVE_TIME_NOT_FINITE = 1 << 7,
  STRAINWAVE_GAUGES_INSUFFICIENT = 1 << 8,
  STRAINWAVE_VARIANCE_LIMITED = 1 << 12,
  STRAINWAVE_COVARIANCE_RESET = 1 << 13,
  STRAINWAVE_AT_REST = 1 << 20,
  STRAINWAVE_SAMPLES_MISSING = 1 << 21,
  STRAINWAVE_ORDER_ABOVE_NYQUIST = 1 << 22,
  STRAINWAVE_TEMPERATURE_OUT_OF_RANGE = 1 << 23,
  STRAINWAVE_GAUGE_LOST = 1 << 24,
  STRAINWAVE_GAUGE_SUSPECTED = 1 << 25,
  STRAINWAVE_GAUGES_DISAGREE = 1 << 26
};
/** The sample was not used, or only in part; the last good torque is held. */
#define STRAINWAVE_FAULTS UINT32_C(0x00000FFF)
/** A protection acted. */
#define STRAINWAVE_LIMITS UINT32_C(0x000FF000)
/** The sample was used, but the reader should know something. */
#define STRAINWAVE_WARNINGS UINT32_C(0xFFF00000)

/** What has become of a lost gauge. */
enum {
  STRAINWAVE_GAUGE_FAULT_NONE = 0,
  STRAINWAVE_GAUGE_FAULT_OPEN = 1,
  STRAINWAVE_GAUGE_FAULT_SHORTED = 2,
  STRAINWAVE_GAUGE_FAULT_STUCK = 3,
  STRAINWAVE_GAUGE_FAULT_SATURATED = 4,
  STRAINWAVE_GAUGE_FAULT_INCONSISTENT = 5
};
/* NOLINTEND(cppcoreguidelines-use-enum-class) */

/** All that changes from sample to sample.  May lie in static memory or on a stack; not to be
    copied while an interrupt uses it. */
typedef union strainwave_state {
  uint64_t alignment;
  unsigned char bytes[STRAINWAVE_STATE_BYTES];
} strainwave_state;

/** Learned coefficients as words for a flash page or backup memory; checked when they come back. */
typedef struct strainwave_learned {
  uint32_t words[STRAINWAVE_LEARNED_WORDS];
} strainwave_learned;

/** Angle of the motor's shaft: whole turns and a fraction in units of 2^-32 turn. */
typedef struct strainwave_phase {
  int64_t turns;
  uint32_t fraction;
} strainwave_phase;

/** Extends an encoder count that wraps at 32 bits; begin with zeros. */
typedef struct strainwave_encoder {
  int64_t counts;
  uint32_t last_raw;
  bool started;
} strainwave_encoder;

/** One sample.  Begin with strainwave_default_inputs(), which says what is said of most samples. */
typedef struct strainwave_inputs {
  int32_t codes[STRAINWAVE_GAUGES]; /**< converter codes, in the order of the joint file */
  strainwave_real expected_torque_Nm;
  strainwave_real motor_speed_rad_s; /**< used by the published filter that turns by speed */
  strainwave_phase motor_phase;
  strainwave_real interval_s; /**< since the sample before; 0: by sample numbers and their period */
  strainwave_real temperature_degC;
  uint32_t sequence;     /**< counts samples as the converter took them, wraps at 32 bits */
  bool sequence_valid;   /**< false where there are no sample numbers */
  bool phase_valid;      /**< false where there is no angle for this sample */
  bool phase_referenced; /**< false where the angle counts from an unknown zero */
} strainwave_inputs;

typedef struct strainwave_outputs {
  strainwave_real torque_measured_Nm; /**< calibrated, ripple included */
  strainwave_real torque_Nm;          /**< ripple removed */
  strainwave_real ripple_Nm;
  strainwave_real residual_fluctuation_Nm; /**< rms that the gains in use leave, as far as known */
  uint32_t status;
  uint8_t left_out_gauge; /**< number of the gauge that is not used, from 1; 0: none */
  uint8_t gauge_fault;    /**< STRAINWAVE_GAUGE_FAULT_... of the lost gauge */
} strainwave_outputs;

/** Whether the configuration in this image is still what was exported; reads it from memory. */
bool strainwave_joint_is_intact(void);

/** The joint file's canonical hash, 64 hexadecimal digits, and the version that exported it. */
const char* strainwave_joint_hash(void);
const char* strainwave_joint_version(void);

/** Brings a state to power-up, with the joint file's learned coefficients where it has some.
    STRAINWAVE_JOINT_CORRUPT: the state is unusable, and strainwave_step() gives no torque. */
strainwave_result strainwave_init(strainwave_state* state);

/** The motor not moving, angle, number and reference known, reference temperature. */
void strainwave_default_inputs(strainwave_inputs* inputs);

/** One sample.  With any result but STRAINWAVE_OK all outputs are 0, where there are outputs. */
strainwave_result strainwave_step(strainwave_state* state, const strainwave_inputs* inputs,
                                  strainwave_outputs* outputs);

/** Writes what the filter has learned; call it where no interrupt steps the state meanwhile. */
strainwave_result strainwave_save_learned(const strainwave_state* state, strainwave_learned* block);

/** Starts the filter anew with a block; one that cannot be used changes nothing. */
strainwave_result strainwave_restore_learned(strainwave_state* state,
                                             const strainwave_learned* block);

/** Forgets the loss of a gauge, after its repair. */
strainwave_result strainwave_clear_lost_gauge(strainwave_state* state);

/** How many samples had one flag, STRAINWAVE_GAUGE_SATURATED for example; flag 0: all samples.
    Counts stay at their largest value; 0 for a state that was not started. */
uint32_t strainwave_event_count(const strainwave_state* state, uint32_t flag);

/** Phase of a position in counts; counts_per_turn 0 gives the zero. */
strainwave_phase strainwave_phase_of_counts(int64_t counts, uint32_t counts_per_turn);

/** Takes an encoder's next raw count, moved by less than 2^31 since the last one. */
strainwave_phase strainwave_encoder_phase(strainwave_encoder* encoder, uint32_t raw,
                                          uint32_t counts_per_turn);

#ifdef __cplusplus
}
#endif

#endif /* STRAINWAVE_STRAINWAVE_H */
