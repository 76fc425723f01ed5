// Configurations and a motor that several tests of the ripple filter use.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "strainwave/ripple_filter.hpp"

/// Orders 2 and 4 with a memory of 30 turns.
template <class Real, std::size_t MaxPairs>
strainwave::RippleFilterConfig<Real, MaxPairs> two_orders() {
  strainwave::RippleFilterConfig<Real, MaxPairs> config;
  config.order_count = 2;
  config.orders[0] = {.order = {2, 1}};
  config.orders[1] = {.order = {4, 1}};
  config.memory_turns = Real(30);
  return config;
}

/// Uniform from -1 to 1, the same on every platform.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15U + 1U) {}

  std::uint64_t bits() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 7U;
    state_ ^= state_ << 17U;
    return state_;
  }
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-52 - 1.0; }
  /// The sum of four uniform numbers, unit variance.
  double gaussian() {
    return (uniform() + uniform() + uniform() + uniform()) * std::sqrt(3.0) / 2.0;
  }

 private:
  std::uint64_t state_;
};

/// True ripple of the examples, Nm.
inline double example_ripple_Nm(double angle_rad) {
  return 1.6 * std::cos(2.0 * angle_rad + 0.3) + 0.6 * std::sin(4.0 * angle_rad);
}

template <class Real>
strainwave::RippleSample<Real> ripple_sample(double torque_Nm, double angle_rad,
                                             double interval_s = 1e-3) {
  strainwave::RippleSample<Real> sample;
  sample.measured_torque_Nm = static_cast<Real>(torque_Nm);
  sample.motor_phase = strainwave::phase_from_radians(angle_rad);
  sample.interval_s = static_cast<Real>(interval_s);
  return sample;
}

/// Smallest pivot of P, coefficients first and T last, factored in double; -1 where one is no
/// positive number.
template <class Real, std::size_t MaxPairs>
double smallest_pivot(const strainwave::RippleFilterConfig<Real, MaxPairs>& config,
                      const strainwave::RippleFilterState<Real, MaxPairs>& state) {
  const auto& p = state.covariance;
  const std::size_t count = 2 * strainwave::pair_count(config);
  double rest[1 + 2 * MaxPairs][1 + 2 * MaxPairs] = {};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      rest[i][j] = static_cast<double>(strainwave::detail::element_of(p, i, j));
    }
    rest[i][count] = rest[count][i] = static_cast<double>(p.torque_row_Nm2[i]);
  }
  rest[count][count] = static_cast<double>(p.torque_variance_Nm2);
  double smallest = INFINITY;
  for (std::size_t k = 0; k <= count; ++k) {
    if (!(rest[k][k] > 0.0) || !std::isfinite(rest[k][k])) {
      return -1.0;
    }
    smallest = std::fmin(smallest, rest[k][k]);
    for (std::size_t i = k + 1; i <= count; ++i) {
      for (std::size_t j = k + 1; j <= count; ++j) {
        rest[i][j] -= rest[i][k] * rest[k][j] / rest[k][k];
      }
    }
  }
  return smallest;
}

/// A covariance with these elements; index 0 of `dense` is T, the others are coefficients.
template <class Real, std::size_t MaxPairs, class Dense>
strainwave::RippleCovariance<Real, MaxPairs> covariance_like(const Dense& dense,
                                                             std::size_t states) {
  strainwave::RippleCovariance<Real, MaxPairs> p;
  p.torque_variance_Nm2 = static_cast<Real>(dense[0][0]);
  for (std::size_t i = 1; i < states; ++i) {
    p.torque_row_Nm2[i - 1] = static_cast<Real>(dense[0][i]);
    for (std::size_t j = 1; j < states; ++j) {
      strainwave::detail::set_element(p, i - 1, j - 1, static_cast<Real>(dense[i][j]));
    }
  }
  return p;
}

inline std::uint32_t times(const strainwave::EventCounters& counters, strainwave::StatusFlag flag) {
  std::size_t bit = 0;
  while ((strainwave::mask(flag) >> bit) != 1U) {
    ++bit;
  }
  return counters.by_bit[bit];
}
