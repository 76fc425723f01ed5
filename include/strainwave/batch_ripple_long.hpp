// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_long.hpp
/// One long log through the ripple filter, on lanes and threads: where its chunks begin, and how
/// early.  The filter forgets by travelled angle.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "strainwave/batch_ripple.hpp"
#include "strainwave/batch_time_chunks.hpp"

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

/// Chunks of about equal length.  Where a warm-up and its chunk would be longer than half of the
/// log there is no boundary: nothing would be won.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] inline std::vector<TimeChunk<RippleFilterState<Real, MaxPairs>>> ripple_chunks(
    const RippleFilterConfig<Real, MaxPairs>& config, const RippleChannel<Real>& channel,
    std::size_t count, double memories) {
  std::vector<TimeChunk<RippleFilterState<Real, MaxPairs>>> chunks(1);
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

/// What filter_in_chunks() asks of a filter.
template <class Real, std::size_t MaxPairs>
struct RippleLog {
  using Config = RippleFilterConfig<Real, MaxPairs>;
  using State = RippleFilterState<Real, MaxPairs>;
  using Channel = RippleChannel<Real>;
  using Block = RippleBlock<Real, MaxPairs>;

  static Channel part_of(const Channel& channel, std::size_t start, std::size_t count) {
    return detail::part_of(channel, start, count);
  }
  static void clear_results(Channel& channel) {
    channel.status = nullptr;
    for (Real*& output : channel.outputs) {
      output = nullptr;
    }
  }
  static void filter_block(VectorLevel level, const Block& block) {
    detail::filter_block(kind_of(*block.configs[0]), level, block);
  }
  static void filter_one(const Config& config, State& state, const Channel& channel) {
    detail::filter_one(config, state, channel);
  }
  static StateDifference difference_of(const Config& config, const State& a, const State& b) {
    return detail::difference_of(config, a, b);
  }
};

}  // namespace detail

/// Filters one long log.  The state goes on as after step() with the last sample.
template <class Real, std::size_t MaxPairs>
LongReport process_long(const RippleFilterConfig<Real, MaxPairs>& config,
                        RippleFilterState<Real, MaxPairs>& state,
                        const RippleChannel<Real>& channel, const LongOptions& options = {}) {
  const std::size_t count = detail::chunk_count_for(config, channel, options);
  std::vector<detail::TimeChunk<RippleFilterState<Real, MaxPairs>>> chunks;
  if (count > 1) {
    chunks = detail::ripple_chunks(config, channel, count, options.warm_up_memories);
  }
  return detail::filter_in_chunks<detail::RippleLog<Real, MaxPairs>>(config, state, channel,
                                                                     options, chunks);
}

}  // namespace strainwave
