// SPDX-License-Identifier: Apache-2.0
/// @file number_row.hpp
/// A row of numbers that the processor computes side by side.
///
/// The compiler's vectors, in registers as long as the processor has them.  What is computed does
/// not depend on their length: an operation is one of each lane alone, and a sum over lanes has one
/// order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#if (defined(__x86_64__) || defined(__aarch64__)) && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define STRAINWAVE_NUMBER_ROWS 1
#endif
#endif

namespace strainwave::detail {

/// Numbers that are summed side by side.
inline constexpr std::size_t row_lane_count = 8;

#if defined(STRAINWAVE_NUMBER_ROWS)

#if defined(__AVX__)
inline constexpr std::size_t register_bytes = 32;
#else
inline constexpr std::size_t register_bytes = 16;
#endif

/// NumberRow of one register.
template <class Real, std::size_t Count>
struct OneRegister {
  using Index = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using Vector [[gnu::vector_size(Count * sizeof(Real))]] = Real;
  using Indices [[gnu::vector_size(Count * sizeof(Real))]] = Index;

  Vector values;

  [[nodiscard]] static OneRegister all(Real value) { return {value - Vector{}}; }
  [[nodiscard]] static OneRegister load(const Real* from) {
    OneRegister to;  // NOLINT(*-member-init): filled in the next line
    __builtin_memcpy(&to.values, from, sizeof(Vector));
    return to;
  }
  /// Of numbers just computed one by one: a load of several of them at once would wait until the
  /// last one has left the processor's store queue.
  [[nodiscard]] static OneRegister gathered(const Real* from) {
    if constexpr (Count == 8) {
      return {Vector{from[0], from[1], from[2], from[3], from[4], from[5], from[6], from[7]}};
    } else if constexpr (Count == 4) {
      return {Vector{from[0], from[1], from[2], from[3]}};
    } else {
      return {Vector{from[0], from[1]}};
    }
  }
  void store(Real* to) const { __builtin_memcpy(to, &values, sizeof(Vector)); }

  OneRegister operator+(const OneRegister& other) const { return {values + other.values}; }
  OneRegister operator-(const OneRegister& other) const { return {values - other.values}; }
  OneRegister operator*(const OneRegister& other) const { return {values * other.values}; }

  /// The first lanes of one, the others of the other.
  [[nodiscard]] static OneRegister joined(std::ptrdiff_t first, const OneRegister& one,
                                          const OneRegister& other) {
    return {indices() < static_cast<Index>(first) ? one.values : other.values};
  }

  /// Adds every fourth lane to one of four sums, one after the other.
  template <class Four>
  [[nodiscard]] Four added_by_fours(const Four& sums) const {
    static_assert(Count >= 4);
    if constexpr (Count == 16) {
      const OneRegister<Real, 8> low = {
          __builtin_shufflevector(values, values, 0, 1, 2, 3, 4, 5, 6, 7)};
      const OneRegister<Real, 8> high = {
          __builtin_shufflevector(values, values, 8, 9, 10, 11, 12, 13, 14, 15)};
      return high.added_by_fours(low.added_by_fours(sums));
    } else if constexpr (Count == 8) {
      const Four low = {__builtin_shufflevector(values, values, 0, 1, 2, 3)};
      const Four high = {__builtin_shufflevector(values, values, 4, 5, 6, 7)};
      return (sums + low) + high;
    } else {
      return sums + *this;
    }
  }

  /// Halves added until one number is left.
  [[nodiscard]] Real sum() const {
    if constexpr (Count == 8) {
      const OneRegister<Real, 4> four = {__builtin_shufflevector(values, values, 0, 1, 2, 3) +
                                         __builtin_shufflevector(values, values, 4, 5, 6, 7)};
      return four.sum();
    } else if constexpr (Count == 4) {
      const Vector two = values + __builtin_shufflevector(values, values, 2, 3, 0, 1);
      return (two + __builtin_shufflevector(two, two, 1, 0, 3, 2))[0];
    } else {
      return values[0] + values[1];
    }
  }

