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

/// Smallest pivot of P as it is factored; -1 where one is no positive number.
template <class Real, std::size_t MaxPairs>
double smallest_pivot(const strainwave::RippleFilterConfig<Real, MaxPairs>& config,
                      const strainwave::RippleFilterState<Real, MaxPairs>& state) {
  double smallest = static_cast<double>(state.covariance.torque_variance_Nm2);
  for (std::size_t j = 0; j < 2 * strainwave::pair_count(config); ++j) {
    const auto pivot = static_cast<double>(state.covariance.variances_Nm2[j]);
    smallest = pivot < smallest || std::isnan(pivot) ? pivot : smallest;
  }
  return smallest > 0.0 && std::isfinite(smallest) ? smallest : -1.0;
}

/// Factors of a positive definite matrix; index 0 of `dense` is T, the others are coefficients.
template <class Real, std::size_t MaxPairs, class Dense>
strainwave::RippleCovariance<Real, MaxPairs> factored(const Dense& dense, std::size_t states) {
  constexpr std::size_t largest = 1 + 2 * MaxPairs;
  const std::size_t count = states - 1;
  const auto dense_index = [count](std::size_t i) { return i == count ? 0 : i + 1; };
  double lower[largest][largest] = {};
  double pivots[largest] = {};
  for (std::size_t j = 0; j <= count; ++j) {
    for (std::size_t i = j; i <= count; ++i) {
      double rest = dense[dense_index(i)][dense_index(j)];
      for (std::size_t k = 0; k < j; ++k) {
        rest -= lower[i][k] * lower[j][k] * pivots[k];
      }
      pivots[j] = i == j ? rest : pivots[j];
      lower[i][j] = rest / pivots[j];
    }
  }
  strainwave::RippleCovariance<Real, MaxPairs> p;
  for (std::size_t j = 0; j < count; ++j) {
    p.variances_Nm2[j] = static_cast<Real>(pivots[j]);
    p.torque_row[j] = static_cast<Real>(lower[count][j]);
    for (std::size_t i = j + 1; i < count; ++i) {
      strainwave::detail::column_of(p, j)[i - j - 1] = static_cast<Real>(lower[i][j]);
    }
  }
  p.torque_variance_Nm2 = static_cast<Real>(pivots[count]);
  return p;
}

inline std::uint32_t times(const strainwave::EventCounters& counters, strainwave::StatusFlag flag) {
  std::size_t bit = 0;
  while ((strainwave::mask(flag) >> bit) != 1U) {
    ++bit;
  }
  return counters.by_bit[bit];
}
