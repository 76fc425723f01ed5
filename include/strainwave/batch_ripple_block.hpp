// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_block.hpp
/// A block of ripple filters on its way through its channels' recordings.
///
/// Tile by tile: signals are put side by side, lanes filter them, results go back to their
/// channels.  What lanes cannot do, step() does for one of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "strainwave/batch_layout.hpp"
#include "strainwave/batch_ripple_angles.hpp"
#include "strainwave/batch_ripple_channel.hpp"
#include "strainwave/batch_ripple_lanes.hpp"
#include "strainwave/lanes.hpp"
#include "strainwave/ripple_filter.hpp"

#if STRAINWAVE_HAS_LANES
#define STRAINWAVE_LEVEL_FILE "strainwave/batch_ripple_angle_kernel.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#define STRAINWAVE_LEVEL_FILE "strainwave/batch_ripple_frame_kernel.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#define STRAINWAVE_LEVEL_FILE "strainwave/batch_ripple_kernel.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#endif

namespace strainwave::detail {

/// Functions of a level.
template <class Real, std::size_t Pairs>
struct RippleKernel {
  void (*filter_tile)(RippleLanes<Real, Pairs>&, const RippleTile<Real>&,
                      const RippleAlone&) = nullptr;
  ConvertAngles<Real> convert_angles = nullptr;
};

template <class Real, std::size_t Pairs>
[[nodiscard]] inline RippleKernel<Real, Pairs> ripple_kernel(VectorLevel level) {
  switch (level) {
#if STRAINWAVE_HAS_X86_LEVELS
    case VectorLevel::x86_64_v2:
      return {level_v2::filter_ripple_tile<Real, Pairs>, level_v2::convert_angles<Real>};
    case VectorLevel::x86_64_v3:
      return {level_v3::filter_ripple_tile<Real, Pairs>, level_v3::convert_angles<Real>};
    case VectorLevel::x86_64_v4:
      return {level_v4::filter_ripple_tile<Real, Pairs>, level_v4::convert_angles<Real>};
#elif STRAINWAVE_HAS_LANES
    case VectorLevel::portable:
      return {level_portable::filter_ripple_tile<Real, Pairs>,
              level_portable::convert_angles<Real>};
#endif
    default:
      return {};
  }
}
/// The channels of one block; a lane without a channel has null pointers.
template <class Real, std::size_t MaxPairs>
struct RippleBlock {
  static constexpr std::size_t width = block_width<Real>;

  const RippleFilterConfig<Real, MaxPairs>* configs[width] = {};
  RippleFilterState<Real, MaxPairs>* states[width] = {};
  RippleChannel<Real> channels[width] = {};
};
/// A block on its way through its channels' recordings.
template <class Real, std::size_t Pairs, std::size_t MaxPairs>
class RippleBlockRun {
 public:
  static constexpr std::size_t width = block_width<Real>;
  using Lanes = RippleLanes<Real, Pairs>;
  using Block = RippleBlock<Real, MaxPairs>;

  RippleBlockRun(const Block& block, const RippleKind& kind,
                 const RippleKernel<Real, Pairs>& kernel)
      : block_(block), kernel_(kernel) {
    put_layout(lanes_, kind.orders, kind.order_count);
    angles_.put_orders(block, kind.order_count);
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (block.configs[lane] == nullptr) {
        continue;
      }
      put_config(lanes_, lane, *block.configs[lane]);
      put_state(lanes_, lane, *block.configs[lane], *block.states[lane]);
      const RippleChannel<Real>& channel = block.channels[lane];
      has_expected_ = has_expected_ || channel.expected_torque_Nm != nullptr;
      has_interval_ = has_interval_ || channel.interval_s != nullptr;
      has_status_ = has_status_ || channel.status != nullptr;
      for (std::size_t i = 0; i < ripple_outputs; ++i) {
        has_output_[i] = has_output_[i] || channel.outputs[i] != nullptr;
      }
      periods_s_[lane] = channel.sample_period_s;
    }
  }

  /// From the first sample to the last one of the longest channel.
  void run() {
    const RippleAlone alone = {this, &RippleBlockRun::leave, &RippleBlockRun::come_back,
                               &RippleBlockRun::find_angles};
    at_ = 0;
    for (std::size_t count = next_count(); count > 0; count = next_count()) {
      gather_tile(count);
      kernel_.filter_tile(lanes_, tile_, alone);
      scatter_tile(count);
      at_ += count;
      take_ended(count);
    }
  }

