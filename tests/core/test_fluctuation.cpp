#include "strainwave/fluctuation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "strainwave/gear.hpp"

namespace {

using strainwave::GaugeFluctuation;
using strainwave::Phase;
using strainwave::Rational;
using strainwave::signal_fluctuation;

const double pi = std::acos(-1.0);

template <class Real>
GaugeFluctuation<Real, 4> gauge_at(double degrees, double a, double b, Rational m) {
  GaugeFluctuation<Real, 4> gauge;
  gauge.harmonic_count = 2;
  gauge.harmonics[0] = {static_cast<Real>(a), Real(0)};
  gauge.harmonics[1] = {static_cast<Real>(b), Real(0)};
  gauge.position_rad = static_cast<Real>(degrees * pi / 180.0);
  gauge.wave_factor = m;
  return gauge;
}

/// Angles over several turns, also backwards, as phases and in rad.
struct Angle {
  explicit Angle(int k)
      : phase(strainwave::phase_from_radians(0.37 * k)),
        beta_rad(strainwave::to_radians<double>(phase)) {}
  Phase phase;
  double beta_rad;
};

template <class Real>
class Fluctuation : public testing::Test {
 protected:
  static constexpr double tolerance = sizeof(Real) == 4 ? 1.5e-6 : 2e-7;
  static void expect_near(Real value, double expected) {
    // A phase has units of 1.5e-9 rad, and an order of it less than ten of them.
    EXPECT_NEAR(static_cast<double>(value), expected, sizeof(Real) == 4 ? 1.5e-6 : 2e-8);
  }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Fluctuation, Precisions);

TYPED_TEST(Fluctuation, TwoGaugesAtNinetyDegrees) {  // Godler 2000, eq. (3); T&B 1999, eq. (2), (3)
  for (const Rational m : {Rational{1, 1}, Rational{51, 50}, Rational{243, 241}}) {
    const auto factor = strainwave::to_real<double>(m);
    const auto first = gauge_at<TypeParam>(0, 1.3, 0, m);
    const auto second = gauge_at<TypeParam>(90, 1.3, 0, m);
    for (int k = -300; k < 300; ++k) {
      const Angle angle(k);
      const double wave = 1.3 * std::sin(2.0 * factor * angle.beta_rad);
      this->expect_near(signal_fluctuation(first, angle.phase), wave);
      this->expect_near(signal_fluctuation(second, angle.phase), -wave);
    }
  }
}

TYPED_TEST(Fluctuation, SecondHarmonicIsInPhaseAtNinetyDegrees) {  // Godler 2000, eq. (4)
  const auto first = gauge_at<TypeParam>(0, 1.0, 0.05, {101, 100});
  const auto second = gauge_at<TypeParam>(90, 1.0, 0.05, {101, 100});
  for (int k = -300; k < 300; ++k) {
    const Angle angle(k);
    const double wave = 2.02 * angle.beta_rad;
    this->expect_near(signal_fluctuation(first, angle.phase),
                      std::sin(wave) + 0.05 * std::sin(2 * wave));
    this->expect_near(signal_fluctuation(second, angle.phase),
                      -std::sin(wave) + 0.05 * std::sin(2 * wave));
    this->expect_near(
        signal_fluctuation(first, angle.phase) + signal_fluctuation(second, angle.phase),
        0.1 * std::sin(2 * wave));
  }
}

TYPED_TEST(Fluctuation, FourGaugesAtFortyFiveDegrees) {  // Godler 2000, eq. (5)
  const double positions[4] = {0, 90, 45, 135};
  for (int k = -300; k < 300; ++k) {
    const Angle angle(k);
    const double wave = 2.0 * 1.02 * angle.beta_rad;
    const double a = 1.0;
    const double b = 0.25;
    const double expected[4] = {
        a * std::sin(wave) + b * std::sin(2 * wave), -a * std::sin(wave) + b * std::sin(2 * wave),
        a * std::cos(wave) - b * std::sin(2 * wave), -a * std::cos(wave) - b * std::sin(2 * wave)};
    double sum = 0.0;
    for (int j = 0; j < 4; ++j) {
      const TypeParam signal =
          signal_fluctuation(gauge_at<TypeParam>(positions[j], a, b, {51, 50}), angle.phase);
      this->expect_near(signal, expected[j]);
      sum += static_cast<double>(signal);
    }
    EXPECT_NEAR(sum, 0.0, 4 * this->tolerance);
  }
}

TYPED_TEST(Fluctuation, GeneralFormWithPhaseErrors) {  // Godler 2000, eq. (6)
  GaugeFluctuation<TypeParam, 4> gauge;
  gauge.harmonic_count = 4;
  const double amplitudes[4] = {1.0, 0.3, -0.2, 0.1};
  const double errors[4] = {0.2, -1.4, 2.9, -7.5};
  for (int i = 0; i < 4; ++i) {
    gauge.harmonics[i] = {static_cast<TypeParam>(amplitudes[i]), static_cast<TypeParam>(errors[i])};
  }
  gauge.position_rad = strainwave::equally_spaced_position_rad<TypeParam>(4, 5);
  gauge.wave_factor = {162, 161};
  for (int k = -300; k < 300; ++k) {
    const Angle angle(k);
    double expected = 0.0;
    for (int i = 1; i <= 4; ++i) {
      expected +=
          amplitudes[i - 1] *
          std::sin(2.0 * i * (162.0 / 161.0 * angle.beta_rad + pi * 3.0 / 5.0) + errors[i - 1]);
    }
    EXPECT_NEAR(static_cast<double>(signal_fluctuation(gauge, angle.phase)), expected,
                sizeof(TypeParam) == 4 ? 4e-6 : 3e-8);
  }
}

/// Largest |sum_j e_j| of ideal gauges over a turn of the wave.
double largest_sum(std::size_t gauges, std::size_t harmonic) {
  double largest = 0.0;
  for (int k = 0; k < 720; ++k) {
    double sum = 0.0;
    for (std::size_t j = 1; j <= gauges; ++j) {
      GaugeFluctuation<double, 8> gauge;
      gauge.harmonic_count = harmonic;
      gauge.harmonics[harmonic - 1] = {1.0, 0.0};
      gauge.position_rad = strainwave::equally_spaced_position_rad<double>(j, gauges);
      gauge.wave_factor = {51, 50};
      sum += signal_fluctuation(gauge, strainwave::phase_from_turns(k / 720.0));
    }
    largest = std::fmax(largest, std::fabs(sum));
  }
  return largest;
}

TEST(Fluctuation, IdealGaugesSumToZeroUnlessTheHarmonicIsAMultiple) {  // Godler 2000, eq. (7)
  for (std::size_t gauges = 2; gauges <= 7; ++gauges) {
    for (std::size_t harmonic = 1; harmonic <= 8; ++harmonic) {
      // Harmonics i = k M are in phase on all gauges: they look like torque.
      const double expected = harmonic % gauges == 0 ? static_cast<double>(gauges) : 0.0;
      EXPECT_NEAR(largest_sum(gauges, harmonic), expected, expected * 3e-4 + 1e-7);
    }
  }
}

TEST(Fluctuation, FactorMAtThePositionAsPrintedLeavesSevenPercent) {
  // Godler 2000, eq. (6) as printed: m multiplies the position too.  Three ideal gauges, R = 50.
  double printed = 0.0;
  double read = 0.0;
  const double m = 51.0 / 50.0;
  for (int k = 0; k < 3600; ++k) {
    const double beta_rad = 2.0 * pi * k / 3600.0;
    double as_printed = 0.0;
    double as_read = 0.0;
    for (int j = 1; j <= 3; ++j) {
      const double position_rad = pi * (j - 1) / 3.0;
      as_printed += std::sin(2.0 * m * (beta_rad + position_rad));
      GaugeFluctuation<double, 1> gauge;
      gauge.harmonics[0] = {1.0, 0.0};
      gauge.position_rad =
          strainwave::equally_spaced_position_rad<double>(static_cast<std::size_t>(j), 3);
      gauge.wave_factor = {51, 50};
      as_read += signal_fluctuation(gauge, strainwave::phase_from_radians(beta_rad));
    }
    printed = std::fmax(printed, std::fabs(as_printed));
    read = std::fmax(read, std::fabs(as_read));
  }
  EXPECT_NEAR(printed, 0.072, 0.001);
  EXPECT_LT(read, 1e-7);
}

TYPED_TEST(Fluctuation, PhasorIsTheSignalsFourierCoefficient) {  // Godler 2000, eq. (8)
  GaugeFluctuation<TypeParam, 2> gauge;
  gauge.harmonic_count = 2;
  gauge.harmonics[0] = {TypeParam(1.07), TypeParam(-0.4)};
  gauge.harmonics[1] = {TypeParam(0.21), TypeParam(1.1)};
  gauge.position_rad = TypeParam(0.9);
  const int count = 64;
  for (std::size_t i = 0; i < 2; ++i) {
    double of_sine = 0.0;
    double of_cosine = 0.0;
    for (int k = 0; k < count; ++k) {
      const double turns = k / static_cast<double>(count);
      const auto signal =
          static_cast<double>(signal_fluctuation(gauge, strainwave::phase_from_turns(turns)));
      const double angle = 2.0 * static_cast<double>(i + 1) * 2.0 * pi * turns;
      of_sine += 2.0 / count * signal * std::sin(angle);
      of_cosine += 2.0 / count * signal * std::cos(angle);
    }
    const auto phasor = strainwave::fluctuation_phasor(gauge, i);
    EXPECT_NEAR(static_cast<double>(phasor.cosine), of_sine, this->tolerance);
    EXPECT_NEAR(static_cast<double>(phasor.sine), of_cosine, this->tolerance);
  }
}

TEST(Fluctuation, StaysInPhaseAfterAYearAt3000Rpm) {
  const auto gauge = gauge_at<float>(0, 1.0, 0.0, {101, 100});
  const std::int64_t year = std::int64_t{365} * 24 * 60 * 3000;  // a multiple of 100 turns
  for (const std::uint32_t fraction : {0U, 12345678U, 0x40000000U, 0xFFFFFFFFU}) {
    EXPECT_EQ(signal_fluctuation(gauge, {year, fraction}),
              signal_fluctuation(gauge, {0, fraction}));
  }
}

TYPED_TEST(Fluctuation, CheckAcceptsWhatTheModelTakes) {
  EXPECT_TRUE(check(GaugeFluctuation<TypeParam, 4>{}).ok());
  auto gauge = gauge_at<TypeParam>(-720, -1.3, 0, {51, 50});
  gauge.harmonic_count = 4;
  EXPECT_TRUE(check(gauge).ok());
  gauge.harmonic_count = 1;
  gauge.harmonics[1].amplitude = std::numeric_limits<TypeParam>::quiet_NaN();  // not in use
  EXPECT_TRUE(check(gauge).ok());
}

TYPED_TEST(Fluctuation, CheckNamesWhatIsWrong) {
  const auto expect = [](auto change, const char* parameter, int index) {
    auto gauge = gauge_at<TypeParam>(45, 1.3, 0.2, {51, 50});
    change(gauge);
    const auto violation = check(gauge);
    ASSERT_FALSE(violation.ok()) << parameter;
    EXPECT_STREQ(violation.parameter, parameter);
    EXPECT_EQ(violation.index, index);
  };
  const TypeParam nan = std::numeric_limits<TypeParam>::quiet_NaN();
  const TypeParam infinity = std::numeric_limits<TypeParam>::infinity();
  expect([](auto& gauge) { gauge.harmonic_count = 0; }, "harmonic_count", -1);
  expect([](auto& gauge) { gauge.harmonic_count = 5; }, "harmonic_count", -1);
  expect([&](auto& gauge) { gauge.harmonics[1].amplitude = infinity; }, "amplitudes", 1);
  expect([&](auto& gauge) { gauge.harmonics[0].phase_error_rad = nan; }, "phase_errors_rad", 0);
  expect([](auto& gauge) { gauge.harmonics[1].phase_error_rad = TypeParam(1e13); },
         "phase_errors_rad", 1);
  expect([](auto& gauge) { gauge.position_rad = TypeParam(-1e13); }, "position_rad", -1);
  expect([](auto& gauge) { gauge.wave_factor = {0, 1}; }, "wave_factor", -1);
  expect([](auto& gauge) { gauge.wave_factor = {1, 0x80000000U}; }, "wave_factor", -1);
}

static_assert(check(GaugeFluctuation<float, 1>{}).ok(), "checked while compiling");

}  // namespace
