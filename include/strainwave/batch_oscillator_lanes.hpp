// SPDX-License-Identifier: Apache-2.0
/// @file batch_oscillator_lanes.hpp
/// A block of published filters side by side: configuration and state, a row of lanes for each
/// number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "strainwave/batch_layout.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace strainwave {

/// Everything that changes from lane to lane is a row.  An order that a lane does not have is a
/// pair of states whose output row is zero: nothing of it ever changes.
template <class Real, std::size_t Orders>
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): filled lane by lane
struct alignas(64) OscillatorLanes {
  using Number = Real;
  using Row = Real[block_width<Real>];
  static constexpr std::size_t states = 2 * Orders;

  Row order[Orders];
  Row process_noise_variance_Nm2[Orders];
  Row variance_limit_Nm2[Orders];  ///< infinite where there is none
  Row measurement_noise_variance_Nm2;
  Row initial_variance_Nm2[Orders];  ///< 0 for an order that the lane does not have
  Row sample_period_s;
  Row turns_period_s;  ///< sample period / 2 pi
  Row highest_order;
  /// Times the rotation from one sample to the next: where this stays below largest_reduced_rad no
  /// angle has to be reduced and no order turns half a cycle.
  Row usual_order;
  Row minimum_travel_rad;
  Row minimum_speed_rad_s;
  Row speed_share;  ///< of a sample in the smoothed speed

  Row states_Nm[states];
  Row covariance_Nm2[states * (states + 1) / 2];
  Row output[states];        ///< cosine and sine of each order
  Row pending_rotation_rad;  ///< of the motor since `output`
  Row travel_rad;            ///< since the last update
  Row last_speed_rad_s;
  Row smoothed_speed_rad_s;
  Row last_torque_Nm;

  /// How often each flag of counted_flags was raised since the counts were taken; then samples with
  /// a fault.
  Row counts[8];

  bool any_variance_limit = false;
  bool any_rest = false;  ///< some lane waits for travel or speed
  bool any_count = false;
};

/// Samples after which counts are taken out of the lanes: they are exact in float up to 2^24.
inline constexpr std::size_t counted_samples = std::size_t{1} << 20U;

/// Samples of a block, [time][block_width].  A stride of 0 reads one row again and again; one of
/// the two results may be null.
template <class Real>
struct OscillatorTile {
  const Real* measured_torque_Nm = nullptr;
  const Real* motor_speed_rad_s = nullptr;
  const Real* expected_torque_Nm = nullptr;
  std::size_t expected_stride = block_width<Real>;
  Real* torque_Nm = nullptr;
  Real* ripple_Nm = nullptr;
  Real* status = nullptr;  ///< as numbers, which hold them exactly; null where not wanted
  std::size_t sample_count = 0;
  const Ahead<Real>* ahead = nullptr;  ///< measured torque, speed and one result; null: none
  std::size_t ahead_at = 0;
};

/// Flags that the published filter raises, as counted in OscillatorLanes.
inline constexpr StatusFlag counted_flags[7] = {
    StatusFlag::torque_not_finite,          StatusFlag::rotation_invalid,
    StatusFlag::expected_torque_not_finite, StatusFlag::variance_limited,
    StatusFlag::covariance_reset,           StatusFlag::at_rest,
    StatusFlag::order_above_nyquist};

namespace detail {

/// Largest |angle| whose cosine and sine need no reduction, rad: an eighth of a turn.
template <class Real>
inline constexpr Real largest_reduced_rad = Real(0.785398);

/// Largest |angle| for which cos_sin_small() of the lanes is good to the last place, rad.
template <class Real>
inline constexpr Real largest_small_rad = Real(0.03);

/// See OscillatorLanes::usual_order.  The second order costs no cosine where it is twice the first.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr Real usual_order(const OscillatorFilterConfig<Real, MaxOrders>& config) {
  Real usual = highest_order(config) * (largest_reduced_rad<Real> / pi<Real>);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    const Real order = to_real<Real>(config.orders[a]);
    const bool is_double = a == 1 && half_of(config, 1) == 0;
    usual = order > usual && !is_double ? order : usual;
  }
  return usual;
}

/// One lane's configuration.
template <class Real, std::size_t Orders, std::size_t MaxOrders>
inline void put_config(OscillatorLanes<Real, Orders>& lanes, std::size_t lane,
                       const OscillatorFilterConfig<Real, MaxOrders>& config) {
  const bool is_limited = config.variance_limit_ratio > Real(0);
  for (std::size_t a = 0; a < Orders; ++a) {
    const bool is_used = a < active_orders(config);
    const Real noise_Nm2 = is_used ? config.process_noise_variance_Nm2[a] : Real(0);
    lanes.order[a][lane] = is_used ? to_real<Real>(config.orders[a]) : Real(0);
    lanes.process_noise_variance_Nm2[a][lane] = noise_Nm2;
    lanes.initial_variance_Nm2[a][lane] = is_used ? config.initial_variance_Nm2 : Real(0);
    lanes.variance_limit_Nm2[a][lane] =
        is_limited ? config.initial_variance_Nm2 + config.variance_limit_ratio * noise_Nm2
                   : std::numeric_limits<Real>::infinity();
  }
  lanes.measurement_noise_variance_Nm2[lane] = config.measurement_noise_variance_Nm2;
  lanes.sample_period_s[lane] = config.sample_period_s;
  lanes.turns_period_s[lane] = config.sample_period_s / two_pi<Real>;
  lanes.highest_order[lane] = highest_order(config);
  lanes.usual_order[lane] = usual_order(config);
  lanes.minimum_travel_rad[lane] = config.minimum_travel_rad;
  lanes.minimum_speed_rad_s[lane] = config.minimum_speed_rad_s;
  lanes.speed_share[lane] = config.minimum_speed_rad_s == Real(0)
                                ? Real(1)
                                : config.sample_period_s / (config.sample_period_s +
                                                            static_cast<Real>(speed_smoothing_s));
  lanes.any_variance_limit = lanes.any_variance_limit || is_limited;
  lanes.any_rest =
      lanes.any_rest || config.minimum_travel_rad > Real(0) || config.minimum_speed_rad_s > Real(0);
}

