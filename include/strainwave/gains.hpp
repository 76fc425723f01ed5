// SPDX-License-Identifier: Apache-2.0
/// @file gains.hpp
/// Per-gauge gains and their weighted sum.
///
/// With gains that are right for the gauges as they were bonded, the sum of all gauges carries the
/// torque and no fluctuation.  Finding the gains is calibration; applying them is this sum.
#pragma once

#include <cstddef>
#include <type_traits>

#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave {

template <class Real, std::size_t MaxGauges>
struct Gains {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  static_assert(MaxGauges > 0, "strainwave: MaxGauges must be at least 1");

  std::size_t count = 1;
  Real values[MaxGauges] = {Real(1)};
};

/// Gauges in use; never more than there is room for, even in gains that nobody checked.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr std::size_t active_gauges(const Gains<Real, MaxGauges>& gains) {
  return gains.count < MaxGauges ? gains.count : MaxGauges;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Real weighted_sum(const Real (&gains)[MaxGauges], std::size_t count,
                                          const Real* gauge_signals) {
  Real sum = Real(0);
  for (std::size_t j = 0; j < MaxGauges && j < count; ++j) {
    sum += gains[j] * gauge_signals[j];
  }
  return sum;
}

/// h = sum_j g_j e_j, the signal of all gauges.  Godler 2000, eq. (7), with the gains of section
/// III-B written out.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Real weighted_sum(const Gains<Real, MaxGauges>& gains,
                                          const Real* gauge_signals) {
  return weighted_sum(gains.values, active_gauges(gains), gauge_signals);
}

/// M sum(g^2) / (sum g)^2: by how much uneven gains raise the noise power of the sum over equal
/// gains.  1 for equal gains, never below.
template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Real noise_factor(const Gains<Real, MaxGauges>& gains) {
  Real sum = Real(0);
  Real squares = Real(0);
  for (std::size_t j = 0; j < active_gauges(gains); ++j) {
    sum += gains.values[j];
    squares += gains.values[j] * gains.values[j];
  }
  return static_cast<Real>(active_gauges(gains)) * squares / (sum * sum);
}

/// The same gains in another precision or capacity; the capacity must hold them.
template <class Real, std::size_t MaxGauges, class FromReal, std::size_t FromMaxGauges>
[[nodiscard]] constexpr Gains<Real, MaxGauges> converted(
    const Gains<FromReal, FromMaxGauges>& from) {
  Gains<Real, MaxGauges> to;
  to.count = from.count;
  for (std::size_t j = 0; j < from.count && j < MaxGauges; ++j) {
    to.values[j] = static_cast<Real>(from.values[j]);
  }
  return to;
}

template <class Real, std::size_t MaxGauges>
[[nodiscard]] constexpr Violation<Real> check(const Gains<Real, MaxGauges>& gains) {
  if (gains.count < 1 || gains.count > MaxGauges) {
    return {"gains", -1, static_cast<Real>(gains.count), "gauges",
            "at least one, and no more than the compiled capacity"};
  }
  Real sum = Real(0);
  for (std::size_t j = 0; j < gains.count; ++j) {
    if (!is_finite(gains.values[j])) {
      return {"gains", static_cast<std::int32_t>(j), gains.values[j], "", "a finite number"};
    }
    sum += gains.values[j];
  }
  if (!(absolute(sum) > Real(0)) || !is_finite(sum)) {
    return {"gains", -1, sum, "", "a finite sum other than 0, which would cancel torque"};
  }
  return {};
}

}  // namespace strainwave
