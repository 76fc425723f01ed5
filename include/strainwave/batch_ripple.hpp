// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple.hpp
/// Ripple filters of many channels at once: side by side in vector registers and over threads.
///
/// Hosted.  Each channel comes out as step() would make it, to rounding; its state may go on with
/// either.  Channels whose orders depend on the same things share a block, whatever else they are
/// told.
#pragma once

#include <span>
#include <vector>

#include "strainwave/batch_blocks.hpp"
#include "strainwave/batch_ripple_block.hpp"
#include "strainwave/batch_ripple_channel.hpp"
#include "strainwave/ripple_filter.hpp"

namespace strainwave {

/// Filters channels, each with its own configuration, state and length.  One configuration, state
/// and channel each; configurations must have passed check(), and arrays must not overlap.
template <class Real, std::size_t MaxPairs>
void process_batch(std::span<const RippleFilterConfig<Real, MaxPairs>> configs,
                   std::span<RippleFilterState<Real, MaxPairs>> states,
                   std::span<const RippleChannel<Real>> channels,
                   const BatchOptions& options = {}) {
  std::vector<detail::RippleKind> kinds;
  for (const auto& config : configs) {
    kinds.push_back(detail::kind_of(config));
  }
  detail::for_each_block<detail::RippleBlock<Real, MaxPairs>>(
      kinds, configs, states, channels, options.thread_count,
      [&](const detail::RippleKind& kind, const auto& block) {
        detail::filter_block(kind, options.level, block);
      });
}

}  // namespace strainwave
