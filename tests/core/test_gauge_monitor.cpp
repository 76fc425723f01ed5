#include "strainwave/gauge_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "gauge_examples.hpp"
#include "strainwave/torque_sensor.hpp"

namespace {

using gauge_examples::detection_samples;
using gauge_examples::five_gauges;
using gauge_examples::gauge_count;
using gauge_examples::Joint;
using gauge_examples::Noise;
using gauge_examples::phase_rad;
using gauge_examples::pi;
using strainwave::GaugeFault;
using strainwave::GaugeVerdict;
using strainwave::has;
using strainwave::mask;
using strainwave::StatusFlag;

template <class Real>
class GaugeMonitor : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GaugeMonitor, Precisions);

constexpr GaugeFault all_faults[] = {GaugeFault::open, GaugeFault::shorted, GaugeFault::stuck,
                                     GaugeFault::saturated, GaugeFault::inconsistent};

static_assert(!strainwave::GaugeMonitorConfig<float, 5>{}.active);
static_assert(check(strainwave::GaugeMonitorConfig<float, 5>{}, 5).ok());
static_assert(static_cast<int>(GaugeFault::inconsistent) == 5);

TYPED_TEST(GaugeMonitor, ExampleIsAValidConfiguration) {
  EXPECT_TRUE(check(five_gauges<TypeParam>()).ok());
}

TYPED_TEST(GaugeMonitor, SoundGaugesAreLeftInPeaceAndReadAsWithoutMonitor) {
  Joint<TypeParam> joint;
  auto unwatched = joint.config;
  unwatched.monitor.active = false;
  auto state = strainwave::initial_state(unwatched);
  for (int i = 0; i < 30000; ++i) {
    joint.speed_rad_s = i % 6000 < 1000 ? 0.0 : 150.0 * std::sin(i * 2e-4);
    joint.torque_Nm = i % 900 < 450 ? 12.0 : -20.0;
    joint.advance();
    const auto watched = joint.take();
    const auto plain = strainwave::step(unwatched, state, joint.sample);
    ASSERT_EQ(watched.status, plain.status) << i;
    ASSERT_EQ(watched.torque_Nm, plain.torque_Nm) << i;
    ASSERT_EQ(watched.torque_measured_Nm, plain.torque_measured_Nm) << i;
    ASSERT_EQ(watched.left_out_gauge, 0) << i;
  }
  EXPECT_EQ(joint.state.monitor.lost_gauge, 0);
}

TYPED_TEST(GaugeMonitor, FindsEveryFaultOfEveryGaugeInMotion) {
  for (const GaugeFault fault : all_faults) {
    for (std::size_t j = 0; j < gauge_count; ++j) {
      Joint<TypeParam> joint;
      ASSERT_EQ(joint.run(500), 0);
      const auto before = joint.sample.codes[j];
      int found_after = 0;
      for (int i = 1; i <= 200 && found_after == 0; ++i) {
        joint.advance();
        joint.fail(j, fault, before);
        const auto reading = joint.take();
        ASSERT_EQ(reading.status & strainwave::fault_mask, 0U);
        // An error e of one gauge leaves e sqrt(4/5) beside the torque, where the limit is 0.05 V +
        // 0.02 x 1.2 V sqrt(5) = 0.104 V: what is not seen is up to 0.116 V, 0.233 Nm, and noise.
        EXPECT_NEAR(reading.torque_measured_Nm, joint.torque_Nm, 0.233 + 0.01);
        if (has(reading.status, StatusFlag::gauge_lost)) {
          found_after = i;
          EXPECT_EQ(reading.left_out_gauge, j + 1);
          EXPECT_EQ(reading.gauge_fault, fault) << "gauge " << j;
          EXPECT_NEAR(reading.residual_fluctuation_Nm, 0.02 * static_cast<double>(j + 1), 1e-6);
        }
      }
      // A signal that agrees by chance delays it: a wave of this speed lasts 157 samples.
      EXPECT_GE(found_after, static_cast<int>(detection_samples));
      EXPECT_LE(found_after, 80) << "gauge " << j << ", fault " << static_cast<int>(fault);
    }
  }
}

