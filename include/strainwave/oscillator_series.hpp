// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_series.hpp
/// The published filter over many samples of one channel: step() after step(), to rounding, in
/// half the time.
///
/// With all samples at hand nothing has to wait for the end of a step: each update is deferred
/// (oscillator_deferred.hpp), and output rows are computed a block of samples ahead.  A block in
/// which a sample is not simply learned from goes through step().
#pragma once

#include <cstddef>
#include <cstdint>

#include "strainwave/number_row.hpp"
#include "strainwave/oscillator_deferred.hpp"
#include "strainwave/oscillator_filter.hpp"

namespace strainwave {

/// Samples of one channel: arrays of `sample_count` numbers, of which those that are written
/// overlap with no other.
template <class Real>
struct OscillatorSeries {
  std::size_t sample_count = 0;
  const Real* measured_torque_Nm = nullptr;
  const Real* motor_speed_rad_s = nullptr;
  const Real* expected_torque_Nm = nullptr;  ///< null: 0
  Real* torque_Nm = nullptr;                 ///< null where not wanted; the next two likewise
  Real* ripple_Nm = nullptr;
  Status* status = nullptr;
};

namespace detail {

template <class Real>
[[nodiscard]] constexpr Real expected_torque_Nm(const OscillatorSeries<Real>& series,
                                                std::size_t k) {
  return series.expected_torque_Nm == nullptr ? Real(0) : series.expected_torque_Nm[k];
}

template <class Real>
constexpr void write_reading(const OscillatorSeries<Real>& series, std::size_t k,
                             const OscillatorReading<Real>& reading) {
  if (series.torque_Nm != nullptr) {
    series.torque_Nm[k] = reading.torque_Nm;
  }
  if (series.ripple_Nm != nullptr) {
    series.ripple_Nm[k] = reading.ripple_Nm;
  }
  if (series.status != nullptr) {
    series.status[k] = reading.status;
  }
}

/// Samples from `first` to before `end` through step().
template <class Real, std::size_t MaxOrders>
inline void step_through(const OscillatorFilterConfig<Real, MaxOrders>& config,
                         OscillatorFilterState<Real, MaxOrders>& state,
                         const OscillatorSeries<Real>& series, std::size_t first, std::size_t end) {
  for (std::size_t k = first; k < end; ++k) {
    OscillatorSample<Real> sample;
    sample.measured_torque_Nm = series.measured_torque_Nm[k];
    sample.motor_speed_rad_s = series.motor_speed_rad_s[k];
    sample.expected_torque_Nm = expected_torque_Nm(series, k);
    write_reading(series, k, step(config, state, sample));
  }
}

#if defined(STRAINWAVE_NUMBER_ROWS)

/// Samples that are looked at ahead of the filter, and that step() takes over together.
inline constexpr std::size_t series_block = 32;

/// Rows that begin here lie in one line of the cache each.
inline constexpr std::size_t row_alignment = 64;

/// A block that was looked at.
template <class Real, std::size_t MaxOrders>
struct SeriesBlock {
  alignas(row_alignment) Real output[series_block][column_length(2 * MaxOrders)] = {};
  bool is_usual = false;  ///< every sample is learned from, and none has a flag
};

/// Whether torques and speeds of a block raise no flag.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline bool is_sound_block(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                         const OscillatorSeries<Real>& series, std::size_t first) {
  const Real order = highest_order(config);
  const Real* const torque_Nm = series.measured_torque_Nm + first;
  const Real* const speed_rad_s = series.motor_speed_rad_s + first;
  std::uint32_t sound = 1;  // a number, so that samples are compared side by side
  for (std::size_t k = 0; k < series_block; ++k) {
    const Real turns = absolute(order * turns_of(config, speed_rad_s[k]));
    sound &= turns <= Real(0.5) ? 1U : 0U;
    sound &= is_usable_torque(torque_Nm[k]) ? 1U : 0U;
  }
  if (series.expected_torque_Nm != nullptr) {
    const Real* const expected_Nm = series.expected_torque_Nm + first;
    for (std::size_t k = 0; k < series_block; ++k) {
      sound &= are_sound(torque_Nm[k], expected_Nm[k]) ? 1U : 0U;
    }
  }
  return sound != 0;
}

/// What step() does with a sound sample before it learns; false where it does not learn.
template <class Real, std::size_t MaxOrders>
[[nodiscard, gnu::always_inline]] inline bool look_at_sample(
    const OscillatorFilterConfig<Real, MaxOrders>& config,
    OscillatorFilterState<Real, MaxOrders>& ahead, Real motor_speed_rad_s, Real* output) {
  Real numbers[column_length(2 * MaxOrders)] = {};
  output_now(config, ahead, ahead.last_phase, numbers);
  NumberRow<Real, column_length(2 * MaxOrders)>::gathered(numbers).store(output);
  const bool moves = is_moving(config, ahead, ahead.last_phase);
  ahead.last_speed_rad_s = motor_speed_rad_s;
  turn_on(config, ahead, turns_of(config, motor_speed_rad_s), true);
  smooth_speed(config, ahead, motor_speed_rad_s);
  begin_travel(config, ahead, ahead.last_phase);
  add_travel(config, ahead, Real(1));
  return moves;
}

/// Whether no variance can reach its limit within a block: it gains process noise and no more.
template <class Real, std::size_t MaxOrders>
[[nodiscard]] inline bool has_room(const OscillatorFilterConfig<Real, MaxOrders>& config,
                                   const OscillatorFilterState<Real, MaxOrders>& state) {
  for (std::size_t i = 0; i < 2 * active_orders(config); ++i) {
    const Real gained_Nm2 = Real(series_block) * config.process_noise_variance_Nm2[i / 2];
    if (config.variance_limit_ratio > Real(0) &&
        !(state.covariance_Nm2[i][i] + gained_Nm2 <= variance_limit(config, i / 2))) {
      return false;
    }
  }
  return true;
}

/// A series on its way through the filter.
template <class Real, std::size_t MaxOrders>
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): rows begin with a line of the cache
class SeriesFilter {
 public:
  using Config = OscillatorFilterConfig<Real, MaxOrders>;
  using State = OscillatorFilterState<Real, MaxOrders>;
  using Series = OscillatorSeries<Real>;

