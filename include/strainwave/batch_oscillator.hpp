// SPDX-License-Identifier: Apache-2.0
/// @file batch_oscillator.hpp
/// A block of published filters through a recording: tiles in, kernel of the vector level, tiles
/// out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "strainwave/batch_layout.hpp"
#include "strainwave/batch_oscillator_lanes.hpp"
#include "strainwave/lanes.hpp"
#include "strainwave/oscillator_filter.hpp"

#if STRAINWAVE_HAS_LANES
#define STRAINWAVE_LEVEL_FILE "strainwave/batch_oscillator_group.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#define STRAINWAVE_LEVEL_FILE "strainwave/batch_oscillator_kernel.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE
#endif

namespace strainwave {

/// One channel's recording: an array for each signal, and where the results go.
template <class Real>
struct OscillatorChannel {
  std::size_t sample_count = 0;
  const Real* measured_torque_Nm = nullptr;
  const Real* motor_speed_rad_s = nullptr;   ///< needed with RotationSource::speed
  const double* motor_angle_rad = nullptr;   ///< needed with RotationSource::angle
  const Real* expected_torque_Nm = nullptr;  ///< null: 0 throughout
  Real* torque_Nm = nullptr;                 ///< measured minus predicted ripple; null: not wanted
  Real* ripple_Nm = nullptr;                 ///< null: not wanted
  Status* status = nullptr;                  ///< null: not wanted; the counters have the sums
};

namespace detail {

template <class Real, std::size_t Orders>
using TileKernel = void (*)(OscillatorLanes<Real, Orders>&, const OscillatorTile<Real>&);

/// The kernel of a level; null where there is none.
template <class Real, std::size_t Orders, bool SecondIsDouble>
[[nodiscard]] inline TileKernel<Real, Orders> tile_kernel(VectorLevel level) {
  switch (level) {
#if STRAINWAVE_HAS_X86_LEVELS
    case VectorLevel::x86_64_v2:
      return level_v2::filter_tile<Real, Orders, SecondIsDouble>;
    case VectorLevel::x86_64_v3:
      return level_v3::filter_tile<Real, Orders, SecondIsDouble>;
    case VectorLevel::x86_64_v4:
      return level_v4::filter_tile<Real, Orders, SecondIsDouble>;
#elif STRAINWAVE_HAS_LANES
    case VectorLevel::portable:
      return level_portable::filter_tile<Real, Orders, SecondIsDouble>;
#endif
    default:
      return nullptr;
  }
}

/// Most orders of a filter that runs on lanes.
inline constexpr std::size_t most_lane_orders = 5;

/// What kernel a filter needs.
struct OscillatorKind {
  std::size_t orders = 0;  ///< capacity of the kernel; 0: none, one by one
  bool second_is_double = false;

  [[nodiscard]] constexpr bool has_kernel() const { return orders != 0; }
  [[nodiscard]] constexpr auto operator<=>(const OscillatorKind&) const = default;
};

template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr OscillatorKind kind_of(
    const OscillatorFilterConfig<Real, MaxOrders>& config) {
  const std::size_t orders = active_orders(config);
  if (config.rotation_source != RotationSource::speed || orders > most_lane_orders) {
    return {};
  }
  if (orders > 3) {
    return {most_lane_orders, false};
  }
  // What the kernel makes of an order that a lane does not have is not used.
  const bool second_is_double = orders < 2 || half_of(config, 1) == 0;
  return {orders > 2 || !second_is_double ? std::size_t{3} : std::size_t{2}, second_is_double};
}

/// Calls with the kernel of a kind and level.
template <class Real, class Call>
inline void with_kernel(OscillatorKind kind, VectorLevel level, const Call& call) {
  if (kind.orders == 2) {
    call(tile_kernel<Real, 2, true>(level));
  } else if (kind.orders == 3) {
    call(kind.second_is_double ? tile_kernel<Real, 3, true>(level)
                               : tile_kernel<Real, 3, false>(level));
  } else {
    call(tile_kernel<Real, most_lane_orders, false>(level));
  }
}

/// The channels of one block; a lane without a channel has null pointers.
template <class Real, std::size_t MaxOrders>
struct OscillatorBlock {
  static constexpr std::size_t width = block_width<Real>;

