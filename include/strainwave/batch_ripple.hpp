// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple.hpp
/// Ripple filters of many channels at once: side by side in vector registers and over threads.
///
/// Hosted.  Each channel comes out as step() would make it, to rounding; its state may go on with
/// either.  Channels whose orders depend on the same things share a block, whatever else they are
/// told.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "strainwave/batch.hpp"
#include "strainwave/batch_ripple_block.hpp"
#include "strainwave/batch_ripple_channel.hpp"
#include "strainwave/batch_threads.hpp"
#include "strainwave/ripple_filter.hpp"

namespace strainwave {

namespace detail {

/// Channels in the order of their kinds and lengths, so that those of a block end together.
template <class Real>
[[nodiscard]] inline std::vector<std::size_t> sorted_channels(
    const std::vector<RippleKind>& kinds, std::span<const RippleChannel<Real>> channels) {
  std::vector<std::size_t> order(channels.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return kinds[a] != kinds[b] ? kinds[a] < kinds[b]
                                : channels[a].sample_count > channels[b].sample_count;
  });
  return order;
}

/// Where blocks begin in the sorted channels, and the end.  A channel without a kernel is a block
/// of its own.
[[nodiscard]] inline std::vector<std::size_t> block_starts(const std::vector<RippleKind>& kinds,
                                                           const std::vector<std::size_t>& order,
                                                           std::size_t width) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const RippleKind& kind = kinds[order[i]];
    if (starts.empty() || i - starts.back() == width || kind.pairs == 0 ||
        kind != kinds[order[starts.back()]]) {
      starts.push_back(i);
    }
  }
  starts.push_back(order.size());
  return starts;
}

}  // namespace detail

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
  const std::vector<std::size_t> order = detail::sorted_channels(kinds, channels);
  const std::vector<std::size_t> starts = detail::block_starts(kinds, order, block_width<Real>);
  detail::for_each_part(starts.size() - 1, options.thread_count, [&](std::size_t part) {
    const detail::RippleKind& kind = kinds[order[starts[part]]];
    const bool on_lanes = kind.pairs != 0 && options.level != VectorLevel::one_by_one;
    detail::RippleBlock<Real, MaxPairs> block;
    for (std::size_t i = starts[part]; i < starts[part + 1]; ++i) {
      const std::size_t channel = order[i];
      if (on_lanes) {
        const std::size_t lane = i - starts[part];
        block.configs[lane] = &configs[channel];
        block.states[lane] = &states[channel];
        block.channels[lane] = channels[channel];
      } else {
        detail::filter_one(configs[channel], states[channel], channels[channel]);
      }
    }
    if (on_lanes) {
      detail::filter_block(kind, options.level, block);
    }
  });
}

}  // namespace strainwave
