// SPDX-License-Identifier: Apache-2.0
/// @file oscillator_deferred.hpp
/// The published filter's update with what the last measurement takes off P kept beside it.
///
/// From one sample to the next a processor otherwise waits: for P, for what C sees of it, for the
/// quotient, for P again.  With g = P C' of the last sample, s its C P C' + R, and P = B - g g' /
/// s,
///
///     P C' = B C' - g (g' C') / s        C P C' = C B C' - (g' C')^2 / s
///
/// ask for B, g and s alone, and B follows while the next sample is under way.  The same numbers as
/// in oscillator_covariance.hpp, to rounding.
#pragma once

#include <cstddef>
#include <limits>

#include "strainwave/number_row.hpp"
#include "strainwave/oscillator_config.hpp"
#include "strainwave/oscillator_state.hpp"

namespace strainwave::detail {

#if defined(STRAINWAVE_NUMBER_ROWS)

/// States and P with the last measurement beside them, in registers.
template <class Real, std::size_t MaxOrders>
class DeferredUpdate {
 public:
  static constexpr std::size_t length = column_length(2 * MaxOrders);
  using Config = OscillatorFilterConfig<Real, MaxOrders>;
  using State = OscillatorFilterState<Real, MaxOrders>;

  [[gnu::always_inline]] DeferredUpdate(std::size_t count, const State& state)
      : states_(Row::load(state.states_Nm)) {
#pragma GCC unroll 8
    for (std::size_t j = 0; j < count; ++j) {
      column_[j] = Row::load(state.covariance_Nm2[j]);
    }
  }

  /// C x of the next sample.
  [[nodiscard, gnu::always_inline]] Real ripple_Nm(const Real* output) {
    const Row row = Row::load(output);
    shared_ = (seen_ * row).sum();
    return (states_ * row).sum() + shared_ * step_Nm_;
  }

  /// Eq. (12) to (14) after ripple_Nm() of the same sample; false where P has lost its sign.
  /// `last_seen` has P C' of the sample before, where single elements are quick to load; that of
  /// this sample goes to `seen`.
  [[nodiscard, gnu::always_inline]] bool learn(const Config& config, std::size_t count,
                                               const Real* output, Real innovation_Nm,
                                               const Real* last_seen, Real* seen) {
    const Row covariance_with_output = product(count, output);
    const Real share = shared_ * per_variance_;
    const Real noise_Nm2 = config.measurement_noise_variance_Nm2;
    const Real variance_Nm2 =
        (covariance_with_output * Row::load(output)).sum() + (noise_Nm2 - shared_ * share);
#pragma GCC unroll 8
    for (std::size_t j = 0; j < count; ++j) {
      column_[j] = column_[j] + noise_row(config, j);
    }
    settle(count, last_seen);
    seen_ = covariance_with_output - seen_ * Row::all(share);
    seen_.store(seen);
    per_variance_ = Real(1) / variance_Nm2;
    gain_ = seen_ * Row::all(per_variance_);
    step_Nm_ = per_variance_ * innovation_Nm;
    return is_between(noise_Nm2, variance_Nm2, std::numeric_limits<Real>::max());
  }

  /// The way back, with nothing left beside P.  Elements above the diagonal are no longer those
  /// below it to the last bit, and become so again.
  [[gnu::always_inline]] void store(std::size_t count, const Real* last_seen, State& state) {
    settle(count, last_seen);
    states_.store(state.states_Nm);
#pragma GCC unroll 8
    for (std::size_t j = 0; j < count; ++j) {
      column_[j].store(state.covariance_Nm2[j]);
    }
    mirror(count, state.covariance_Nm2);
  }

 private:
  using Row = NumberRow<Real, length>;

  /// B C', in two chains.
  [[nodiscard, gnu::always_inline]] Row product(std::size_t count, const Real* output) const {
    Row even = column_[0] * Row::all(output[0]);
    Row odd = column_[1] * Row::all(output[1]);
#pragma GCC unroll 8
    for (std::size_t j = 2; j < count; j += 2) {
      even = even + column_[j] * Row::all(output[j]);
      odd = odd + column_[j + 1] * Row::all(output[j + 1]);
    }
    return even + odd;
  }

  [[gnu::always_inline]] void settle(std::size_t count, const Real* last_seen) {
    states_ = states_ + seen_ * Row::all(step_Nm_);
#pragma GCC unroll 8
    for (std::size_t j = 0; j < count; ++j) {
      column_[j] = column_[j] - gain_ * Row::all(last_seen[j]);
    }
  }

  /// Process noise of a state, in its own element of its column.
  [[nodiscard, gnu::always_inline]] static Row noise_row(const Config& config, std::size_t j) {
    const auto above = static_cast<std::ptrdiff_t>(j);
    const Row zero = Row::all(Real(0));
    const Row noise = Row::all(config.process_noise_variance_Nm2[j / 2]);
    return Row::joined(above, zero, Row::joined(above + 1, noise, zero));
  }

  Row column_[2 * MaxOrders];  ///< B
  Row states_;
  Row seen_ = Row::all(Real(0));  ///< P C' of the last sample
  Row gain_ = Row::all(Real(0));  ///< the same by its C P C' + R
  Real per_variance_ = Real(0);
  Real step_Nm_ = Real(0);  ///< innovation by C P C' + R
  Real shared_ = Real(0);   ///< `seen_` through the next sample's output row
};

#endif

}  // namespace strainwave::detail
