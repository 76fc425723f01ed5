// SPDX-License-Identifier: Apache-2.0
/// @file gauges.hpp
/// The chain of four gauges in motion, and every fault its samples can have.
#pragma once

#include <limits>

#include "run.hpp"
#include "signals.hpp"

struct Gauges {
  using State = joint::SensorState;
  using Sample = joint::Sample;
  static constexpr std::uint32_t fault_blocks = 16;
  static constexpr std::uint32_t config_bytes = sizeof(joint::SensorConfig);

  signals::Joint turning;
  strainwave::EncoderCounter encoder;
  std::uint32_t skipped = 0;
  std::uint32_t broken = 0;

  static State initial() { return strainwave::initial_state(joint::sensor); }

  Sample next(bool with_faults) {
    Sample sample;
    turning.advance(50);  // 153 rad/s
    sample.motor_phase = strainwave::phase_from_counts(encoder.update(turning.encoder_counts()),
                                                       joint::counts_per_turn);
    turning.read(sample.motor_phase, sample.codes);
    sample.sequence = turning.sequence() + skipped;
    if (with_faults) {
      spoil(sample);
    }
    return sample;
  }

  /// Half of the samples are spoilt one way each; then gauge 2 goes to its rail for good, and gauge
  /// 3 disagrees now and then besides.
  void spoil(Sample& sample) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    ++broken;
    switch (broken % 32U) {
      case 1:
        sample.codes[0].value = 32767;
        break;
      case 3:
        sample.temperature_degC = nan;
        break;
      case 5:
        sample.expected_torque_Nm = nan;
        break;
      case 7:
        sample.phase_valid = false;
        break;
      case 9:
        sample.phase_referenced = false;
        break;
      case 11:
        skipped += 1000;
        sample.sequence += 1000;
        break;  // a gap
      case 13:
        --sample.sequence;
        break;  // repeated
      case 15:
        sample.sequence -= 5;
        break;  // late
      case 17:
        skipped = 0U - turning.sequence();
        sample.sequence = 0;
        break;  // restart
      case 19:
        sample.motor_phase.turns += 1;
        break;  // a jump of the angle
      case 21:
        sample.interval_s = nan;
        break;
      case 23:
        sample.interval_s = 0.5F;
        break;
      case 25:
        for (auto& code : sample.codes) {
          code.value = -32768;
        }
        break;  // overload
      case 27:
        sample.codes[3].value /= 2;
        break;  // inconsistent
      case 29:
        sample.temperature_degC = 500.0F;
        break;
      case 31:
        sample.codes[1].value += 8000;
        sample.codes[2].value -= 8000;
        break;
      default:
        break;
    }
    if (broken > 512) {
      sample.codes[1].value = 32767;
    }
  }
};
