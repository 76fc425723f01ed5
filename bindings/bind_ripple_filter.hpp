// SPDX-License-Identifier: Apache-2.0
/// @file bind_ripple_filter.hpp
/// The ripple filter's configuration and what it has learned, as Python holds them.
#pragma once

#include "common.hpp"
#include "strainwave/learned_ripple.hpp"

namespace strainwave::bindings {

/// Pairs of coefficients that Python has compiled in.
inline constexpr std::size_t most_pairs = 32;

using RippleConfigD = RippleFilterConfig<double, most_pairs>;
using LearnedD = LearnedRipple<double, most_pairs>;

}  // namespace strainwave::bindings
