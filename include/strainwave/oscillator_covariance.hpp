// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_covariance.hpp
/// What a measurement does to states and covariance: eq. (12) to (14) in the turning frame.
///
/// P is stored by columns.  Only its triangle on and below the diagonal counts.
#pragma once

#include <cstddef>
#include <type_traits>

#include "strainwave/arithmetic.hpp"

namespace strainwave::detail {

/// Elements that are summed side by side.
inline constexpr std::size_t lane_count = 8;

/// Length of a column of P.  It depends on the kind of processor alone and never on a compiler's
/// option, so that objects compiled with different options agree on it.
[[nodiscard]] constexpr std::size_t column_length(std::size_t states) {
#if defined(__x86_64__) || defined(__aarch64__)
  const std::size_t step = states <= 2 ? 2 : states <= 4 ? 4 : lane_count;
  return (states + step - 1) / step * step;
#else
  return states;
#endif
}

/// A number in memory that is read again where it is used next.  A processor with few registers
/// would otherwise store a copy of it first.
template <class Real>
[[nodiscard]] constexpr Real passing(const Real& value) {
#if defined(__arm__)
  if (!std::is_constant_evaluated()) {
    return *static_cast<const volatile Real*>(&value);
  }
#endif
  return value;
}

/// Sum of the products of two rows of numbers, added to `start`.
template <class Real>
[[nodiscard]] constexpr Real sum_of_products(std::size_t count, const Real* a, const Real* b,
                                             Real start) {
  Real lanes[lane_count] = {start + a[0] * b[0]};
  for (std::size_t i = 1; i < count; ++i) {
    const Real product = a[i] * b[i];
    lanes[i % lane_count] = i < lane_count ? product : lanes[i % lane_count] + product;
  }
  for (std::size_t half = lane_count / 2; half > 0; half /= 2) {
    for (std::size_t i = 0; i < half && i + half < count; ++i) {
      lanes[i] += lanes[i + half];
    }
  }
  return lanes[0];
}

/// P C', and C P C' + R, which is returned.
template <class Real, std::size_t Length>
[[nodiscard]] constexpr Real project(std::size_t count, const Real (*p)[Length], const Real* output,
                                     Real measurement_noise_variance_Nm2,
                                     Real* covariance_with_output) {
  for (std::size_t i = 0; i < count; ++i) {
    covariance_with_output[i] = p[0][i] * output[0];
  }
  for (std::size_t j = 1; j < count; ++j) {
    for (std::size_t i = 0; i < count; ++i) {
      covariance_with_output[i] += (i < j ? p[i][j] : p[j][i]) * output[j];
    }
  }
  return sum_of_products(count, covariance_with_output, output, measurement_noise_variance_Nm2);
}

/// Eq. (12) to (14): states and covariance after the measurement, plus the process noise.
template <class Real, std::size_t Length>
constexpr void learn(std::size_t count, Real (*p)[Length], Real* states_Nm,
                     const Real* process_noise_variance_Nm2, const Real* covariance_with_output,
                     Real per_variance, Real innovation_Nm) {
  const Real step_Nm = per_variance * innovation_Nm;
  for (std::size_t i = 0; i < count; ++i) {
    states_Nm[i] += step_Nm * covariance_with_output[i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Real gain = covariance_with_output[i] * per_variance;
    p[i][i] += process_noise_variance_Nm2[i / 2];
    for (std::size_t j = 0; j <= i; ++j) {
      p[j][i] -= gain * covariance_with_output[j];
    }
  }
}

}  // namespace strainwave::detail
