#include "strainwave/gauge_consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "gauge_examples.hpp"

namespace {

using gauge_examples::five_gauges;
using gauge_examples::gauge_count;
using gauge_examples::Noise;
using strainwave::detail::Disagreement;

using Check = strainwave::ConsistencyCheck<double, gauge_count>;

/// Without a wave to predict: the signals are what is left.
Check without_wave(std::size_t direction_count) {
  Check check = five_gauges<double>().monitor.consistency;
  check.harmonic_count = 0;
  check.direction_count = direction_count;
  for (std::size_t j = 0; j < gauge_count; ++j) {
    check.directions[1][j] = std::sqrt(0.4) * std::cos(gauge_examples::phase_rad(j));
    check.directions[2][j] = std::sqrt(0.4) * std::sin(gauge_examples::phase_rad(j));
  }
  return check;
}

Disagreement find(const Check& check, std::uint8_t lost_gauge, std::size_t suspect,
                  const double* volts) {
  strainwave::GaugeSignals<double> signals;
  signals.count = gauge_count;
  signals.volts = volts;
  return strainwave::detail::find_inconsistent(check, lost_gauge, suspect, signals, 0.0);
}

/// What is left of the signals beside the directions and the errors of some gauges, by
/// Gram-Schmidt on all of them: length squared, and length along the torque without these gauges.
struct Left {
  double squared_V2 = 0;
  double torque_V = 0;
};

Left left_without(const Check& check, const double* volts, const bool* left_out) {
  double basis[2 * gauge_count][gauge_count] = {};
  std::size_t count = 0;
  double rest[gauge_count] = {};
  const auto take_out = [&](const double* vector) {
    double next[gauge_count];
    double length = 0;
    for (std::size_t j = 0; j < gauge_count; ++j) {
      next[j] = vector[j];
    }
    for (std::size_t b = 0; b < count; ++b) {
      double along = 0;
      for (std::size_t j = 0; j < gauge_count; ++j) {
        along += basis[b][j] * next[j];
      }
      for (std::size_t j = 0; j < gauge_count; ++j) {
        next[j] -= along * basis[b][j];
      }
    }
    for (const double each : next) {
      length += each * each;
    }
    for (std::size_t j = 0; j < gauge_count; ++j) {
      basis[count][j] = next[j] / std::sqrt(length);
    }
    ++count;
  };
  for (std::size_t j = 0; j < gauge_count; ++j) {
    double unit[gauge_count] = {};
    unit[j] = 1;
    if (left_out[j]) {
      take_out(unit);
    }
  }
  for (std::size_t d = check.direction_count; d-- > 0;) {  // the torque's last
    take_out(check.directions[d]);
  }
  for (std::size_t j = 0; j < gauge_count; ++j) {
    rest[j] = volts[j];
  }
  double along = 0;
  for (std::size_t b = 0; b < count; ++b) {
    along = 0;
    for (std::size_t j = 0; j < gauge_count; ++j) {
      along += basis[b][j] * rest[j];
    }
    for (std::size_t j = 0; j < gauge_count; ++j) {
      rest[j] -= along * basis[b][j];
    }
  }
  Left left;
  for (const double each : rest) {
    left.squared_V2 += each * each;
  }
  // Least squares: the torque's part of the signals over that of its direction.
  double length = 0;
  for (std::size_t j = 0; j < gauge_count; ++j) {
    length += basis[count - 1][j] * check.directions[0][j];
  }
  left.torque_V = along / length;
  return left;
}

/// The same decision by trying each gauge.
Disagreement by_trying(const Check& check, std::uint8_t lost_gauge, const double* volts) {
  bool left_out[gauge_count] = {};
  if (lost_gauge > 0) {
    left_out[lost_gauge - 1] = true;
  }
  const Left before = left_without(check, volts, left_out);
  Left best{std::numeric_limits<double>::infinity(), 0};
  std::size_t gauge = gauge_count;
  for (std::size_t j = 0; j < gauge_count; ++j) {
    if (j + 1 != lost_gauge) {
      left_out[j] = true;
      const Left left = left_without(check, volts, left_out);
      if (left.squared_V2 < best.squared_V2) {
        best = left;
        gauge = j;
      }
      left_out[j] = false;
    }
  }
  const double limit_V = check.limit_V + check.limit_per_V * std::abs(best.torque_V);
  if (before.squared_V2 <= limit_V * limit_V) {
    return {gauge_count, false};
  }
  if (best.squared_V2 > limit_V * limit_V) {
    return {gauge_count, true};
  }
  return {gauge, false};
}

TEST(GaugeConsistency, DecidesAsTryingEachGaugeDoes) {
  Noise noise;
  int single = 0;
  int several = 0;
  int sound = 0;
  for (int i = 0; i < 30000; ++i) {
    const auto lost_gauge = static_cast<std::uint8_t>(noise.bits() % (gauge_count + 1));
    // One direction leaves room beside a lost gauge; three do only where none is lost.
    Check check = without_wave(lost_gauge == 0 && i % 2 == 0 ? 3 : 1);
    if (lost_gauge > 0) {
      check.limit_per_V = 0;  // the torque of the others is then an approximation
    }
    double volts[gauge_count];
    for (double& each : volts) {
      each = noise.next() * (i % 3 == 0 ? 0.03 : 0.005);
    }
    const double torque_V = 5 * noise.next();
    for (std::size_t j = 0; j < gauge_count; ++j) {
      volts[j] += torque_V * check.directions[0][j];
    }
    if (i % 4 != 0) {
      volts[noise.bits() % gauge_count] += 0.3 * noise.next();
    }
    const Disagreement found = find(check, lost_gauge, gauge_count, volts);
    const Disagreement expected = by_trying(check, lost_gauge, volts);
    ASSERT_EQ(found.gauge, expected.gauge) << i;
    ASSERT_EQ(found.several, expected.several) << i;
    single += found.gauge < gauge_count ? 1 : 0;
    several += found.several ? 1 : 0;
    sound += found.gauge == gauge_count && !found.several ? 1 : 0;
  }
  EXPECT_GT(single, 3000);
  EXPECT_GT(several, 1000);
  EXPECT_GT(sound, 3000);
}

TEST(GaugeConsistency, TheSuspectIsBlamedWhereItExplainsWhatIsLeft) {
  Check check = without_wave(1);
  check.limit_per_V = 0;
  // An error of 1 V at gauge 1 leaves 0.8 V^2; without gauge 0 still 0.75, without gauge 1 nothing.
  const double volts[gauge_count] = {0, 1, 0, 0, 0};
  check.limit_V = std::sqrt(0.77);
  EXPECT_EQ(find(check, 0, gauge_count, volts).gauge, 1U);
  EXPECT_EQ(find(check, 0, 0, volts).gauge, 0U);
  check.limit_V = std::sqrt(0.73);  // gauge 0 does not explain it
  EXPECT_EQ(find(check, 0, 0, volts).gauge, 1U);
  check.limit_V = std::sqrt(0.83);
  EXPECT_EQ(find(check, 0, 0, volts).gauge, gauge_count);
  EXPECT_FALSE(find(check, 0, 0, volts).several);
}

}  // namespace