TYPED_TEST(GaugeMonitor, FindsAtRestWhatIsBeyondTheLimit) {
  for (const GaugeFault fault : all_faults) {
    Joint<TypeParam> joint;
    joint.speed_rad_s = 0;
    ASSERT_EQ(joint.run(500), 0);
    const auto before = joint.sample.codes[0];  // 1.54 V
    int found_after = 0;
    for (int i = 1; i <= 30 && found_after == 0; ++i) {
      joint.advance();
      joint.fail(0, fault, before);
      found_after = has(joint.take().status, StatusFlag::gauge_lost) ? i : 0;
    }
    EXPECT_GE(found_after, static_cast<int>(detection_samples));
    EXPECT_LE(found_after, 12);
    EXPECT_EQ(joint.state.monitor.fault, fault);
  }
}

TYPED_TEST(GaugeMonitor, LeavesAGaugeOutFromTheFirstWrongSampleAndTakesItBack) {
  Joint<TypeParam> joint;
  ASSERT_EQ(joint.run(100), 0);
  for (std::uint32_t i = 1; i < detection_samples; ++i) {
    joint.advance();
    joint.fail(2, GaugeFault::open, {});
    const auto reading = joint.take();
    EXPECT_EQ(reading.left_out_gauge, 3);
    EXPECT_EQ(reading.gauge_fault, GaugeFault::none);
    EXPECT_EQ(reading.status & ~mask(StatusFlag::at_rest), mask(StatusFlag::gauge_suspected));
    EXPECT_NEAR(reading.torque_measured_Nm, joint.torque_Nm, 0.01);
  }
  ASSERT_EQ(joint.run(100), 0);
  EXPECT_EQ(joint.state.monitor.lost_gauge, 0);
}

TYPED_TEST(GaugeMonitor, ALostGaugeStaysLostUntilCleared) {
  Joint<TypeParam> joint;
  ASSERT_EQ(joint.run(100), 0);
  for (std::uint32_t i = 0; i < detection_samples; ++i) {
    joint.advance();
    joint.fail(4, GaugeFault::saturated, {});
    (void)joint.take();
  }
  for (int i = 0; i < 1000; ++i) {
    const auto reading = joint.next();
    ASSERT_EQ(reading.left_out_gauge, 5);
    ASSERT_TRUE(has(reading.status, StatusFlag::gauge_lost));
    ASSERT_FALSE(has(reading.status, StatusFlag::gauge_suspected));
    ASSERT_EQ(reading.gauge_fault, GaugeFault::saturated);
  }
  clear_lost_gauge(joint.state.monitor);
  ASSERT_EQ(joint.run(100), 0);
}

TYPED_TEST(GaugeMonitor, ARailInsideTheConvertersRangeIsARail) {
  for (const double rail_V : {9.2, -9.2}) {
    Joint<TypeParam> joint;
    joint.config.monitor.lowest_V = TypeParam(-9);
    joint.config.monitor.highest_V = TypeParam(9);
    joint.config.monitor.consistency.samples = 0;
    ASSERT_EQ(joint.run(100), 0);
    for (std::uint32_t i = 1; i <= detection_samples; ++i) {
      joint.advance();
      joint.sample.codes[1] = joint.code(rail_V);
      const auto reading = joint.take();
      EXPECT_EQ(reading.left_out_gauge, 2);
      EXPECT_EQ(has(reading.status, StatusFlag::gauge_lost), i == detection_samples);
    }
    EXPECT_EQ(joint.state.monitor.fault, rail_V > 0 ? GaugeFault::open : GaugeFault::saturated);
  }
}