 private:
  [[nodiscard]] bool is_live(std::size_t lane, std::size_t at) const {
    return block_.configs[lane] != nullptr && block_.channels[lane].sample_count > at;
  }

  /// Samples up to where the next channel ends, a tile at most; 0 where all have ended.  Channels
  /// that have ended read another one's samples, and nobody reads what comes of it.
  [[nodiscard]] std::size_t next_count() {
    std::size_t live = width;
    std::size_t left = tile_samples;
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (is_live(lane, at_)) {
        left = std::min(left, block_.channels[lane].sample_count - at_);
        live = lane;
      }
    }
    for (std::size_t lane = 0; lane < width && live < width; ++lane) {
      from_[lane] = is_live(lane, at_) ? lane : live;
      lanes_.live[lane] = from_[lane] == lane ? Real(1) : Real(0);
    }
    return live < width ? left : 0;
  }

  void gather_tile(std::size_t count) {
    const Real* torques[width];
    for (std::size_t lane = 0; lane < width; ++lane) {
      torques[lane] = block_.channels[from_[lane]].measured_torque_Nm + at_;
    }
    gather(torques, 0, count, measured_.values);
    tile_ = {.measured_torque_Nm = measured_.values,
             .interval_s = periods_s_,
             .interval_stride = 0,
             .expected_torque_Nm = zero_row<Real>,
             .expected_stride = 0,
             .status = has_status_ ? status_.values : nullptr,
             .first_sample = at_,
             .sample_count = count};
    look_ahead();
    angles_.gather_into(tile_, kernel_.convert_angles, block_, from_, at_, count);
    gather_rest(count);
    for (std::size_t i = 0; i < ripple_outputs; ++i) {
      tile_.outputs[i] = has_output_[i] ? outputs_[i].values : nullptr;
    }
  }

  void look_ahead() {
    for (std::size_t lane = 0; lane < width; ++lane) {
      const RippleChannel<Real>& channel = block_.channels[from_[lane]];
      if (channel.sample_count < at_ + 3 * tile_samples) {
        return;
      }
      ahead_.torques_Nm[lane] = channel.measured_torque_Nm;
      ahead_.angles_rad[lane] = channel.motor_angle_rad;
      ahead_.results[lane] = channel.measured_torque_Nm;
      for (const Real* const output : channel.outputs) {
        ahead_.results[lane] = output != nullptr ? output : ahead_.results[lane];
      }
    }
    tile_.ahead = &ahead_;
  }

  /// Signals that some channels of a block may have and others not.
  void gather_rest(std::size_t count) {
    if (has_interval_) {
      for (std::size_t lane = 0; lane < width; ++lane) {
        const RippleChannel<Real>& channel = block_.channels[from_[lane]];
        for (std::size_t k = 0; k < count; ++k) {
          intervals_.values[k * width + lane] =
              channel.interval_s == nullptr ? channel.sample_period_s : channel.interval_s[at_ + k];
        }
      }
      tile_.interval_s = intervals_.values;
      tile_.interval_stride = width;
    }
    if (has_expected_) {
      for (std::size_t lane = 0; lane < width; ++lane) {
        const Real* const expected_Nm = block_.channels[from_[lane]].expected_torque_Nm;
        for (std::size_t k = 0; k < count; ++k) {
          expected_.values[k * width + lane] =
              expected_Nm == nullptr ? Real(0) : expected_Nm[at_ + k];
        }
      }
      tile_.expected_torque_Nm = expected_.values;
      tile_.expected_stride = width;
    }
  }

  void scatter_tile(std::size_t count) {
    for (std::size_t i = 0; i < ripple_outputs; ++i) {
      if (has_output_[i]) {
        Real* rows[width];
        for (std::size_t lane = 0; lane < width; ++lane) {
          Real* const row = block_.channels[lane].outputs[i];
          rows[lane] = is_live(lane, at_) && row != nullptr ? row + at_ : nullptr;
        }
        scatter(outputs_[i].values, count, rows, 0);
      }
    }
    for (std::size_t lane = 0; lane < width && has_status_; ++lane) {
      Status* const status = block_.channels[lane].status;
      for (std::size_t k = 0; k < count && is_live(lane, at_) && status != nullptr; ++k) {
        status[at_ + k] = static_cast<Status>(status_.values[k * width + lane]);
      }
    }
  }

  /// Counts of a tile of `count` samples, and the states of channels that end with it.
  void take_ended(std::size_t count) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (!is_live(lane, at_ - count)) {
        continue;
      }
      EventCounters& counters = block_.states[lane]->counters;
      count_up_by(counters.samples, count - alone_samples_[lane]);
      for (std::size_t flag = 0; flag < 3 && lanes_.any_count; ++flag) {
        count_up_by(counters.by_bit[lowest_bit(mask(ripple_lane_flags[flag]))],
                    static_cast<std::size_t>(lanes_.counts[flag][lane]));
      }
      alone_samples_[lane] = 0;
      if (!is_live(lane, at_)) {
        take_state(lanes_, lane, *block_.configs[lane], *block_.states[lane]);
        lanes_.in_step[lane] = Real(0);
      }
    }
    for (std::size_t flag = 0; flag < 3; ++flag) {
      std::fill(std::begin(lanes_.counts[flag]), std::end(lanes_.counts[flag]), Real(0));
    }
    lanes_.any_count = false;
  }

  // ---- lanes alone ------------------------------------------------------------------------------

  [[nodiscard]] bool is_alone(std::size_t lane) const {
    return lanes_.alone[lane] > Real(0) && is_live(lane, at_);
  }

  static void leave(void* block, std::size_t lane, std::size_t lanes, std::size_t sample) {
    auto& run = *static_cast<RippleBlockRun*>(block);
    for (std::size_t i = lane; i < lane + lanes; ++i) {
      if (run.is_alone(i)) {
        run.step_alone(i, sample);
      }
    }
  }

  void step_alone(std::size_t lane, std::size_t sample) {
    const RippleFilterConfig<Real, MaxPairs>& config = *block_.configs[lane];
    RippleFilterState<Real, MaxPairs>& state = *block_.states[lane];
    if (own_angle_sample_[lane] == at_ + sample + 1) {  // found by a lane that leaves after all
      state.history = history_before_[lane];
      state.learned_phase = learned_before_[lane];
    }
    take_state(lanes_, lane, config, state);
    readings_[lane] = step(config, state, block_.channels[lane].sample(at_ + sample));
    ++alone_samples_[lane];
  }

  static void come_back(void* block, std::size_t lane, std::size_t lanes, std::size_t sample) {
    auto& run = *static_cast<RippleBlockRun*>(block);
    for (std::size_t i = lane; i < lane + lanes; ++i) {
      if (run.is_alone(i)) {
        put_state(run.lanes_, i, *run.block_.configs[i], *run.block_.states[i]);
        run.put_in_tile(i, sample);
      }
    }
  }

  void put_in_tile(std::size_t lane, std::size_t sample) {
    const RippleReading<Real>& reading = readings_[lane];
    const Real values[ripple_outputs] = {
        reading.torque_Nm,       reading.ripple_Nm,     reading.torque_all_removed_Nm,
        reading.torque_state_Nm, reading.innovation_Nm, reading.innovation_variance_Nm2};
    const std::size_t place = sample * width + lane;
    for (std::size_t i = 0; i < ripple_outputs; ++i) {
      outputs_[i].values[place] = values[i];
    }
    status_.values[place] = static_cast<Real>(reading.status);
  }

  static void find_angles(void* block, std::size_t lane, std::size_t lanes, std::size_t sample) {
    auto& run = *static_cast<RippleBlockRun*>(block);
    for (std::size_t i = lane; i < lane + lanes; ++i) {
      run.lanes_.frozen_Nm[i] = Real(0);
      if (run.lanes_.alone[i] <= Real(0) && run.is_live(i, run.at_) &&
          has_own_angle(*run.block_.configs[i])) {
        run.find_angle(i, sample);
      }
    }
  }

  /// take_ripple_phase() and take_in(), as far as they are about the angle.
  void find_angle(std::size_t lane, std::size_t sample) {
    const RippleFilterConfig<Real, MaxPairs>& config = *block_.configs[lane];
    RippleFilterState<Real, MaxPairs>& state = *block_.states[lane];
    own_angle_sample_[lane] = at_ + sample + 1;
    history_before_[lane] = state.history;
    learned_before_[lane] = state.learned_phase;
    const RippleSample<Real> now = block_.channels[lane].sample(at_ + sample);
    if (config.angle_to_torque_delay_s > Real(0)) {
      remember(state.history, config.angle_to_torque_delay_s, now.interval_s,
               lanes_.rotation_rad[lane]);
    }
    state.speed_rad_s = lanes_.new_speed_rad_s[lane];
    state.time_since_phase_s = Real(0);
    const Real offset_rad = torque_offset_rad(config, state);
    const Phase phase =
        offset_rad == Real(0) ? now.motor_phase : now.motor_phase + phase_from_radians(offset_rad);
    lanes_.rotation_rad[lane] = to_radians<Real>(phase - state.learned_phase);
    state.learned_phase = phase;
    for (std::size_t a = 0; a < config.order_count; ++a) {
      lanes_.order_fraction[a][lane] =
          static_cast<std::int32_t>(order_fraction(phase, config.orders[a].order));
    }
    if (now.phase_referenced) {
      lanes_.frozen_Nm[lane] = frozen_torque_Nm(config, phase);
    }
  }

  Lanes lanes_ = {};
  alignas(64) Real periods_s_[width] = {};
  Tile<Real> measured_;
  Tile<Real> intervals_;
  Tile<Real> expected_;
  Tile<Real> outputs_[ripple_outputs];
  Tile<Real> status_;
  const Block& block_;  // NOLINT(cppcoreguidelines-avoid-const-or-ref-data-members)
  RippleKernel<Real, Pairs> kernel_;
  RippleTile<Real> tile_ = {};
  RippleAhead<Real> ahead_ = {};
  std::size_t at_ = 0;  ///< first sample of the tile
  std::size_t from_[width] = {};
  bool has_expected_ = false;
  bool has_interval_ = false;
  bool has_status_ = false;
  bool has_output_[ripple_outputs] = {};
  RippleAngles<Real, Pairs> angles_;

  RippleReading<Real> readings_[width] = {};
  std::size_t alone_samples_[width] = {};
  std::size_t own_angle_sample_[width] = {};
  AngleHistory<Real> history_before_[width] = {};
  Phase learned_before_[width] = {};
};

