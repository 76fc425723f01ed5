// Ripple filters in lanes: each channel as step() makes it, whatever the others do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "ripple_examples.hpp"
#include "strainwave/batch_ripple.hpp"
#include "strainwave/batch_ripple_long.hpp"

namespace {

using strainwave::RippleOutput;
using strainwave::VectorLevel;

constexpr std::size_t most_pairs = 12;
template <class Real>
using Config = strainwave::RippleFilterConfig<Real, most_pairs>;
template <class Real>
using State = strainwave::RippleFilterState<Real, most_pairs>;

std::vector<VectorLevel> levels() {
  std::vector<VectorLevel> found;
  for (const VectorLevel level : {VectorLevel::portable, VectorLevel::x86_64_v2,
                                  VectorLevel::x86_64_v3, VectorLevel::x86_64_v4}) {
    if (strainwave::is_available(level)) {
      found.push_back(level);
    }
  }
  return found;
}

/// Joints of five structures that differ in everything else: with load, speed and direction, with
/// fractions of orders and frozen terms, with a delay and a lead, and one with too many pairs for
/// lanes.
template <class Real>
Config<Real> joint(std::size_t number) {
  Config<Real> config;
  config.order_count = 3;
  config.orders[0] = {.order = {2, 1}, .with_load = true, .with_speed = true};
  config.orders[1] = {.order = {4, 1}, .with_load = true, .with_speed = true};
  config.orders[2] = {.order = {6, 1}};
  switch (number % 5) {
    case 1:
      config.orders[0] = {.order = {2, 1}, .with_direction = true};
      config.orders[1] = {.order = {number % 2 == 0 ? 5U : 3U, 1}};
      config.order_count = 2;
      break;
    case 2:
      config.orders[1] = {.order = {5, 2}, .with_load = true};
      config.orders[2] = {.order = {3, 2}, .keep = true};
      config.frozen_count = 1;
      config.frozen[0] = {{3, 100}, Real(0.3), Real(-0.2)};
      break;
    case 3:
      config.orders[0] = {.order = {2, 1},
                          .with_load = true,
                          .with_speed = true,
                          .with_direction = true,
                          .keep = true};
      config.orders[1] = {.order = {4, 1}, .with_load = true, .with_speed = true};
      break;
    case 4:
      for (std::size_t a = 0; a < 3; ++a) {
        config.orders[a].with_load = config.orders[a].with_speed = true;
        // Eleven pairs, the most that lanes have room for, or twelve.
        config.orders[a].with_direction = a < 2 || number % 2 == 0;
      }
      break;
    default:
      break;
  }
  if (number % 7 == 5) {
    config.angle_to_torque_delay_s = Real(0.0023);
  } else if (number % 7 == 6) {
    config.angle_to_torque_delay_s = Real(-0.0005);
  }
  config.memory_turns = static_cast<Real>(5.0 + static_cast<double>(number));
  config.torque_noise_Nm *= static_cast<Real>(1.0 + 0.05 * static_cast<double>(number));
  return config;
}

/// A channel's recording and what a filter makes of it.
template <class Real>
struct Log {
  std::vector<Real> torque_Nm;
  std::vector<double> angle_rad;
  std::vector<Real> interval_s;
  std::vector<Real> expected_Nm;
  std::vector<Real> outputs[strainwave::ripple_outputs];
  std::vector<strainwave::Status> status;

