// SPDX-License-Identifier: Apache-2.0
/// @file batch.hpp
/// Many channels at once: a robot's joints, a fleet's logs, side by side in vector registers and
/// over threads.
///
/// Hosted: threads and vectors of the standard library.  Each channel comes out as step() would
/// make it, to rounding (products and sums are fused where the processor can); its state may go on
/// with either.  Levels, layouts and limits: docs/reference/batch.md.
#pragma once

#include <span>
#include <vector>

#include "strainwave/batch_blocks.hpp"
#include "strainwave/batch_oscillator.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace strainwave {

/// Filters channels, each with its own configuration, state and length.  One configuration, state
/// and channel each; configurations must have passed check(), and arrays must not overlap.
template <class Real, std::size_t MaxOrders>
void process_batch(std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs,
                   std::span<OscillatorFilterState<Real, MaxOrders>> states,
                   std::span<const OscillatorChannel<Real>> channels,
                   const BatchOptions& options = {}) {
  std::vector<detail::OscillatorKind> kinds;
  for (const auto& config : configs) {
    kinds.push_back(detail::kind_of(config));
  }
  detail::for_each_block<detail::OscillatorBlock<Real, MaxOrders>>(
      kinds, configs, states, channels, options.thread_count,
      [&](const detail::OscillatorKind& kind, const auto& block) {
        detail::filter_block(kind, options.level, block);
      });
}

}  // namespace strainwave
