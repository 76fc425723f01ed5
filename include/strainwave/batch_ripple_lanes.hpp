// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_lanes.hpp
/// A block of ripple filters side by side: configuration and state, a row of lanes for each number.
///
/// Lanes hold the filters that go on from sample to sample as usual.  What is rare (the start, a
/// missing angle, a late row, a gap) a lane does alone, through step(), and then comes back.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "strainwave/batch_layout.hpp"
#include "strainwave/ripple_filter.hpp"

namespace strainwave {

/// What a pair is multiplied by: an order's first one by 1, one that the filters do not have by 0.
enum class RippleFactor : std::uint8_t { one, load, speed, direction, none };
inline constexpr std::size_t ripple_factors = 5;

/// An order of a block, alike in all of its lanes but for the order itself.
struct RippleOrderLayout {
  std::size_t first_pair = 0;
  std::size_t terms = 0;  ///< further pairs
  RippleFactor factors[3] = {};
  bool in_series = false;  ///< the sum of the order before it and the first one, in every lane

  [[nodiscard]] constexpr auto operator<=>(const RippleOrderLayout&) const = default;
};

/// Everything that changes from lane to lane is a row.  Pairs that the filters do not have are
/// rows of zeros.
template <class Real, std::size_t Pairs>
struct alignas(64) RippleLanes {
  static constexpr std::size_t width = block_width<Real>;
  static constexpr std::size_t coefficients = 2 * Pairs;
  using Row = Real[width];
  using Whole = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using WholeRow = Whole[width];

  // Configuration.
  Row order[Pairs];
  Row per_order[Pairs];
  WholeRow numerator[Pairs];
  Row kept[Pairs];  ///< 1 for an order that stays in the torque
  Row noise_Nm2;    ///< R
  Row walk_Nm2_per_s;
  Row half_per_limit;  ///< 1 / (2 P0), P0 the coefficients' first variance, 1/Nm^2
  Row per_rated_torque;
  Row per_reference_speed;
  Row per_memory_square;  ///< 1 / (2 pi n)^2
  Row minimum_speed_rad_s;
  Row least_scale_Nm;
  Row highest_order;

  // State.
  Row torque_state_Nm;
  Row coefficients_Nm[coefficients];  ///< an order's first pair: its ripple in the frame
  Row frames[Pairs];                  ///< factor of each further pair; 0 for the others
  Row half_per_limits[Pairs];         ///< of a further pair half_per_limit, of a first one less
  Row covariance_Nm2[coefficients * (coefficients + 1) / 2];
  Row torque_row_Nm2[coefficients];
  Row torque_variance_Nm2;
  Row innovation_scale_Nm;
  WholeRow last_turns;     ///< the nearest whole ones
  WholeRow last_fraction;  ///< from there, in units of 2^-32 turn, either side of zero
  Row speed_rad_s;
  Row smoothed_speed_rad_s;
  Row load_Nm;
  Row load_factor;  ///< that follows from it: its quotient need not be waited for
  Row typical_interval_s;
  Row measured_Nm;
  Row torque_Nm;
  Row torque_all_Nm;

  // Of the interval, which seldom changes.
  Row interval_s;
  Row per_interval;
  Row speed_share;
  Row smoothed_speed_share;
  Row load_share;

  Row in_step;  ///< 1: the state is here; 0: with the channel, whose next sample is done alone
  Row live;     ///< 1: a channel that has not ended
  Row alone;    ///< 1: this sample is done alone
  // Of lanes that find their angles alone: those with a delay or frozen terms.
  Row new_speed_rad_s;
  Row rotation_rad;  ///< since the last sample; then, since what was learned last
  WholeRow order_fraction[Pairs];
  Row frozen_Nm;

  /// How often each flag of ripple_lane_flags was raised since the counts were taken.
  Row counts[3];