  /// All whole blocks; returns how many samples they have.
  [[gnu::always_inline]] std::size_t filter(const Config& config, State& state,
                                            const Series& series) {
    std::size_t first = 0;
    bool is_looked_at = false;
    for (; first + series_block <= series.sample_count; first += series_block) {
      if (!is_looked_at) {
        ahead_ = state;
        look_at(config, series, first);
      }
      is_looked_at = blocks_[now_].is_usual && has_room(config, state) &&
                     filter_any_block(config, state, series, first);
      if (!is_looked_at) {
        step_through(config, state, series, first, first + series_block);
      }
    }
    return first;
  }

 private:
  void look_at(const Config& config, const Series& series, std::size_t first) {
    SeriesBlock<Real, MaxOrders>& block = blocks_[now_];
    block.is_usual = is_sound_block(config, series, first);
    for (std::size_t k = 0; block.is_usual && k < series_block; ++k) {
      block.is_usual =
          look_at_sample(config, ahead_, series.motor_speed_rad_s[first + k], block.output[k]);
    }
  }

  /// Loops have constant length where the configuration uses all of its capacity.
  [[nodiscard, gnu::always_inline]] bool filter_any_block(const Config& config, State& state,
                                                          const Series& series, std::size_t first) {
    return active_orders(config) == MaxOrders
               ? filter_block(config, state, series, first, 2 * MaxOrders)
               : filter_block(config, state, series, first, 2 * active_orders(config));
  }

  /// Filters a usual block and looks at the next one; at this one again where there is none that is
  /// sound.  False, and the state is as it was, where P loses its sign.
  [[nodiscard, gnu::always_inline]] bool filter_block(const Config& config, State& state,
                                                      const Series& series, std::size_t first,
                                                      std::size_t count) {
    const SeriesBlock<Real, MaxOrders>& block = blocks_[now_];
    now_ = 1 - now_;
    SeriesBlock<Real, MaxOrders>& next = blocks_[now_];
    const bool has_next = series.sample_count - first >= 2 * series_block &&
                          is_sound_block(config, series, first + series_block);
    const Real* const next_speed_rad_s =
        series.motor_speed_rad_s + first + (has_next ? series_block : 0);
    const State after = ahead_;
    DeferredUpdate<Real, MaxOrders> update(count, state);
    bool is_usual = has_next;
    bool is_sound = true;
    for (std::size_t k = 0; k < series_block; ++k) {
      const Real* const output = block.output[k];
      ripple_Nm_[k] = update.ripple_Nm(output);
      is_usual = look_at_sample(config, ahead_, next_speed_rad_s[k], next.output[k]) && is_usual;
      const Real innovation_Nm = series.measured_torque_Nm[first + k] - ripple_Nm_[k] -
                                 expected_torque_Nm(series, first + k);
      const bool keeps_sign =
          update.learn(config, count, output, innovation_Nm, seen_[k], seen_[k + 1]);
      is_sound = is_sound && keeps_sign;
    }
    next.is_usual = is_usual;
    if (is_sound) {
      update.store(count, seen_[series_block], state);
      take_motion(after, state);
      write(series, first, state);
    }
    return is_sound;
  }

  static void take_motion(const State& from, State& to) {
    for (std::size_t a = 0; a < MaxOrders; ++a) {
      to.angle[a] = from.angle[a];
    }
    to.travel_rad = from.travel_rad;
    to.last_speed_rad_s = from.last_speed_rad_s;
    to.smoothed_speed_rad_s = from.smoothed_speed_rad_s;
  }

  /// Readings and counters of a usual block.
  void write(const Series& series, std::size_t first, State& state) const {
    for (std::size_t k = 0; k < series_block; ++k) {
      state.last_torque_Nm = series.measured_torque_Nm[first + k] - ripple_Nm_[k];
      write_reading(series, first + k,
                    {.torque_Nm = state.last_torque_Nm, .ripple_Nm = ripple_Nm_[k], .status = 0});
      record(state.counters, 0);
    }
  }

  State ahead_;  ///< angles, travel and speeds after all samples that were looked at
  SeriesBlock<Real, MaxOrders> blocks_[2];
  std::size_t now_ = 0;
  alignas(row_alignment) Real seen_[series_block + 1][column_length(2 * MaxOrders)] = {};
  Real ripple_Nm_[series_block] = {};
};

#endif

}  // namespace detail

/// step() for each sample of a series, with RotationSource::speed.  Torque and ripple are those of
/// step() to rounding, statuses and counters the same.
template <class Real, std::size_t MaxOrders>
inline void steps(const OscillatorFilterConfig<Real, MaxOrders>& config,
                  OscillatorFilterState<Real, MaxOrders>& state,
                  const OscillatorSeries<Real>& series) {
  std::size_t first = 0;
#if defined(STRAINWAVE_NUMBER_ROWS)
  detail::SeriesFilter<Real, MaxOrders> filter;
  first = filter.filter(config, state, series);
#endif
  detail::step_through(config, state, series, first, series.sample_count);
}

}  // namespace strainwave
