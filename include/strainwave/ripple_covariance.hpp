// SPDX-License-Identifier: Apache-2.0
/// @file ripple_covariance.hpp
/// The ripple filter's covariance in factors, P = L D L', so that float is enough.
///
/// Two pairs that cannot be told apart for a minute (load and constant at a constant load) have
/// large variances whose difference is small; a plain P loses that difference in float, and its
/// sign with it.  D cannot become negative.  Coefficients come first and T last: what happens to T
/// alone then touches its row alone.
#pragma once

#include <cstddef>
#include <type_traits>

#include "strainwave/arithmetic.hpp"

namespace strainwave {

template <class Real, std::size_t MaxPairs>
struct RippleCovariance {
  static constexpr std::size_t max_coefficients = 2 * MaxPairs;

  /// Below the diagonal of L, by columns: rows j + 1 and on of column j stand together.
  Real lower[max_coefficients * (max_coefficients - 1) / 2] = {};
  Real variances_Nm2[max_coefficients] = {};  ///< D of the coefficients
  Real torque_row[max_coefficients] = {};     ///< row of T in L
  Real torque_variance_Nm2 = Real(0);         ///< D of T
};

namespace detail {

/// Column j of L below the diagonal; its element [i - j - 1] belongs to row i.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real* column_of(RippleCovariance<Real, MaxPairs>& p, std::size_t j) {
  return p.lower + j * (2 * RippleCovariance<Real, MaxPairs>::max_coefficients - j - 1) / 2;
}
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr const Real* column_of(const RippleCovariance<Real, MaxPairs>& p,
                                              std::size_t j) {
  return p.lower + j * (2 * RippleCovariance<Real, MaxPairs>::max_coefficients - j - 1) / 2;
}

/// Calls with the number of coefficients: as a constant where all of the capacity is in use, so
/// that the compiler can write out the loops.
template <std::size_t Capacity, class Call>
constexpr auto with_count(std::size_t count, const Call& call) {
  return count == Capacity ? call(std::integral_constant<std::size_t, Capacity>{}) : call(count);
}

/// Uncorrelated coefficients of one variance.
template <class Real, std::size_t MaxPairs>
constexpr void set_uncorrelated(RippleCovariance<Real, MaxPairs>& p, Real variance_Nm2) {
  p = RippleCovariance<Real, MaxPairs>{};
  for (Real& each : p.variances_Nm2) {
    each = variance_Nm2;
  }
}

// Count: std::size_t, or a std::integral_constant of it.

/// L' h of the coefficients, T left out.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void project(const RippleCovariance<Real, MaxPairs>& p, Count count, const Real* h,
                       Real* projected) {
  for (std::size_t j = 0; j < count; ++j) {
    const Real* const column = column_of(p, j);
    Real sum = h[j];
    for (std::size_t i = j + 1; i < count; ++i) {
      sum += column[i - j - 1] * h[i];
    }
    projected[j] = sum;
  }
}

/// Variance of one coefficient.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real variance_of(const RippleCovariance<Real, MaxPairs>& p, std::size_t i) {
  Real sum = p.variances_Nm2[i];
  for (std::size_t j = 0; j < i; ++j) {
    const Real element = column_of(p, j)[i - j - 1];
    sum += element * element * p.variances_Nm2[j];
  }
  return sum;
}

