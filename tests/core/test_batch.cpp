// Channels in lanes against one filter at a time: the same results, states and flags at every
// vector level.
#include "strainwave/batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "batch_examples.hpp"
#include "strainwave/batch_interleaved.hpp"

namespace {

using strainwave::BatchOptions;
using strainwave::OscillatorChannel;
using strainwave::VectorLevel;

/// Channels with their filters.
template <class Real>
struct Fleet {
  std::vector<BatchConfig<Real>> configs;
  std::vector<BatchState<Real>> states;
  std::vector<Log<Real>> logs;

  void add(const BatchConfig<Real>& config, Log<Real> log) {
    configs.push_back(config);
    states.push_back(strainwave::initial_state(config));
    logs.push_back(std::move(log));
  }

  void process(const BatchOptions& options, std::size_t start, std::size_t end) {
    std::vector<OscillatorChannel<Real>> channels;
    channels.reserve(logs.size());
    for (Log<Real>& log : logs) {
      channels.push_back(
          log.channel(std::min(start, log.torque_Nm.size()), std::min(end, log.torque_Nm.size())));
    }
    strainwave::process_batch<Real, batch_orders>(configs, states, channels, options);
  }
  void process(const BatchOptions& options) {
    process(options, 0, std::numeric_limits<std::size_t>::max());
  }
};

/// Numbers of channels and lengths that fill no block.
template <class Real>
Fleet<Real> wild_fleet() {
  Fleet<Real> fleet;
  for (std::size_t i = 0; i < 43; ++i) {
    fleet.add(joint<Real>(i), wild_log<Real>(i, i == 7 ? 0 : 1500 + 37 * (i % 11)));
  }
  return fleet;
}

/// Rounding of some thousand steps in another order, Nm, at a ripple of 9 Nm.
template <class Real>
constexpr double tolerance_Nm = sizeof(Real) == 4 ? 1e-3 : 1e-10;

template <class Real>
void expect_same(const Fleet<Real>& fleet, const Fleet<Real>& expected, VectorLevel level) {
  double worst_Nm = 0.0;
  for (std::size_t i = 0; i < fleet.logs.size(); ++i) {
    const Log<Real>& log = fleet.logs[i];
    EXPECT_EQ(log.status, expected.logs[i].status) << "channel " << i;
    for (std::size_t k = 0; k < log.clean_Nm.size(); ++k) {
      const auto torque_Nm = static_cast<double>(log.clean_Nm[k] - expected.logs[i].clean_Nm[k]);
      const auto ripple_Nm = static_cast<double>(log.ripple_Nm[k] - expected.logs[i].ripple_Nm[k]);
      ASSERT_TRUE(std::isfinite(torque_Nm) && std::isfinite(ripple_Nm)) << i << ", " << k;
      worst_Nm = std::fmax(worst_Nm, std::fmax(std::fabs(torque_Nm), std::fabs(ripple_Nm)));
    }
    const auto& counters = fleet.states[i].counters;
    EXPECT_EQ(counters.samples, log.clean_Nm.size());
    EXPECT_EQ(counters.faults, expected.states[i].counters.faults);
    for (std::size_t bit = 0; bit < 32; ++bit) {
      EXPECT_EQ(counters.by_bit[bit], expected.states[i].counters.by_bit[bit]) << i << ", " << bit;
    }
  }
  EXPECT_LT(worst_Nm, tolerance_Nm<Real>) << "level " << static_cast<int>(level);
}

template <class Real>
class BatchOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchOf, Precisions);

TYPED_TEST(BatchOf, EveryLaneIsTheFilterAloneWithWhateverItIsFed) {
  using Real = TypeParam;
  Fleet<Real> alone = wild_fleet<Real>();
  alone.process({.level = VectorLevel::one_by_one});
  // Every flag that the published filter has is in there but the loss of P's sign, tested below.
  strainwave::Status seen = 0;
  for (const Log<Real>& log : alone.logs) {
    for (const strainwave::Status status : log.status) {
      seen |= status;
    }
  }
  EXPECT_EQ(seen & mask(strainwave::StatusFlag::covariance_reset), 0U);
  for (const strainwave::StatusFlag flag : strainwave::counted_flags) {
    EXPECT_TRUE(has(seen, flag) || flag == strainwave::StatusFlag::covariance_reset ||
                flag == strainwave::StatusFlag::variance_limited)
        << mask(flag);
  }
  for (const VectorLevel level : vector_levels()) {
    Fleet<Real> fleet = wild_fleet<Real>();
    fleet.process({.level = level});
    expect_same(fleet, alone, level);
  }
}