  const OscillatorFilterConfig<Real, MaxOrders>* configs[width] = {};
  OscillatorFilterState<Real, MaxOrders>* states[width] = {};
  OscillatorChannel<Real> channels[width] = {};
};

/// One channel through step(): what has no kernel, and what must be exactly so.
template <class Real, std::size_t MaxOrders>
inline void filter_one(const OscillatorFilterConfig<Real, MaxOrders>& config,
                       OscillatorFilterState<Real, MaxOrders>& state,
                       const OscillatorChannel<Real>& channel) {
  const bool by_angle = config.rotation_source == RotationSource::angle;
  OscillatorSample<Real> sample;
  for (std::size_t k = 0; k < channel.sample_count; ++k) {
    sample.measured_torque_Nm = channel.measured_torque_Nm[k];
    if (!by_angle) {
      sample.motor_speed_rad_s = channel.motor_speed_rad_s[k];
    } else if (sample.phase_valid = is_representable_angle(channel.motor_angle_rad[k]);
               sample.phase_valid) {
      sample.motor_phase = phase_from_radians(channel.motor_angle_rad[k]);
    }
    sample.expected_torque_Nm =
        channel.expected_torque_Nm == nullptr ? Real(0) : channel.expected_torque_Nm[k];
    const OscillatorReading<Real> reading = step(config, state, sample);
    if (channel.torque_Nm != nullptr) {
      channel.torque_Nm[k] = reading.torque_Nm;
    }
    if (channel.ripple_Nm != nullptr) {
      channel.ripple_Nm[k] = reading.ripple_Nm;
    }
    if (channel.status != nullptr) {
      channel.status[k] = reading.status;
    }
  }
}

/// A block on its way through its channels' recordings.
template <class Real, std::size_t Orders, std::size_t MaxOrders>
class OscillatorBlockRun {
 public:
  static constexpr std::size_t width = block_width<Real>;

  OscillatorBlockRun(const OscillatorBlock<Real, MaxOrders>& block, VectorLevel level,
                     TileKernel<Real, Orders> kernel)
      : block_(&block), kernel_(kernel), level_(level) {
    std::size_t known = 0;
    while (block.configs[known] == nullptr) {
      ++known;
    }
    for (std::size_t lane = 0; lane < width; ++lane) {
      // A lane without a channel goes along with another one; nobody reads it.
      const std::size_t like = block.configs[lane] == nullptr ? known : lane;
      put_config(lanes_, lane, *block.configs[like]);
      put_state(lanes_, lane, *block.configs[like], *block.states[like]);
      const OscillatorChannel<Real>& channel = block.channels[lane];
      has_expected_ = has_expected_ || channel.expected_torque_Nm != nullptr;
      has_torque_ = has_torque_ || channel.torque_Nm != nullptr;
      has_ripple_ = has_ripple_ || channel.ripple_Nm != nullptr;
      has_status_ = has_status_ || channel.status != nullptr;
      rows_.torque[lane] = channel.torque_Nm;
      rows_.ripple[lane] = channel.ripple_Nm;
    }
  }

  /// From the first sample to the last one of the longest channel.
  void run() {
    for (std::size_t at = 0; begin_stretch(at); at += stretch_) {
      for (std::size_t done = 0; done < stretch_; done += tile_.sample_count) {
        gather_tile(at + done, stretch_ - done);
        kernel_(lanes_, tile_);
        scatter_tile(at + done, tile_.sample_count);
      }
      end_stretch(at, at + stretch_);
    }
  }

 private:
  [[nodiscard]] bool is_live(std::size_t lane, std::size_t at) const {
    return block_->configs[lane] != nullptr && block_->channels[lane].sample_count > at;
  }

  /// Samples up to where the next channel ends; false where all have ended.  Channels that have
  /// ended read another one's samples and write none.
  [[nodiscard]] bool begin_stretch(std::size_t at) {
    std::size_t live = width;
    stretch_ = counted_samples;
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (is_live(lane, at)) {
        const std::size_t left = block_->channels[lane].sample_count - at;
        stretch_ = left < stretch_ ? left : stretch_;
        live = lane;
      }
    }
    for (std::size_t lane = 0; lane < width && live < width; ++lane) {
      take_rows(lane, is_live(lane, at), block_->channels[is_live(lane, at) ? lane : live]);
    }
    return live < width;
  }

  void take_rows(std::size_t lane, bool own, const OscillatorChannel<Real>& from) {
    rows_.measured[lane] = from.measured_torque_Nm;
    rows_.speed[lane] = from.motor_speed_rad_s;
    rows_.expected[lane] = from.expected_torque_Nm;
    rows_.torque[lane] = own ? rows_.torque[lane] : nullptr;
    rows_.ripple[lane] = own ? rows_.ripple[lane] : nullptr;
    const Real* const result =
        rows_.torque[lane] != nullptr ? rows_.torque[lane] : rows_.ripple[lane];
    ahead_[0].rows[lane] = from.measured_torque_Nm;
    ahead_[1].rows[lane] = from.motor_speed_rad_s;
    ahead_[2].rows[lane] = result != nullptr ? result : from.motor_speed_rad_s;
  }

