// SPDX-License-Identifier: Apache-2.0
/// @file signals.hpp
/// What the gauges of a turning joint read, in place of a converter and an encoder.
#pragma once

#include <cstdint>

#include "joint.hpp"

namespace signals {

/// The joint's own motion and load, sample by sample, the same in every run.
class Joint {
 public:
  /// Ripple of orders 2 and 4, Nm: what the filter has to find.
  static constexpr float ripple_Nm(std::uint32_t turn_fraction) {
    const auto second = strainwave::cos_sin_of_fraction<float>(2U * turn_fraction);
    const auto fourth = strainwave::cos_sin_of_fraction<float>(4U * turn_fraction);
    return 1.6F * second.cosine + 0.6F * fourth.sine;
  }

  /// Takes the joint one sample on; counts of the encoder a sample.
  void advance(std::int32_t counts) {
    counts_ += static_cast<std::uint32_t>(counts);
    ++sequence_;
    // Load: a triangle of 1.6 s between -8 and 8 Nm.
    const std::uint32_t place = sequence_ % 12800U;
    const auto rise = static_cast<float>(place < 6400U ? place : 12800U - place);
    load_Nm_ = rise * (16.0F / 6400.0F) - 8.0F;
  }

  [[nodiscard]] float load_Nm() const { return load_Nm_; }
  [[nodiscard]] std::uint32_t encoder_counts() const { return counts_; }
  [[nodiscard]] std::uint32_t sequence() const { return sequence_; }

  /// What the four converters read at this angle of the motor.
  void read(strainwave::Phase motor, strainwave::ConverterCode* codes) {
    const std::uint32_t fraction = motor.fraction;
    const float artefact_Nm = ripple_Nm(fraction) + joint::misalignment_Nm(motor);
    const float gauge_V = (load_Nm_ + artefact_Nm) / joint::torque_Nm_per_V;
    for (std::uint32_t j = 0; j < joint::gauge_count; ++j) {
      const float wave_V =
          joint::wave_V * strainwave::cos_sin_of_fraction<float>(2U * fraction + (j << 30U)).sine;
      codes[j] = strainwave::to_code(joint::sensor.converter, gauge_V + wave_V + noise_V());
    }
  }

 private:
  /// Uniform within +-2 mV, some 6 steps of the converter.
  float noise_V() {
    seed_ = seed_ * 1664525U + 1013904223U;
    return static_cast<float>(static_cast<std::int32_t>(seed_) >> 8U) * (2e-3F / 8388608.0F);
  }

  std::uint32_t counts_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint32_t seed_ = 12345;
  float load_Nm_ = -8.0F;
};

}  // namespace signals
