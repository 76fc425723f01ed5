// SPDX-License-Identifier: Apache-2.0
/// @file status.hpp
/// What a step says about its sample: faults apart from limits and warnings.
///
/// A *fault* means that the sample was not used (or only in part); a *limit* that a protection
/// acted; a *warning* that the sample was used but the reader should know something.  The numbers
/// are stable: logs keep them.  The sample path never fails, it flags and counts.
#pragma once

#include <cstddef>
#include <cstdint>

namespace strainwave {

/// One bit each.  Bits 0-11 are faults, 12-19 limits, 20-31 warnings.
enum class StatusFlag : std::uint32_t {
  torque_not_finite = 1U << 0U,           ///< fault: torque is NaN, infinite or beyond 1e15 Nm
  rotation_invalid = 1U << 1U,            ///< fault: speed or angle NaN, infinite or beyond reach
  expected_torque_not_finite = 1U << 2U,  ///< fault: expected torque, likewise
  gauge_saturated = 1U << 3U,             ///< fault: a converter code at an end of its range
  temperature_not_finite = 1U << 4U,      ///< fault: temperature is NaN or infinite
  sample_repeated = 1U << 5U,             ///< fault: the sample was seen before
  sample_out_of_order = 1U << 6U,         ///< fault: the sample is older than the last one
  time_not_finite = 1U << 7U,             ///< fault: time stamp or interval unusable
  gauges_insufficient = 1U << 8U,         ///< fault: no gains do without what is wrong, torque held
  variance_limited = 1U << 12U,           ///< limit: covariance cut back to its limit
  covariance_reset = 1U << 13U,           ///< limit: covariance unusable, set back to its start
  at_rest = 1U << 20U,                    ///< warning: too little travel, adaptation waits
  samples_missing = 1U << 21U,            ///< warning: samples are missing before this one
  order_above_nyquist = 1U << 22U,        ///< warning: an order turns over half a cycle a sample
  temperature_out_of_range = 1U << 23U,   ///< warning: outside the calibrated temperatures
  gauge_lost = 1U << 24U,                 ///< warning: a gauge is lost, for good until cleared
  gauge_suspected = 1U << 25U,            ///< warning: a gauge is wrong in this sample
  gauges_disagree = 1U << 26U,            ///< warning: not one gauge alone, or the angle, is wrong
};

/// A set of StatusFlag bits; 0 means that nothing is to be said.
using Status = std::uint32_t;

[[nodiscard]] constexpr Status mask(StatusFlag flag) { return static_cast<Status>(flag); }
[[nodiscard]] constexpr bool has(Status status, StatusFlag flag) {
  return (status & mask(flag)) != 0U;
}

inline constexpr Status fault_mask = 0x00000FFFU;
inline constexpr Status limit_mask = 0x000FF000U;
inline constexpr Status warning_mask = 0xFFF00000U;

/// How often each flag was raised; counts stay at their largest value instead of wrapping.
struct EventCounters {
  std::uint32_t samples = 0;
  std::uint32_t faults = 0;  ///< samples with at least one fault
  std::uint32_t by_bit[32] = {};
};

constexpr void count_up(std::uint32_t& counter) {
  const std::uint32_t next = counter + 1U;
  if (next != 0U) {
    counter = next;
  }
}

/// Adds to a counter that stays at its largest value instead of wrapping.
constexpr void count_up_by(std::uint32_t& counter, std::size_t events) {
  const std::size_t room = 0xFFFFFFFFU - counter;
  counter += static_cast<std::uint32_t>(events < room ? events : room);
}

/// Number of the lowest bit that is set; not for 0.
[[nodiscard]] constexpr std::size_t lowest_bit(Status status) {
#if defined(__GNUC__)
  return static_cast<std::size_t>(__builtin_ctz(status));
#else
  std::size_t bit = 0;
  while ((status >> bit & 1U) == 0U) {
    ++bit;
  }
  return bit;
#endif
}

/// Records one sample's status.
constexpr void record(EventCounters& counters, Status status) {
  count_up(counters.samples);
  if (status == 0U) {
    return;
  }
  if ((status & fault_mask) != 0U) {
    count_up(counters.faults);
  }
  for (; status != 0U; status &= status - 1U) {
    count_up(counters.by_bit[lowest_bit(status)]);
  }
}

/// What is wrong with a configuration: nothing where `parameter` is null.  Checked when a
/// configuration is built, and in a static_assert where it is a constant.
template <class Real>
struct Violation {
  const char* parameter = nullptr;
  std::int32_t index = -1;  ///< element of a list, from 0; -1 for a single value
  Real value = Real(0);
  const char* unit = "";
  const char* expected = "";

  [[nodiscard]] constexpr bool ok() const { return parameter == nullptr; }
};

}  // namespace strainwave