TYPED_TEST(GaugeMonitor, CodesAtTheEndsNeedNotBeCountedBeforehand) {
  Joint<TypeParam> joint;
  auto other = joint.state.monitor;
  for (int i = 0; i < 2000; ++i) {
    joint.advance();
    if (i % 50 > 20) {
      joint.fail(i % 3 == 0 ? 3 : 1, i % 7 == 0 ? GaugeFault::open : GaugeFault::saturated, {});
    }
    if (i % 200 == 0) {
      clear_lost_gauge(joint.state.monitor);
      clear_lost_gauge(other);
    }
    TypeParam volts[gauge_count] = {};
    strainwave::GaugeSignals<TypeParam> signals;
    signals.count = gauge_count;
    signals.codes = joint.sample.codes;
    signals.volts = volts;
    signals.motor_phase = joint.sample.motor_phase;
    std::size_t at_end = 0;
    for (std::size_t j = 0; j < gauge_count; ++j) {
      volts[j] = to_volts(joint.config.converter, joint.sample.codes[j]);
      at_end += is_saturated(joint.config.converter, joint.sample.codes[j]) ? 1U : 0U;
    }
    const auto& config = joint.config;
    const auto uncounted = watch(config.monitor, other, config.converter, signals);
    signals.at_end = at_end;
    const auto counted = watch(config.monitor, joint.state.monitor, config.converter, signals);
    ASSERT_EQ(counted.left_out, uncounted.left_out) << i;
    ASSERT_EQ(counted.status, uncounted.status) << i;
  }
  EXPECT_EQ(joint.state.monitor.lost_gauge, other.lost_gauge);
}

TYPED_TEST(GaugeMonitor, ZerosOfTheGaugesGoWithTheGains) {
  Joint<TypeParam> joint;
  auto& monitor = joint.config.monitor;
  const double zeros_V[] = {0.3, -0.2, 0.1, 0.25, -0.4};
  double sum_V = 0;
  for (std::size_t j = 0; j < gauge_count; ++j) {
    monitor.consistency.zero_V[j] = static_cast<TypeParam>(zeros_V[j]);
    sum_V += zeros_V[j];
    for (std::size_t i = 0; i < gauge_count; ++i) {
      monitor.without[j].zero_shift_V +=
          (monitor.without[j].gains.values[i] - TypeParam(1)) * static_cast<TypeParam>(zeros_V[i]);
    }
  }
  joint.config.calibration.zero_V = static_cast<TypeParam>(sum_V);
  for (std::uint32_t i = 0; i < 100; ++i) {
    joint.advance();
    for (std::size_t j = 0; j < gauge_count; ++j) {
      joint.sample.codes[j] = joint.code(joint.volts(j) + zeros_V[j]);
    }
    if (i >= 50) {
      joint.fail(1, GaugeFault::open, {});
    }
    EXPECT_NEAR(joint.take().torque_measured_Nm, joint.torque_Nm, 0.005) << i;
  }
  EXPECT_EQ(joint.state.monitor.lost_gauge, 2);
}

TYPED_TEST(GaugeMonitor, WithoutAGainSetTheTorqueIsInvalidAndHeld) {
  Joint<TypeParam> joint;
  joint.config.monitor.without[2].available = false;
  ASSERT_EQ(joint.run(200), 0);
  const auto before = joint.next();
  for (int i = 0; i < 100; ++i) {
    joint.torque_Nm = 30;
    joint.advance();
    joint.fail(2, GaugeFault::open, {});
    const auto reading = joint.take();
    EXPECT_TRUE(has(reading.status, StatusFlag::gauges_insufficient));
    EXPECT_EQ(reading.torque_measured_Nm, before.torque_measured_Nm);
    EXPECT_EQ(has(reading.status, StatusFlag::gauge_lost),
              i + 1 >= static_cast<int>(detection_samples));
  }
}

TYPED_TEST(GaugeMonitor, ASecondLossIsInvalid) {
  for (const GaugeFault fault : all_faults) {
    Joint<TypeParam> joint;
    ASSERT_EQ(joint.run(500), 0);
    const auto before = joint.sample.codes[3];
    for (int i = 0; i < 100; ++i) {
      joint.advance();
      joint.fail(0, GaugeFault::open, {});
      EXPECT_FALSE(has(joint.take().status, StatusFlag::gauges_insufficient));
    }
    int found_after = 0;
    for (int i = 1; i <= 300 && !joint.state.monitor.more_are_lost; ++i) {
      joint.advance();
      joint.fail(0, GaugeFault::open, {});
      joint.fail(3, fault, before);
      (void)joint.take();
      found_after = i;
    }
    EXPECT_LE(found_after, 150) << static_cast<int>(fault);
    EXPECT_TRUE(has(joint.take().status, StatusFlag::sample_repeated));
    const auto reading = joint.next();
    EXPECT_TRUE(has(reading.status, StatusFlag::gauges_insufficient));
    EXPECT_EQ(reading.left_out_gauge, 1);
  }
}

