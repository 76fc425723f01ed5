// SPDX-License-Identifier: Apache-2.0
/// @file batch_time_chunks.hpp
/// One long log in time chunks, each warmed up on the samples before it; the same for every filter.
///
/// A Kalman filter forgets where it started.  A chunk starts early, by several memories of the
/// filter; at each boundary its state is held against the one in which the chunk before ended, and
/// a chunk that differs too much is filtered again in sequence.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "strainwave/arithmetic.hpp"
#include "strainwave/batch_blocks.hpp"
#include "strainwave/batch_threads.hpp"
#include "strainwave/status.hpp"

namespace strainwave {

/// How much more than the ripple a single state may differ at a boundary.  A state that is hardly
/// seen may be some way off: what matters of it is in the ripple.
inline constexpr double state_tolerance_ratio = 100.0;

struct LongOptions {
  BatchOptions batch = {};
  bool in_sequence = false;  ///< exactly as step() does it, sample after sample
  /// Memories of the filter that a chunk is warmed up by; what is left of a wrong start falls by
  /// a factor of e with each.
  double warm_up_memories = 16.0;
  /// Difference of the predicted ripple at a boundary beyond which the chunk after it is filtered
  /// again in sequence.
  double tolerance_Nm = 1e-4;
  double state_tolerance_Nm = state_tolerance_ratio * 1e-4;  ///< likewise of any single state
};

/// What process_long() did, and how far from a filter in sequence it came out.
struct LongReport {
  std::size_t chunk_count = 1;      ///< 1: in sequence
  std::size_t repeated_chunks = 0;  ///< filtered again in sequence, because they differed too much
  std::size_t warm_up_samples = 0;  ///< filtered twice
  /// Differences at the boundaries that were kept; a repeated chunk begins without one.
  double largest_ripple_difference_Nm = 0.0;
  double rms_ripple_difference_Nm = 0.0;
  double largest_state_difference_Nm = 0.0;
};

namespace detail {

/// Blocks for each thread: threads that were held up leave work to the others.
inline constexpr std::size_t blocks_per_thread = 2;

/// How far two states of the same filter lie apart.
struct StateDifference {
  double ripple_Nm = 0.0;
  double state_Nm = 0.0;  ///< of the state that differs most
};

/// A chunk of a long log.
template <class State>
struct TimeChunk {
  std::size_t start = 0;
  std::size_t count = 0;
  std::size_t warm_up = 0;
  State began;
  State ended;
};

/// Adds the counts of a part of a recording.
constexpr void add_counts(EventCounters& counters, const EventCounters& of_part) {
  count_up_by(counters.samples, of_part.samples);
  count_up_by(counters.faults, of_part.faults);
  for (std::size_t bit = 0; bit < 32; ++bit) {
    count_up_by(counters.by_bit[bit], of_part.by_bit[bit]);
  }
}

// Filter: Config, State, Channel and Block, and static functions part_of(), clear_results(),
// filter_block(), filter_one() and difference_of().

/// A block of chunks: warmed up without a result, then filtered.
template <class Filter>
inline void filter_chunks(const typename Filter::Config& config,
                          const typename Filter::Channel& channel, VectorLevel level,
                          TimeChunk<typename Filter::State>* chunks, std::size_t count) {
  typename Filter::Block block;
  for (std::size_t lane = 0; lane < count; ++lane) {
    auto& chunk = chunks[lane];
    block.configs[lane] = &config;
    block.states[lane] = &chunk.began;
    block.channels[lane] = Filter::part_of(channel, chunk.start - chunk.warm_up, chunk.warm_up);
    Filter::clear_results(block.channels[lane]);
  }
  Filter::filter_block(level, block);
  for (std::size_t lane = 0; lane < count; ++lane) {
    auto& chunk = chunks[lane];
    chunk.began.counters = {};
    chunk.ended = chunk.began;
    block.states[lane] = &chunk.ended;
    block.channels[lane] = Filter::part_of(channel, chunk.start, chunk.count);
  }
  Filter::filter_block(level, block);
}

/// Holds each chunk's beginning against the end of the one before, and filters it again where they
/// differ too much.
template <class Filter>
inline LongReport join_chunks(const typename Filter::Config& config,
                              const typename Filter::Channel& channel, const LongOptions& options,
                              std::vector<TimeChunk<typename Filter::State>>& chunks) {
  LongReport report;
  report.chunk_count = chunks.size();
  double squares_Nm2 = 0.0;
  for (std::size_t i = 1; i < chunks.size(); ++i) {
    auto& chunk = chunks[i];
    report.warm_up_samples += chunk.warm_up;
    const StateDifference apart = Filter::difference_of(config, chunk.began, chunks[i - 1].ended);
    // In this way round, so that what is no number is no agreement.
    const bool agrees =
        apart.ripple_Nm <= options.tolerance_Nm && apart.state_Nm <= options.state_tolerance_Nm;
    if (!agrees) {
      ++report.repeated_chunks;
      chunk.ended = chunks[i - 1].ended;
      chunk.ended.counters = {};
      Filter::filter_one(config, chunk.ended, Filter::part_of(channel, chunk.start, chunk.count));
      continue;
    }
    report.largest_ripple_difference_Nm =
        std::max(report.largest_ripple_difference_Nm, apart.ripple_Nm);
    report.largest_state_difference_Nm =
        std::max(report.largest_state_difference_Nm, apart.state_Nm);
    squares_Nm2 += apart.ripple_Nm * apart.ripple_Nm;
  }
  const std::size_t kept = chunks.size() - 1 - report.repeated_chunks;
  if (kept > 0) {
    report.rms_ripple_difference_Nm = square_root(squares_Nm2 / static_cast<double>(kept));
  }
  return report;
}

/// A log in its chunks; one chunk is a sequence.  The state goes on as after the last sample.
template <class Filter>
inline LongReport filter_in_chunks(const typename Filter::Config& config,
                                   typename Filter::State& state,
                                   const typename Filter::Channel& channel,
                                   const LongOptions& options,
                                   std::vector<TimeChunk<typename Filter::State>>& chunks) {
  if (chunks.size() < 2) {
    Filter::filter_one(config, state, channel);
    return {};
  }
  for (auto& chunk : chunks) {
    // A warm-up that begins with the log begins with its state.
    chunk.began = chunk.warm_up == chunk.start ? state : initial_state(config);
  }
  constexpr std::size_t width = Filter::Block::width;
  const std::size_t blocks = (chunks.size() + width - 1) / width;
  for_each_part(blocks, options.batch.thread_count, [&](std::size_t block) {
    const std::size_t first = block * width;
    filter_chunks<Filter>(config, channel, options.batch.level, chunks.data() + first,
                          std::min(width, chunks.size() - first));
  });
  const LongReport report = join_chunks<Filter>(config, channel, options, chunks);
  EventCounters counters = state.counters;
  for (const auto& chunk : chunks) {
    add_counts(counters, chunk.ended.counters);
  }
  state = chunks.back().ended;
  state.counters = counters;
  return report;
}

}  // namespace detail

}  // namespace strainwave