TYPED_TEST(BatchOf, StatesGoOnWithStepAndStepGoesOnWithThem) {
  using Real = TypeParam;
  Fleet<Real> alone = wild_fleet<Real>();
  alone.process({.level = VectorLevel::one_by_one});
  for (const VectorLevel level : vector_levels()) {
    Fleet<Real> fleet = wild_fleet<Real>();
    fleet.process({.level = level}, 0, 611);
    fleet.process({.level = VectorLevel::one_by_one}, 611, 940);
    fleet.process({.level = level}, 940, 5000);
    expect_same(fleet, alone, level);
  }
}

TYPED_TEST(BatchOf, ABadChannelChangesNoBitOfAnother) {
  using Real = TypeParam;
  using Limits = std::numeric_limits<Real>;
  for (const VectorLevel level : vector_levels()) {
    for (const Real bad : {Limits::quiet_NaN(), Limits::infinity(), Limits::max()}) {
      Fleet<Real> clean;
      for (std::size_t i = 0; i < 16; ++i) {
        clean.add(joint<Real>(0), quiet_log<Real>(4 * i, 700));
      }
      Fleet<Real> spoilt = clean;
      for (std::size_t k = 100; k < 700; ++k) {
        spoilt.logs[5].torque_Nm[k] = bad;
        spoilt.logs[6].speed_rad_s[k] = bad;
      }
      spoilt.states[9].states_Nm[1] = bad;
      spoilt.states[10].covariance_Nm2[1][1] = bad;
      clean.process({.level = level});
      spoilt.process({.level = level});
      for (std::size_t i = 0; i < 16; ++i) {
        if (i != 5 && i != 6 && i != 9 && i != 10) {
          // Rounding depends on which loop a sample went through, and on nothing else.
          double worst_Nm = 0.0;
          for (std::size_t k = 0; k < 700; ++k) {
            worst_Nm =
                std::fmax(worst_Nm, std::fabs(static_cast<double>(clean.logs[i].clean_Nm[k] -
                                                                  spoilt.logs[i].clean_Nm[k])));
          }
          EXPECT_LT(worst_Nm, tolerance_Nm<Real>) << i;
          EXPECT_EQ(clean.logs[i].status, spoilt.logs[i].status) << i;
        }
      }
    }
  }
}

TYPED_TEST(BatchOf, ThreadsChangeNoBit) {
  using Real = TypeParam;
  Fleet<Real> one = wild_fleet<Real>();
  Fleet<Real> three = one;
  one.process({.thread_count = 1});
  three.process({.thread_count = 3});
  for (std::size_t i = 0; i < one.logs.size(); ++i) {
    EXPECT_EQ(one.logs[i].clean_Nm, three.logs[i].clean_Nm) << i;
    EXPECT_EQ(one.logs[i].status, three.logs[i].status) << i;
  }
}

TYPED_TEST(BatchOf, LossOfTheCovariancesSignIsMetAsByStep) {
  using Real = TypeParam;
  for (const VectorLevel level : vector_levels()) {
    Fleet<Real> fleet;
    for (std::size_t i = 0; i < 20; ++i) {
      fleet.add(joint<Real>(i % 3), quiet_log<Real>(4 * i, 300));
    }
    fleet.process({.level = VectorLevel::one_by_one}, 0, 100);
    fleet.states[3].covariance_Nm2[0][0] = Real(-1e6);
    fleet.states[11].covariance_Nm2[1][1] = std::numeric_limits<Real>::quiet_NaN();
    Fleet<Real> alone = fleet;
    alone.process({.level = VectorLevel::one_by_one}, 100, 300);
    fleet.process({.level = level}, 100, 300);
    expect_same(fleet, alone, level);
    const auto bit = strainwave::lowest_bit(mask(strainwave::StatusFlag::covariance_reset));
    EXPECT_EQ(fleet.states[3].counters.by_bit[bit], 1U);
    EXPECT_EQ(fleet.states[11].counters.by_bit[bit], 1U);
    EXPECT_EQ(fleet.states[4].counters.by_bit[bit], 0U);
  }
}

