// SPDX-License-Identifier: Apache-2.0
/// @file lanes_each_level.hpp
/// Includes the file named by STRAINWAVE_LEVEL_FILE once for each vector level, in a namespace of
/// the level's own and compiled for it.
///
/// Included as often as there are kernels.  The file finds STRAINWAVE_LANE_BYTES, the length of a
/// register, and STRAINWAVE_LANE_LEVEL, 0 for portable and 2 to 4 for x86-64-v2 to v4.  What it
/// defines has to be complete there: templates from elsewhere are not compiled for the level, and
/// neither are lambdas.
// No guard: included once for each kernel.

#if !defined(STRAINWAVE_LEVEL_FILE)
#error "strainwave: STRAINWAVE_LEVEL_FILE must name the file to be compiled for each level"
#endif

#if STRAINWAVE_HAS_X86_LEVELS

#define STRAINWAVE_LANE_BYTES 16
#define STRAINWAVE_LANE_LEVEL 2
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("arch=x86-64-v2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v2")
#endif
namespace strainwave::level_v2 {
#include STRAINWAVE_LEVEL_FILE
}  // namespace strainwave::level_v2
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef STRAINWAVE_LANE_LEVEL
#undef STRAINWAVE_LANE_BYTES

#define STRAINWAVE_LANE_BYTES 32
#define STRAINWAVE_LANE_LEVEL 3
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("arch=x86-64-v3"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#endif
namespace strainwave::level_v3 {
#include STRAINWAVE_LEVEL_FILE
}  // namespace strainwave::level_v3
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef STRAINWAVE_LANE_LEVEL
#undef STRAINWAVE_LANE_BYTES

#define STRAINWAVE_LANE_BYTES 64
#define STRAINWAVE_LANE_LEVEL 4
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("arch=x86-64-v4"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v4")
#endif
namespace strainwave::level_v4 {
#include STRAINWAVE_LEVEL_FILE
}  // namespace strainwave::level_v4
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef STRAINWAVE_LANE_LEVEL
#undef STRAINWAVE_LANE_BYTES

#else

#define STRAINWAVE_LANE_BYTES 16
#define STRAINWAVE_LANE_LEVEL 0
namespace strainwave::level_portable {
#include STRAINWAVE_LEVEL_FILE
}  // namespace strainwave::level_portable
#undef STRAINWAVE_LANE_LEVEL
#undef STRAINWAVE_LANE_BYTES

#endif