TYPED_TEST(GaugeMonitor, AnOverloadIsNoFaultOfAGauge) {
  Joint<TypeParam> joint;
  ASSERT_EQ(joint.run(100), 0);
  joint.torque_Nm = 94;  // some gauges at the rail, some below it
  for (int i = 0; i < 1000; ++i) {
    const auto reading = joint.next();
    EXPECT_EQ(reading.left_out_gauge, 0);
  }
  joint.torque_Nm = 150;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(has(joint.next().status, StatusFlag::gauge_saturated));
  }
  joint.torque_Nm = 12;
  ASSERT_EQ(joint.run(100), 0);
}

TYPED_TEST(GaugeMonitor, AnEncoderThatDithersAtRestIsNoTravel) {
  Joint<TypeParam> joint;
  joint.speed_rad_s = 0;
  for (int i = 0; i < 20000; ++i) {
    joint.advance();
    joint.sample.motor_phase =
        strainwave::phase_from_radians(joint.angle_rad + (i % 2 == 0 ? 0.0 : 2 * pi / 4096));
    ASSERT_EQ(joint.take().left_out_gauge, 0) << i;
  }
}

TYPED_TEST(GaugeMonitor, AQuietConverterThatRepeatsAllCodesIsNotStuck) {
  Joint<TypeParam> joint;
  joint.speed_rad_s = 0;
  joint.advance();
  for (int i = 0; i < 1000; ++i) {
    ++joint.sample.sequence;
    ASSERT_EQ(joint.take().left_out_gauge, 0) << i;
  }
}

TYPED_TEST(GaugeMonitor, AWrongAngleIsNotTakenForAGauge) {
  Joint<TypeParam> joint;
  ASSERT_EQ(joint.run(100), 0);
  bool said = false;
  for (int i = 0; i < 2000; ++i) {
    joint.advance();
    joint.sample.motor_phase = strainwave::phase_from_radians(joint.angle_rad + 0.4);
    said = has(joint.take().status, StatusFlag::gauges_disagree) || said;
  }
  EXPECT_TRUE(said);
  EXPECT_EQ(joint.state.monitor.lost_gauge, 0);
}

TYPED_TEST(GaugeMonitor, WithoutItsZeroTheAngleIsNotUsed) {
  for (const bool valid : {false, true}) {
    Joint<TypeParam> joint;
    joint.sample.phase_valid = valid;
    joint.sample.phase_referenced = !valid;
    for (int i = 0; i < 2000; ++i) {
      joint.advance();
      joint.sample.motor_phase = strainwave::phase_from_radians(joint.angle_rad + 0.4);
      const auto reading = joint.take();
      ASSERT_FALSE(has(reading.status, StatusFlag::gauges_disagree));
      ASSERT_EQ(reading.left_out_gauge, 0);
    }
    joint.advance();
    joint.fail(1, GaugeFault::open, {});
    EXPECT_EQ(joint.take().left_out_gauge, 2);  // rails need no angle
  }
}

TYPED_TEST(GaugeMonitor, WithoutAngleTheWaveCanBeADirection) {
  // Of five gauges two directions are left beside torque and the wave's sine and cosine.
  for (std::size_t j = 0; j < gauge_count; ++j) {
    Joint<TypeParam> joint;
    auto& parity = joint.config.monitor.consistency;
    parity.harmonic_count = 0;
    parity.direction_count = 3;
    for (std::size_t i = 0; i < gauge_count; ++i) {
      parity.directions[1][i] = static_cast<TypeParam>(std::sqrt(0.4) * std::cos(phase_rad(i)));
      parity.directions[2][i] = static_cast<TypeParam>(std::sqrt(0.4) * std::sin(phase_rad(i)));
    }
    ASSERT_TRUE(check(joint.config).ok());
    joint.sample.phase_referenced = false;
    ASSERT_EQ(joint.run(1000), 0);
    for (int i = 0; i < 60; ++i) {
      joint.advance();
      joint.fail(j, GaugeFault::inconsistent, {});
      (void)joint.take();
    }
    EXPECT_EQ(joint.state.monitor.lost_gauge, j + 1);
  }
}