  RippleOrderLayout orders[Pairs] = {};
  std::size_t order_count = 0;
  std::size_t order_of[Pairs] = {};   ///< of each pair
  std::size_t first_of[Pairs] = {};   ///< its order's first pair
  std::size_t factor_of[Pairs] = {};  ///< a RippleFactor
  Real widest_offset[Pairs] = {};     ///< of the factor from the frame; infinite where it has none
  bool any_kept = false;
  bool any_direction = false;
  bool any_own_angle = false;
  bool any_count = false;
};

/// Flags that lanes raise without step().
inline constexpr StatusFlag ripple_lane_flags[3] = {
    StatusFlag::at_rest, StatusFlag::order_above_nyquist, StatusFlag::variance_limited};

/// What may be asked of a filter sample by sample.
enum class RippleOutput : std::uint8_t { torque, ripple, all_removed, state, innovation, variance };
inline constexpr std::size_t ripple_outputs = 6;

/// Most pairs of a filter that runs on lanes.
inline constexpr std::size_t most_lane_pairs = 11;

/// A block's arrays two tiles ahead; as Ahead of batch_layout.hpp, with angles in double.
template <class Real>
struct RippleAhead {
  static constexpr std::size_t width = block_width<Real>;
  static constexpr std::size_t line = 64 / sizeof(Real);
  static constexpr std::size_t angle_line = 64 / sizeof(double);

  const Real* torques_Nm[width] = {};
  const Real* results[width] = {};
  const double* angles_rad[width] = {};

  /// Asks for some lines of the tile that begins at `at`, for each sample of the tile before it.
  [[gnu::always_inline]] void ask([[maybe_unused]] std::size_t at,
                                  [[maybe_unused]] std::size_t sample) const {
#if STRAINWAVE_HAS_LANES
    const std::size_t lane = sample % width;
    const std::size_t from = at + sample / width * line;
    __builtin_prefetch(torques_Nm[lane] + from);
    __builtin_prefetch(results[lane] + from);
    for (std::size_t i = 0; i < line; i += angle_line) {
      __builtin_prefetch(angles_rad[lane] + from + i);
    }
#endif
  }
};

/// Samples of a block, [time][block_width]; null outputs are not wanted.
template <class Real>
struct RippleTile {
  const Real* measured_torque_Nm = nullptr;
  const Real* turns = nullptr;     ///< bits of whole numbers, see RippleLanes::last_turns
  const Real* fraction = nullptr;  ///< likewise
  /// Likewise of an order's cycles; null where all lanes have whole ones in a turn.
  const Real* order_fraction[most_lane_pairs] = {};
  const Real* interval_s = nullptr;
  std::size_t interval_stride = block_width<Real>;
  const Real* expected_torque_Nm = nullptr;
  std::size_t expected_stride = block_width<Real>;
  Real* outputs[ripple_outputs] = {};
  Real* status = nullptr;        ///< as numbers, which hold them exactly
  std::size_t first_sample = 0;  ///< since the call began
  std::size_t sample_count = 0;
  const RippleAhead<Real>* ahead = nullptr;  ///< null: nothing is that far ahead
};

/// Where an order's cycles go that depend on whole turns as well.
template <class Real>
struct OrderCycles {
  double numerator = 1.0;
  double denominator = 1.0;
  double per_denominator = 1.0;
  Real* fraction = nullptr;  ///< bits of whole numbers, units of 2^-32 cycle
};

/// What lanes cannot do: called with the first lane of a group, how many they
/// are, and the sample of the tile.
struct RippleAlone {
  void* block = nullptr;
  /// Lanes that RippleLanes::alone marks take their states with them and do the sample.
  void (*leave)(void* block, std::size_t lane, std::size_t lanes, std::size_t sample) = nullptr;
  /// They come back with the results.
  void (*come_back)(void* block, std::size_t lane, std::size_t lanes, std::size_t sample) = nullptr;
  /// Lanes with angles of their own find them.
  void (*find_angles)(void* block, std::size_t lane, std::size_t lanes,
                      std::size_t sample) = nullptr;
};

namespace detail {

[[nodiscard]] constexpr std::size_t lane_element(std::size_t row, std::size_t column) {
  return row >= column ? row * (row + 1) / 2 + column : column * (column + 1) / 2 + row;
}

/// lane_element() of all of them, where it would take longer to compute.
template <std::size_t Coefficients>
struct LanePlaces {
  std::uint8_t of[Coefficients][Coefficients] = {};

