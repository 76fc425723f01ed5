#include "strainwave/torque_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace {

using strainwave::has;
using strainwave::RotationSource;
using strainwave::StatusFlag;
using strainwave::TorqueReading;

template <class Real>
using Sample = strainwave::TorqueSensorSample<4, Real>;

constexpr double speed_rad_s = 150.0;

/// Everything of the chain but its filter: two gauges that count half each.
template <class Config>
Config two_gauges() {
  using Real = decltype(Config{}.calibration.gain_Nm_per_V);
  Config config;
  config.converter = {16, Real(-10), Real(10), -32768};
  config.gains = {2, {Real(0.5), Real(0.5)}};
  config.calibration.gain_Nm_per_V = Real(6.6);
  config.filter.order_count = 2;
  return config;
}

/// The chain with the published filter, for orders 2 and 4.
template <class RealT>
struct Oscillator {
  using Real = RealT;
  using Config = strainwave::TorqueSensorConfig<Real, 4, 3>;
  using State = strainwave::TorqueSensorState<Real, 4, 3>;

  static Config config() {
    auto config = two_gauges<Config>();
    config.filter.orders[1] = {4, 1};
    config.filter.process_noise_variance_Nm2[0] = Real(1e-4);
    config.filter.process_noise_variance_Nm2[1] = Real(1e-4);
    return config;
  }
  static void turn_by(Config& config, RotationSource source) {
    config.filter.rotation_source = source;
  }
  static const char* spoil_filter(Config& config) {
    config.filter.measurement_noise_variance_Nm2 = Real(-1);
    return "measurement_noise_variance_Nm2";
  }
};

/// The chain with the ripple filter, for the same orders.
template <class RealT>
struct Ripple {
  using Real = RealT;
  using Config = strainwave::RippleSensorConfig<Real, 4, 3>;
  using State = strainwave::RippleSensorState<Real, 4, 3>;

  static Config config() {
    auto config = two_gauges<Config>();
    config.filter.orders[1].order = {4, 1};
    return config;
  }
  static void turn_by(Config& /*config*/, RotationSource /*source*/) {}  // always by angle
  static const char* spoil_filter(Config& config) {
    config.filter.torque_noise_Nm = Real(-1);
    return "torque_noise_Nm";
  }
};

/// Sample k of a joint that turns at constant speed: ripple of order 2 over a torque of 13.2 Nm,
/// which the filter is told to expect.
template <class Config>
auto sample_at(const Config& config, int k) {
  using Real = decltype(config.calibration.gain_Nm_per_V);
  Sample<Real> sample;
  const double angle_rad = speed_rad_s * 1e-3 * k;
  const double ripple_V = 0.4 * std::cos(2 * angle_rad);
  sample.codes[0] = strainwave::to_code(config.converter, static_cast<Real>(2.0 + 2 * ripple_V));
  sample.codes[1] = strainwave::to_code(config.converter, Real(2));
  sample.expected_torque_Nm = Real(13.2);
  sample.motor_speed_rad_s = static_cast<Real>(speed_rad_s);
  sample.motor_phase = strainwave::phase_from_radians(angle_rad);
  sample.temperature_degC = Real(20);
  sample.sequence = static_cast<std::uint32_t>(k);
  return sample;
}

template <class Filter>
class TorqueSensor : public testing::Test {
 protected:
  using Reading = TorqueReading<typename Filter::Real>;
  Filter::Config config = Filter::config();
  Filter::State state = strainwave::initial_state(config);
  int k = 0;

  Reading next() { return take(sample_at(config, k)); }
  Reading take(const Sample<typename Filter::Real>& sample) {
    ++k;
    return strainwave::step(config, state, sample);
  }
  void settle() {
    while (k < 3000) {
      (void)next();
    }
  }
  void expect_clean(const Reading& reading) {
    EXPECT_EQ(reading.status & strainwave::fault_mask, 0U);
    EXPECT_NEAR(reading.torque_Nm, 13.2, 0.01);
  }
};
using Filters =
    testing::Types<Oscillator<float>, Oscillator<double>, Ripple<float>, Ripple<double>>;
TYPED_TEST_SUITE(TorqueSensor, Filters);

