// SPDX-License-Identifier: Apache-2.0
/// @file arithmetic.hpp
/// The few functions every part of the core shares: finiteness, square root, cosine and sine.
///
/// They are written here, and not taken from the platform's library, where two platforms would
/// otherwise answer differently: host, Python and microcontroller run the same operations in the
/// same order.  The square root is the exception, because IEEE 754 fixes its result.
#pragma once

#if !defined(__GNUC__)
#include <cmath>  // GCC 13 and later refuse it where there is no operating system
#endif
#include <cstdint>
#include <limits>
#include <type_traits>

namespace strainwave {

template <class Real>
inline constexpr Real pi = Real(3.141592653589793238462643383279502884L);
template <class Real>
inline constexpr Real two_pi = Real(6.283185307179586476925286766559005768L);

template <class Number>
[[nodiscard]] constexpr Number absolute(Number value) {
#if defined(__GNUC__)
  // One instruction; the comparison below would be four, because of the sign of zero.
  if constexpr (std::is_same_v<Number, float>) {
    return __builtin_fabsf(value);
  }
  if constexpr (std::is_same_v<Number, double>) {
    return __builtin_fabs(value);
  }
#endif
  return value < Number(0) ? -value : value;
}

/// True for every number that is neither infinite nor not-a-number; usable in constant expressions.
template <class Real>
[[nodiscard]] constexpr bool is_finite(Real value) {
  static_assert(std::is_floating_point_v<Real>, "strainwave: Real must be float or double");
  return absolute(value) <= std::numeric_limits<Real>::max();
}

template <class Real>
[[nodiscard]] inline Real square_root(Real value) {
#if defined(__GNUC__)
  // The builtin is one instruction where the processor has it, and needs no hosted <cmath>.
  if constexpr (std::is_same_v<Real, float>) {
    return __builtin_sqrtf(value);
  } else {
    return __builtin_sqrt(value);
  }
#else
  return std::sqrt(value);
#endif
}

/// Cosine and sine of one angle.
template <class Real>
struct CosSin {
  Real cosine;
  Real sine;
};

namespace detail {

/// Cosine and sine of an angle within an eighth of a turn either side of zero, by Taylor series.
/// The first term left out is below half a unit in the last place of Real at pi/4.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> cos_sin_reduced(Real angle_rad) {
  const Real square = angle_rad * angle_rad;
  if constexpr (std::is_same_v<Real, float>) {
    constexpr float s3 = -1.0F / 6.0F;
    constexpr float s5 = 1.0F / 120.0F;
    constexpr float s7 = -1.0F / 5040.0F;
    constexpr float s9 = 1.0F / 362880.0F;
    constexpr float c4 = 1.0F / 24.0F;
    constexpr float c6 = -1.0F / 720.0F;
    constexpr float c8 = 1.0F / 40320.0F;
    const float sine =
        angle_rad + angle_rad * square * (s3 + square * (s5 + square * (s7 + square * s9)));
    const float cosine = 1.0F - square * (0.5F - square * (c4 + square * (c6 + square * c8)));
    return {cosine, sine};
  } else {
    constexpr Real s3 = Real(-1) / Real(6);
    constexpr Real s5 = Real(1) / Real(120);
    constexpr Real s7 = Real(-1) / Real(5040);
    constexpr Real s9 = Real(1) / Real(362880);
    constexpr Real s11 = Real(-1) / Real(39916800);
    constexpr Real s13 = Real(1) / Real(6227020800);
    constexpr Real s15 = Real(-1) / Real(1307674368000);
    constexpr Real s17 = Real(1) / Real(355687428096000);
    constexpr Real c4 = Real(1) / Real(24);
    constexpr Real c6 = Real(-1) / Real(720);
    constexpr Real c8 = Real(1) / Real(40320);
    constexpr Real c10 = Real(-1) / Real(3628800);
    constexpr Real c12 = Real(1) / Real(479001600);
    constexpr Real c14 = Real(-1) / Real(87178291200);
    constexpr Real c16 = Real(1) / Real(20922789888000);
    Real s_tail = s15 + square * s17;
    s_tail = s11 + square * (s13 + square * s_tail);
    s_tail = s7 + square * (s9 + square * s_tail);
    s_tail = s3 + square * (s5 + square * s_tail);
    Real c_tail = c14 + square * c16;
    c_tail = c10 + square * (c12 + square * c_tail);
    c_tail = c6 + square * (c8 + square * c_tail);
    c_tail = c4 + square * c_tail;
    return {Real(1) - square * (Real(0.5) - square * c_tail),
            angle_rad + angle_rad * square * s_tail};
  }
}

/// Turns a reduced pair by whole quarters of a turn.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> turn_by_quarters(CosSin<Real> reduced,
                                                      std::uint32_t quarters) {
  switch (quarters & 3U) {
    case 0:
      return reduced;
    case 1:
      return {-reduced.sine, reduced.cosine};
    case 2:
      return {-reduced.cosine, -reduced.sine};
    default:
      return {reduced.sine, -reduced.cosine};
  }
}

/// Steps of the table of cosines and sines around the turn, as a power of two.
inline constexpr std::uint32_t circle_bits = 7;

/// Cosine and sine at every step around the turn.
template <class Real>
struct Circle {
  CosSin<Real> at[1U << circle_bits] = {};

  constexpr Circle() {
    constexpr double step_rad = two_pi<double> / (1U << circle_bits);
    constexpr std::uint32_t quarter = 1U << (circle_bits - 2U);
    for (std::uint32_t i = 0; i < 4U * quarter; ++i) {
      const std::uint32_t quarters = (i + quarter / 2U) / quarter;
      const auto rest = static_cast<std::int32_t>(i - quarters * quarter);
      const auto exact = turn_by_quarters(cos_sin_reduced(rest * step_rad), quarters);
      at[i] = {static_cast<Real>(exact.cosine), static_cast<Real>(exact.sine)};
    }
  }
};

