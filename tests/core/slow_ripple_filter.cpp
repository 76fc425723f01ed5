// 1e8 float samples (27.8 hours at 1 kHz) of cruising at steady and changing load, reversing,
// crawling, stopping and starting again, with load and speed terms: the torque stays with that of
// the same filter in double, and the covariance stays positive definite without being reset.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "ripple_examples.hpp"
#include "strainwave/ripple_filter.hpp"

namespace {

constexpr std::size_t max_pairs = 7;
constexpr double sample_period_s = 1e-3;

template <class Real>
using Config = strainwave::RippleFilterConfig<Real, max_pairs>;
template <class Real>
using State = strainwave::RippleFilterState<Real, max_pairs>;

/// Parts of the motor's day, by their place in part_names.
using Part = std::size_t;
constexpr Part cruise = 0;
constexpr Part reversals = 1;
constexpr Part crawl = 2;
constexpr Part stop_and_go = 3;
constexpr Part rest = 4;
constexpr std::size_t parts = 5;
constexpr const char* part_names[parts] = {"cruise", "reversals", "crawl", "stop and go", "rest"};

/// The motor's day in cycles of 200 s; every tenth cycle stands for 600 s more.
class Day {
 public:
  double speed_rad_s = 0.0;
  double torque_Nm = 0.0;  ///< true torque of the load
  Part part = cruise;

  void next() {
    const std::uint64_t length = cycle_ % 10 == 9 ? 800'000 : 200'000;
    set(static_cast<double>(at_) * sample_period_s);
    if (++at_ == length) {
      at_ = 0;
      ++cycle_;
    }
  }

 private:
  void set(double t) {
    // Three cycles in four bear one load for all of a cruise: the load pairs are then not seen.
    const double held_Nm = 4.0 * static_cast<double>(cycle_ % 7) - 12.0;
    torque_Nm = cycle_ % 4 == 3 ? 15.0 * std::sin(0.7 * t) : held_Nm;
    speed_rad_s = 0.0;
    if (t < 60.0) {
      part = cruise;
      const double sign = cycle_ % 2 == 0 ? 1.0 : -1.0;
      const double wave = cycle_ % 3 == 0 ? 0.0 : 40.0 * std::sin(0.3 * t);
      speed_rad_s = sign * std::min(1.0, t) * (156.0 + wave);
    } else if (t < 100.0) {
      part = reversals;
      speed_rad_s = 80.0 * std::cos(2.0 * (t - 60.0));
      torque_Nm += 5.0 * std::sin(3.0 * t);
    } else if (t < 120.0) {
      part = crawl;
      speed_rad_s = 0.004 * static_cast<double>(1U << (cycle_ % 12U));
    } else if (t < 140.0) {
      part = stop_and_go;
      speed_rad_s = std::fmod(t, 0.5) < 0.25 ? 20.0 : 0.0;
    } else {
      part = rest;
      torque_Nm = std::fmod(t, 20.0) < 10.0 ? held_Nm : held_Nm + 10.0;
    }
  }

  std::uint64_t at_ = 0;
  std::uint64_t cycle_ = 0;
};

/// Gaussian enough: the sum of four uniform numbers, unit variance.
class Noise {
 public:
  double next() {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      state_ ^= state_ << 13U;
      state_ ^= state_ >> 7U;
      state_ ^= state_ << 17U;
      sum += static_cast<double>(state_ >> 11U) * 0x1p-53;
    }
    return (sum - 2.0) * std::sqrt(3.0);
  }

 private:
  std::uint64_t state_ = 0x9E3779B97F4A7C15U;
};

struct Figures {
  double rms_Nm = 0.0;  ///< of torque in float less torque in double
  double part_rms_Nm[parts] = {};
  double largest_Nm = 0.0;
  double residual_rms_Nm = 0.0;  ///< true ripple less that of the double filter, cruising
  double smallest_pivot_Nm2 = INFINITY;
  double smallest_pivot_double_Nm2 = INFINITY;
  double largest_variance_Nm2 = 0.0;
  std::uint64_t not_positive = 0;
  std::uint32_t resets = 0;
  std::uint32_t resets_double = 0;
  std::uint32_t limited = 0;
  std::uint32_t at_rest = 0;
};

template <class Real>
std::uint32_t count_of(const State<Real>& state, strainwave::StatusFlag flag) {
  std::size_t bit = 0;
  while ((strainwave::mask(flag) >> bit) != 1U) {
    ++bit;
  }
  return state.counters.by_bit[bit];
}