  [[nodiscard]] strainwave::RippleChannel<Real> channel(std::size_t start, std::size_t end) {
    strainwave::RippleChannel<Real> channel;
    channel.sample_count = end - start;
    channel.measured_torque_Nm = torque_Nm.data() + start;
    channel.motor_angle_rad = angle_rad.data() + start;
    channel.interval_s = interval_s.empty() ? nullptr : interval_s.data() + start;
    channel.expected_torque_Nm = expected_Nm.empty() ? nullptr : expected_Nm.data() + start;
    for (std::size_t i = 0; i < strainwave::ripple_outputs; ++i) {
      channel.outputs[i] = outputs[i].data() + start;
    }
    channel.status = status.data() + start;
    return channel;
  }
  [[nodiscard]] strainwave::RippleChannel<Real> channel() { return channel(0, torque_Nm.size()); }
};

/// A joint that turns both ways, rests, is loaded, and touches something.
template <class Real>
Log<Real> quiet_log(std::size_t number, std::size_t samples) {
  Log<Real> log;
  Random random(number + 1);
  double angle_rad = 1000.0 * static_cast<double>(number % 3) - 1000.0;
  for (std::size_t k = 0; k < samples; ++k) {
    const double time_s = 1e-3 * static_cast<double>(k);
    double speed_rad_s = 120.0 * std::sin(2.0 * time_s + static_cast<double>(number)) + 40.0;
    if (number % 4 == 1 && k % 900 > 700) {
      speed_rad_s = 0.0;
    }
    angle_rad += speed_rad_s * 1e-3;
    const double load_Nm = 15.0 * std::sin(3.0 * time_s + static_cast<double>(number)) +
                           (k % 1100 > 1000 ? 20.0 : 0.0);
    log.angle_rad.push_back(angle_rad);
    log.torque_Nm.push_back(
        static_cast<Real>(load_Nm + (1.0 + 0.02 * load_Nm) * example_ripple_Nm(angle_rad) +
                          0.04 * random.gaussian()));
  }
  for (auto& output : log.outputs) {
    output.assign(samples, Real(-99));
  }
  log.status.assign(samples, 0xFFFFFFFFU);
  return log;
}

/// The same with everything in it that a filter has to refuse or to flag.
template <class Real>
Log<Real> wild_log(std::size_t number, std::size_t samples) {
  using Limits = std::numeric_limits<Real>;
  const Real wild[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                       Limits::max(),       Real(1e16),         Real(-1e30)};
  Log<Real> log = quiet_log<Real>(number, samples);
  Random random(number + 1000);
  log.interval_s.assign(samples, Real(1e-3));
  if (number % 3 != 0) {
    log.expected_Nm.assign(samples, Real(0));
  }
  for (std::size_t k = 1; k < samples; ++k) {
    const Real value = wild[random.bits() % 6];
    switch (random.bits() % 400) {
      case 0:
        log.torque_Nm[k] = value;
        break;
      case 1:
        log.angle_rad[k] = static_cast<double>(value);
        break;
      case 2:
        log.interval_s[k] = value;
        break;
      case 3:
        log.interval_s[k] = Real(-1e-3);
        break;
      case 4:
        log.interval_s[k] = Real(0.05);  // a gap
        break;
      case 5:
        log.torque_Nm[k] = log.torque_Nm[k - 1];  // a row that repeats the last one
        log.angle_rad[k] = log.angle_rad[k - 1];
        break;
      case 6:
        log.angle_rad[k] += 500.0;  // a jump there, and back
        break;
      case 7:
        if (!log.expected_Nm.empty()) {
          log.expected_Nm[k] = value;
        }
        break;
      default:
        break;
    }
  }
  for (std::size_t k = samples / 2; k < samples / 2 + 40 && k < samples; ++k) {
    log.angle_rad[k] = std::numeric_limits<double>::quiet_NaN();  // a cable that is out
  }
  return log;
}

/// What step() makes of it, sample after sample.
template <class Real>
Log<Real> one_by_one(const Config<Real>& config, State<Real>& state, Log<Real> log) {
  strainwave::detail::filter_one(config, state, log.channel());
  return log;
}

template <class Real>
bool is_alike(Real a, Real b, double tolerance) {
  const double scale = std::max(1.0, std::abs(static_cast<double>(b)));
  return a == b || (std::isnan(a) && std::isnan(b)) ||
         std::abs(static_cast<double>(a) - static_cast<double>(b)) <= tolerance * scale;
}

/// Largest difference, Nm: float learns from its own rounding; and how little a pair is known is
/// judged in the frame, which lanes move at other samples.
template <class Real>
constexpr double tolerance_Nm = sizeof(Real) == 4 ? 2e-3 : 1e-4;

template <class Real>
void expect_alike(const Log<Real>& lanes, const Log<Real>& alone, std::size_t channel) {
  for (std::size_t k = 0; k < alone.status.size(); ++k) {
    ASSERT_EQ(lanes.status[k], alone.status[k]) << "channel " << channel << " sample " << k;
    for (const RippleOutput output : {RippleOutput::torque, RippleOutput::ripple,
                                      RippleOutput::all_removed, RippleOutput::state}) {
      const auto i = static_cast<std::size_t>(output);
      ASSERT_TRUE(is_alike(lanes.outputs[i][k], alone.outputs[i][k], tolerance_Nm<Real>))
          << "channel " << channel << " output " << i << " sample " << k << ": "
          << lanes.outputs[i][k] << " and " << alone.outputs[i][k];
    }
  }
}

template <class Real>
struct Batch {
  std::vector<Config<Real>> configs;
  std::vector<State<Real>> states;
  std::vector<Log<Real>> logs;

