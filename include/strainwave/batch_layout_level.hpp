// SPDX-License-Identifier: Apache-2.0
/// @file batch_layout_level.hpp
/// Squares of numbers that change rows and columns, as wide as a register of the vector level.
///
/// Included by batch_layout.hpp within the namespace of each level.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers: they would take minutes to compile, for what only moves numbers.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline
#define STRAINWAVE_KERNEL \
  [[gnu::noinline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

/// As many rows as a register has numbers.
template <class Real>
struct Square {
  using Row = LaneVectors<Real>::Reals;
  static constexpr std::size_t side = STRAINWAVE_LANE_BYTES / sizeof(Real);
  /// Numbers within 16 bytes, which change places most cheaply.
  static constexpr std::size_t part = 16 / sizeof(Real);
  static constexpr std::size_t parts = side / part;

  Row rows[side];

  STRAINWAVE_INLINE void load_row(std::size_t i, const Real* from) {
    __builtin_memcpy(&rows[i], from, sizeof(Row));
  }
  STRAINWAVE_INLINE void store_row(std::size_t i, Real* to) const {
    __builtin_memcpy(to, &rows[i], sizeof(Row));
  }

  STRAINWAVE_INLINE void transpose() {
    constexpr auto numbers = std::make_index_sequence<side>{};
#pragma GCC unroll 16
    for (std::size_t i = 0; i < side; i += part) {
      transpose_parts(rows + i, numbers);
    }
#pragma GCC unroll 4
    for (std::size_t i = 0; i < part; ++i) {
      change_parts(i, numbers);
    }
  }

 private:
  /// Which number of two joined rows comes next to the one in place `i`: number i / 2 of the lower
  /// or upper half of each 16 bytes, from the one row and the other in turn.
  static constexpr std::size_t alternating(std::size_t i, bool upper) {
    const std::size_t in_part = i % part / 2 + (upper ? part / 2 : 0);
    return i / part * part + in_part + (i % 2 == 0 ? 0 : side);
  }
  /// Likewise of pairs of numbers.
  static constexpr std::size_t paired(std::size_t i, bool upper) {
    const std::size_t in_part = i % 2 + (upper ? 2 : 0);
    return i / part * part + in_part + (i % part < 2 ? 0 : side);
  }
  /// Every other 16 bytes of two joined rows.
  static constexpr std::size_t every_other_part(std::size_t i, bool odd) {
    return (2 * (i / part) + (odd ? 1 : 0)) * part + i % part;
  }

  /// Within each 16 bytes of `part` rows.
  template <std::size_t... I>
  STRAINWAVE_INLINE static void transpose_parts(Row* row, std::index_sequence<I...> /*numbers*/) {
    const Row low = __builtin_shufflevector(row[0], row[1], alternating(I, false)...);
    const Row high = __builtin_shufflevector(row[0], row[1], alternating(I, true)...);
    if constexpr (part == 2) {
      row[0] = low;
      row[1] = high;
    } else {
      const Row next_low = __builtin_shufflevector(row[2], row[3], alternating(I, false)...);
      const Row next_high = __builtin_shufflevector(row[2], row[3], alternating(I, true)...);
      row[0] = __builtin_shufflevector(low, next_low, paired(I, false)...);
      row[1] = __builtin_shufflevector(low, next_low, paired(I, true)...);
      row[2] = __builtin_shufflevector(high, next_high, paired(I, false)...);
      row[3] = __builtin_shufflevector(high, next_high, paired(I, true)...);
    }
  }

  /// The 16 bytes of rows first, first + part, ... among each other.
  template <std::size_t... I>
  STRAINWAVE_INLINE void change_parts(std::size_t first, std::index_sequence<I...> /*numbers*/) {
    if constexpr (parts > 1) {
      const Row even =
          __builtin_shufflevector(rows[first], rows[first + part], every_other_part(I, false)...);
      const Row odd =
          __builtin_shufflevector(rows[first], rows[first + part], every_other_part(I, true)...);
      if constexpr (parts == 2) {
        rows[first] = even;
        rows[first + part] = odd;
      } else {
        const Row next_even = __builtin_shufflevector(
            rows[first + 2 * part], rows[first + 3 * part], every_other_part(I, false)...);
        const Row next_odd = __builtin_shufflevector(rows[first + 2 * part], rows[first + 3 * part],
                                                     every_other_part(I, true)...);
        rows[first] = __builtin_shufflevector(even, next_even, every_other_part(I, false)...);
        rows[first + part] = __builtin_shufflevector(odd, next_odd, every_other_part(I, false)...);
        rows[first + 2 * part] =
            __builtin_shufflevector(even, next_even, every_other_part(I, true)...);
        rows[first + 3 * part] =
            __builtin_shufflevector(odd, next_odd, every_other_part(I, true)...);
      }
    }
  }
};

/// The part of a tile that whole squares cover, from one array a channel; returns its samples.
template <class Real>
STRAINWAVE_KERNEL std::size_t gather_squares(const Real* const* rows, std::size_t at,
                                             std::size_t count, Real* tile) {
  constexpr std::size_t width = block_width<Real>;
  constexpr std::size_t side = Square<Real>::side;
  for (std::size_t lane = 0; lane < width; lane += side) {
    for (std::size_t k = 0; k + side <= count; k += side) {
      Square<Real> square = {};
#pragma GCC unroll 16
      for (std::size_t i = 0; i < side; ++i) {
        square.load_row(i, rows[lane + i] + at + k);
      }
      square.transpose();
#pragma GCC unroll 16
      for (std::size_t i = 0; i < side; ++i) {
        square.store_row(i, tile + (k + i) * width + lane);
      }
    }
  }
  return count / side * side;
}

/// The way back; a null row is not wanted.
template <class Real>
STRAINWAVE_KERNEL std::size_t scatter_squares(const Real* tile, std::size_t count,
                                              Real* const* rows, std::size_t at) {
  constexpr std::size_t width = block_width<Real>;
  constexpr std::size_t side = Square<Real>::side;
  for (std::size_t lane = 0; lane < width; lane += side) {
    for (std::size_t k = 0; k + side <= count; k += side) {
      Square<Real> square = {};
#pragma GCC unroll 16
      for (std::size_t i = 0; i < side; ++i) {
        square.load_row(i, tile + (k + i) * width + lane);
      }
      square.transpose();
#pragma GCC unroll 16
      for (std::size_t i = 0; i < side; ++i) {
        if (rows[lane + i] != nullptr) {
          square.store_row(i, rows[lane + i] + at + k);
        }
      }
    }
  }
  return count / side * side;
}

#undef STRAINWAVE_KERNEL
#undef STRAINWAVE_INLINE