  constexpr LanePlaces() {
    static_assert(lane_element(Coefficients - 1, Coefficients - 1) <= 255);
    for (std::size_t i = 0; i < Coefficients; ++i) {
      for (std::size_t j = 0; j < Coefficients; ++j) {
        of[i][j] = static_cast<std::uint8_t>(lane_element(i, j));
      }
    }
  }
};

/// How far lanes let factors go from their frame: further than a filter alone, because some lane of
/// a block moves at many a sample, and all of them wait for it.
inline constexpr float widest_lane_offset = 2.0F * widest_frame_offset;

/// Turns beyond this a lane does alone.
inline constexpr std::int64_t most_lane_turns = std::int64_t{1} << 30U;

/// The nearest whole turns.
[[nodiscard]] constexpr std::int64_t nearest_turns(Phase phase) {
  return phase.turns + (phase.fraction >= 0x80000000U ? 1 : 0);
}
template <class Whole>
[[nodiscard]] constexpr Phase phase_of_lane(Whole turns, Whole fraction) {
  return {turns - (fraction < 0 ? 1 : 0), static_cast<std::uint32_t>(fraction)};
}

/// Whether lanes find an order's cycles from turns and fraction: products of both parts and 2^32
/// have to be held by double.
[[nodiscard]] constexpr bool has_short_parts(Order order) {
  return order.denominator == 1 ||
         std::uint64_t{order.numerator} * order.denominator < (std::uint64_t{1} << 19U);
}

/// Whether a filter finds its angles alone.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr bool has_own_angle(const RippleFilterConfig<Real, MaxPairs>& config) {
  bool own = config.angle_to_torque_delay_s != Real(0) || config.frozen_count > 0;
  for (std::size_t a = 0; a < config.order_count; ++a) {
    own = own || !has_short_parts(config.orders[a].order);
  }
  return own;
}

/// Whether the next sample finds everything as it is after a usual one.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr bool is_in_step(const RippleFilterConfig<Real, MaxPairs>& config,
                                        const RippleFilterState<Real, MaxPairs>& state) {
  const std::int64_t turns = nearest_turns(state.last_phase);
  const bool alike = has_own_angle(config) || state.learned_phase == state.last_phase;
  return state.phase_known && state.torque_known && state.learned_phase_known && alike &&
         state.time_since_phase_s <= Real(0) && state.time_since_update_s <= Real(0) &&
         state.typical_interval_s > Real(0) && reaches_back(config, state) &&
         turns > -most_lane_turns && turns < most_lane_turns;
}

/// What is alike in all lanes.
template <class Real, std::size_t Pairs>
inline void put_layout(RippleLanes<Real, Pairs>& lanes, const RippleOrderLayout* orders,
                       std::size_t order_count) {
  lanes.order_count = order_count;
  for (std::size_t pair = 0; pair < Pairs; ++pair) {
    lanes.factor_of[pair] = static_cast<std::size_t>(RippleFactor::none);
    lanes.widest_offset[pair] = std::numeric_limits<Real>::infinity();
    lanes.first_of[pair] = pair;
  }
  for (std::size_t a = 0; a < order_count; ++a) {
    const RippleOrderLayout& order = orders[a];
    lanes.orders[a] = order;
    lanes.factor_of[order.first_pair] = static_cast<std::size_t>(RippleFactor::one);
    lanes.order_of[order.first_pair] = a;
    for (std::size_t t = 0; t < order.terms; ++t) {
      const std::size_t pair = order.first_pair + 1 + t;
      lanes.order_of[pair] = a;
      lanes.first_of[pair] = order.first_pair;
      lanes.factor_of[pair] = static_cast<std::size_t>(order.factors[t]);
      lanes.any_direction = lanes.any_direction || order.factors[t] == RippleFactor::direction;
      lanes.widest_offset[pair] = static_cast<Real>(widest_lane_offset);
    }
  }
}

