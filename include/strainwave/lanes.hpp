// SPDX-License-Identifier: Apache-2.0
/// @file lanes.hpp
/// Numbers side by side in one vector register, at every vector level of the processor.
///
/// Hosted: not for a microcontroller.  A kernel is one file that is compiled once for each level
/// (lanes_each_level.hpp); which one runs is decided when the program runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <type_traits>

#include "strainwave/arithmetic.hpp"

/// Vector extensions of GCC and Clang; other compilers filter channel after channel.
#if defined(__GNUC__)
#define STRAINWAVE_HAS_LANES 1
#else
#define STRAINWAVE_HAS_LANES 0
#endif

/// Levels of x86-64 beyond what the program is compiled for.
#if STRAINWAVE_HAS_LANES && defined(__x86_64__)
#define STRAINWAVE_HAS_X86_LEVELS 1
#include <immintrin.h>
#else
#define STRAINWAVE_HAS_X86_LEVELS 0
#endif

#if STRAINWAVE_HAS_LANES && defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace strainwave {

/// What the processor can do with vectors.
enum class VectorLevel : std::uint8_t {
  one_by_one,  ///< no vectors: channel after channel through step()
  portable,    ///< 16 bytes, for other processors than x86-64; NEON on aarch64
  x86_64_v2,   ///< 16 bytes, SSE 4.2
  x86_64_v3,   ///< 32 bytes, AVX2 and fused products
  x86_64_v4,   ///< 64 bytes, AVX-512 with masks
};

/// Whether this processor, and this build, have the level.
[[nodiscard]] inline bool is_available(VectorLevel level) {
  switch (level) {
    case VectorLevel::one_by_one:
      return true;
    case VectorLevel::portable:
      return STRAINWAVE_HAS_LANES != 0 && STRAINWAVE_HAS_X86_LEVELS == 0;
#if STRAINWAVE_HAS_X86_LEVELS
    case VectorLevel::x86_64_v2:
      return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("ssse3");
    case VectorLevel::x86_64_v3:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
             __builtin_cpu_supports("bmi2");
    case VectorLevel::x86_64_v4:
      return is_available(VectorLevel::x86_64_v3) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#endif
    default:
      return false;
  }
}

/// The highest level that is available.
[[nodiscard]] inline VectorLevel best_vector_level() {
  for (const VectorLevel level :
       {VectorLevel::x86_64_v4, VectorLevel::x86_64_v3, VectorLevel::x86_64_v2}) {
    if (is_available(level)) {
      return level;
    }
  }
  return is_available(VectorLevel::portable) ? VectorLevel::portable : VectorLevel::one_by_one;
}

/// Channels side by side in memory: a cache line, whatever the level.  A narrower register takes a
/// block in parts.
template <class Real>
inline constexpr std::size_t block_width = 64 / sizeof(Real);

}  // namespace strainwave

#if STRAINWAVE_HAS_LANES
#define STRAINWAVE_LEVEL_FILE "strainwave/lanes_level.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#endif