TYPED_TEST(GaugeMonitor, TheDelayOfTheGaugesIsTakenOut) {
  Joint<TypeParam> joint;
  joint.config.monitor.consistency.delay_samples = TypeParam(2.5);
  joint.speed_rad_s = 150;
  for (int i = 0; i < 3000; ++i) {
    joint.advance();
    const double ahead_rad = joint.angle_rad + 2.5e-3 * joint.speed_rad_s;
    joint.sample.motor_phase = strainwave::phase_from_radians(ahead_rad);
    if (i % 50 == 10) {  // a gap: the angle has gone further since the sample before
      continue;
    }
    const auto reading = joint.take();
    ASSERT_EQ(reading.left_out_gauge, 0) << i;
    ASSERT_FALSE(i > 0 && has(reading.status, StatusFlag::gauges_disagree)) << i;
  }
}

TYPED_TEST(GaugeMonitor, WildCodesNeverGiveWildTorque) {
  Joint<TypeParam> joint;
  Noise wild;
  for (int i = 0; i < 20000; ++i) {
    joint.advance();
    for (auto& code : joint.sample.codes) {
      const std::uint32_t bits = wild.bits();
      if ((bits & 3U) == 0U) {
        code.value = static_cast<std::int32_t>(wild.bits());
      }
    }
    joint.sample.motor_phase = {static_cast<std::int64_t>(wild.bits()) << 20, wild.bits()};
    joint.sample.phase_valid = (wild.bits() & 7U) != 0U;
    const auto reading = joint.take();
    ASSERT_TRUE(std::isfinite(reading.torque_Nm));
    ASSERT_TRUE(std::isfinite(reading.torque_measured_Nm));
    ASSERT_LE(reading.left_out_gauge, gauge_count);
    if (i % 100 == 0) {
      clear_lost_gauge(joint.state.monitor);
    }
  }
  joint.state = strainwave::initial_state(joint.config);
  joint.sample.phase_valid = true;
  ASSERT_EQ(joint.run(100), 0);
}

TEST(GaugeMonitorPrecision, FloatAndDoubleFindTheSameInTheSameSample) {
  for (const GaugeFault fault : all_faults) {
    for (std::size_t j = 0; j < gauge_count; ++j) {
      Joint<float> single;
      Joint<double> twice;
      for (int i = 0; i < 300; ++i) {
        twice.advance();
        if (i >= 200) {
          twice.fail(j, fault, single.sample.codes[j]);
        }
        single.sample = {};
        for (std::size_t g = 0; g < gauge_count; ++g) {
          single.sample.codes[g] = twice.sample.codes[g];
        }
        single.sample.motor_phase = twice.sample.motor_phase;
        single.sample.sequence = twice.sample.sequence;
        const auto narrow = single.take();
        const auto wide = twice.take();
        ASSERT_EQ(narrow.left_out_gauge, wide.left_out_gauge);
        ASSERT_EQ(narrow.gauge_fault, wide.gauge_fault);
        ASSERT_NEAR(narrow.torque_measured_Nm, wide.torque_measured_Nm, 1e-4);
      }
    }
  }
}

