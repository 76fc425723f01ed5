// SPDX-License-Identifier: Apache-2.0
/// @file batch_layout.hpp
/// Between one array a channel and the layout of the lanes, [time][block_width], tile by tile.
///
/// A tile is short enough to stay in the first cache with all that belongs to it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/lanes.hpp"
#include "strainwave/status.hpp"

namespace strainwave {

/// Samples of a tile: five tiles of 64 x 64 bytes are 20 KB.
inline constexpr std::size_t tile_samples = 64;

/// Samples of one block in the layout of the lanes; element (k, lane) is at k * block_width + lane.
template <class Real>
struct alignas(64) Tile {
  Real values[tile_samples * block_width<Real>];
};

/// Arrays of a block's channels that are read or written a tile ahead.  There are more of them than
/// the processor foresees on its own, and asking for all at once would make it wait.
template <class Number>
struct Ahead {
  static constexpr std::size_t line = 64 / sizeof(Number);

  const Number* rows[block_width<Number>] = {};
  bool is_on = false;

  /// Asks for one line of a tile for each sample of the tile before it.
  [[gnu::always_inline]] void ask(std::size_t sample) const {
#if STRAINWAVE_HAS_LANES
    __builtin_prefetch(rows[sample % block_width<Number>] + sample / block_width<Number> * line);
#endif
  }
};

namespace detail {

#if STRAINWAVE_HAS_LANES

/// Squares of 16-byte rows: 4 x 4 floats or 2 x 2 doubles.
template <class Real>
struct Square {
  using Row [[gnu::vector_size(16)]] = Real;
  static constexpr std::size_t side = 16 / sizeof(Real);

  Row rows[side];

  void load_row(std::size_t i, const Real* from) { __builtin_memcpy(&rows[i], from, 16); }
  void store_row(std::size_t i, Real* to) const { __builtin_memcpy(to, &rows[i], 16); }

  void transpose() {
    if constexpr (side == 4) {
      const Row low01 = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
      const Row high01 = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
      const Row low23 = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
      const Row high23 = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
      rows[0] = __builtin_shufflevector(low01, low23, 0, 1, 4, 5);
      rows[1] = __builtin_shufflevector(low01, low23, 2, 3, 6, 7);
      rows[2] = __builtin_shufflevector(high01, high23, 0, 1, 4, 5);
      rows[3] = __builtin_shufflevector(high01, high23, 2, 3, 6, 7);
    } else {
      const Row first = rows[0];
      rows[0] = __builtin_shufflevector(first, rows[1], 0, 2);
      rows[1] = __builtin_shufflevector(first, rows[1], 1, 3);
    }
  }
};

/// The part of a tile that whole squares cover, from one array a channel; returns its samples.
template <class Real>
inline std::size_t gather_squares(const Real* const* rows, std::size_t at, std::size_t count,
                                  Real* tile) {
  constexpr std::size_t width = block_width<Real>;
  constexpr std::size_t side = Square<Real>::side;
  Square<Real> square = {};
  for (std::size_t lane = 0; lane < width; lane += side) {
    for (std::size_t k = 0; k + side <= count; k += side) {
      for (std::size_t i = 0; i < side; ++i) {
        square.load_row(i, rows[lane + i] + at + k);
      }
      square.transpose();
      for (std::size_t i = 0; i < side; ++i) {
        square.store_row(i, tile + (k + i) * width + lane);
      }
    }
  }
  return count / side * side;
}

/// The way back, for the channels from `lane` on that share a square; returns its samples, 0 where
/// one of the channels is not wanted.
template <class Real>
inline std::size_t scatter_squares(const Real* tile, std::size_t count, Real* const* rows,
                                   std::size_t lane, std::size_t at) {
  constexpr std::size_t side = Square<Real>::side;
  for (std::size_t i = 0; i < side; ++i) {
    if (rows[lane + i] == nullptr) {
      return 0;
    }
  }
  Square<Real> square = {};
  for (std::size_t k = 0; k + side <= count; k += side) {
    for (std::size_t i = 0; i < side; ++i) {
      square.load_row(i, tile + (k + i) * block_width<Real> + lane);
    }
    square.transpose();
    for (std::size_t i = 0; i < side; ++i) {
      square.store_row(i, rows[lane + i] + at + k);
    }
  }
  return count / side * side;
}

#else

template <class Real>
struct Square {
  static constexpr std::size_t side = 1;
};
template <class Real>
inline std::size_t gather_squares(const Real* const* /*rows*/, std::size_t /*at*/,
                                  std::size_t /*count*/, Real* /*tile*/) {
  return 0;
}
template <class Real>
inline std::size_t scatter_squares(const Real* /*tile*/, std::size_t /*count*/,
                                   Real* const* /*rows*/, std::size_t /*lane*/,
                                   std::size_t /*at*/) {
  return 0;
}

#endif

/// Samples [at, at + count) of a block's channels into a tile.  Rows may repeat.
template <class Real>
inline void gather(const Real* const* rows, std::size_t at, std::size_t count, Real* tile) {
  constexpr std::size_t width = block_width<Real>;
  for (std::size_t k = gather_squares(rows, at, count, tile); k < count; ++k) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      tile[k * width + lane] = rows[lane][at + k];
    }
  }
}

/// A tile's samples into [at, at + count) of a block's channels; a null row is not wanted.
template <class Real>
inline void scatter(const Real* tile, std::size_t count, Real* const* rows, std::size_t at) {
  constexpr std::size_t width = block_width<Real>;
  for (std::size_t lane = 0; lane < width; lane += Square<Real>::side) {
    const std::size_t done = scatter_squares(tile, count, rows, lane, at);
    for (std::size_t i = lane; i < lane + Square<Real>::side; ++i) {
      for (std::size_t k = done; k < count && rows[i] != nullptr; ++k) {
        rows[i][at + k] = tile[k * width + i];
      }
    }
  }
}

}  // namespace detail

}  // namespace strainwave
