// SPDX-License-Identifier: Apache-2.0
/// @file batch_interleaved.hpp
/// Channels that already stand side by side in memory, [block][time][lane]: no transposition.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>

#include "strainwave/batch.hpp"

namespace strainwave {

/// Channels of one length; element (block, k, lane) of each array is at
/// (block * sample_count + k) * block_width + lane.  Lanes beyond the last channel hold anything.
template <class Real>
struct InterleavedRecording {
  std::size_t sample_count = 0;
  const Real* measured_torque_Nm = nullptr;
  const Real* motor_speed_rad_s = nullptr;
  const Real* expected_torque_Nm = nullptr;  ///< null: 0 throughout
  Real* torque_Nm = nullptr;
  Real* ripple_Nm = nullptr;  ///< null: not wanted
};

namespace detail {

/// The kind of kernel that does for all channels; none where one of them has none.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline OscillatorKind common_kind(
    std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs) {
  OscillatorKind common = configs.empty() ? OscillatorKind{} : kind_of(configs[0]);
  for (const auto& config : configs) {
    const OscillatorKind kind = kind_of(config);
    common = kind.orders == 0 || common.orders == 0
                 ? OscillatorKind{}
                 : OscillatorKind{std::max(kind.orders, common.orders),
                                  kind.second_is_double && common.second_is_double};
  }
  // There is no kernel of two orders without a double.
  common.orders = common.orders == 2 && !common.second_is_double ? 3 : common.orders;
  return common;
}

/// One block through its part of the recording.
template <class Real, std::size_t Orders, std::size_t MaxOrders>
inline void filter_interleaved(std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs,
                               std::span<OscillatorFilterState<Real, MaxOrders>> states,
                               const InterleavedRecording<Real>& part,
                               TileKernel<Real, Orders> kernel) {
  constexpr std::size_t width = block_width<Real>;
  const auto lanes = std::make_unique<OscillatorLanes<Real, Orders>>();
  for (std::size_t lane = 0; lane < width; ++lane) {
    const std::size_t like = lane < configs.size() ? lane : 0;
    put_config(*lanes, lane, configs[like]);
    put_state(*lanes, lane, configs[like], states[like]);
  }
  for (std::size_t at = 0; at < part.sample_count; at += counted_samples) {
    const std::size_t from = at * width;
    const bool has_expected = part.expected_torque_Nm != nullptr;
    const bool has_ripple = part.ripple_Nm != nullptr;
    const std::size_t count = std::min(counted_samples, part.sample_count - at);
    kernel(*lanes,
           {.measured_torque_Nm = part.measured_torque_Nm + from,
            .motor_speed_rad_s = part.motor_speed_rad_s + from,
            .expected_torque_Nm = has_expected ? part.expected_torque_Nm + from : zero_row<Real>,
            .expected_stride = has_expected ? width : 0,
            .torque_Nm = part.torque_Nm + from,
            .ripple_Nm = has_ripple ? part.ripple_Nm + from : nullptr,
            .sample_count = count});
    for (std::size_t lane = 0; lane < configs.size(); ++lane) {
      take_counts(*lanes, lane, count, states[lane].counters);
    }
    clear_counts(*lanes);
  }
  for (std::size_t lane = 0; lane < configs.size(); ++lane) {
    take_state(*lanes, lane, configs[lane], states[lane]);
  }
}

}  // namespace detail

/// Filters an interleaved recording, one configuration and state a channel.  Returns false, and
/// does nothing, where a configuration or the level has no kernel: see process_batch() for those.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] bool process_interleaved(
    std::span<const OscillatorFilterConfig<Real, MaxOrders>> configs,
    std::span<OscillatorFilterState<Real, MaxOrders>> states,
    const InterleavedRecording<Real>& recording, const BatchOptions& options = {}) {
  const detail::OscillatorKind kind = detail::common_kind(configs);
  if (kind.orders == 0 || options.level == VectorLevel::one_by_one ||
      !is_available(options.level)) {
    return false;
  }
  constexpr std::size_t width = block_width<Real>;
  detail::for_each_part(
      (configs.size() + width - 1) / width, options.thread_count, [&](std::size_t block) {
        const std::size_t first = block * width;
        const std::size_t count = std::min(width, configs.size() - first);
        const auto from = [&](auto* array) {
          return array == nullptr ? nullptr : array + first * recording.sample_count;
        };
        const InterleavedRecording<Real> part = {
            .sample_count = recording.sample_count,
            .measured_torque_Nm = from(recording.measured_torque_Nm),
            .motor_speed_rad_s = from(recording.motor_speed_rad_s),
            .expected_torque_Nm = from(recording.expected_torque_Nm),
            .torque_Nm = from(recording.torque_Nm),
            .ripple_Nm = from(recording.ripple_Nm)};
        detail::with_kernel<Real>(
            kind, options.level, [&]<std::size_t Orders>(detail::TileKernel<Real, Orders> kernel) {
              detail::filter_interleaved<Real, Orders, MaxOrders>(
                  configs.subspan(first, count), states.subspan(first, count), part, kernel);
            });
      });
  return true;
}

}  // namespace strainwave