TYPED_TEST(TorqueSensor, ChainFromCodesToCleanTorque) {
  using Real = TypeParam::Real;
  this->settle();
  for (int i = 0; i < 100; ++i) {
    const double angle_rad = speed_rad_s * 1e-3 * this->k;
    const auto reading = this->next();
    EXPECT_EQ(reading.status, 0U);
    EXPECT_NEAR(static_cast<double>(reading.torque_measured_Nm),
                13.2 + 6.6 * 0.4 * std::cos(2 * angle_rad), 2e-3);  // a code is 2 mNm
    EXPECT_NEAR(static_cast<double>(reading.ripple_Nm), 2.64 * std::cos(2 * angle_rad), 0.01);
    EXPECT_NEAR(reading.torque_Nm, Real(13.2), Real(0.01));
  }
}

TYPED_TEST(TorqueSensor, SaturatedGaugeHoldsTheTorqueAndFreezesLearning) {
  this->settle();
  const auto before = this->next();
  using Limits = std::numeric_limits<std::int32_t>;
  for (const std::int32_t code : {32767, -32768, Limits::max(), Limits::min()}) {
    auto sample = sample_at(this->config, this->k);
    sample.codes[1].value = code;
    const auto reading = this->take(sample);
    EXPECT_EQ(reading.status, strainwave::mask(StatusFlag::gauge_saturated));
    EXPECT_EQ(reading.torque_Nm, before.torque_Nm);
    EXPECT_EQ(reading.torque_measured_Nm, before.torque_measured_Nm);
  }
  EXPECT_EQ(this->state.counters.faults, 4U);
  EXPECT_EQ(this->state.counters.by_bit[3], 4U);
  this->expect_clean(this->next());
}

TYPED_TEST(TorqueSensor, RepeatedSampleIsIgnored) {
  this->settle();
  const auto sample = sample_at(this->config, this->k);
  const auto first = this->take(sample);
  const auto again = strainwave::step(this->config, this->state, sample);
  EXPECT_EQ(again.status, strainwave::mask(StatusFlag::sample_repeated));
  EXPECT_EQ(again.torque_Nm, first.torque_Nm);
  this->expect_clean(this->next());
  EXPECT_EQ(this->state.counters.by_bit[5], 1U);
}

TYPED_TEST(TorqueSensor, HeldSampleIsFlaggedAndTimeGoesOn) {
  this->settle();
  for (int i = 0; i < 5; ++i) {
    (void)this->next();
    auto held = sample_at(this->config, this->k - 1);
    held.sequence = static_cast<std::uint32_t>(this->k);
    held.sequence_valid = false;  // rows are counted, not conversions
    EXPECT_TRUE(has(this->take(held).status, StatusFlag::sample_repeated));
    this->expect_clean(this->next());
  }
}

TYPED_TEST(TorqueSensor, StandingEncoderAtCrawlIsNoFault) {
  using Real = TypeParam::Real;
  // 0.1 rad/s and 4096 counts a turn: the encoder moves every 15th sample, and a quiet gauge keeps
  // its code meanwhile.  Nothing is wrong with such samples.
  int faults = 0;
  for (int i = 0; i < 1000; ++i) {
    Sample<Real> sample = sample_at(this->config, 0);
    sample.sequence = static_cast<std::uint32_t>(i);
    sample.motor_speed_rad_s = Real(0.1);
    sample.motor_phase = strainwave::phase_from_counts(i / 15, 4096);
    faults += (this->take(sample).status & strainwave::fault_mask) != 0U ? 1 : 0;
  }
  EXPECT_EQ(faults, 0);
}

TYPED_TEST(TorqueSensor, GapIsFlaggedAndBridged) {
  this->settle();
  this->k += 20;
  const auto reading = this->next();
  // The angle alone does not say how often an order has turned meanwhile.
  EXPECT_EQ(reading.status & ~strainwave::mask(StatusFlag::order_above_nyquist),
            strainwave::mask(StatusFlag::samples_missing));
  this->expect_clean(reading);
}

TYPED_TEST(TorqueSensor, OlderSampleIsIgnored) {
  this->settle();
  const auto before = this->next();
  const auto reading =
      strainwave::step(this->config, this->state, sample_at(this->config, this->k - 3));
  EXPECT_EQ(reading.status, strainwave::mask(StatusFlag::sample_out_of_order));
  EXPECT_EQ(reading.torque_Nm, before.torque_Nm);
  this->expect_clean(this->next());
}