/// Adds to the variance of one coefficient.  Agee and Turner's rank-one change of the factors, from
/// the coefficient's own column on.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void add_variance(RippleCovariance<Real, MaxPairs>& p, Count count, std::size_t i,
                            Real variance_Nm2) {
  Real rest[RippleCovariance<Real, MaxPairs>::max_coefficients] = {};
  Real rest_of_torque = Real(0);
  rest[i] = Real(1);
  Real weight = variance_Nm2;
  for (std::size_t j = 0; j < count; ++j) {
    if (j < i) {
      continue;  // not started at i, so that each column's code has constant places
    }
    const Real pivot = rest[j];
    const Real before = p.variances_Nm2[j];
    const Real after = before + weight * pivot * pivot;
    if (!(after > Real(0))) {
      continue;  // nothing was added to nothing; later rows may still gain
    }
    const Real step = weight * pivot / after;
    weight *= before / after;
    p.variances_Nm2[j] = after;
    Real* const column = column_of(p, j);
    for (std::size_t r = j + 1; r < count; ++r) {
      Real& element = column[r - j - 1];
      rest[r] -= pivot * element;
      element += step * rest[r];
    }
    rest_of_torque -= pivot * p.torque_row[j];
    p.torque_row[j] += step * rest_of_torque;
  }
  p.torque_variance_Nm2 += weight * rest_of_torque * rest_of_torque;
}

/// Multiplies one coefficient's deviation and leaves all correlations as they are.
template <class Real, std::size_t MaxPairs>
constexpr void scale_deviation(RippleCovariance<Real, MaxPairs>& p, std::size_t count,
                               std::size_t i, Real scale) {
  for (std::size_t j = 0; j < i; ++j) {
    column_of(p, j)[i - j - 1] *= scale;
  }
  p.variances_Nm2[i] *= scale * scale;
  Real* const column = column_of(p, i);
  const Real inverse = Real(1) / scale;
  for (std::size_t r = i + 1; r < count; ++r) {
    column[r - i - 1] *= inverse;
  }
  p.torque_row[i] *= inverse;
}

/// Bierman's update with a measurement T + h'c of variance R, h given as `projected`.  Gains come
/// out T first; the measurement's own variance, h'P h + R, is returned.
template <class Real, std::size_t MaxPairs, class Count>
constexpr Real measure(RippleCovariance<Real, MaxPairs>& p, Count count, const Real* projected,
                       Real noise_Nm2, Real* gains) {
  Real* const coefficient_gains = gains + 1;
  Real torque_gain = p.torque_variance_Nm2;
  Real variance = noise_Nm2 + p.torque_variance_Nm2;
  Real inverse = Real(1) / variance;
  p.torque_variance_Nm2 *= noise_Nm2 * inverse;
  for (std::size_t j = count; j-- > 0;) {
    const Real seen = projected[j] + p.torque_row[j];
    const Real covariance = p.variances_Nm2[j] * seen;
    const Real next = variance + covariance * seen;
    const Real step = -seen * inverse;
    inverse = Real(1) / next;
    p.variances_Nm2[j] *= variance * inverse;
    Real* const column = column_of(p, j);
    for (std::size_t i = j + 1; i < count; ++i) {
      const Real element = column[i - j - 1];
      column[i - j - 1] = element + step * coefficient_gains[i];
      coefficient_gains[i] += covariance * element;
    }
    const Real element = p.torque_row[j];
    p.torque_row[j] = element + step * torque_gain;
    torque_gain += covariance * element;
    coefficient_gains[j] = covariance;
    variance = next;
  }
  gains[0] = torque_gain * inverse;
  for (std::size_t j = 0; j < count; ++j) {
    coefficient_gains[j] *= inverse;
  }
  return variance;
}

/// Element of P; indices as in the filter's states, 0 is T.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real covariance_of(const RippleCovariance<Real, MaxPairs>& p,
                                           std::size_t count, std::size_t a, std::size_t b) {
  const auto element = [&p](std::size_t state, std::size_t j) {
    if (state == 0) {
      return p.torque_row[j];
    }
    const std::size_t i = state - 1;
    if (i > j) {
      return column_of(p, j)[i - j - 1];
    }
    return i == j ? Real(1) : Real(0);
  };
  Real sum = a == 0 && b == 0 ? p.torque_variance_Nm2 : Real(0);
  for (std::size_t j = 0; j < count; ++j) {
    sum += element(a, j) * element(b, j) * p.variances_Nm2[j];
  }
  return sum;
}

}  // namespace detail

}  // namespace strainwave
