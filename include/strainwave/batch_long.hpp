// SPDX-License-Identifier: Apache-2.0
/// @file batch_long.hpp
/// One long log through the published filter, on lanes and threads: where its chunks begin, and how
/// early.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "strainwave/batch.hpp"
#include "strainwave/batch_time_chunks.hpp"

namespace strainwave {

namespace detail {

/// How long the filter remembers: samples that it learns from, and travelled angle.
struct OscillatorMemory {
  double samples = 0.0;
  double travel_rad = 0.0;
};

/// A state of variance q a sample, seen half of the time with noise R, is forgotten at the rate
/// sqrt(q / 2 R) a sample (the steady state of its Riccati equation).  Orders are told apart, from
/// each other and from a constant, within a radian of their difference.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline OscillatorMemory memory_of(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  OscillatorMemory memory;
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const auto noise_Nm2 = static_cast<double>(config.process_noise_variance_Nm2[a]);
    const auto measured_Nm2 = static_cast<double>(config.measurement_noise_variance_Nm2);
    memory.samples =
        std::max(memory.samples, noise_Nm2 > 0.0 ? square_root(2.0 * measured_Nm2 / noise_Nm2)
                                                 : std::numeric_limits<double>::infinity());
    const auto order = to_real<double>(config.orders[a]);
    memory.travel_rad = std::max(memory.travel_rad, 1.0 / order);
    for (std::size_t b = 0; b < a; ++b) {
      const double difference = absolute(order - to_real<double>(config.orders[b]));
      memory.travel_rad = std::max(memory.travel_rad, 1.0 / difference);
    }
  }
  memory.samples = std::max(memory.samples, 1.0);
  return memory;
}

/// Samples before `start` from which a filter has learned enough; `start` where the log begins
/// before that.  Standstill and unusable samples teach nothing and are passed over.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline std::size_t warm_up_before(
    const OscillatorFilterConfig<Real, MaxOrders>& config, const OscillatorChannel<Real>& channel,
    std::size_t start, double memories) {
  const OscillatorMemory memory = memory_of(config);
  double samples = 0.0;
  double travel_rad = 0.0;
  std::size_t k = start;
  while (k > 0 &&
         (samples < memories * memory.samples || travel_rad < memories * memory.travel_rad)) {
    --k;
    const Real speed_rad_s = absolute(channel.motor_speed_rad_s[k]);
    if (speed_rad_s <= std::numeric_limits<Real>::max() &&
        speed_rad_s >= config.minimum_speed_rad_s &&
        is_usable_torque(channel.measured_torque_Nm[k])) {
      samples += 1.0;
      travel_rad += static_cast<double>(speed_rad_s * config.sample_period_s);
    }
  }
  return start - k;
}

/// The part [start, start + count) of a channel.
template <class Real>
[[nodiscard]] inline OscillatorChannel<Real> part_of(const OscillatorChannel<Real>& channel,
                                                     std::size_t start, std::size_t count) {
  const auto from = [start](auto* array) { return array == nullptr ? nullptr : array + start; };
  return {.sample_count = count,
          .measured_torque_Nm = from(channel.measured_torque_Nm),
          .motor_speed_rad_s = from(channel.motor_speed_rad_s),
          .motor_angle_rad = from(channel.motor_angle_rad),
          .expected_torque_Nm = from(channel.expected_torque_Nm),
          .torque_Nm = from(channel.torque_Nm),
          .ripple_Nm = from(channel.ripple_Nm),
          .status = from(channel.status)};
}

/// Chunks of about equal length, the same wherever the arrays lie: what comes out shall not depend
/// on an address.  Where a warm-up would take longer than a chunk there is no boundary: nothing
/// would be won.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline std::vector<TimeChunk<OscillatorFilterState<Real, MaxOrders>>> chunks_of(
    const OscillatorFilterConfig<Real, MaxOrders>& config, const OscillatorChannel<Real>& channel,
    std::size_t count, const LongOptions& options) {
  // Whole lines of the cache, and an odd number of them, so that chunks do not meet in one set.
  const std::size_t line = block_width<Real>;
  const std::size_t length = ((channel.sample_count / (count * line) + 1U) | 1U) * line;
  std::vector<std::size_t> warm_ups((channel.sample_count - 1) / length);
  for_each_part(warm_ups.size(), options.batch.thread_count, [&](std::size_t i) {
    warm_ups[i] = warm_up_before(config, channel, (i + 1) * length, options.warm_up_memories);
  });
  std::vector<TimeChunk<OscillatorFilterState<Real, MaxOrders>>> chunks(1);
  for (std::size_t i = 0; i < warm_ups.size(); ++i) {
    if (warm_ups[i] <= length) {
      const std::size_t start = (i + 1) * length;
      chunks.back().count = start - chunks.back().start;
      chunks.emplace_back();
      chunks.back().start = start;
      chunks.back().warm_up = warm_ups[i];
    }
  }
  chunks.back().count = channel.sample_count - chunks.back().start;
  return chunks;
}