  void run(const strainwave::BatchOptions& options) {
    std::vector<strainwave::RippleChannel<Real>> channels;
    channels.reserve(logs.size());
    for (auto& log : logs) {
      channels.push_back(log.channel());
    }
    strainwave::process_batch<Real, most_pairs>(configs, states, channels, options);
  }
};

template <class Real>
Batch<Real> batch_of(std::size_t channels, bool wild) {
  Batch<Real> batch;
  for (std::size_t i = 0; i < channels; ++i) {
    const std::size_t samples = 1500 + 37 * (i % 11);
    batch.configs.push_back(joint<Real>(i));
    batch.states.push_back(strainwave::initial_state(batch.configs.back()));
    batch.logs.push_back(wild ? wild_log<Real>(i, samples) : quiet_log<Real>(i, samples));
  }
  return batch;
}

template <class Real>
class BatchRipple : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchRipple, Reals);

TYPED_TEST(BatchRipple, EachChannelIsAsStepMakesIt) {
  for (const bool wild : {false, true}) {
    const Batch<TypeParam> start = batch_of<TypeParam>(45, wild);
    for (const VectorLevel level : levels()) {
      Batch<TypeParam> batch = start;
      batch.run({.level = level, .thread_count = 2});
      for (std::size_t i = 0; i < start.logs.size(); ++i) {
        State<TypeParam> state = start.states[i];
        const auto alone = one_by_one(start.configs[i], state, start.logs[i]);
        SCOPED_TRACE(testing::Message() << "level " << static_cast<int>(level) << " wild " << wild);
        expect_alike(batch.logs[i], alone, i);
        EXPECT_EQ(batch.states[i].counters.samples, state.counters.samples);
        EXPECT_EQ(batch.states[i].counters.faults, state.counters.faults);
        if (this->HasFatalFailure()) {
          return;
        }
      }
    }
  }
}

TYPED_TEST(BatchRipple, WhatOneChannelHoldsDoesNotReachAnother) {
  using Real = TypeParam;
  Batch<Real> quiet = batch_of<Real>(16, false);
  Batch<Real> spoilt = quiet;
  for (std::size_t k = 300; k < spoilt.logs[5].torque_Nm.size(); ++k) {
    spoilt.logs[5].torque_Nm[k] = std::numeric_limits<Real>::quiet_NaN();
  }
  quiet.run({});
  spoilt.run({});
  for (std::size_t i = 0; i < quiet.logs.size(); ++i) {
    const auto torque = static_cast<std::size_t>(RippleOutput::torque);
    EXPECT_EQ(quiet.logs[i].outputs[torque] == spoilt.logs[i].outputs[torque], i != 5) << i;
  }
}

TYPED_TEST(BatchRipple, AStateGoesOnWithStepAndBack) {
  using Real = TypeParam;
  const Config<Real> config = joint<Real>(0);
  const Log<Real> log = wild_log<Real>(0, 1200);
  State<Real> alone = strainwave::initial_state(config);
  const Log<Real> expected = one_by_one(config, alone, log);
  Log<Real> parts = log;
  State<Real> state = strainwave::initial_state(config);
  for (std::size_t start = 0; start < 1200; start += 150) {
    const auto channel = parts.channel(start, start + 150);
    if (start % 300 == 0) {
      strainwave::process_batch<Real, most_pairs>({&config, 1}, {&state, 1}, {&channel, 1});
    } else {
      strainwave::detail::filter_one(config, state, channel);
    }
  }
  expect_alike(parts, expected, 0);
  EXPECT_EQ(state.counters.samples, 1200U);
}

template <class Real>
double rms_difference_Nm(const Log<Real>& a, const Log<Real>& b) {
  const auto torque = static_cast<std::size_t>(RippleOutput::torque);
  double squares_Nm2 = 0.0;
  for (std::size_t k = 0; k < a.status.size(); ++k) {
    const double apart_Nm =
        static_cast<double>(a.outputs[torque][k]) - static_cast<double>(b.outputs[torque][k]);
    squares_Nm2 += apart_Nm * apart_Nm;
  }
  return std::sqrt(squares_Nm2 / static_cast<double>(a.status.size()));
}