template <class Real, std::size_t Pairs, std::size_t MaxPairs>
inline void run_ripple_block(const RippleKind& kind, VectorLevel level,
                             const RippleBlock<Real, MaxPairs>& block) {
  using Run = RippleBlockRun<Real, Pairs, MaxPairs>;
  std::make_unique<Run>(block, kind, ripple_kernel<Real, Pairs>(level))->run();
}

/// A block through its channels' recordings, at a vector level; one by one where there is no
/// kernel.
template <class Real, std::size_t MaxPairs>
inline void filter_block(const RippleKind& kind, VectorLevel level,
                         const RippleBlock<Real, MaxPairs>& block) {
  const bool has_lanes = level != VectorLevel::one_by_one && is_available(level);
  const std::size_t pairs = has_lanes ? kind.pairs : 0;
  if (pairs == 3) {
    return run_ripple_block<Real, 3>(kind, level, block);
  }
  if constexpr (MaxPairs > 3) {
    if (pairs == 5) {
      return run_ripple_block<Real, 5>(kind, level, block);
    }
  }
  if constexpr (MaxPairs > 5) {
    if (pairs == 7) {
      return run_ripple_block<Real, 7>(kind, level, block);
    }
  }
  if constexpr (MaxPairs > 7) {
    if (pairs == 10) {
      return run_ripple_block<Real, 10>(kind, level, block);
    }
  }
  if constexpr (MaxPairs > 10) {
    if (pairs == most_lane_pairs) {
      return run_ripple_block<Real, most_lane_pairs>(kind, level, block);
    }
  }
  for (std::size_t lane = 0; lane < block.width; ++lane) {
    if (block.configs[lane] != nullptr) {
      filter_one(*block.configs[lane], *block.states[lane], block.channels[lane]);
    }
  }
}

}  // namespace strainwave::detail
