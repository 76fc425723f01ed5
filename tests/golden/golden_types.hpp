// What the golden vectors' header is made of; the values are in tests/data/golden/golden.json.
#pragma once

#include <cstdint>

#include "strainwave/torque_sensor.hpp"

namespace golden {

/// Part of the motion: the speed that the motor heads for, 1/256 counts a sample.
struct Segment {
  std::uint32_t samples;
  std::int64_t speed;
};

/// A sine of an order of the motor's angle: amplitude in codes, phase in 2^-16 turn.
struct Wave {
  std::int64_t order;
  std::int64_t amplitude;
  std::int64_t phase;
};

struct GaugeMakeup {
  std::int64_t zero;
  std::uint32_t wave_count;
  Wave wave[2];
};

/// What goes wrong; gauge_1 to gauge_4 are in a row.
enum class Happening : std::uint8_t {
  torque,
  expected,
  speed,
  temperature,
  no_angle,
  all_gauges,
  gauge_1,
  gauge_2,
  gauge_3,
  gauge_4,
  gap,
  repeated,
  time_back,
  sequence_back,
};

struct Event {
  Happening kind;
  std::int64_t first;
  std::int64_t samples;
  std::int64_t value;
};

/// Answers of one chain: kept torques and statuses, and the CRC-32 of all.
struct Golden {
  const char* name;
  const double* double_Nm;
  const std::uint32_t* double_status;
  std::uint32_t double_checksum;
  const double* float_Nm;
  const std::uint32_t* float_status;
  std::uint32_t float_checksum;
};

}  // namespace golden
