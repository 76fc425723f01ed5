// The golden vectors' samples, made by the same whole-number arithmetic as in
// benchmarks/golden/inputs.py; freestanding, so that the firmware makes them, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "golden_vectors.hpp"

namespace golden {

/// Codes that stand for what is no number.
inline constexpr std::int64_t nan_code = -2147483648LL;
inline constexpr std::int64_t infinity_code = -2147483647LL;
inline constexpr std::int64_t ticks_a_sample = 1024;
inline constexpr std::size_t gauge_count = 4;

/// CRC-32 as in zlib.
class Checksum {
 public:
  template <class Whole>
  constexpr void add(Whole value) {
    for (std::size_t byte = 0; byte < sizeof(Whole); ++byte) {
      crc_ ^= static_cast<std::uint32_t>(value >> (8 * byte)) & 0xFFU;
      for (int bit = 0; bit < 8; ++bit) {
        crc_ = (crc_ >> 1U) ^ ((crc_ & 1U) != 0U ? 0xEDB88320U : 0U);
      }
    }
  }
  [[nodiscard]] constexpr std::uint32_t value() const { return ~crc_; }

 private:
  std::uint32_t crc_ = 0xFFFFFFFFU;
};

/// A sample as converters, encoder and clock deliver it.
struct RawSample {
  std::int64_t ticks = 0;  ///< 2^-20 s
  std::uint32_t sequence = 0;
  std::uint32_t encoder = 0;
  std::int64_t torque = 0;       ///< 2^-12 Nm
  std::int64_t expected = 0;     ///< 2^-12 Nm
  std::int64_t speed = 0;        ///< 2^-6 rad/s
  std::int64_t temperature = 0;  ///< 2^-8 degC
  std::int64_t gauges[gauge_count] = {};
  bool angle_known = true;
};

constexpr void add(Checksum& checksum, const RawSample& sample) {
  checksum.add(static_cast<std::uint64_t>(sample.ticks));
  checksum.add(sample.sequence);
  checksum.add(sample.encoder);
  for (const std::int64_t code :
       {sample.torque, sample.expected, sample.speed, sample.temperature}) {
    checksum.add(static_cast<std::uint32_t>(code));
  }
  checksum.add(std::uint32_t{sample.angle_known ? 1U : 0U});
  for (const std::int64_t code : sample.gauges) {
    checksum.add(static_cast<std::uint32_t>(code));
  }
}

/// 2^-15; angle in 2^-16 turn.
[[nodiscard]] constexpr std::int64_t sine(std::int64_t angle) {
  const std::int64_t t = ((angle & 0xFFFF) ^ 0x8000) - 0x8000;
  const std::int64_t y = (t * (32768 - (t < 0 ? -t : t))) >> 13;
  return y + ((7373 * (((y * (y < 0 ? -y : y)) >> 15) - y)) >> 15);
}

[[nodiscard]] constexpr std::int64_t sine(const Wave& wave, std::int64_t angle) {
  return (wave.amplitude * sine(wave.order * angle + wave.phase)) >> 15;
}

[[nodiscard]] constexpr std::int64_t noise(std::uint32_t k, std::uint32_t channel) {
  std::uint32_t x = k * 0x9E3779B1U + channel * 0x85EBCA6BU;
  x ^= x >> 16U;
  x *= 0x7FEB352DU;
  x ^= x >> 15U;
  x *= 0x846CA68BU;
  x ^= x >> 16U;
  const std::uint32_t sum =
      (x & 0xFFU) + (x >> 8U & 0xFFU) + (x >> 16U & 0xFFU) + (x >> 24U & 0xFFU);
  return static_cast<std::int64_t>(sum) - 510;
}

/// Makes one sample after the other.
class Inputs {
 public:
  constexpr RawSample next() {
    move();
    RawSample sample;
    const std::int64_t encoder = encoder_start + (position_ >> 8);
    sample.encoder = static_cast<std::uint32_t>(encoder);
    const auto number = static_cast<std::uint32_t>(k_);
    constexpr std::size_t load_count = sizeof(loads_Nm) / sizeof(loads_Nm[0]);
    const std::int64_t load =
        loads_Nm[(number >> 11U) % load_count] * 4096 + ((4096 * sine(k_ * 13)) >> 15);
    std::int64_t of_ripple = 0;
    for (const Wave& wave : ripple) {
      of_ripple += sine(wave, encoder);
    }
    of_ripple += (of_ripple * (load < 0 ? -load : load)) >> 18;
    sample.torque = load + of_ripple + noise(number, 0);
    sample.expected = (number >> 13U & 1U) != 0U ? load >> 1 : 0;
    sample.speed = ((speed_ * 1571) >> 16) + (noise(number, 1) >> 6);
    sample.temperature = 5120 + ((3840 * sine(k_ * 3)) >> 15);
    for (std::size_t j = 0; j < gauge_count; ++j) {
      sample.gauges[j] = gauges[j].zero + ((load * codes_a_torque_step) >> 16) +
                         (noise(number, static_cast<std::uint32_t>(2 + j)) >> 6);
      for (std::size_t i = 0; i < gauges[j].wave_count; ++i) {
        sample.gauges[j] += sine(gauges[j].wave[i], encoder);
      }
    }
    number_and_time(sample);
    for (const Event& event : events) {
      if (k_ >= event.first && k_ < event.first + event.samples) {
        spoil(sample, event);
      }
    }
    ++k_;
    return sample;
  }