/// One lane's configuration.
template <class Real, std::size_t Pairs, std::size_t MaxPairs>
inline void put_config(RippleLanes<Real, Pairs>& lanes, std::size_t lane,
                       const RippleFilterConfig<Real, MaxPairs>& config) {
  for (std::size_t a = 0; a < config.order_count; ++a) {
    const Order order = config.orders[a].order;
    lanes.order[a][lane] = to_real<Real>(order);
    lanes.per_order[a][lane] = Real(1) / to_real<Real>(order);
    lanes.numerator[a][lane] = static_cast<RippleLanes<Real, Pairs>::Whole>(order.numerator);
    lanes.kept[a][lane] = config.orders[a].keep ? Real(1) : Real(0);
    lanes.any_kept = lanes.any_kept || config.orders[a].keep;
  }
  const Real per_memory_rad = Real(1) / (two_pi<Real> * config.memory_turns);
  lanes.noise_Nm2[lane] = config.torque_noise_Nm * config.torque_noise_Nm;
  lanes.walk_Nm2_per_s[lane] = config.torque_walk_Nm_per_sqrt_s * config.torque_walk_Nm_per_sqrt_s;
  lanes.half_per_limit[lane] =
      Real(0.5) / (config.initial_amplitude_Nm * config.initial_amplitude_Nm);
  lanes.per_rated_torque[lane] = Real(1) / config.rated_torque_Nm;
  lanes.per_reference_speed[lane] = Real(1) / config.reference_speed_rad_s;
  lanes.per_memory_square[lane] = per_memory_rad * per_memory_rad;
  lanes.minimum_speed_rad_s[lane] = config.minimum_speed_rad_s;
  lanes.least_scale_Nm[lane] = Real(0.5) * config.torque_noise_Nm;
  lanes.highest_order[lane] = highest_order(config);
  lanes.any_own_angle = lanes.any_own_angle || has_own_angle(config);
}

/// One lane's state, where the next sample may be a usual one.
template <class Real, std::size_t Pairs, std::size_t MaxPairs>
inline void put_state(RippleLanes<Real, Pairs>& lanes, std::size_t lane,
                      const RippleFilterConfig<Real, MaxPairs>& config,
                      const RippleFilterState<Real, MaxPairs>& state) {
  using Whole = RippleLanes<Real, Pairs>::Whole;
  lanes.in_step[lane] = is_in_step(config, state) ? Real(1) : Real(0);
  if (lanes.in_step[lane] <= Real(0)) {
    return;
  }
  const std::size_t count = 2 * pair_count(config);
  const auto& p = state.covariance;
  // All of them: what the filter does not have may hold what came of a sample done alone.
  for (std::size_t i = 0; i < 2 * Pairs; ++i) {
    const bool is_used = i < count;
    lanes.coefficients_Nm[i][lane] = is_used ? state.states_Nm[i + 1] : Real(0);
    lanes.torque_row_Nm2[i][lane] = is_used ? p.torque_row_Nm2[i] : Real(0);
    for (std::size_t j = 0; j <= i; ++j) {
      lanes.covariance_Nm2[lane_element(i, j)][lane] = is_used ? element_of(p, i, j) : Real(0);
    }
    lanes.frames[i / 2][lane] = Real(0);
    lanes.half_per_limits[i / 2][lane] = lanes.half_per_limit[lane];
  }
  for (std::size_t a = 0; a < lanes.order_count; ++a) {
    const std::size_t first = lanes.orders[a].first_pair;
    Real weight = Real(1);
    for (std::size_t t = 0; t < lanes.orders[a].terms; ++t) {
      const std::size_t pair = first + 1 + t;
      lanes.frames[pair][lane] = p.frames[a][t];
      weight += p.frames[a][t] * p.frames[a][t];
      for (std::size_t side = 0; side < 2; ++side) {
        lanes.coefficients_Nm[2 * first + side][lane] +=
            p.frames[a][t] * state.states_Nm[1 + 2 * pair + side];
      }
    }
    lanes.half_per_limits[first][lane] = lanes.half_per_limit[lane] / weight;
  }
  lanes.torque_state_Nm[lane] = state.states_Nm[0];
  lanes.torque_variance_Nm2[lane] = p.torque_variance_Nm2;
  lanes.innovation_scale_Nm[lane] = state.innovation_scale_Nm;
  lanes.last_turns[lane] = static_cast<Whole>(nearest_turns(state.last_phase));
  lanes.last_fraction[lane] = static_cast<std::int32_t>(state.last_phase.fraction);
  lanes.speed_rad_s[lane] = state.speed_rad_s;
  lanes.smoothed_speed_rad_s[lane] = state.smoothed_speed_rad_s;
  lanes.load_Nm[lane] = state.load_Nm;
  lanes.load_factor[lane] = factors_now(config, state).load;
  lanes.typical_interval_s[lane] = state.typical_interval_s;
  lanes.measured_Nm[lane] = state.measured_Nm;
  lanes.torque_Nm[lane] = state.torque_Nm;
  lanes.torque_all_Nm[lane] = state.torque_all_Nm;
}

