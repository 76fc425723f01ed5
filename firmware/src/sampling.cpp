// SPDX-License-Identifier: Apache-2.0
/// @file sampling.cpp
/// SysTick at 8 kHz: converter codes and encoder in, clean torque out.

#include "sampling.hpp"

#include "board.hpp"
#include "strainwave/torque_sensor.hpp"

namespace {

joint::SensorState state;
strainwave::EncoderCounter encoder;
signals::Joint turning;
sampling::Report now;

/// Even while nobody writes: the background copies, and looks whether it was the same throughout.
volatile std::uint32_t writes = 0;

joint::Sample take_sample() {
  joint::Sample sample;
  turning.advance(50);  // 153 rad/s
  sample.motor_phase = strainwave::phase_from_counts(encoder.update(turning.encoder_counts()),
                                                     joint::counts_per_turn);
  turning.read(sample.motor_phase, sample.codes);
  sample.sequence = turning.sequence();
  return sample;
}

/// One sample through the chain.
void measure() {
  const joint::Sample sample = take_sample();
  const auto reading = step(joint::sensor, state, sample);
  now.torque_Nm = reading.torque_Nm;
  now.measured_Nm = reading.torque_measured_Nm;
  now.load_Nm = turning.load_Nm();
  const float error_Nm = reading.torque_Nm - turning.load_Nm();
  now.mean_square_Nm2 += 1e-3F * (error_Nm * error_Nm - now.mean_square_Nm2);
  now.status = reading.status;
}

template <class Value, class Read>
Value consistent(Read read) {
  for (;;) {
    const std::uint32_t before = writes;
    Value value = read();
    __asm volatile("" ::: "memory");
    if (before == writes) {
      return value;
    }
  }
}

}  // namespace

/// The sample path.  Flattened: the constant configuration then folds into it.  With a spoilt joint
/// it counts, so that the watchdog is content, and the torque stays 0.
extern "C" [[gnu::flatten]] void systick_handler() {
  ++now.samples;
  if (now.joint_intact) {
    measure();
  }
  writes = writes + 1;
}

namespace sampling {

keeper::Found start() {
  now.joint_intact = joint::exported::joint_is_intact();
  keeper::Found found = keeper::Found::nothing;
  if (now.joint_intact) {
    state = joint::exported::power_up_state();
    found = keeper::restore(state);
  }
  reg(board::systick_reload) = board::clock_Hz / joint::sample_rate_Hz - 1;
  reg(board::systick_value) = 0;
  reg(board::systick_control) = 7;  // the processor's clock, with interrupt
  return found;
}

Report report() {
  return consistent<Report>([] { return now; });
}

strainwave::LearnedRipple<float, joint::pairs> learned() {
  return consistent<strainwave::LearnedRipple<float, joint::pairs>>(
      [] { return strainwave::learned(joint::sensor.filter, state.filter); });
}

void break_down() { reg(board::systick_control) = 0; }

}  // namespace sampling