/// How far two states of the same filter lie apart, in the paper's frame.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline StateDifference difference_of(
    const OscillatorFilterConfig<Real, MaxOrders>& config,
    const OscillatorFilterState<Real, MaxOrders>& a,
    const OscillatorFilterState<Real, MaxOrders>& b) {
  const auto first = predicted(config, a);
  const auto second = predicted(config, b);
  StateDifference difference;
  for (std::size_t i = 0; i < 2 * active_orders(config); ++i) {
    const auto apart_Nm =
        static_cast<double>(first.states_Nm[i]) - static_cast<double>(second.states_Nm[i]);
    difference.ripple_Nm += i % 2 == 0 ? apart_Nm : 0.0;
    difference.state_Nm = std::max(difference.state_Nm, absolute(apart_Nm));
  }
  difference.ripple_Nm = absolute(difference.ripple_Nm);
  return difference;
}

/// The shortest of the warm-ups in a log's quarters: a long one is a standstill's.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline std::size_t typical_warm_up(
    const OscillatorFilterConfig<Real, MaxOrders>& config, const OscillatorChannel<Real>& channel,
    double memories) {
  std::size_t typical = channel.sample_count;
  for (std::size_t quarter = 1; quarter < 4; ++quarter) {
    const std::size_t start = channel.sample_count / 4 * quarter;
    typical = std::min(typical, warm_up_before(config, channel, start, memories));
  }
  return std::max<std::size_t>(typical, 1);
}

/// Fewer chunks than these leave most lanes empty, and are no faster than a sequence.
inline constexpr std::size_t fewest_chunks = 4;

/// How many chunks a log is cut into, each of two warm-ups at least; 1 where it is filtered in
/// sequence.  All lanes of all threads are filled first; more blocks cost more warm-ups.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline std::size_t chunk_count_for(
    const OscillatorFilterConfig<Real, MaxOrders>& config, const OscillatorChannel<Real>& channel,
    const LongOptions& options) {
  if (options.in_sequence || options.batch.level == VectorLevel::one_by_one ||
      kind_of(config).orders == 0) {
    return 1;
  }
  const std::size_t at_once =
      block_width<Real> * std::max<std::size_t>(options.batch.thread_count, 1);
  const std::size_t warm_up = typical_warm_up(config, channel, options.warm_up_memories);
  const std::size_t most = channel.sample_count / std::max(2 * warm_up, 2 * tile_samples);
  const bool is_long = channel.sample_count / (blocks_per_thread * at_once) >= 16 * warm_up;
  const std::size_t count = std::min(is_long ? blocks_per_thread * at_once : at_once, most);
  return count < fewest_chunks ? 1 : count;
}

/// What filter_in_chunks() asks of a filter.
template <class Real, std::size_t MaxOrders>
struct OscillatorLog {
  using Config = OscillatorFilterConfig<Real, MaxOrders>;
  using State = OscillatorFilterState<Real, MaxOrders>;
  using Channel = OscillatorChannel<Real>;
  using Block = OscillatorBlock<Real, MaxOrders>;

  static Channel part_of(const Channel& channel, std::size_t start, std::size_t count) {
    return detail::part_of(channel, start, count);
  }
  static void clear_results(Channel& channel) {
    channel.torque_Nm = nullptr;
    channel.ripple_Nm = nullptr;
    channel.status = nullptr;
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
template <class Real, std::size_t MaxOrders>
LongReport process_long(const OscillatorFilterConfig<Real, MaxOrders>& config,
                        OscillatorFilterState<Real, MaxOrders>& state,
                        const OscillatorChannel<Real>& channel, const LongOptions& options = {}) {
  const std::size_t count = detail::chunk_count_for(config, channel, options);
  std::vector<detail::TimeChunk<OscillatorFilterState<Real, MaxOrders>>> chunks;
  if (count > 1) {
    chunks = detail::chunks_of(config, channel, count, options);
  }
  return detail::filter_in_chunks<detail::OscillatorLog<Real, MaxOrders>>(config, state, channel,
                                                                          options, chunks);
}

}  // namespace strainwave