TYPED_TEST(BatchOf, VariancesAreLimitedAsByStep) {
  using Real = TypeParam;
  Fleet<Real> start;
  for (std::size_t i = 0; i < 20; ++i) {
    BatchConfig<Real> config = joint<Real>(0);
    config.variance_limit_ratio = i % 2 == 0 ? Real(0) : Real(100);
    start.add(config, quiet_log<Real>(4 * i, 600));
    for (Real& speed_rad_s : start.logs.back().speed_rad_s) {
      speed_rad_s *= Real(0.02);
    }
  }
  Fleet<Real> alone = start;
  alone.process({.level = VectorLevel::one_by_one});
  const auto bit = strainwave::lowest_bit(mask(strainwave::StatusFlag::variance_limited));
  EXPECT_GT(alone.states[1].counters.by_bit[bit], 100U);
  EXPECT_EQ(alone.states[2].counters.by_bit[bit], 0U);
  for (const VectorLevel level : vector_levels()) {
    Fleet<Real> fleet = start;
    fleet.process({.level = level});
    for (std::size_t i = 0; i < 20; ++i) {
      // A variance that rounding puts on the other side of its limit is limited a sample later.
      EXPECT_NEAR(fleet.states[i].counters.by_bit[bit], alone.states[i].counters.by_bit[bit], 5)
          << i;
      for (std::size_t k = 0; k < 600; ++k) {
        ASSERT_NEAR(fleet.logs[i].ripple_Nm[k], alone.logs[i].ripple_Nm[k],
                    sizeof(Real) == 4 ? 1e-2 : 1e-8)
            << i << ", " << k;
      }
    }
  }
}

TYPED_TEST(BatchOf, ChannelsByAngleComeOutAsByStep) {
  using Real = TypeParam;
  BatchConfig<Real> config = joint<Real>(1);
  config.rotation_source = strainwave::RotationSource::angle;
  std::vector<double> angle_rad(800);
  for (std::size_t k = 0; k < 800; ++k) {
    angle_rad[k] = k == 400 ? std::nan("") : 0.1 * static_cast<double>(k);
  }
  Fleet<Real> fleet;
  fleet.add(config, quiet_log<Real>(3, 800));
  std::vector<OscillatorChannel<Real>> channels = {fleet.logs[0].channel()};
  channels[0].motor_angle_rad = angle_rad.data();
  channels[0].motor_speed_rad_s = nullptr;
  strainwave::process_batch<Real, batch_orders>(fleet.configs, fleet.states, channels);
  auto state = strainwave::initial_state(config);
  for (std::size_t k = 0; k < 800; ++k) {
    strainwave::OscillatorSample<Real> sample;
    sample.measured_torque_Nm = fleet.logs[0].torque_Nm[k];
    sample.phase_valid = k != 400;
    sample.motor_phase = strainwave::phase_from_radians(0.1 * static_cast<double>(k));
    const auto reading = strainwave::step(config, state, sample);
    ASSERT_EQ(fleet.logs[0].clean_Nm[k], reading.torque_Nm) << k;
    ASSERT_EQ(fleet.logs[0].status[k], reading.status) << k;
  }
}

