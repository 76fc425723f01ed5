// SPDX-License-Identifier: Apache-2.0
/// @file batch.hpp
/// Many channels at once: a robot's joints, a fleet's logs, side by side in vector registers and
/// over threads.
///
/// Hosted: threads and vectors of the standard library.  Each channel comes out as step() would
/// make it, to rounding (products and sums are fused where the processor can); its state may go on
/// with either.  Levels, layouts and limits: docs/reference/batch.md.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "strainwave/batch_oscillator.hpp"
#include "strainwave/batch_threads.hpp"
#include "strainwave/lanes.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace strainwave {

struct BatchOptions {
  VectorLevel level = best_vector_level();  ///< one by one where it is not available
  std::size_t thread_count = 1;
};

namespace detail {

/// Channels in the order of their kernels and lengths, so that those of a block end together.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline std::vector<std::size_t> sorted_channels(
    std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs,
    std::span<const OscillatorChannel<Real>> channels) {
  std::vector<std::size_t> order(channels.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(kind_of(configs[a]), channels[b].sample_count) <
           std::tuple(kind_of(configs[b]), channels[a].sample_count);
  });
  return order;
}

/// Where blocks begin in the sorted channels, and the end.  A channel without a kernel is a block
/// of its own.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline std::vector<std::size_t> block_starts(
    std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs,
    const std::vector<std::size_t>& order) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const OscillatorKind kind = kind_of(configs[order[i]]);
    if (starts.empty() || i - starts.back() == block_width<Real> || kind.orders == 0 ||
        kind != kind_of(configs[order[starts.back()]])) {
      starts.push_back(i);
    }
  }
  starts.push_back(order.size());
  return starts;
}

}  // namespace detail

/// Filters channels, each with its own configuration, state and length.  One configuration, state
/// and channel each; configurations must have passed check(), and arrays must not overlap.
template <class Real, std::size_t MaxOrders>
void process_batch(std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs,
                   std::span<OscillatorFilterState<Real, MaxOrders>> states,
                   std::span<const OscillatorChannel<Real>> channels,
                   const BatchOptions& options = {}) {
  const std::vector<std::size_t> order = detail::sorted_channels(configs, channels);
  const std::vector<std::size_t> starts = detail::block_starts(configs, order);
  detail::for_each_part(starts.size() - 1, options.thread_count, [&](std::size_t part) {
    detail::OscillatorBlock<Real, MaxOrders> block;
    for (std::size_t i = starts[part]; i < starts[part + 1]; ++i) {
      const std::size_t lane = i - starts[part];
      block.configs[lane] = &configs[order[i]];
      block.states[lane] = &states[order[i]];
      block.channels[lane] = channels[order[i]];
    }
    detail::filter_block(detail::kind_of(*block.configs[0]), options.level, block);
  });
}

}  // namespace strainwave