  /// A tile of up to `left` samples.  The tile after the next one is asked for while this one is
  /// computed: memory is that far away.
  void gather_tile(std::size_t at, std::size_t left) {
    const std::size_t count = left < tile_samples ? left : tile_samples;
    gather(rows_.measured, at, count, measured_.values, level_);
    gather(rows_.speed, at, count, speed_.values, level_);
    if (has_expected_) {
      gather_expected(at, count);
    }
    tile_ = {.measured_torque_Nm = measured_.values,
             .motor_speed_rad_s = speed_.values,
             .expected_torque_Nm = has_expected_ ? expected_.values : zero_row<Real>,
             .expected_stride = has_expected_ ? width : 0,
             .torque_Nm = has_torque_ || !has_ripple_ ? torque_.values : nullptr,
             .ripple_Nm = has_ripple_ ? ripple_.values : nullptr,
             .status = has_status_ ? status_.values : nullptr,
             .sample_count = count,
             .ahead = left >= 3 * tile_samples ? ahead_ : nullptr,
             .ahead_at = at + 2 * tile_samples};
  }

  /// Some channels of a block may have an expected torque and others none.
  void gather_expected(std::size_t at, std::size_t count) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      const Real* const from = rows_.expected[lane];
      for (std::size_t k = 0; k < count; ++k) {
        expected_.values[k * width + lane] = from == nullptr ? Real(0) : from[at + k];
      }
    }
  }

  void scatter_tile(std::size_t at, std::size_t count) {
    if (has_torque_) {
      scatter(torque_.values, count, rows_.torque, at, level_);
    }
    if (has_ripple_) {
      scatter(ripple_.values, count, rows_.ripple, at, level_);
    }
    for (std::size_t lane = 0; lane < width && has_status_; ++lane) {
      if (is_live(lane, at) && block_->channels[lane].status != nullptr) {
        for (std::size_t k = 0; k < count; ++k) {
          block_->channels[lane].status[at + k] =
              static_cast<Status>(status_.values[k * width + lane]);
        }
      }
    }
  }

  /// Counts of a stretch, and the states of channels that end with it.
  void end_stretch(std::size_t from, std::size_t to) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (!is_live(lane, from)) {
        continue;
      }
      take_counts(lanes_, lane, to - from, block_->states[lane]->counters);
      if (!is_live(lane, to)) {
        take_state(lanes_, lane, *block_->configs[lane], *block_->states[lane]);
      }
    }
    clear_counts(lanes_);
  }

  struct Rows {
    const Real* measured[width];
    const Real* speed[width];
    const Real* expected[width];
    Real* torque[width];
    Real* ripple[width];
  };

  OscillatorLanes<Real, Orders> lanes_ = {};
  Tile<Real> measured_;
  Tile<Real> speed_;
  Tile<Real> expected_;
  Tile<Real> torque_;
  Tile<Real> ripple_;
  Tile<Real> status_;
  const OscillatorBlock<Real, MaxOrders>* block_;
  TileKernel<Real, Orders> kernel_;
  std::size_t stretch_ = 0;  ///< samples in which no channel ends
  OscillatorTile<Real> tile_ = {};
  Ahead<Real> ahead_[3];
  Rows rows_ = {};
  VectorLevel level_;
  bool has_expected_ = false;
  bool has_torque_ = false;
  bool has_ripple_ = false;
  bool has_status_ = false;
};

/// A block through its channels' recordings, at a vector level; one by one where there is no
/// kernel.
template <class Real, std::size_t MaxOrders>
inline void filter_block(OscillatorKind kind, VectorLevel level,
                         const OscillatorBlock<Real, MaxOrders>& block) {
  bool is_done = false;
  if (kind.orders != 0 && is_available(level)) {
    with_kernel<Real>(kind, level, [&]<std::size_t Orders>(TileKernel<Real, Orders> kernel) {
      if (kernel != nullptr) {
        // 30 KB: not every thread's stack has room for it.
        std::make_unique<OscillatorBlockRun<Real, Orders, MaxOrders>>(block, level, kernel)->run();
        is_done = true;
      }
    });
  }
  for (std::size_t lane = 0; lane < block_width<Real> && !is_done; ++lane) {
    if (block.configs[lane] != nullptr) {
      filter_one(*block.configs[lane], *block.states[lane], block.channels[lane]);
    }
  }
}

}  // namespace detail

}  // namespace strainwave