TYPED_TEST(BatchOf, SideBySideInMemoryIsTheSame) {
  using Real = TypeParam;
  constexpr std::size_t width = strainwave::block_width<Real>;
  constexpr std::size_t samples = 700;
  const std::size_t channels = 2 * width + 3;
  Fleet<Real> alone;
  for (std::size_t i = 0; i < channels; ++i) {
    alone.add(joint<Real>(6 * i + i % 4), wild_log<Real>(3 * i, samples));
  }
  Fleet<Real> fleet = alone;
  alone.process({.level = VectorLevel::one_by_one});
  std::vector<Real> torque_Nm(3 * width * samples);
  std::vector<Real> speed_rad_s(3 * width * samples);
  const auto place = [](std::size_t channel, std::size_t k) {
    return (channel / width * samples + k) * width + channel % width;
  };
  for (std::size_t i = 0; i < channels; ++i) {
    for (std::size_t k = 0; k < samples; ++k) {
      torque_Nm[place(i, k)] = fleet.logs[i].torque_Nm[k];
      speed_rad_s[place(i, k)] = fleet.logs[i].speed_rad_s[k];
    }
  }
  for (const VectorLevel level : vector_levels()) {
    Fleet<Real> run = fleet;
    std::vector<Real> clean_Nm(3 * width * samples);
    const strainwave::InterleavedRecording<Real> recording = {
        .sample_count = samples,
        .measured_torque_Nm = torque_Nm.data(),
        .motor_speed_rad_s = speed_rad_s.data(),
        .torque_Nm = clean_Nm.data()};
    ASSERT_TRUE((strainwave::process_interleaved<Real, batch_orders>(
        run.configs, run.states, recording, {.level = level, .thread_count = 2})));
    for (std::size_t i = 0; i < channels; ++i) {
      EXPECT_EQ(run.states[i].counters.faults, alone.states[i].counters.faults);
      EXPECT_EQ(run.states[i].counters.samples, samples);
      for (std::size_t k = 0; k < samples; ++k) {
        ASSERT_NEAR(clean_Nm[place(i, k)], alone.logs[i].clean_Nm[k], tolerance_Nm<Real>);
      }
    }
    run.configs[5] = joint<Real>(5);  // ten orders: no kernel
    EXPECT_FALSE(
        (strainwave::process_interleaved<Real, batch_orders>(run.configs, run.states, recording)));
  }
}

TEST(Batch, ResultsThatNobodyWantsAreLeftOut) {
  Fleet<float> all = wild_fleet<float>();
  Fleet<float> some = all;
  all.process({});
  std::vector<OscillatorChannel<float>> channels;
  for (std::size_t i = 0; i < some.logs.size(); ++i) {
    channels.push_back(some.logs[i].channel());
    OscillatorChannel<float>& channel = channels.back();
    channel.torque_Nm = i % 4 == 0 ? nullptr : channel.torque_Nm;
    channel.ripple_Nm = i % 5 != 0 ? nullptr : channel.ripple_Nm;
    channel.status = i % 3 != 0 ? nullptr : channel.status;
  }
  strainwave::process_batch<float, batch_orders>(some.configs, some.states, channels);
  for (std::size_t i = 0; i < some.logs.size(); ++i) {
    const std::size_t size = some.logs[i].clean_Nm.size();
    const auto untouched = std::vector<float>(size, -99.0F);
    EXPECT_EQ(some.logs[i].clean_Nm, i % 4 == 0 ? untouched : all.logs[i].clean_Nm) << i;
    EXPECT_EQ(some.logs[i].ripple_Nm, i % 5 != 0 ? untouched : all.logs[i].ripple_Nm) << i;
    EXPECT_EQ(some.logs[i].status,
              i % 3 != 0 ? std::vector<strainwave::Status>(size, 0xFFFFFFFFU) : all.logs[i].status)
        << i;
    EXPECT_EQ(some.states[i].counters.faults, all.states[i].counters.faults) << i;
  }
}

TEST(Batch, NoChannelsAreNoWork) {
  Fleet<float> fleet;
  fleet.process({.thread_count = 4});
  EXPECT_TRUE(fleet.states.empty());
}

TEST(Batch, TheBestLevelIsAvailable) {
  EXPECT_TRUE(strainwave::is_available(strainwave::best_vector_level()));
  EXPECT_TRUE(strainwave::is_available(VectorLevel::one_by_one));
#if STRAINWAVE_HAS_X86_LEVELS
  // A higher level has everything that a lower one has.
  EXPECT_TRUE(strainwave::is_available(VectorLevel::x86_64_v3) ||
              !strainwave::is_available(VectorLevel::x86_64_v4));
#endif
}

}  // namespace