 private:
  [[nodiscard]] static Indices indices() {
    if constexpr (Count == 8) {
      return Indices{0, 1, 2, 3, 4, 5, 6, 7};
    } else if constexpr (Count == 4) {
      return Indices{0, 1, 2, 3};
    } else {
      return Indices{0, 1};
    }
  }
};

template <class Real, std::size_t Count>
struct SeveralRegisters;

/// `Count` numbers side by side: 2, 4, 8 or a multiple of 8.
template <class Real, std::size_t Count>
using NumberRow =
    std::conditional_t<Count <= row_lane_count && Count * sizeof(Real) <= register_bytes,
                       OneRegister<Real, Count>, SeveralRegisters<Real, Count>>;

#if defined(__AVX512F__)
/// As NumberRow, and sixteen numbers in one register.
template <class Real, std::size_t Count>
using WideRow = std::conditional_t<Count == 16 && sizeof(Real) == 4, OneRegister<Real, Count>,
                                   NumberRow<Real, Count>>;
#else
template <class Real, std::size_t Count>
using WideRow = NumberRow<Real, Count>;
#endif

/// Numbers of several registers: two halves, or the first row_lane_count lanes and the others.
template <class Real, std::size_t Count>
struct SeveralRegisters {
  static constexpr std::size_t low_count = Count > row_lane_count ? row_lane_count : Count / 2;
  using Low = NumberRow<Real, low_count>;
  using High = NumberRow<Real, Count - low_count>;

  Low low;
  High high;

  [[nodiscard]] static SeveralRegisters all(Real value) {
    return {Low::all(value), High::all(value)};
  }
  [[nodiscard]] static SeveralRegisters load(const Real* from) {
    return {Low::load(from), High::load(from + low_count)};
  }
  [[nodiscard]] static SeveralRegisters gathered(const Real* from) {
    return {Low::gathered(from), High::gathered(from + low_count)};
  }
  void store(Real* to) const {
    low.store(to);
    high.store(to + low_count);
  }

  SeveralRegisters operator+(const SeveralRegisters& other) const {
    return {low + other.low, high + other.high};
  }
  SeveralRegisters operator-(const SeveralRegisters& other) const {
    return {low - other.low, high - other.high};
  }
  SeveralRegisters operator*(const SeveralRegisters& other) const {
    return {low * other.low, high * other.high};
  }

  [[nodiscard]] static SeveralRegisters joined(std::ptrdiff_t first, const SeveralRegisters& one,
                                               const SeveralRegisters& other) {
    return {Low::joined(first, one.low, other.low),
            High::joined(first - static_cast<std::ptrdiff_t>(low_count), one.high, other.high)};
  }

  /// Adds every fourth lane to one of four sums, one after the other.
  template <class Four>
  [[nodiscard]] Four added_by_fours(const Four& sums) const {
    if constexpr (Count == 4) {
      return sums + *this;
    } else {
      return high.added_by_fours(low.added_by_fours(sums));
    }
  }

  /// NumberRow that are row_lane_count apart first, one after the other; then halves.
  [[nodiscard]] Real sum() const {
    if constexpr (Count > row_lane_count) {
      return sum_of_rest(low, high).sum();
    } else {
      return (low + high).sum();
    }
  }

 private:
  template <class Rest>
  [[nodiscard]] static Low sum_of_rest(const Low& so_far, const Rest& rest) {
    if constexpr (std::is_same_v<Rest, Low>) {
      return so_far + rest;
    } else {
      return sum_of_rest(so_far + rest.low, rest.high);
    }
  }
};

/// Sum of products in the order in which four sums side by side have it; see product_sum().
template <class Row, class Real>
[[nodiscard]] Real product_sum_by_fours(const Real* a, const Real* b) {
  using Four = NumberRow<Real, 4>;
  Real sums[4];  // NOLINT(*-member-init): filled in the next line
  (Row::load(a) * Row::load(b)).added_by_fours(Four::all(Real(0))).store(sums);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

#else

/// Not there: what is written for them is not compiled.
template <class Real, std::size_t Count>
struct NumberRow;
template <class Real, std::size_t Count>
using WideRow = NumberRow<Real, Count>;
template <class Row, class Real>
Real product_sum_by_fours(const Real* a, const Real* b);

#endif

}  // namespace strainwave::detail