/// The way back, of a lane that is in step; the counters, and the angles of lanes that find their
/// own, have stayed with the state.
template <class Real, std::size_t Pairs, std::size_t MaxPairs>
inline void take_state(const RippleLanes<Real, Pairs>& lanes, std::size_t lane,
                       const RippleFilterConfig<Real, MaxPairs>& config,
                       RippleFilterState<Real, MaxPairs>& state) {
  if (lanes.in_step[lane] <= Real(0)) {
    return;
  }
  const std::size_t count = 2 * pair_count(config);
  auto& p = state.covariance;
  for (std::size_t i = 0; i < count; ++i) {
    state.states_Nm[i + 1] = lanes.coefficients_Nm[i][lane];
    p.torque_row_Nm2[i] = lanes.torque_row_Nm2[i][lane];
    for (std::size_t j = 0; j <= i; ++j) {
      set_element(p, i, j, lanes.covariance_Nm2[lane_element(i, j)][lane]);
    }
  }
  for (std::size_t a = 0; a < lanes.order_count; ++a) {
    for (std::size_t t = 0; t < lanes.orders[a].terms; ++t) {
      const std::size_t first = lanes.orders[a].first_pair;
      const std::size_t pair = first + 1 + t;
      p.frames[a][t] = lanes.frames[pair][lane];
      for (std::size_t side = 0; side < 2; ++side) {
        state.states_Nm[1 + 2 * first + side] -=
            p.frames[a][t] * state.states_Nm[1 + 2 * pair + side];
      }
    }
  }
  state.states_Nm[0] = lanes.torque_state_Nm[lane];
  p.torque_variance_Nm2 = lanes.torque_variance_Nm2[lane];
  state.innovation_scale_Nm = lanes.innovation_scale_Nm[lane];
  state.last_phase = phase_of_lane(lanes.last_turns[lane], lanes.last_fraction[lane]);
  if (!has_own_angle(config)) {
    state.learned_phase = state.last_phase;
  }
  state.time_since_phase_s = Real(0);
  state.time_since_update_s = Real(0);
  state.speed_rad_s = lanes.speed_rad_s[lane];
  state.smoothed_speed_rad_s = lanes.smoothed_speed_rad_s[lane];
  state.load_Nm = lanes.load_Nm[lane];
  state.typical_interval_s = lanes.typical_interval_s[lane];
  state.measured_Nm = lanes.measured_Nm[lane];
  state.torque_Nm = lanes.torque_Nm[lane];
  state.torque_all_Nm = lanes.torque_all_Nm[lane];
}

}  // namespace detail

}  // namespace strainwave