TYPED_TEST(TorqueSensor, TenOlderSamplesAreIgnoredAndTheEleventhIsANewCount) {
  this->settle();
  for (int i = 0; i < 11; ++i) {
    auto sample = sample_at(this->config, this->k);
    sample.sequence = static_cast<std::uint32_t>(i);  // the counter has started again
    const auto reading = this->take(sample);
    EXPECT_EQ(has(reading.status, StatusFlag::sample_out_of_order), i < 10) << i;
    EXPECT_EQ(has(reading.status, StatusFlag::samples_missing), i == 10) << i;
  }
}

TYPED_TEST(TorqueSensor, FreshSamplesOfACoarseConverterAreNoFaults) {
  using Real = TypeParam::Real;
  // 12 bits, no noise, 30 rad/s: most codes are those of the sample before.
  auto coarse = this->config;
  coarse.converter = {12, Real(-10), Real(10), 0};
  for (const bool numbered : {true, false}) {
    auto started = strainwave::initial_state(coarse);
    int faults = 0;
    for (int n = 0; n < 4000; ++n) {
      Sample<Real> sample;
      const double angle_rad = 0.03 * n;
      const auto volts = static_cast<Real>(2.0 + 0.02 * std::sin(2.0 * angle_rad));
      for (std::size_t j = 0; j < coarse.gains.count; ++j) {
        sample.codes[j] = strainwave::to_code(coarse.converter, volts);
      }
      sample.motor_speed_rad_s = Real(30);
      sample.motor_phase = strainwave::phase_from_counts(
          static_cast<std::int64_t>(std::floor(angle_rad / 6.283185307179586 * 4096.0)), 4096);
      sample.sequence = static_cast<std::uint32_t>(n);
      sample.sequence_valid = numbered;
      faults += (strainwave::step(coarse, started, sample).status & strainwave::fault_mask) != 0U;
    }
    EXPECT_EQ(faults, 0) << numbered;
  }
}

TYPED_TEST(TorqueSensor, SequenceWrapsAt32Bits) {
  for (; this->k < 3000;) {
    auto sample = sample_at(this->config, this->k);
    sample.sequence += 0xFFFFFFFFU - 2900U;
    const auto reading = this->take(sample);
    ASSERT_EQ(reading.status & ~strainwave::mask(StatusFlag::at_rest), 0U) << this->k;
  }
}

TYPED_TEST(TorqueSensor, OneWrongSequenceNumberDoesNotStopTheSensor) {
  using Real = TypeParam::Real;
  this->settle();
  auto wrong = sample_at(this->config, this->k);
  wrong.sequence += 1U << 30U;  // one flipped bit on the bus
  (void)this->take(wrong);
  TorqueReading<Real> reading;
  for (int i = 0; i < 1000; ++i) {
    reading = this->next();
  }
  this->expect_clean(reading);
}

TYPED_TEST(TorqueSensor, CounterThatStartsAgainDoesNotStopTheSensor) {
  using Real = TypeParam::Real;
  this->settle();
  TorqueReading<Real> reading;
  for (std::uint32_t i = 0; i < 1000; ++i) {  // the drive was switched off and on
    auto sample = sample_at(this->config, this->k);
    sample.sequence = i;
    reading = this->take(sample);
  }
  this->expect_clean(reading);
}

TYPED_TEST(TorqueSensor, TemperatureIsHeldOrLimited) {
  using Real = TypeParam::Real;
  this->config.calibration.gain_drift_per_K = Real(0.001);
  this->config.calibration.maximum_temperature_degC = Real(60);
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  const auto at = [this](Real temperature_degC) {
    auto sample = sample_at(this->config, this->k);
    sample.codes[0] = sample.codes[1];
    sample.temperature_degC = temperature_degC;
    return this->take(sample);
  };
  const auto tolerance = Real(2e-3);
  EXPECT_NEAR(at(Real(30)).torque_measured_Nm, Real(13.2 * 1.01), tolerance);
  auto reading = at(nan);
  EXPECT_TRUE(has(reading.status, StatusFlag::temperature_not_finite));
  EXPECT_NEAR(reading.torque_measured_Nm, Real(13.2 * 1.01), tolerance);
  reading = at(Real(1000));
  EXPECT_TRUE(has(reading.status, StatusFlag::temperature_out_of_range));
  EXPECT_NEAR(reading.torque_measured_Nm, Real(13.2 * 1.04), tolerance);
  reading = at(-std::numeric_limits<Real>::infinity());
  EXPECT_TRUE(has(reading.status, StatusFlag::temperature_not_finite));
}

