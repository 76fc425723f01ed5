// Hours of sound gauges: how often one is taken for lost.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "gauge_examples.hpp"
#include "strainwave/gauge_monitor.hpp"

namespace {

using gauge_examples::gauge_count;

/// Losses and doubted samples in so many samples at 1 kHz of a joint that cruises, reverses, rests
/// and changes its load, with gauges whose wave grows with the load as far as the limit allows.
struct Doubts {
  int losses = 0;
  int samples = 0;
};

template <class Real>
Doubts doubts_of(gauge_examples::Joint<Real>& joint, std::int64_t samples) {
  Doubts doubts;
  for (std::int64_t i = 0; i < samples; ++i) {
    const std::int64_t phase = i % 60000;
    const double cruise_rad_s = 150.0 * std::sin(static_cast<double>(i) * 1e-4);
    joint.speed_rad_s = phase < 20000 ? 0.0 : cruise_rad_s;
    joint.torque_Nm = 30.0 * std::sin(static_cast<double>(i) * 3.7e-3);
    joint.advance();
    // The limit grows by 0.02 sqrt(5) a volt of torque, the wave's length by sqrt(5/2) of this.
    const double grown = 1 + 0.025 * std::abs(joint.torque_Nm) / 10 / gauge_examples::amplitude_V;
    Real volts[gauge_count] = {};
    for (std::size_t j = 0; j < gauge_count; ++j) {
      const double wave_V = joint.volts(j) - joint.torque_Nm / 10;
      joint.sample.codes[j] =
          joint.code(joint.torque_Nm / 10 + grown * wave_V + 0.001 * joint.noise.next());
      volts[j] = to_volts(joint.config.converter, joint.sample.codes[j]);
    }
    strainwave::GaugeSignals<Real> signals;
    signals.count = gauge_count;
    signals.codes = joint.sample.codes;
    signals.volts = volts;
    signals.motor_phase = joint.sample.motor_phase;
    const auto verdict =
        watch(joint.config.monitor, joint.state.monitor, joint.config.converter, signals);
    doubts.samples += verdict.left_out != 0 ? 1 : 0;
    if (joint.state.monitor.lost_gauge != 0) {
      ++doubts.losses;
      clear_lost_gauge(joint.state.monitor);
    }
  }
  return doubts;
}

constexpr std::int64_t an_hour = 3600000;

TEST(SlowGaugeMonitor, NoFalseLossIn24HoursOfMotionLoadAndRest) {
  gauge_examples::Joint<float> joint;
  const Doubts doubts = doubts_of(joint, 24 * an_hour);
  EXPECT_EQ(doubts.losses, 0);
  EXPECT_EQ(doubts.samples, 0);
}

TEST(SlowGaugeMonitor, FiveEqualCodesInARowAreAsRareAsNoiseMakesThem) {
  // A run of six equal codes begins where the code before is another one: sum_c P(c)^6 (1 - P(c)).
  // P is that of the generator, the sum of twelve even numbers: a normal distribution with an
  // excess of -0.1, by Edgeworth's expansion.
  gauge_examples::Joint<double> joint;
  joint.config.monitor.stuck_samples = 5;
  joint.config.monitor.consistency.samples = 0;
  joint.speed_rad_s = 0;
  int losses = 0;
  const std::int64_t samples = 2 * an_hour;
  for (std::int64_t i = 0; i < samples; ++i) {
    joint.advance();
    double volts[gauge_count] = {};
    for (std::size_t j = 0; j < gauge_count; ++j) {
      volts[j] = to_volts(joint.config.converter, joint.sample.codes[j]);
    }
    strainwave::GaugeSignals<double> signals;
    signals.count = gauge_count;
    signals.codes = joint.sample.codes;
    signals.volts = volts;
    signals.motor_phase = joint.sample.motor_phase;
    (void)watch(joint.config.monitor, joint.state.monitor, joint.config.converter, signals);
    if (joint.state.monitor.lost_gauge != 0) {
      ++losses;
      clear_lost_gauge(joint.state.monitor);
    }
  }
  const double sigma_steps = 0.001 / (20.0 / 65536.0);
  double share = 0;
  for (int code = -30; code <= 30; ++code) {
    const double x = code / sigma_steps;
    const double normal = std::exp(-x * x / 2) / std::sqrt(2 * gauge_examples::pi) / sigma_steps;
    const double probability = normal * (1 - 0.1 / 24 * (x * x * x * x - 6 * x * x + 3));
    share += std::pow(probability, 6) * (1 - probability);
  }
  const double expected = static_cast<double>(samples) * gauge_count * share;
  EXPECT_NEAR(losses, expected, 3 * std::sqrt(expected)) << expected;
}

}  // namespace
