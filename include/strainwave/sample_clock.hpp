// SPDX-License-Identifier: Apache-2.0
/// @file sample_clock.hpp
/// From time stamps to intervals: what a recording's clock says, and where it cannot be believed.
///
/// Jitter and gaps are taken as they are.  A stamp that is older than the last one, or the same, is
/// refused; many of them in a row mean that the clock was set back, and the record goes on with it.
#pragma once

#include <cstdint>

#include "strainwave/arithmetic.hpp"
#include "strainwave/status.hpp"

namespace strainwave {

struct SampleClock {
  double last_time_s = 0.0;
  double typical_interval_s = 0.0;  ///< smoothed over about 64 samples; gaps do not move it much
  bool started = false;
  std::uint32_t older_in_a_row = 0;
};

/// Time since the sample before, and what is to be said about it.
struct Interval {
  double interval_s = 0.0;
  Status status = 0;
};

/// So many stamps in a row that are older than the last one taken mean that the clock was set back.
inline constexpr std::uint32_t most_older_stamps_in_a_row = 10;
/// An interval of so many typical ones is a gap.
inline constexpr double least_gap_in_intervals = 5.0;

/// Takes the next time stamp, s.
[[nodiscard]] constexpr Interval take_stamp(SampleClock& clock, double time_s) {
  if (!is_finite(time_s)) {
    return {0.0, mask(StatusFlag::time_not_finite)};
  }
  if (!clock.started) {
    clock.started = true;
    clock.last_time_s = time_s;
    return {};
  }
  double interval_s = time_s - clock.last_time_s;
  if (!is_finite(interval_s)) {
    return {0.0, mask(StatusFlag::time_not_finite)};
  }
  if (!(interval_s > 0.0)) {
    if (++clock.older_in_a_row <= most_older_stamps_in_a_row) {
      return {0.0, mask(StatusFlag::sample_out_of_order)};
    }
    // Set back: how long the step took is not known; typical intervals are the best guess, for this
    // row and those refused before it.
    const double guessed_s = clock.typical_interval_s * clock.older_in_a_row;
    clock.older_in_a_row = 0;
    clock.last_time_s = time_s;
    return {guessed_s, mask(StatusFlag::samples_missing)};
  }
  clock.older_in_a_row = 0;
  clock.last_time_s = time_s;
  Interval interval = {interval_s, 0};
  if (clock.typical_interval_s <= 0.0) {
    clock.typical_interval_s = interval_s;
    return interval;
  }
  if (interval_s > least_gap_in_intervals * clock.typical_interval_s) {
    interval.status = mask(StatusFlag::samples_missing);
    interval_s = 2.0 * clock.typical_interval_s;
  }
  clock.typical_interval_s += (interval_s - clock.typical_interval_s) / 64.0;
  return interval;
}

}  // namespace strainwave
