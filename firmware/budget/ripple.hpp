// SPDX-License-Identifier: Apache-2.0
/// @file ripple.hpp
/// The ripple filter in motion, and every fault its samples can have.
#pragma once

#include <limits>

#include "run.hpp"
#include "signals.hpp"
#include "strainwave/ripple_filter.hpp"

/// The defaults with orders 2, 4 and 6.
template <std::size_t Pairs>
constexpr strainwave::RippleFilterConfig<float, Pairs> three_orders(bool with_load_and_speed) {
  strainwave::RippleFilterConfig<float, Pairs> config;
  config.order_count = 3;
  for (std::uint32_t a = 0; a < 3; ++a) {
    config.orders[a].order = {2 * (a + 1), 1};
    config.orders[a].with_load = with_load_and_speed;
    config.orders[a].with_speed = with_load_and_speed;
  }
  return config;
}

template <std::size_t Pairs>
struct Ripple {
  using State = strainwave::RippleFilterState<float, Pairs>;
  using Sample = strainwave::RippleSample<float>;
  static constexpr std::uint32_t fault_blocks = 8;
  static constexpr std::uint32_t config_bytes =
      sizeof(strainwave::RippleFilterConfig<float, Pairs>);

  signals::Joint turning;
  strainwave::EncoderCounter encoder;
  std::uint32_t broken = 0;

  Sample next(bool with_faults) {
    Sample sample;
    turning.advance(50);  // 153 rad/s
    sample.motor_phase = strainwave::phase_from_counts(encoder.update(turning.encoder_counts()),
                                                       joint::counts_per_turn);
    sample.measured_torque_Nm =
        turning.load_Nm() + signals::Joint::ripple_Nm(sample.motor_phase.fraction);
    sample.interval_s = 1.0F / static_cast<float>(joint::sample_rate_Hz);
    if (with_faults) {
      spoil(sample);
    }
    return sample;
  }

  void spoil(Sample& sample) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    ++broken;
    switch (broken % 20U) {
      case 1:
        sample.measured_torque_Nm = nan;
        break;
      case 3:
        sample.expected_torque_Nm = nan;
        break;
      case 5:
        sample.phase_valid = false;
        break;
      case 7:
        sample.interval_s = nan;
        break;
      case 9:
        sample.interval_s = 0.5F;
        break;  // a gap
      case 11:
        sample.motor_phase.turns += 1;
        break;  // a jump of the angle
      case 13:
        sample.torque_valid = false;
        break;
      case 15:
        sample.measured_torque_Nm += 20.0F;
        break;  // a contact
      case 17:
        sample.interval_s = 0.0F;
        break;  // repeated
      case 19:
        sample.phase_referenced = false;
        break;
      default:
        break;
    }
  }
};
