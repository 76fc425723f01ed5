// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_long.hpp
/// One long log through the ripple filter, on lanes and threads: time chunks, each warmed up on the
/// samples before it.
///
/// The filter forgets by travelled angle: a chunk starts early, by several memories.  At each
/// boundary its state is held against the one in which the chunk before ended, and a chunk that
/// differs too much is filtered again in sequence.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "strainwave/batch_long.hpp"
#include "strainwave/batch_ripple.hpp"

namespace strainwave {

namespace detail {

/// Further pairs are forgotten so many times more slowly than an order's first one, because they
/// are seen only as far as load and speed change.  Measured on logs that do change them; on others
/// the comparison at the boundaries decides.
inline constexpr double slowness_of_further_pairs = 12.0;

/// Samples before `start` in which the motor has travelled so many memories; all of them where it
/// has not.  Standstill, jumps and missing angles teach nothing and are passed over.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline std::size_t warm_up_before(const RippleFilterConfig<Real, MaxPairs>& config,
                                                const RippleChannel<Real>& channel,
                                                std::size_t start, double memories) {
  const double slowness = pair_count(config) > config.order_count ? slowness_of_further_pairs : 1.0;
  const double needed_rad =
      memories * slowness * two_pi<double> * static_cast<double>(config.memory_turns);
  const auto least_rad_s = static_cast<double>(config.minimum_speed_rad_s);
  double travel_rad = 0.0;
  std::size_t k = start;
  while (k > 1 && travel_rad < needed_rad) {
    --k;
    const double rotation_rad =
        absolute(channel.motor_angle_rad[k] - channel.motor_angle_rad[k - 1]);
    const auto interval_s = static_cast<double>(
        channel.interval_s == nullptr ? channel.sample_period_s : channel.interval_s[k]);
    if (rotation_rad >= least_rad_s * interval_s &&
        rotation_rad <= static_cast<double>(largest_motor_speed_rad_s) * interval_s &&
        is_usable_torque(channel.measured_torque_Nm[k])) {
      travel_rad += rotation_rad;
    }
  }
  return travel_rad < needed_rad ? start : start - k;
}

/// The part [start, start + count) of a channel.
template <class Real>
[[nodiscard]] inline RippleChannel<Real> part_of(const RippleChannel<Real>& channel,
                                                 std::size_t start, std::size_t count) {
  const auto from = [start](auto* array) { return array == nullptr ? nullptr : array + start; };
  RippleChannel<Real> part = channel;
  part.sample_count = count;
  part.measured_torque_Nm = from(channel.measured_torque_Nm);
  part.motor_angle_rad = from(channel.motor_angle_rad);
  part.interval_s = from(channel.interval_s);
  part.expected_torque_Nm = from(channel.expected_torque_Nm);
  for (Real*& output : part.outputs) {
    output = from(output);
  }
  part.status = from(channel.status);
  return part;
}

/// A chunk of a long log.
template <class Real, std::size_t MaxPairs>
struct RippleChunk {
  std::size_t start = 0;
  std::size_t count = 0;
  std::size_t warm_up = 0;
  RippleFilterState<Real, MaxPairs> began;
  RippleFilterState<Real, MaxPairs> ended;
};

/// Chunks of about equal length.  Where a warm-up and its chunk would be longer than half of the
/// log there is no boundary: nothing would be won.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline std::vector<RippleChunk<Real, MaxPairs>> ripple_chunks(
    const RippleFilterConfig<Real, MaxPairs>& config, const RippleChannel<Real>& channel,
    std::size_t count, double memories) {
  std::vector<RippleChunk<Real, MaxPairs>> chunks(1);
  const std::size_t length = (channel.sample_count + count - 1) / count;
  for (std::size_t start = length; start < channel.sample_count; start += length) {
    const std::size_t warm_up = warm_up_before(config, channel, start, memories);
    if (warm_up + length <= channel.sample_count / 2) {
      chunks.back().count = start - chunks.back().start;
      chunks.emplace_back();
      chunks.back().start = start;
      chunks.back().warm_up = warm_up;
    }
  }
  chunks.back().count = channel.sample_count - chunks.back().start;
  return chunks;
}

/// How far two states of the same filter lie apart: the ripple at any angle, at the first one's
/// load and speed, and the coefficient that differs most.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline StateDifference difference_of(const RippleFilterConfig<Real, MaxPairs>& config,
                                                   const RippleFilterState<Real, MaxPairs>& a,
                                                   const RippleFilterState<Real, MaxPairs>& b) {
  const auto apart_Nm = [&](std::size_t i) {
    return static_cast<double>(a.states_Nm[1 + i]) - static_cast<double>(b.states_Nm[1 + i]);
  };
  const RippleFactors<Real> factors = factors_now(config, a);
  StateDifference difference;
  each_order(config, [&](std::size_t order, std::size_t first) {
    const OrderTerms<Real> terms = terms_of(config.orders[order], factors);
    double cosine_Nm = apart_Nm(first);
    double sine_Nm = apart_Nm(first + 1);
    for (std::size_t t = 0; t < further_pairs_of(config.orders[order]); ++t) {
      cosine_Nm += static_cast<double>(terms.factors[t]) * apart_Nm(first + 2 * t + 2);
      sine_Nm += static_cast<double>(terms.factors[t]) * apart_Nm(first + 2 * t + 3);
    }
    difference.ripple_Nm += square_root(cosine_Nm * cosine_Nm + sine_Nm * sine_Nm);
  });
  for (std::size_t i = 0; i < 2 * pair_count(config); ++i) {
    difference.state_Nm = std::max(difference.state_Nm, absolute(apart_Nm(i)));
  }
  return difference;
}

