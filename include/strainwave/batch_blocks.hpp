// SPDX-License-Identifier: Apache-2.0
/// @file batch_blocks.hpp
/// Channels put together into blocks, and blocks handed to threads; the same for every filter.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "strainwave/batch_threads.hpp"
#include "strainwave/lanes.hpp"

namespace strainwave {

struct BatchOptions {
  VectorLevel level = best_vector_level();  ///< one by one where it is not available
  std::size_t thread_count = 1;
};

namespace detail {

/// Channels in the order of their kinds and lengths, so that those of a block end together.
template <class Kind, class Channel>
[[nodiscard]] inline std::vector<std::size_t> sorted_channels(const std::vector<Kind>& kinds,
                                                              std::span<const Channel> channels) {
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
template <class Kind>
[[nodiscard]] inline std::vector<std::size_t> block_starts(const std::vector<Kind>& kinds,
                                                           const std::vector<std::size_t>& order,
                                                           std::size_t width) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Kind& kind = kinds[order[i]];
    if (starts.empty() || i - starts.back() == width || !kind.has_kernel() ||
        kind != kinds[order[starts.back()]]) {
      starts.push_back(i);
    }
  }
  starts.push_back(order.size());
  return starts;
}

/// Calls filter_block(kind, block) for all channels' blocks, over threads.
template <class Block, class Kind, class Config, class State, class Channel, class FilterBlock>
void for_each_block(const std::vector<Kind>& kinds, std::span<const Config> configs,
                    std::span<State> states, std::span<const Channel> channels,
                    std::size_t thread_count, const FilterBlock& filter_block) {
  const std::vector<std::size_t> order = sorted_channels(kinds, channels);
  const std::vector<std::size_t> starts = block_starts(kinds, order, Block::width);
  for_each_part(starts.size() - 1, thread_count, [&](std::size_t part) {
    Block block;
    for (std::size_t i = starts[part]; i < starts[part + 1]; ++i) {
      const std::size_t lane = i - starts[part];
      block.configs[lane] = &configs[order[i]];
      block.states[lane] = &states[order[i]];
      block.channels[lane] = channels[order[i]];
    }
    filter_block(kinds[order[starts[part]]], block);
  });
}

}  // namespace detail

}  // namespace strainwave
