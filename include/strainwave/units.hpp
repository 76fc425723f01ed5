// SPDX-License-Identifier: Apache-2.0
/// @file units.hpp
/// What a number means: exact ratios and orders, and the phase of a shaft.
///
/// Units are carried in names everywhere in strainwave (`torque_Nm`, `motor_angle_rad`).  Two
/// quantities need more than a name.  An *order* (cycles per motor turn) is a ratio of whole
/// numbers, because tooth counts are.  A *phase* is a count of whole turns and a 32-bit fraction
/// of a turn, because a floating-point angle loses digits as a joint keeps running.
#pragma once

#include <cstdint>
#include <type_traits>

#include "strainwave/arithmetic.hpp"

namespace strainwave {

/// A positive ratio of whole numbers: a gear ratio, or an order in cycles per motor turn.
struct Rational {
  std::uint32_t numerator = 1;
  std::uint32_t denominator = 1;

  [[nodiscard]] constexpr bool operator==(const Rational&) const = default;
};

/// Cycles per motor turn.
using Order = Rational;

/// Largest numerator and denominator; products of phase and order then fit in 64 bits.
inline constexpr std::uint32_t largest_rational_part = 0x7FFFFFFFU;

[[nodiscard]] constexpr bool is_valid(Rational ratio) {
  return ratio.numerator > 0 && ratio.denominator > 0 && ratio.numerator <= largest_rational_part &&
         ratio.denominator <= largest_rational_part;
}

template <class Real>
[[nodiscard]] constexpr Real to_real(Rational ratio) {
  return static_cast<Real>(ratio.numerator) / static_cast<Real>(ratio.denominator);
}

/// Whether the first is half of the second.
[[nodiscard]] constexpr bool is_half(Rational half, Rational whole) {
  return 2U * std::uint64_t{half.numerator} * whole.denominator ==
         std::uint64_t{whole.numerator} * half.denominator;
}

[[nodiscard]] constexpr Rational inverse(Rational ratio) {
  return {ratio.denominator, ratio.numerator};
}

[[nodiscard]] constexpr std::uint64_t greatest_common_divisor(std::uint64_t a, std::uint64_t b) {
  while (b != 0) {
    const std::uint64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

/// The ratio in lowest terms; {0, 0}, which is_valid() refuses, where it does not fit.
[[nodiscard]] constexpr Rational reduced(std::uint64_t numerator, std::uint64_t denominator) {
  const std::uint64_t divisor = greatest_common_divisor(numerator, denominator);
  if (divisor == 0) {
    return {0, 0};
  }
  numerator /= divisor;
  denominator /= divisor;
  if (numerator > largest_rational_part || denominator > largest_rational_part) {
    return {0, 0};
  }
  return {static_cast<std::uint32_t>(numerator), static_cast<std::uint32_t>(denominator)};
}

/// Product in lowest terms; {0, 0} where it does not fit.
[[nodiscard]] constexpr Rational multiply(Rational a, Rational b) {
  return reduced(std::uint64_t{a.numerator} * b.numerator,
                 std::uint64_t{a.denominator} * b.denominator);
}

/// The simplest ratio within 1e-12 (relative) of a number, by continued fraction; for example
/// 120.5 gives 241/2.  {0, 0}, which is_valid() refuses, for what is not positive and finite or
/// has no such ratio.
[[nodiscard]] constexpr Rational rational_from(double value) {
  if (!is_finite(value) || value <= 0.0 || value > static_cast<double>(largest_rational_part)) {
    return {0, 0};
  }
  std::uint64_t previous_numerator = 0;
  std::uint64_t previous_denominator = 1;
  std::uint64_t numerator = 1;
  std::uint64_t denominator = 0;
  double rest = value;
  for (int term = 0; term < 64; ++term) {
    auto whole = static_cast<std::uint64_t>(rest);
    // The last step goes as far as there is room: between two convergents the error falls, too.
    if (numerator > 0 && whole > (largest_rational_part - previous_numerator) / numerator) {
      whole = (largest_rational_part - previous_numerator) / numerator;
    }
    if (denominator > 0 && whole > (largest_rational_part - previous_denominator) / denominator) {
      whole = (largest_rational_part - previous_denominator) / denominator;
    }
    const bool is_last = whole < static_cast<std::uint64_t>(rest);
    if (is_last && whole == 0) {
      break;
    }
    const std::uint64_t next_numerator = whole * numerator + previous_numerator;
    const std::uint64_t next_denominator = whole * denominator + previous_denominator;
    previous_numerator = numerator;
    previous_denominator = denominator;
    numerator = next_numerator;
    denominator = next_denominator;
    const double error =
        absolute(static_cast<double>(numerator) / static_cast<double>(denominator) - value);
    const double fraction = rest - static_cast<double>(whole);
    if (is_last || error <= 1e-12 * value || fraction <= 0.0) {
      break;
    }
    rest = 1.0 / fraction;
    if (rest > static_cast<double>(largest_rational_part)) {
      break;
    }
  }
  if (denominator == 0 || numerator == 0) {
    return {0, 0};
  }
  const double found = static_cast<double>(numerator) / static_cast<double>(denominator);
  if (absolute(found - value) > 1e-12 * value) {
    return {0, 0};
  }
  return {static_cast<std::uint32_t>(numerator), static_cast<std::uint32_t>(denominator)};
}

/// Angle of a shaft since a reference: whole turns and a fraction in units of 2^-32 turn
/// (1.5e-9 rad).  The same bits on every platform.
struct Phase {
  std::int64_t turns = 0;
  std::uint32_t fraction = 0;

  [[nodiscard]] constexpr bool operator==(const Phase&) const = default;
};

/// Largest angle phase_from_turns() takes, turns: 2^40 turns are 200 years at 10,000 rpm.
inline constexpr std::int64_t largest_turns = std::int64_t{1} << 40;

/// The whole part of a number within +-2^54, towards zero.  A processor without 64-bit conversions
/// would call a library for it that computes in double; the split is exact.
template <class Real>
[[nodiscard]] constexpr std::int64_t whole_part(Real value) {
  if constexpr (std::is_same_v<Real, float>) {
    const auto high = static_cast<std::int32_t>(value * 0x1p-24F);
    const auto low = static_cast<std::int32_t>(value - static_cast<float>(high) * 0x1p24F);
    return (std::int64_t{high} * (std::int64_t{1} << 24)) + low;
  } else {
    return static_cast<std::int64_t>(value);
  }
}

/// Phase of an angle in turns; |turns| <= largest_turns (callers check).
template <class Real>
[[nodiscard]] constexpr Phase phase_from_turns(Real turns) {
  std::int64_t whole = whole_part(turns);
  if (static_cast<Real>(whole) > turns) {
    --whole;
  }
  const Real part = turns - static_cast<Real>(whole);
  auto units = static_cast<std::uint64_t>(whole_part(part * Real(4294967296.0) + Real(0.5)));
  if (units > 0xFFFFFFFFU) {
    ++whole;
    units = 0;
  }
  return {whole, static_cast<std::uint32_t>(units)};
}

/// True where phase_from_radians() can represent the angle.
template <class Real>
[[nodiscard]] constexpr bool is_representable_angle(Real angle_rad) {
  return is_finite(angle_rad) &&
         absolute(angle_rad) <= two_pi<Real> * static_cast<Real>(largest_turns);
}

/// Phase of an angle in radians; see is_representable_angle().
template <class Real>
[[nodiscard]] constexpr Phase phase_from_radians(Real angle_rad) {
  return phase_from_turns(angle_rad / two_pi<Real>);
}

/// Phase of an encoder position in counts: exact to half a unit, without accumulation, for any
/// number of counts per turn.
[[nodiscard]] constexpr Phase phase_from_counts(std::int64_t counts,
                                                std::uint32_t counts_per_turn) {
  const auto per_turn = static_cast<std::int64_t>(counts_per_turn);
  std::int64_t turns = counts / per_turn;
  std::int64_t rest = counts % per_turn;
  if (rest < 0) {
    --turns;
    rest += per_turn;
  }
  const std::uint64_t units =
      ((static_cast<std::uint64_t>(rest) << 32U) + counts_per_turn / 2U) / counts_per_turn;
  if (units > 0xFFFFFFFFU) {
    return {turns + 1, 0};
  }
  return {turns, static_cast<std::uint32_t>(units)};
}

[[nodiscard]] constexpr Phase operator+(Phase a, Phase b) {
  const std::uint64_t units = std::uint64_t{a.fraction} + b.fraction;
  // Unsigned, because turns beyond 2^63 shall wrap and not be undefined.
  const std::uint64_t turns =
      static_cast<std::uint64_t>(a.turns) + static_cast<std::uint64_t>(b.turns) + (units >> 32U);
  return {static_cast<std::int64_t>(turns), static_cast<std::uint32_t>(units)};
}

[[nodiscard]] constexpr Phase operator-(Phase a, Phase b) {
  const std::int64_t units = std::int64_t{a.fraction} - std::int64_t{b.fraction};
  const std::uint64_t turns = static_cast<std::uint64_t>(a.turns) -
                              static_cast<std::uint64_t>(b.turns) +
                              static_cast<std::uint64_t>(units >> 32U);  // 0 or -1
  return {static_cast<std::int64_t>(turns), static_cast<std::uint32_t>(units)};
}

/// A whole number as Real; the short way where it fits in 32 bits, with the same result.
template <class Real>
[[nodiscard]] constexpr Real whole_to_real(std::int64_t value) {
  const auto narrow = static_cast<std::int32_t>(value);
  return narrow == value ? static_cast<Real>(narrow) : static_cast<Real>(value);
}

/// The angle in turns; exact while |turns| stays below 2^20 in double, meant for differences in
/// float.
template <class Real>
[[nodiscard]] constexpr Real to_turns(Phase phase) {
  // A fraction in the upper half counts down from the next turn, so that small negative
  // differences keep all their digits in float.
  const auto fraction = static_cast<std::int32_t>(phase.fraction);
  const Real part = static_cast<Real>(fraction) / Real(4294967296.0);
  if (phase.turns == std::int64_t{fraction >> 31U}) {
    return part;
  }
  return whole_to_real<Real>(phase.turns + (fraction < 0 ? 1 : 0)) + part;
}

template <class Real>
[[nodiscard]] constexpr Real to_radians(Phase phase) {
  return to_turns<Real>(phase) * two_pi<Real>;
}

/// order_fraction() by 32-bit divisions, where turns and both parts of the order are short enough.
[[nodiscard]] constexpr std::uint32_t short_order_fraction(std::int32_t turns,
                                                           std::uint32_t fraction, Order order) {
  const auto denominator = static_cast<std::int32_t>(order.denominator);
  std::int32_t rest = turns % denominator;
  rest += rest < 0 ? denominator : 0;
  // Long division in two digits of 16 bits; each dividend is below denominator x 2^16.
  const std::uint32_t upper = (static_cast<std::uint32_t>(rest) << 16U) | (fraction >> 16U);
  const std::uint32_t high = upper / order.denominator;
  const std::uint32_t lower = ((upper - high * order.denominator) << 16U) | (fraction & 0xFFFFU);
  const std::uint32_t low = lower / order.denominator;
  const std::uint32_t remainder = lower - low * order.denominator;
  return ((high << 16U) + low) * order.numerator + remainder * order.numerator / order.denominator;
}

#if defined(__x86_64__) || defined(__aarch64__)
/// Turns times numerator below which double finds order_fraction() by one division: whole numbers
/// below 2^51, and a quotient whose error is smaller than the half unit that keeps it from the next
/// whole number.
inline constexpr std::int64_t most_turns_in_double = std::int64_t{1} << 19U;

/// order_fraction() where the processor divides doubles faster than whole numbers.
[[nodiscard]] constexpr std::uint32_t order_fraction_by_double(Phase phase, Order order) {
  const double angle =
      static_cast<double>(phase.turns) * 4294967296.0 + static_cast<double>(phase.fraction);
  const double cycles =
      (angle * static_cast<double>(order.numerator) + 0.5) / static_cast<double>(order.denominator);
  const auto towards_zero = static_cast<std::int64_t>(cycles);
  return static_cast<std::uint32_t>(towards_zero - (cycles < 0.0 ? 1 : 0));
}
#endif

/// Phase of an order, as a fraction of its cycle in units of 2^-32: order x angle, modulo one.
/// Exact to the unit for every order and every number of turns, because only whole numbers are
/// multiplied and divided.  1/R is an order like any other.
[[nodiscard]] constexpr std::uint32_t order_fraction(Phase phase, Order order) {
  if (order.denominator <= 1) {  // 0 is no ratio, which is_valid() says; it must not divide
    return phase.fraction * order.numerator;  // whole cycles drop out modulo 2^32
  }
#if defined(__x86_64__) || defined(__aarch64__)
  const std::int64_t most_turns = most_turns_in_double / 2;
  if (phase.turns > -most_turns && phase.turns < most_turns &&
      order.numerator < static_cast<std::uint32_t>(most_turns) &&
      absolute(phase.turns * static_cast<std::int64_t>(order.numerator)) < most_turns) {
    return order_fraction_by_double(phase, order);
  }
#endif
  const auto short_turns = static_cast<std::int32_t>(phase.turns);
  if (order.denominator <= 0xFFFFU && order.numerator <= 0xFFFFU && short_turns == phase.turns) {
    return short_order_fraction(short_turns, phase.fraction, order);
  }
  const auto denominator = static_cast<std::int64_t>(order.denominator);
  std::int64_t turns = phase.turns % denominator;
  if (turns < 0) {
    turns += denominator;
  }
  // angle < denominator x 2^32, so that quotient and remainder keep every bit of the product.
  const std::uint64_t angle = (static_cast<std::uint64_t>(turns) << 32U) | phase.fraction;
  const std::uint64_t quotient = angle / order.denominator;
  const std::uint64_t remainder = angle % order.denominator;
  return static_cast<std::uint32_t>(quotient) * order.numerator +
         static_cast<std::uint32_t>(remainder * order.numerator / order.denominator);
}

/// Extends an encoder count that wraps at 32 bits to 64 bits.
struct EncoderCounter {
  std::int64_t counts = 0;
  std::uint32_t last_raw = 0;
  bool started = false;

  /// Takes the next raw count; it may have moved by at most 2^31 - 1 counts either way.
  constexpr std::int64_t update(std::uint32_t raw) {
    if (started) {
      counts += static_cast<std::int32_t>(raw - last_raw);
    } else {
      counts = static_cast<std::int32_t>(raw);
      started = true;
    }
    last_raw = raw;
    return counts;
  }
};

}  // namespace strainwave