TYPED_TEST(BatchRipple, ALongLogInChunksIsAsInSequence) {
  using Real = TypeParam;
  auto config = two_orders<Real, most_pairs>();
  config.memory_turns = Real(3);
  const Log<Real> log = quiet_log<Real>(2, 60000);
  Log<Real> sequence = log;
  State<Real> state = strainwave::initial_state(config);
  const auto exact =
      strainwave::process_long(config, state, sequence.channel(), {.in_sequence = true});
  EXPECT_EQ(exact.chunk_count, 1U);
  Log<Real> chunks = log;
  State<Real> chunked = strainwave::initial_state(config);
  const auto report = strainwave::process_long(config, chunked, chunks.channel());
  EXPECT_GT(report.chunk_count, 4U);
  EXPECT_LE(report.largest_ripple_difference_Nm, 1e-4);
  EXPECT_LE(rms_difference_Nm(chunks, sequence), 1e-4);
  EXPECT_EQ(chunked.counters.samples, 60000U);
}

TYPED_TEST(BatchRipple, AWarmUpThatIsTooShortIsFoundOut) {
  using Real = TypeParam;
  auto config = two_orders<Real, most_pairs>();
  config.memory_turns = Real(3);
  Log<Real> log = quiet_log<Real>(3, 40000);
  State<Real> state = strainwave::initial_state(config);
  const auto report =
      strainwave::process_long(config, state, log.channel(), {.warm_up_memories = 0.3});
  EXPECT_GT(report.repeated_chunks, 0U);
  Log<Real> open = log;
  State<Real> other = strainwave::initial_state(config);
  const auto tolerant = strainwave::process_long(
      config, other, open.channel(),
      {.warm_up_memories = 0.3, .tolerance_Nm = 10.0, .state_tolerance_Nm = 10.0});
  EXPECT_EQ(tolerant.repeated_chunks, 0U);
  EXPECT_GT(tolerant.largest_ripple_difference_Nm, 1e-4);
}

/// Angles of a fraction of a turn to a million turns, either way.
std::vector<double> angles_rad() {
  std::vector<double> angles_rad;
  std::uint64_t state = 20;
  for (int i = 0; i < 4001; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const double share = static_cast<double>(state >> 11U) / 9007199254740992.0 - 0.5;
    angles_rad.push_back(share * std::pow(10.0, i % 8));
  }
  return angles_rad;
}

template <class Real>
void expect_cycles(VectorLevel level, strainwave::Order order) {
  const std::vector<double> angles = angles_rad();
  std::vector<Real> turns(angles.size());
  std::vector<Real> fraction(angles.size());
  std::vector<Real> cycles(angles.size());
  const strainwave::OrderCycles<Real> wanted = {static_cast<double>(order.numerator),
                                                static_cast<double>(order.denominator),
                                                1.0 / order.denominator, cycles.data()};
  const auto convert = strainwave::detail::ripple_kernel<Real, 3>(level).convert_angles;
  ASSERT_NE(convert, nullptr);
  convert(angles.data(), angles.size(), turns.data(), fraction.data(), &wanted, 1);
  using Whole = strainwave::RippleLanes<Real, 3>::Whole;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    Whole whole[3];
    for (std::size_t n = 0; n < 3; ++n) {
      const Real from[3] = {turns[i], fraction[i], cycles[i]};
      std::memcpy(&whole[n], &from[n], sizeof(Whole));
    }
    const strainwave::Phase phase = strainwave::detail::phase_of_lane(whole[0], whole[1]);
    EXPECT_NEAR(strainwave::to_radians<double>(phase), angles[i], 1e-8);
    ASSERT_EQ(static_cast<std::uint32_t>(whole[2]), strainwave::order_fraction(phase, order))
        << angles[i] << " rad, order " << order.numerator << "/" << order.denominator;
  }
}

TEST(BatchRippleAngles, CyclesOfAnOrderAreExact) {
  for (const VectorLevel level : levels()) {
    // The last two at the limit of has_short_parts().
    for (const strainwave::Order order :
         {strainwave::Order{1, 100}, strainwave::Order{2, 1}, strainwave::Order{7, 3},
          strainwave::Order{201, 100}, strainwave::Order{1, 524287}, strainwave::Order{809, 648}}) {
      ASSERT_TRUE(strainwave::detail::has_short_parts(order));
      expect_cycles<float>(level, order);
      expect_cycles<double>(level, order);
    }
  }
}

}  // namespace