TYPED_TEST(TorqueSensor, WildInputsKeepEveryOutputFinite) {
  using Real = TypeParam::Real;
  using Limits = std::numeric_limits<Real>;
  const Real wild[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                       Limits::max(),       Limits::lowest(),   Limits::denorm_min(),
                       Real(1e30),          Real(-1e15),        Real(0)};
  std::uint32_t random = 7;
  const auto draw = [&random](std::uint32_t count) {
    random = random * 1664525U + 1013904223U;
    return (random >> 16U) % count;
  };
  this->settle();
  std::uint32_t faults = this->state.counters.faults;
  for (int i = 0; i < 30'000; ++i) {
    auto sample = sample_at(this->config, this->k);
    sample.expected_torque_Nm = wild[draw(9)];
    sample.motor_speed_rad_s = wild[draw(9)];
    sample.temperature_degC = wild[draw(9)];
    sample.phase_valid = draw(2) == 0;
    sample.motor_phase = {static_cast<std::int64_t>(draw(65536)) << draw(40), draw(65536) << 16U};
    sample.codes[draw(2)].value = static_cast<std::int32_t>(draw(65536)) - 32768;
    sample.interval_s = wild[draw(9)];
    TypeParam::turn_by(this->config, draw(2) == 0 ? RotationSource::speed : RotationSource::angle);
    const auto reading = this->take(sample);
    ASSERT_TRUE(strainwave::is_finite(reading.torque_Nm)) << i;
    ASSERT_TRUE(strainwave::is_finite(reading.torque_measured_Nm)) << i;
    ASSERT_TRUE(strainwave::is_finite(reading.ripple_Nm)) << i;
    faults += (reading.status & strainwave::fault_mask) != 0U ? 1U : 0U;
  }
  EXPECT_EQ(this->state.counters.faults, faults);
  EXPECT_EQ(this->state.counters.samples, 33'000U);
  EXPECT_GT(faults, 20'000U);
}

TYPED_TEST(TorqueSensor, RecoversFromWildInputsWithinFourThousandSamples) {
  using Real = TypeParam::Real;
  this->settle();
  for (int i = 0; i < 500; ++i) {
    auto sample = sample_at(this->config, this->k);
    sample.expected_torque_Nm = i % 2 == 0 ? std::numeric_limits<Real>::quiet_NaN() : Real(1e6);
    sample.motor_speed_rad_s = i % 3 == 0 ? Real(-2e3) : Real(1e30);
    (void)this->take(sample);
  }
  TorqueReading<Real> reading;
  for (int i = 0; i < 4000; ++i) {
    reading = this->next();
  }
  this->expect_clean(reading);
}

TYPED_TEST(TorqueSensor, CheckReachesEveryPart) {
  using Real = TypeParam::Real;
  auto changed = TypeParam::config();
  EXPECT_TRUE(check(changed).ok());
  changed.converter.bits = 0;
  EXPECT_STREQ(check(changed).parameter, "bits");
  changed = TypeParam::config();
  changed.gains.count = 5;
  EXPECT_STREQ(check(changed).parameter, "gains");
  changed = TypeParam::config();
  changed.calibration.gain_Nm_per_V = Real(0);
  EXPECT_STREQ(check(changed).parameter, "gain_Nm_per_V");
  changed = TypeParam::config();
  const char* const spoilt = TypeParam::spoil_filter(changed);
  EXPECT_STREQ(check(changed).parameter, spoilt);
}

template <class Filter>
void expect_float_follows_double() {
  const auto config = Filter::config();
  const auto config_float = strainwave::converted<float, 4, 3>(config);
  auto state = strainwave::initial_state(config);
  auto state_float = strainwave::initial_state(config_float);
  double worst = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const auto sample = sample_at(config, k);
    Sample<float> sample_float = sample_at(config_float, k);
    sample_float.codes[0] = sample.codes[0];
    sample_float.codes[1] = sample.codes[1];
    const double a = strainwave::step(config, state, sample).torque_Nm;
    const float b = strainwave::step(config_float, state_float, sample_float).torque_Nm;
    worst = std::fmax(worst, std::fabs(a - static_cast<double>(b)));
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(worst, 1e-9);
}

TEST(TorqueSensorPrecision, FloatFollowsDouble) {
  expect_float_follows_double<Oscillator<double>>();
  expect_float_follows_double<Ripple<double>>();
}

}  // namespace