/// Cosine and sine of an order's present angle.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] constexpr CosSin<Real> wave_of(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                             const OscillatorFilterState<Real, MaxOrders>& state,
                                             std::size_t order) {
  const std::size_t half = half_of(config, order);
  return half < order ? doubled(wave_of(config, state, half))
                      : cos_sin_of_fraction<Real>(state.angle[order]);
}

/// One lane's state.
template <class Real, std::size_t Orders, std::size_t MaxOrders>
inline void put_state(OscillatorLanes<Real, Orders>& lanes, std::size_t lane,
                      const OscillatorFilterConfig<Real, MaxOrders>& config,
                      const OscillatorFilterState<Real, MaxOrders>& state) {
  const std::size_t used = 2 * active_orders(config);
  for (std::size_t i = 0; i < 2 * Orders; ++i) {
    const bool is_used = i < used;
    lanes.states_Nm[i][lane] = is_used ? state.states_Nm[i] : Real(0);
    const CosSin<Real> wave =
        is_used ? wave_of(config, state, i / 2) : CosSin<Real>{Real(0), Real(0)};
    lanes.output[i][lane] = i % 2 == 0 ? wave.cosine : wave.sine;
    for (std::size_t j = 0; j <= i; ++j) {
      lanes.covariance_Nm2[i * (i + 1) / 2 + j][lane] =
          is_used ? state.covariance_Nm2[j][i] : Real(0);
    }
  }
  lanes.pending_rotation_rad[lane] = Real(0);
  lanes.travel_rad[lane] = state.travel_rad;
  lanes.last_speed_rad_s[lane] = state.last_speed_rad_s;
  lanes.smoothed_speed_rad_s[lane] = state.smoothed_speed_rad_s;
  lanes.last_torque_Nm[lane] = state.last_torque_Nm;
  for (std::size_t flag = 0; flag < 8; ++flag) {
    lanes.counts[flag][lane] = Real(0);
  }
}

/// The way back; counters stay as they are.
template <class Real, std::size_t Orders, std::size_t MaxOrders>
inline void take_state(const OscillatorLanes<Real, Orders>& lanes, std::size_t lane,
                       const OscillatorFilterConfig<Real, MaxOrders>& config,
                       OscillatorFilterState<Real, MaxOrders>& state) {
  using Fraction = OscillatorFilterState<Real, MaxOrders>::Fraction;
  using Signed = std::make_signed_t<Fraction>;
  const std::size_t count = 2 * active_orders(config);
  for (std::size_t i = 0; i < count; ++i) {
    state.states_Nm[i] = lanes.states_Nm[i][lane];
    for (std::size_t j = 0; j <= i; ++j) {
      state.covariance_Nm2[j][i] = lanes.covariance_Nm2[i * (i + 1) / 2 + j][lane];
    }
  }
  mirror(count, state.covariance_Nm2);
  for (std::size_t a = 0; a < active_orders(config); ++a) {
    // The output row is that of the last sample; the state's angle is that of the next one.
    constexpr Real half_range = Real(2) * static_cast<Real>(Fraction{1} << (sizeof(Real) * 8 - 2));
    const Real turns = angle_of(lanes.output[2 * a][lane], lanes.output[2 * a + 1][lane]) *
                       (Real(1) / two_pi<Real>);
    state.angle[a] = 2U * static_cast<Fraction>(static_cast<Signed>(turns * half_range));
  }
  turn_on(config, state, lanes.pending_rotation_rad[lane] / two_pi<Real>, false);
  state.travel_rad = lanes.travel_rad[lane];
  state.last_speed_rad_s = lanes.last_speed_rad_s[lane];
  state.smoothed_speed_rad_s = lanes.smoothed_speed_rad_s[lane];
  state.last_torque_Nm = lanes.last_torque_Nm[lane];
}

/// Adds a lane's counts of `samples` samples to its counters.
template <class Real, std::size_t Orders>
inline void take_counts(const OscillatorLanes<Real, Orders>& lanes, std::size_t lane,
                        std::size_t samples, EventCounters& counters) {
  count_up_by(counters.samples, samples);
  if (!lanes.any_count) {
    return;
  }
  for (std::size_t flag = 0; flag < 7; ++flag) {
    count_up_by(counters.by_bit[lowest_bit(mask(counted_flags[flag]))],
                static_cast<std::size_t>(lanes.counts[flag][lane]));
  }
  count_up_by(counters.faults, static_cast<std::size_t>(lanes.counts[7][lane]));
}

template <class Real, std::size_t Orders>
inline void clear_counts(OscillatorLanes<Real, Orders>& lanes) {
  if (lanes.any_count) {
    for (auto& row : lanes.counts) {
      for (Real& count : row) {
        count = Real(0);
      }
    }
    lanes.any_count = false;
  }
}

}  // namespace detail

}  // namespace strainwave