TEST(GaugeMonitorConfiguration, CapacityMakesNoDifference) {
  const auto config = five_gauges<double>();
  const auto more = strainwave::converted<double, 9>(config.monitor);
  EXPECT_TRUE(check(more, gauge_count).ok());
  strainwave::GaugeMonitorState<double, 5> state;
  strainwave::GaugeMonitorState<double, 9> other;
  Joint<double> joint;
  for (int i = 0; i < 300; ++i) {
    joint.advance();
    if (i >= 250) {
      joint.fail(3, GaugeFault::inconsistent, {});
    }
    double volts[gauge_count] = {};
    for (std::size_t j = 0; j < gauge_count; ++j) {
      volts[j] = to_volts(config.converter, joint.sample.codes[j]);
    }
    strainwave::GaugeSignals<double> signals;
    signals.count = gauge_count;
    signals.codes = joint.sample.codes;
    signals.volts = volts;
    signals.motor_phase = joint.sample.motor_phase;
    const GaugeVerdict one = watch(config.monitor, state, config.converter, signals);
    const GaugeVerdict two = watch(more, other, config.converter, signals);
    ASSERT_EQ(one.left_out, two.left_out);
    ASSERT_EQ(one.status, two.status);
  }
  EXPECT_EQ(state.lost_gauge, 4);
  EXPECT_EQ(other.lost_gauge, 4);
}

TEST(GaugeMonitorConfiguration, SaysWhatIsWrong) {
  using Config = strainwave::RippleSensorConfig<double, gauge_count, 3>;
  const auto expect = [](const char* parameter, auto spoil) {
    Config config = five_gauges<double>();
    spoil(config.monitor);
    const auto violation = check(config);
    ASSERT_FALSE(violation.ok()) << parameter;
    EXPECT_EQ(std::string(violation.parameter), parameter);
    config.monitor.active = false;
    EXPECT_TRUE(check(config).ok()) << "an inactive monitor is not read: " << parameter;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect("rail_samples", [](auto& m) { m.rail_samples = 60001; });
  expect("stuck_samples", [](auto& m) { m.stuck_samples = 1; });
  expect("stuck_samples", [](auto& m) { m.stuck_samples = 60001; });
  expect("lowest_V", [&](auto& m) { m.lowest_V = nan; });
  expect("highest_V", [](auto& m) { m.highest_V = m.lowest_V; });
  expect("overload_V", [](auto& m) { m.overload_V = 0; });
  expect("flat_travel_turns", [&](auto& m) { m.flat_travel_turns = nan; });
  expect("flat_band_V", [](auto& m) { m.flat_band_V = -1; });
  expect("amplifier_zero_V", [&](auto& m) { m.amplifier_zero_V = nan; });
  expect("short_band_V", [&](auto& m) { m.short_band_V = nan; });
  expect("residual_fluctuation_V", [](auto& m) { m.residual_fluctuation_V = -1; });
  expect("consistency_samples", [](auto& m) { m.consistency.samples = 60001; });
  expect("signal_directions", [](auto& m) { m.consistency.direction_count = 0; });
  expect("signal_directions", [](auto& m) { m.consistency.direction_count = 4; });
  expect("signal_directions", [](auto& m) { m.consistency.directions[0][1] = 0; });
  expect("signal_directions", [](auto& m) {
    m.consistency.directions[0][0] = 1;
    for (std::size_t j = 1; j < gauge_count; ++j) {
      m.consistency.directions[0][j] = 0;
    }
  });
  expect("fluctuation_V", [](auto& m) { m.consistency.harmonic_count = 5; });
  expect("fluctuation_V", [&](auto& m) { m.consistency.wave_V[4][0].sine = nan; });
  expect("wave_factor", [](auto& m) { m.consistency.wave_factor = {0, 1}; });
  expect("gauge_zero_V", [&](auto& m) { m.consistency.zero_V[2] = nan; });
  expect("delay_samples", [&](auto& m) { m.consistency.delay_samples = nan; });
  expect("consistency_limit_V", [](auto& m) { m.consistency.limit_V = 0; });
  expect("consistency_limit_per_V", [](auto& m) { m.consistency.limit_per_V = -1; });
  expect("gains_without", [](auto& m) { m.without[1].gains.count = 4; });
  expect("gains_without", [](auto& m) { m.without[1].gains.values[1] = 1; });
  expect("zero_shift_V", [&](auto& m) { m.without[1].zero_shift_V = nan; });
  expect("residual_fluctuation_V", [](auto& m) { m.without[1].residual_fluctuation_V = -1; });
}

}  // namespace
