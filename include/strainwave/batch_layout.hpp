// SPDX-License-Identifier: Apache-2.0
/// @file batch_layout.hpp
/// Between one array a channel and the layout of the lanes, [time][block_width], tile by tile.
///
/// A tile is short enough to stay in the first cache with all that belongs to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "strainwave/lanes.hpp"
#include "strainwave/status.hpp"

#if STRAINWAVE_HAS_LANES
#define STRAINWAVE_LEVEL_FILE "strainwave/batch_layout_level.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#endif

namespace strainwave {

/// Samples of a tile: five tiles of 64 x 64 bytes are 20 KB.
inline constexpr std::size_t tile_samples = 64;

/// Samples of one block in the layout of the lanes; element (k, lane) is at k * block_width + lane.
template <class Real>
struct alignas(64) Tile {
  Real values[tile_samples * block_width<Real>];
};

namespace detail {

/// A row of zeros, for what a recording does not have.
template <class Real>
inline constexpr Real zero_row[block_width<Real>] = {};

}  // namespace detail

/// Arrays of a block's channels that are read or written a tile ahead.  There are more of them than
/// the processor foresees on its own, and asking for all at once would make it wait.
template <class Number>
struct Ahead {
  static constexpr std::size_t line = 64 / sizeof(Number);

  const Number* rows[block_width<Number>] = {};

  /// Asks for one line of the tile that begins at `at`, for each sample of the tile before it.
  [[gnu::always_inline]] void ask(std::size_t at, std::size_t sample) const {
#if STRAINWAVE_HAS_LANES
    __builtin_prefetch(rows[sample % block_width<Number>] + at +
                       sample / block_width<Number> * line);
#endif
  }
};

namespace detail {

/// The part of a tile that whole squares cover, from one array a channel; returns its samples, 0
/// where the level has no squares.
template <class Real>
inline std::size_t gather_squares(VectorLevel level, const Real* const* rows, std::size_t at,
                                  std::size_t count, Real* tile) {
  switch (level) {
#if STRAINWAVE_HAS_X86_LEVELS
    case VectorLevel::x86_64_v2:
      return level_v2::gather_squares<Real>(rows, at, count, tile);
    case VectorLevel::x86_64_v3:
      return level_v3::gather_squares<Real>(rows, at, count, tile);
    case VectorLevel::x86_64_v4:
      return level_v4::gather_squares<Real>(rows, at, count, tile);
#elif STRAINWAVE_HAS_LANES
    case VectorLevel::portable:
      return level_portable::gather_squares<Real>(rows, at, count, tile);
#endif
    default:
      return 0;
  }
}

/// The way back; a null row is not wanted.
template <class Real>
inline std::size_t scatter_squares(VectorLevel level, const Real* tile, std::size_t count,
                                   Real* const* rows, std::size_t at) {
  switch (level) {
#if STRAINWAVE_HAS_X86_LEVELS
    case VectorLevel::x86_64_v2:
      return level_v2::scatter_squares<Real>(tile, count, rows, at);
    case VectorLevel::x86_64_v3:
      return level_v3::scatter_squares<Real>(tile, count, rows, at);
    case VectorLevel::x86_64_v4:
      return level_v4::scatter_squares<Real>(tile, count, rows, at);
#elif STRAINWAVE_HAS_LANES
    case VectorLevel::portable:
      return level_portable::scatter_squares<Real>(tile, count, rows, at);
#endif
    default:
      return 0;
  }
}

/// Samples [at, at + count) of a block's channels into a tile.  Rows may repeat.
template <class Real>
inline void gather(const Real* const* rows, std::size_t at, std::size_t count, Real* tile,
                   VectorLevel level = best_vector_level()) {
  constexpr std::size_t width = block_width<Real>;
  for (std::size_t k = gather_squares(level, rows, at, count, tile); k < count; ++k) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      tile[k * width + lane] = rows[lane][at + k];
    }
  }
}

/// A tile's samples into [at, at + count) of a block's channels; a null row is not wanted.
template <class Real>
inline void scatter(const Real* tile, std::size_t count, Real* const* rows, std::size_t at,
                    VectorLevel level = best_vector_level()) {
  constexpr std::size_t width = block_width<Real>;
  for (std::size_t k = scatter_squares(level, tile, count, rows, at); k < count; ++k) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (rows[lane] != nullptr) {
        rows[lane][at + k] = tile[k * width + lane];
      }
    }
  }
}

}  // namespace detail

}  // namespace strainwave