/// A block of chunks: warmed up without a result, then filtered.
template <class Real, std::size_t MaxPairs>
inline void filter_chunks(const RippleFilterConfig<Real, MaxPairs>& config,
                          const RippleChannel<Real>& channel, VectorLevel level,
                          RippleChunk<Real, MaxPairs>* chunks, std::size_t count) {
  const RippleKind kind = kind_of(config);
  RippleBlock<Real, MaxPairs> block;
  for (std::size_t lane = 0; lane < count; ++lane) {
    RippleChunk<Real, MaxPairs>& chunk = chunks[lane];
    block.configs[lane] = &config;
    block.states[lane] = &chunk.began;
    RippleChannel<Real>& before = block.channels[lane];
    before = part_of(channel, chunk.start - chunk.warm_up, chunk.warm_up);
    before.status = nullptr;
    std::fill(std::begin(before.outputs), std::end(before.outputs), nullptr);
  }
  filter_block(kind, level, block);
  for (std::size_t lane = 0; lane < count; ++lane) {
    RippleChunk<Real, MaxPairs>& chunk = chunks[lane];
    chunk.began.counters = {};
    chunk.ended = chunk.began;
    block.states[lane] = &chunk.ended;
    block.channels[lane] = part_of(channel, chunk.start, chunk.count);
  }
  filter_block(kind, level, block);
}

/// Holds each chunk's beginning against the end of the one before, and filters it again where they
/// differ too much.
template <class Real, std::size_t MaxPairs>
inline LongReport join_chunks(const RippleFilterConfig<Real, MaxPairs>& config,
                              const RippleChannel<Real>& channel, const LongOptions& options,
                              std::vector<RippleChunk<Real, MaxPairs>>& chunks) {
  LongReport report;
  report.chunk_count = chunks.size();
  double squares_Nm2 = 0.0;
  for (std::size_t i = 1; i < chunks.size(); ++i) {
    RippleChunk<Real, MaxPairs>& chunk = chunks[i];
    report.warm_up_samples += chunk.warm_up;
    const StateDifference apart = difference_of(config, chunk.began, chunks[i - 1].ended);
    // In this way round, so that what is no number is no agreement.
    const bool agrees =
        apart.ripple_Nm <= options.tolerance_Nm && apart.state_Nm <= options.state_tolerance_Nm;
    if (!agrees) {
      ++report.repeated_chunks;
      chunk.ended = chunks[i - 1].ended;
      chunk.ended.counters = {};
      filter_one(config, chunk.ended, part_of(channel, chunk.start, chunk.count));
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

/// How many chunks a log is cut into; 1 where it is filtered in sequence.  Lanes take their chunks
/// side by side, so that warm-ups may be longer than chunks as long as both together are short
/// beside the log.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline std::size_t chunk_count_for(const RippleFilterConfig<Real, MaxPairs>& config,
                                                 const RippleChannel<Real>& channel,
                                                 const LongOptions& options) {
  if (options.in_sequence || options.batch.level == VectorLevel::one_by_one ||
      kind_of(config).pairs == 0) {
    return 1;
  }
  const std::size_t threads = std::max<std::size_t>(options.batch.thread_count, 1);
  const std::size_t warm_up =
      std::max(warm_up_before(config, channel, channel.sample_count / 2, options.warm_up_memories),
               warm_up_before(config, channel, channel.sample_count, options.warm_up_memories));
  const std::size_t least = 2 * tile_samples;
  const std::size_t lanes = block_width<Real> * threads;
  const std::size_t most = channel.sample_count / std::max(2 * warm_up, least);
  if (most >= lanes) {
    return std::min(lanes * blocks_per_thread, most);
  }
  const std::size_t length = std::max(channel.sample_count / lanes, least);
  return length + warm_up <= channel.sample_count / 2 ? channel.sample_count / length : 1;
}

}  // namespace detail

/// Filters one long log.  The state goes on as after step() with the last sample.
template <class Real, std::size_t MaxPairs>
LongReport process_long(const RippleFilterConfig<Real, MaxPairs>& config,
                        RippleFilterState<Real, MaxPairs>& state,
                        const RippleChannel<Real>& channel, const LongOptions& options = {}) {
  const std::size_t count = detail::chunk_count_for(config, channel, options);
  std::vector<detail::RippleChunk<Real, MaxPairs>> chunks;
  if (count > 1) {
    chunks = detail::ripple_chunks(config, channel, count, options.warm_up_memories);
  }
  if (chunks.size() < 2) {
    detail::filter_one(config, state, channel);
    return {};
  }
  for (auto& chunk : chunks) {
    // A warm-up that begins with the log begins with its state.
    chunk.began = chunk.warm_up == chunk.start ? state : initial_state(config);
  }
  constexpr std::size_t width = block_width<Real>;
  const std::size_t blocks = (chunks.size() + width - 1) / width;
  detail::for_each_part(blocks, options.batch.thread_count, [&](std::size_t block) {
    const std::size_t first = block * width;
    detail::filter_chunks(config, channel, options.batch.level, chunks.data() + first,
                          std::min(width, chunks.size() - first));
  });
  const LongReport report = detail::join_chunks(config, channel, options, chunks);
  EventCounters counters = state.counters;
  for (const auto& chunk : chunks) {
    detail::add_counts(counters, chunk.ended.counters);
  }
  state = chunks.back().ended;
  state.counters = counters;
  return report;
}

}  // namespace strainwave