 private:
  constexpr void move() {
    const std::int64_t missing = segments[segment_].speed - speed_;
    speed_ += missing > speed_step ? speed_step : (missing < -speed_step ? -speed_step : missing);
    position_ += speed_;
    if (++in_segment_ == segments[segment_].samples) {
      in_segment_ = 0;
      segment_ = (segment_ + 1) % (sizeof(segments) / sizeof(segments[0]));
    }
  }

  /// Sample number and time, after gaps, and those of the sample before where it is repeated.
  constexpr void number_and_time(RawSample& sample) const {
    std::int64_t taken = k_;
    for (const Event& event : events) {
      if (event.kind == Happening::repeated && k_ >= event.first &&
          k_ < event.first + event.samples) {
        taken = event.first - 1;
      }
    }
    std::int64_t missing = 0;
    for (const Event& event : events) {
      missing += event.kind == Happening::gap && taken >= event.first ? event.value : 0;
    }
    sample.ticks = (taken + missing) * ticks_a_sample;
    sample.sequence = static_cast<std::uint32_t>(sequence_start + taken + missing);
  }

  static constexpr void spoil(RawSample& sample, const Event& event) {
    switch (event.kind) {
      case Happening::torque:
        sample.torque = event.value;
        break;
      case Happening::expected:
        sample.expected = event.value;
        break;
      case Happening::speed:
        sample.speed = event.value;
        break;
      case Happening::temperature:
        sample.temperature = event.value;
        break;
      case Happening::no_angle:
        sample.angle_known = false;
        break;
      case Happening::all_gauges:
        for (std::int64_t& code : sample.gauges) {
          code = event.value;
        }
        break;
      case Happening::gauge_1:
      case Happening::gauge_2:
      case Happening::gauge_3:
      case Happening::gauge_4:
        sample.gauges[static_cast<std::size_t>(event.kind) -
                      static_cast<std::size_t>(Happening::gauge_1)] = event.value;
        break;
      case Happening::time_back:
        sample.ticks -= event.value;
        break;
      case Happening::sequence_back:
        sample.sequence -= static_cast<std::uint32_t>(event.value);
        break;
      case Happening::gap:
      case Happening::repeated:
        break;  // number_and_time() knows them
    }
  }

  std::int64_t k_ = 0;
  std::size_t segment_ = 0;
  std::uint32_t in_segment_ = 0;
  std::int64_t speed_ = 0;
  std::int64_t position_ = 0;
};

}  // namespace golden