template <class Real>
inline constexpr Circle<Real> circle = {};

/// A pair turned on by at most half a step of the table.  The first term left out is below a
/// quarter of a unit in the last place of Real.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> turned_within_step(const CosSin<Real>& from, Real angle_rad) {
  const Real square = angle_rad * angle_rad;
  Real cosine_less_1 = -Real(0.5);
  Real sine_tail = Real(-1) / Real(6);
  if constexpr (!std::is_same_v<Real, float>) {
    sine_tail += square * (Real(1) / Real(120) - square * (Real(1) / Real(5040)));
    cosine_less_1 += square * (Real(1) / Real(24) - square * (Real(1) / Real(720)));
  }
  cosine_less_1 *= square;
  const Real sine = angle_rad + angle_rad * square * sine_tail;
  return {from.cosine + (from.cosine * cosine_less_1 - from.sine * sine),
          from.sine + (from.sine * cosine_less_1 + from.cosine * sine)};
}

}  // namespace detail

/// Cosine and sine of a fraction of a turn, the whole range of an unsigned number being one turn.
/// The reduction is exact, so the result is as good after a year of running as in the first turn.
/// No branch: every angle takes as long as any other.
template <class Real, class Fraction>
[[nodiscard]] constexpr CosSin<Real> cos_sin_of_fraction(Fraction fraction) {
  static_assert(std::is_unsigned_v<Fraction> && sizeof(Fraction) >= 4);
  constexpr auto bits = std::numeric_limits<Fraction>::digits;
  constexpr auto rest_bits = bits - detail::circle_bits;
  constexpr Fraction half_step = Fraction{1} << (rest_bits - 1U);
  const Fraction step = static_cast<Fraction>(fraction + half_step) >> rest_bits;
  // What is left of the nearest step: the low bits with the sign of the highest of them.
  const auto rest = static_cast<std::make_signed_t<Fraction>>(fraction << detail::circle_bits);
  constexpr Real radians_per_unit = two_pi<Real> / (Real(1U << (detail::circle_bits + 2U)) *
                                                    static_cast<Real>(Fraction{1} << (bits - 2)));
  return detail::turned_within_step(detail::circle<Real>.at[step],
                                    static_cast<Real>(rest) * radians_per_unit);
}

/// The largest angle cos_sin_of_radians() takes, rad; beyond it the reduction would lose digits.
inline constexpr std::int32_t largest_reducible_angle_rad = 100000;

/// Cosine and sine of an angle in radians, |angle| <= largest_reducible_angle_rad.
template <class Real>
[[nodiscard]] constexpr CosSin<Real> cos_sin_of_radians(Real angle_rad) {
  // A quarter turn in parts, all but the last short enough for an exact product with the count.
  const Real scaled = angle_rad * (Real(2) / pi<Real>);
  if (absolute(scaled) < Real(0.499999F)) {  // a sample's rotation most often is
    return detail::cos_sin_reduced(angle_rad);
  }
  const auto count =
      static_cast<std::int32_t>(scaled + (scaled < Real(0) ? Real(-0.5) : Real(0.5)));
  const auto quarters = static_cast<Real>(count);
  Real reduced = angle_rad;
  if constexpr (std::is_same_v<Real, float>) {
    reduced -= quarters * 1.5703125F;
    reduced -= quarters * 0.0004825592041015625F;
    reduced -= quarters * 1.2665987014770508e-06F;
    reduced -= quarters * 9.920935796805404e-10F;
  } else {
    reduced -= quarters * Real(1.57079632673412561417);
    reduced -= quarters * Real(6.07710050630396597660e-11);
    reduced -= quarters * Real(2.02226624879595063154e-21);
  }
  return detail::turn_by_quarters(detail::cos_sin_reduced(reduced),
                                  static_cast<std::uint32_t>(count));
}

/// Angle of a vector, rad, from -pi to pi; 0 for the zero vector and for what is not finite.
template <class Real>
[[nodiscard]] inline Real angle_of(Real cosine, Real sine) {
  const Real larger = absolute(cosine) > absolute(sine) ? absolute(cosine) : absolute(sine);
  if (!(larger > Real(0)) || !is_finite(cosine) || !is_finite(sine)) {
    return Real(0);
  }
  // Scaled first, so that squares neither overflow nor vanish.
  const Real x = cosine / larger;
  const Real y = sine / larger;
  const Real length = square_root(x * x + y * y);
  // A rough angle by octants, then what a rotation back by it leaves: asin(d) = d + d^3/6 +
  // 3d^5/40.
  const bool steep = absolute(y) > absolute(x);
  const Real slope = steep ? absolute(x) / absolute(y) : absolute(y) / absolute(x);
  Real angle_rad = slope * (Real(0.9724) - Real(0.1919) * slope * slope);
  angle_rad = steep ? Real(0.5) * pi<Real> - angle_rad : angle_rad;
  angle_rad = x < Real(0) ? pi<Real> - angle_rad : angle_rad;
  angle_rad = y < Real(0) ? -angle_rad : angle_rad;
  const CosSin<Real> rough = cos_sin_of_radians(angle_rad);
  const Real rest = (y * rough.cosine - x * rough.sine) / length;
  const Real square = rest * rest;
  angle_rad += rest * (Real(1) + square * (Real(1) / Real(6) + square * Real(0.075)));
  if (angle_rad > pi<Real>) {
    return pi<Real>;
  }
  return angle_rad < -pi<Real> ? -pi<Real> : angle_rad;
}

}  // namespace strainwave
