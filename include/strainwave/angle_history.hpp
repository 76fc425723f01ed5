// SPDX-License-Identifier: Apache-2.0
/// @file angle_history.hpp
/// Where the motor was a moment ago: compensation of a delay between angle and torque.
///
/// A torque signal that lags the angle by a few milliseconds belongs to an earlier angle.  The last
/// rotations are kept with their intervals, and the angle of the earlier moment is interpolated
/// between them, whatever part of a sample the delay is and however the samples jitter.
#pragma once

#include <cstddef>

#include "strainwave/arithmetic.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

/// Longest delay that is compensated, s, and longest lead: a lead is extrapolated, not known.
inline constexpr double longest_delay_s = 0.05;
inline constexpr double longest_lead_s = 0.005;

/// The motor's last rotations.  The points lie at least a twelfth of the delay apart, so that their
/// number does not depend on the sample rate.
template <class Real>
struct AngleHistory {
  static constexpr std::size_t capacity = 16;

  Real intervals_s[capacity] = {};    ///< from the point before to this one
  Real rotations_rad[capacity] = {};  ///< likewise
  Real interval_since_point_s = Real(0);
  Real rotation_since_point_rad = Real(0);
  std::size_t newest = 0;
  std::size_t count = 0;
};

/// Takes in how far the motor turned since the last call, and in what time.
template <class Real>
constexpr void remember(AngleHistory<Real>& history, Real delay_s, Real interval_s,
                        Real rotation_rad) {
  history.interval_since_point_s += interval_s;
  history.rotation_since_point_rad += rotation_rad;
  if (history.interval_since_point_s < delay_s / Real(12)) {
    return;
  }
  history.newest = (history.newest + 1) % AngleHistory<Real>::capacity;
  history.intervals_s[history.newest] = history.interval_since_point_s;
  history.rotations_rad[history.newest] = history.rotation_since_point_rad;
  history.interval_since_point_s = Real(0);
  history.rotation_since_point_rad = Real(0);
  if (history.count < AngleHistory<Real>::capacity) {
    ++history.count;
  }
}

/// How far back the record reaches, s.
template <class Real>
[[nodiscard]] constexpr Real duration_of(const AngleHistory<Real>& history) {
  Real duration_s = history.interval_since_point_s;
  for (std::size_t i = 0; i < history.count; ++i) {
    const std::size_t point =
        (history.newest + AngleHistory<Real>::capacity - i) % AngleHistory<Real>::capacity;
    duration_s += history.intervals_s[point];
  }
  return duration_s;
}

/// Rotation during the last `delay_s`, rad.  Where the record is shorter than the delay, the motor
/// is taken to have turned at `speed_rad_s` before it.
template <class Real>
[[nodiscard]] constexpr Real rotation_during(const AngleHistory<Real>& history, Real delay_s,
                                             Real speed_rad_s) {
  Real left_s = delay_s;
  Real rotation_rad = Real(0);
  Real span_s = history.interval_since_point_s;
  Real span_rad = history.rotation_since_point_rad;
  for (std::size_t i = 0; i <= history.count; ++i) {
    if (left_s < span_s) {
      return rotation_rad + span_rad * (left_s / span_s);
    }
    left_s -= span_s;
    rotation_rad += span_rad;
    if (i < history.count) {
      const std::size_t point =
          (history.newest + AngleHistory<Real>::capacity - i) % AngleHistory<Real>::capacity;
      span_s = history.intervals_s[point];
      span_rad = history.rotations_rad[point];
    }
  }
  return rotation_rad + speed_rad_s * left_s;
}

}  // namespace strainwave
