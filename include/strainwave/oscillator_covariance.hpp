// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_covariance.hpp
/// What a measurement does to states and covariance: eq. (12) to (14) in the turning frame.
///
/// In two ways with the same operations in the same order, so that both give the same bits where
/// products and sums are not fused.  A processor with vectors computes whole columns of P.
/// Elsewhere only the elements on and below the diagonal are read and written.
#pragma once

#include <cstddef>
#include <type_traits>

#include "strainwave/number_row.hpp"

namespace strainwave::detail {

/// Length of a column of P.  It depends on the kind of processor alone and never on a compiler's
/// option, so that objects compiled with different options agree on it.
[[nodiscard]] constexpr std::size_t column_length(std::size_t states) {
#if defined(__x86_64__) || defined(__aarch64__)
  if (states <= 4) {
    return states <= 2 ? 2 : 4;
  }
  return (states + row_lane_count - 1) / row_lane_count * row_lane_count;
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

/// `start` and the products of two rows of numbers: those that are row_lane_count apart first, then
/// halves.
template <class Real>
[[nodiscard]] constexpr Real sum_of_products(std::size_t count, const Real* a, const Real* b,
                                             Real start) {
  Real lanes[row_lane_count] = {start + a[0] * b[0]};
#pragma GCC unroll 8
  for (std::size_t i = 1; i < count; ++i) {
    const Real product = a[i] * b[i];
    lanes[i % row_lane_count] = i < row_lane_count ? product : lanes[i % row_lane_count] + product;
  }
#pragma GCC unroll 8
  for (std::size_t half = row_lane_count / 2; half > 0; half /= 2) {
#pragma GCC unroll 8
    for (std::size_t i = 0; i < half; ++i) {
      lanes[i] = i + half < count ? lanes[i] + lanes[i + half] : lanes[i];
    }
  }
  return lanes[0];
}

#if defined(STRAINWAVE_NUMBER_ROWS)

/// Elements above the diagonal repeat those below it to the last bit.
inline constexpr bool whole_columns = true;

template <class Real, std::size_t Length>
using CovarianceWithOutput = NumberRow<Real, Length>;

/// P C', and C P C' + R, which is returned.
template <class Real, std::size_t Length>
[[nodiscard]] inline Real project(std::size_t count, const Real (*p)[Length], const Real* output,
                                  Real measurement_noise_variance_Nm2,
                                  NumberRow<Real, Length>& covariance_with_output) {
  using Row = NumberRow<Real, Length>;
  covariance_with_output = Row::load(p[0]) * Row::all(output[0]);
#pragma GCC unroll 8
  for (std::size_t j = 1; j < count; ++j) {
    covariance_with_output = covariance_with_output + Row::load(p[j]) * Row::all(output[j]);
  }
  const Row noise = Row::joined(1, Row::all(measurement_noise_variance_Nm2), Row::all(Real(0)));
  return (noise + covariance_with_output * Row::gathered(output)).sum();
}

/// Eq. (12) to (14): states and covariance after the measurement, plus the process noise.
template <class Real, std::size_t Length>
inline void learn(std::size_t count, Real (*p)[Length], Real* states_Nm,
                  const Real* process_noise_variance_Nm2,
                  const NumberRow<Real, Length>& covariance_with_output, Real per_variance,
                  Real innovation_Nm) {
  using Row = NumberRow<Real, Length>;
  (Row::load(states_Nm) + Row::all(per_variance * innovation_Nm) * covariance_with_output)
      .store(states_Nm);
  Real elements[Length];  // NOLINT(*-member-init): filled in the next line
  covariance_with_output.store(elements);
  const Row scale = Row::all(per_variance);
  const Row gain = covariance_with_output * scale;
  const Row zero = Row::all(Real(0));
  const Row one = Row::all(Real(1));
#pragma GCC unroll 8
  for (std::size_t j = 0; j < count; ++j) {
    // Gain times element on and below the diagonal; above it the same two with their parts changed.
    const auto above = static_cast<std::ptrdiff_t>(j);
    const Row row = Row::joined(above, covariance_with_output, gain);
    // NOLINTNEXTLINE(readability-suspicious-call-argument): the joined one is called one, too
    const Row column = Row::all(elements[j]) * Row::joined(above, scale, one);
    const Row noise = Row::joined(
        above, zero, Row::joined(above + 1, Row::all(process_noise_variance_Nm2[j / 2]), zero));
    (Row::load(p[j]) + noise - row * column).store(p[j]);
  }
}

#else

inline constexpr bool whole_columns = false;

template <class Real, std::size_t Length>
using CovarianceWithOutput = Real[Length];

/// P C', and C P C' + R, which is returned.
template <class Real, std::size_t Length>
[[nodiscard]] constexpr Real project(std::size_t count, const Real (*p)[Length], const Real* output,
                                     Real measurement_noise_variance_Nm2,
                                     Real (&covariance_with_output)[Length]) {
#pragma GCC unroll 8
  for (std::size_t i = 0; i < count; ++i) {
    covariance_with_output[i] = p[0][i] * output[0];
  }
#pragma GCC unroll 8
  for (std::size_t j = 1; j < count; ++j) {
#pragma GCC unroll 8
    for (std::size_t i = 0; i < count; ++i) {
      covariance_with_output[i] += (i < j ? p[i][j] : p[j][i]) * output[j];
    }
  }
  return sum_of_products(count, covariance_with_output, output, measurement_noise_variance_Nm2);
}

/// Eq. (12) to (14): states and covariance after the measurement, plus the process noise.
template <class Real, std::size_t Length>
constexpr void learn(std::size_t count, Real (*p)[Length], Real* states_Nm,
                     const Real* process_noise_variance_Nm2,
                     const Real (&covariance_with_output)[Length], Real per_variance,
                     Real innovation_Nm) {
  const Real step_Nm = per_variance * innovation_Nm;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < count; ++i) {
    states_Nm[i] += step_Nm * covariance_with_output[i];
  }
#pragma GCC unroll 8
  for (std::size_t i = 0; i < count; ++i) {
    const Real gain = covariance_with_output[i] * per_variance;
    p[i][i] += process_noise_variance_Nm2[i / 2];
#pragma GCC unroll 8
    for (std::size_t j = 0; j <= i; ++j) {
      p[j][i] -= gain * covariance_with_output[j];
    }
  }
}

#endif

/// Repeats above the diagonal what was changed below it.
template <class Real, std::size_t Length>
constexpr void mirror(std::size_t count, Real (*p)[Length]) {
  for (std::size_t i = 0; whole_columns && i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      p[i][j] = p[j][i];
    }
  }
}

}  // namespace strainwave::detail
