// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_channel.hpp
/// A recording for the ripple filter, and what a block of lanes has to know of its filter.
#pragma once

#include <compare>
#include <cstddef>

#include "strainwave/batch_ripple_lanes.hpp"
#include "strainwave/ripple_filter.hpp"

namespace strainwave {

/// One channel's recording: an array for each signal, and where the results go.
template <class Real>
struct RippleChannel {
  std::size_t sample_count = 0;
  const Real* measured_torque_Nm = nullptr;
  const double* motor_angle_rad = nullptr;  ///< not wrapped; NaN where it is not known
  const Real* interval_s = nullptr;         ///< null: sample_period_s throughout
  Real sample_period_s = Real(1e-3);
  const Real* expected_torque_Nm = nullptr;  ///< null: 0 throughout
  bool angle_referenced = true;              ///< false: from an unknown zero, frozen terms wait
  /// Where each RippleOutput goes; null: not wanted.
  Real* outputs[ripple_outputs] = {};
  Status* status = nullptr;  ///< null: not wanted; the counters have the sums

  [[nodiscard]] Real*& output(RippleOutput which) {
    return outputs[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] RippleSample<Real> sample(std::size_t k) const {
    RippleSample<Real> sample;
    sample.measured_torque_Nm = measured_torque_Nm[k];
    sample.expected_torque_Nm = expected_torque_Nm == nullptr ? Real(0) : expected_torque_Nm[k];
    sample.interval_s = interval_s == nullptr ? sample_period_s : interval_s[k];
    sample.phase_valid = is_representable_angle(motor_angle_rad[k]);
    if (sample.phase_valid) {
      sample.motor_phase = phase_from_radians(motor_angle_rad[k]);
    }
    sample.phase_referenced = angle_referenced;
    return sample;
  }
};

namespace detail {

/// What kernel a filter needs: lanes of a block have to be alike in this.
struct RippleKind {
  std::size_t pairs = 0;  ///< capacity of the kernel; 0: none, one by one
  std::size_t order_count = 0;
  RippleOrderLayout orders[most_lane_pairs] = {};

  [[nodiscard]] constexpr bool has_kernel() const { return pairs != 0; }
  [[nodiscard]] constexpr auto operator<=>(const RippleKind&) const = default;
};

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr RippleKind kind_of(const RippleFilterConfig<Real, MaxPairs>& config) {
  RippleKind kind;
  const std::size_t pairs = strainwave::pair_count(config);
  if (pairs > most_lane_pairs) {
    return kind;
  }
  for (const std::size_t capacity :
       {std::size_t{3}, std::size_t{5}, std::size_t{7}, std::size_t{10}}) {
    kind.pairs = kind.pairs == 0 && pairs <= capacity ? capacity : kind.pairs;
  }
  kind.pairs = kind.pairs == 0 ? most_lane_pairs : kind.pairs;
  kind.order_count = config.order_count;
  std::size_t pair = 0;
  for (std::size_t a = 0; a < config.order_count; ++a) {
    const RippleOrder& order = config.orders[a];
    RippleOrderLayout& layout = kind.orders[a];
    layout.first_pair = pair;
    layout.in_series = a > 0 && continues_series(config, a);
    if (order.with_load) {
      layout.factors[layout.terms++] = RippleFactor::load;
    }
    if (order.with_speed) {
      layout.factors[layout.terms++] = RippleFactor::speed;
    }
    if (order.with_direction) {
      layout.factors[layout.terms++] = RippleFactor::direction;
    }
    pair += 1 + layout.terms;
  }
  return kind;
}
template <class Real>
inline void put_reading(const RippleChannel<Real>& channel, std::size_t k,
                        const RippleReading<Real>& reading) {
  const Real values[ripple_outputs] = {
      reading.torque_Nm,       reading.ripple_Nm,     reading.torque_all_removed_Nm,
      reading.torque_state_Nm, reading.innovation_Nm, reading.innovation_variance_Nm2};
  for (std::size_t i = 0; i < ripple_outputs; ++i) {
    if (channel.outputs[i] != nullptr) {
      channel.outputs[i][k] = values[i];
    }
  }
  if (channel.status != nullptr) {
    channel.status[k] = reading.status;
  }
}

/// One channel through step(): what has no kernel, and what must be exactly so.
template <class Real, std::size_t MaxPairs>
inline void filter_one(const RippleFilterConfig<Real, MaxPairs>& config,
                       RippleFilterState<Real, MaxPairs>& state,
                       const RippleChannel<Real>& channel) {
  for (std::size_t k = 0; k < channel.sample_count; ++k) {
    put_reading(channel, k, step(config, state, channel.sample(k)));
  }
}

}  // namespace detail

}  // namespace strainwave
