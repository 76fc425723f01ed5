// SPDX-License-Identifier: Apache-2.0
/// @file published.hpp
/// The published filter in a motion with changing speed, and every fault its samples can have.
#pragma once

#include <limits>

#include "run.hpp"
#include "strainwave/oscillator_filter.hpp"

template <std::size_t Orders>
struct Published {
  using State = strainwave::OscillatorFilterState<float, Orders>;
  using Sample = strainwave::OscillatorSample<float>;
  static constexpr std::uint32_t fault_blocks = 8;
  static constexpr std::uint32_t config_bytes =
      sizeof(strainwave::OscillatorFilterConfig<float, Orders>);

  std::uint32_t k = 0;
  strainwave::Phase angle;

  Sample next(bool with_faults) {
    ++k;
    Sample sample;
    // 60 to 156 rad/s, both ways.
    const auto swing = static_cast<float>(k % 512U < 256U ? k % 256U : 256U - k % 256U);
    sample.motor_speed_rad_s = (k % 1024U < 512U ? 1.0F : -1.0F) * (60.0F + 0.375F * swing);
    angle = angle + strainwave::phase_from_radians(sample.motor_speed_rad_s * 1e-3F);
    const auto second = strainwave::cos_sin_of_fraction<float>(2U * angle.fraction);
    const auto fourth = strainwave::cos_sin_of_fraction<float>(4U * angle.fraction);
    sample.measured_torque_Nm = 5.0F + 1.6F * second.cosine + 0.6F * fourth.sine;
    if (with_faults) {
      spoil(sample);
    }
    return sample;
  }

  void spoil(Sample& sample) const {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinite = std::numeric_limits<float>::infinity();
    switch (k % 16U) {
      case 1:
        sample.measured_torque_Nm = nan;
        break;
      case 3:
        sample.motor_speed_rad_s = infinite;
        break;
      case 5:
        sample.expected_torque_Nm = nan;
        break;
      case 6:
        sample.torque_valid = false;
        break;
      case 8:
        sample.measured_torque_Nm = -infinite;
        sample.motor_speed_rad_s = nan;
        break;
      case 10:
        sample.motor_speed_rad_s = 0.0F;
        break;
      case 12:
        sample.motor_speed_rad_s = 9e5F;
        break;  // above Nyquist
      case 13:
        sample.measured_torque_Nm = 1e14F;
        break;
      default:
        break;
    }
  }
};