Figures run(const Config<double>& config, std::uint64_t sample_count) {
  const Config<float> config_float = strainwave::converted<float, max_pairs>(config);
  State<double> reference = strainwave::initial_state(config);
  State<float> state = strainwave::initial_state(config_float);
  const std::size_t states = 1 + 2 * strainwave::pair_count(config);
  Day day;
  Noise noise;
  Figures figures;
  double angle_rad = 0.0;
  double square[parts] = {};
  std::uint64_t samples[parts] = {};
  double residual_square = 0.0;
  for (std::uint64_t k = 0; k < sample_count; ++k) {
    day.next();
    const double load = day.torque_Nm / 40.0;
    const double speed = std::fabs(day.speed_rad_s) / 150.0;
    const double ripple_Nm = (1.6 + 0.8 * load + 0.2 * speed) * std::cos(2.0 * angle_rad + 0.3) +
                             (0.6 - 0.3 * load + 0.1 * speed) * std::sin(4.0 * angle_rad) +
                             0.2 * std::cos(6 * angle_rad);
    const auto torque_Nm = static_cast<float>(day.torque_Nm + ripple_Nm + 0.04 * noise.next());
    const strainwave::Phase phase = strainwave::phase_from_radians(angle_rad);
    const auto single = strainwave::step(config_float, state,
                                         {.measured_torque_Nm = torque_Nm,
                                          .motor_phase = phase,
                                          .interval_s = static_cast<float>(sample_period_s)});
    const auto twice = strainwave::step(config, reference,
                                        {.measured_torque_Nm = static_cast<double>(torque_Nm),
                                         .motor_phase = phase,
                                         .interval_s = sample_period_s});
    const double deviation_Nm = static_cast<double>(single.torque_Nm) - twice.torque_Nm;
    figures.largest_Nm = std::max(figures.largest_Nm, std::fabs(deviation_Nm));
    square[day.part] += deviation_Nm * deviation_Nm;
    ++samples[day.part];
    if (day.part == cruise) {
      residual_square += (twice.ripple_Nm - ripple_Nm) * (twice.ripple_Nm - ripple_Nm);
    }
    angle_rad += day.speed_rad_s * sample_period_s;
    if (k % 997 == 0) {
      const double pivot_Nm2 = smallest_pivot(config_float, state);
      figures.not_positive += pivot_Nm2 > 0.0 ? 0U : 1U;
      figures.smallest_pivot_Nm2 = std::min(figures.smallest_pivot_Nm2, pivot_Nm2);
      figures.smallest_pivot_double_Nm2 =
          std::min(figures.smallest_pivot_double_Nm2, smallest_pivot(config, reference));
      for (std::size_t i = 1; i < states; ++i) {
        figures.largest_variance_Nm2 = std::max(
            figures.largest_variance_Nm2,
            static_cast<double>(strainwave::detail::element_of(state.covariance, i - 1, i - 1)));
      }
    }
  }
  double sum = 0.0;
  for (std::size_t part = 0; part < parts; ++part) {
    sum += square[part];
    figures.part_rms_Nm[part] = std::sqrt(square[part] / static_cast<double>(samples[part]));
  }
  figures.rms_Nm = std::sqrt(sum / static_cast<double>(sample_count));
  figures.residual_rms_Nm = std::sqrt(residual_square / static_cast<double>(samples[cruise]));
  figures.resets = count_of(state, strainwave::StatusFlag::covariance_reset);
  figures.resets_double = count_of(reference, strainwave::StatusFlag::covariance_reset);
  figures.limited = count_of(state, strainwave::StatusFlag::variance_limited);
  figures.at_rest = count_of(state, strainwave::StatusFlag::at_rest);
  std::printf(
      "|float - double|: rms %.3g Nm, largest %.3g Nm; residual rms while cruising %.4g Nm\n"
      "smallest pivot %.4g Nm^2 (double %.4g), not positive definite %llu, resets %u (double %u), "
      "limited %u, at rest %u, largest variance %.4g Nm^2\n",
      figures.rms_Nm, figures.largest_Nm, figures.residual_rms_Nm, figures.smallest_pivot_Nm2,
      figures.smallest_pivot_double_Nm2, static_cast<unsigned long long>(figures.not_positive),
      figures.resets, figures.resets_double, figures.limited, figures.at_rest,
      figures.largest_variance_Nm2);
  for (std::size_t part = 0; part < parts; ++part) {
    std::printf("  %s: rms %.3g Nm\n", part_names[part], figures.part_rms_Nm[part]);
  }
  return figures;
}

Config<double> seven_pairs() {
  Config<double> config;
  config.order_count = 3;
  config.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
  config.orders[1] = {.order = {4, 1}, .with_load = true, .with_speed = true};
  config.orders[2] = {.order = {6, 1}};
  return config;
}

void expect_float_holds(const Figures& figures, std::uint64_t sample_count) {
  EXPECT_LT(figures.rms_Nm, 5e-5);
  EXPECT_GT(figures.rms_Nm, 1e-8);  // they are two filters
  EXPECT_EQ(figures.not_positive, 0U);
  EXPECT_GT(figures.smallest_pivot_Nm2, 0.0);
  EXPECT_LE(figures.largest_variance_Nm2, 4.0 * (1.0 + 1e-5));
  EXPECT_EQ(figures.resets, 0U);
  EXPECT_EQ(figures.resets_double, 0U);
  EXPECT_GT(figures.at_rest, sample_count / 4);  // the runs do stand and crawl
  EXPECT_LT(figures.residual_rms_Nm, 0.1);       // the first cruise back finds the direction anew
  EXPECT_GT(figures.residual_rms_Nm, 0.002);
}

TEST(RippleFilterSlow, FloatStaysWithDoubleOver1e8Samples) {
  constexpr std::uint64_t sample_count = 100'000'000;
  const Config<double> config = seven_pairs();
  ASSERT_EQ(strainwave::pair_count(config), max_pairs);
  ASSERT_TRUE(check(config).ok());
  const Figures figures = run(config, sample_count);
  expect_float_holds(figures, sample_count);
  EXPECT_LT(figures.largest_Nm, 1e-3);
}

TEST(RippleFilterSlow, FloatStaysWithDoubleWithDirectionTermsAndALongMemory) {
  constexpr std::uint64_t sample_count = 8'000'000;
  for (const int memory_turns : {10, 30, 100}) {
    for (const bool with_load : {false, true}) {
      Config<double> config = seven_pairs();
      for (std::size_t a = 0; a < 2; ++a) {
        config.orders[a].with_load = with_load;
        config.orders[a].with_speed = false;
        config.orders[a].with_direction = true;
      }
      config.memory_turns = memory_turns;
      SCOPED_TRACE(memory_turns);
      std::printf("memory %d turns, direction terms%s\n", memory_turns,
                  with_load ? " and load terms" : "");
      expect_float_holds(run(config, sample_count), sample_count);
    }
  }
}

}  // namespace
