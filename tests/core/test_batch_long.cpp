// One long log in time chunks against the same log in sequence.
#include "strainwave/batch_long.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "batch_examples.hpp"

namespace {

using strainwave::LongOptions;
using strainwave::LongReport;
using strainwave::OscillatorChannel;

constexpr std::size_t log_samples = 200'000;

/// The default tuning, its covariance at its steady state soon: what a long log is filtered with.
BatchConfig<float> joint_of_log() {
  BatchConfig<float> config = tuned<float, batch_orders>(3);
  config.orders[2] = {1, 2};
  return config;
}

/// A filter's results over a log, and what was reported.
struct Filtered {
  Log<float> log;
  BatchState<float> state;
  LongReport report;
};

Filtered filtered(const BatchConfig<float>& config, const Log<float>& log,
                  const LongOptions& options) {
  Filtered run{log, strainwave::initial_state(config), {}};
  run.report = process_long(config, run.state, run.log.channel(), options);
  return run;
}

double rms_difference_Nm(const Log<float>& a, const Log<float>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.clean_Nm.size(); ++k) {
    const auto difference = static_cast<double>(a.clean_Nm[k] - b.clean_Nm[k]);
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(a.clean_Nm.size()));
}

TEST(BatchLong, AWrongStartIsForgottenByAFactorOfEAMemory) {
  // Theory: the steady state of the Riccati equation forgets at sqrt(q / 2 R) a sample where the
  // motor turns many times within a memory.
  const auto config = tuned<double, 12>(2);
  const strainwave::detail::OscillatorMemory memory = strainwave::detail::memory_of(config);
  EXPECT_DOUBLE_EQ(memory.samples, std::sqrt(2.0 / 1e-4));
  EXPECT_DOUBLE_EQ(memory.travel_rad, 0.5);
  Log<double> log = quiet_log<double>(0, 20'000);
  std::fill(log.speed_rad_s.begin(), log.speed_rad_s.end(), 100.0);
  const OscillatorChannel<double> channel = log.channel();
  auto right = strainwave::initial_state(config);
  strainwave::detail::filter_one(config, right, strainwave::detail::part_of(channel, 0, 10'000));
  auto wrong = right;
  wrong.states_Nm[0] += 1.0;
  const auto part =
      strainwave::detail::part_of(channel, 10'000, static_cast<std::size_t>(8.0 * memory.samples));
  strainwave::detail::filter_one(config, right, part);
  strainwave::detail::filter_one(config, wrong, part);
  const double left =
      std::hypot(right.states_Nm[0] - wrong.states_Nm[0], right.states_Nm[1] - wrong.states_Nm[1]);
  EXPECT_NEAR(std::log(left), -8.0, 0.5);
}

TEST(BatchLong, WarmUpPassesOverStandstillAndUnusableSamples) {
  const BatchConfig<float> config = joint_of_log();
  Log<float> log = quiet_log<float>(0, 20'000);
  std::fill(log.speed_rad_s.begin(), log.speed_rad_s.end(), 100.0F);
  const auto warm_up = [&] {
    return strainwave::detail::warm_up_before(config, log.channel(), 15'000, 10.0);
  };
  const std::size_t moving = warm_up();
  // Ten memories of sqrt(2 R / q) samples; 2 rad of travel, 20 samples, come to less.
  EXPECT_NEAR(static_cast<double>(moving), 10.0 * std::sqrt(2.0 / 1e-4), 2.0);
  std::fill(log.speed_rad_s.begin() + 13'500, log.speed_rad_s.begin() + 14'500, 0.0F);
  EXPECT_NEAR(static_cast<double>(warm_up()), static_cast<double>(moving) + 1000.0, 5.0);
  std::fill(log.torque_Nm.begin() + 13'000, log.torque_Nm.begin() + 13'100, NAN);
  EXPECT_NEAR(static_cast<double>(warm_up()), static_cast<double>(moving) + 1100.0, 5.0);
  std::fill(log.speed_rad_s.begin(), log.speed_rad_s.end(), 0.0F);
  EXPECT_EQ(warm_up(), 15'000U);
}

TEST(BatchLong, ChunksAreTheSequenceWithinTheReportedDifference) {
  const BatchConfig<float> config = joint_of_log();
  const Log<float> log = wild_log<float>(1, log_samples);
  const Filtered sequence = filtered(config, log, {.in_sequence = true});
  EXPECT_EQ(sequence.report.chunk_count, 1U);
  for (const strainwave::VectorLevel level : vector_levels()) {
    const Filtered chunks =
        filtered(config, log, {.batch = {.level = level, .thread_count = 2}, .tolerance_Nm = 1e-3});
    EXPECT_GT(chunks.report.chunk_count, 8U);
    EXPECT_EQ(chunks.report.repeated_chunks, 0U);
    EXPECT_LT(chunks.report.largest_ripple_difference_Nm, 2e-4);
    EXPECT_LT(rms_difference_Nm(chunks.log, sequence.log), 1e-4);
    // Which samples count as at rest is decided by sums that were begun elsewhere.
    std::size_t other = 0;
    for (std::size_t k = 0; k < log_samples; ++k) {
      other += chunks.log.status[k] != sequence.log.status[k] ? 1U : 0U;
    }
    EXPECT_LE(other, log_samples / 10'000);
    EXPECT_EQ(chunks.state.counters.samples, log_samples);
    EXPECT_EQ(chunks.state.counters.faults, sequence.state.counters.faults);
  }
}

TEST(BatchLong, TheEndGoesOnLikeTheSequence) {
  const BatchConfig<float> config = joint_of_log();
  const Log<float> log = quiet_log<float>(1, log_samples);
  Filtered chunks = filtered(config, log, {});
  Filtered sequence = filtered(config, log, {.in_sequence = true});
  ASSERT_GT(chunks.report.chunk_count, 1U);
  Log<float> rest = quiet_log<float>(6, 3000);
  Log<float> other_rest = rest;
  strainwave::detail::filter_one(config, chunks.state, rest.channel());
  strainwave::detail::filter_one(config, sequence.state, other_rest.channel());
  EXPECT_LT(rms_difference_Nm(rest, other_rest), 1e-4);
  EXPECT_EQ(rest.status, other_rest.status);
}

TEST(BatchLong, TooShortAWarmUpIsFoundAndRepeated) {
  const BatchConfig<float> config = joint_of_log();
  const Log<float> log = quiet_log<float>(0, log_samples);
  const Filtered sequence = filtered(config, log, {.in_sequence = true});
  // Half a memory leaves most of a wrong start: every chunk differs, and none is believed.
  const Filtered repeated = filtered(config, log, {.warm_up_memories = 0.5});
  EXPECT_GT(repeated.report.chunk_count, 8U);
  EXPECT_EQ(repeated.report.repeated_chunks, repeated.report.chunk_count - 1);
  EXPECT_LT(rms_difference_Nm(repeated.log, sequence.log), 1e-4);
  EXPECT_EQ(repeated.state.counters.samples, log_samples);
  // Told to believe them, it reports by how much they differ.
  const Filtered believed = filtered(
      config, log, {.warm_up_memories = 0.5, .tolerance_Nm = 1e3, .state_tolerance_Nm = 1e3});
  EXPECT_EQ(believed.report.repeated_chunks, 0U);
  EXPECT_GT(believed.report.largest_ripple_difference_Nm, 1e-2);
  EXPECT_GT(rms_difference_Nm(believed.log, sequence.log), 1e-3);
}

TEST(BatchLong, WhereNothingIsForgottenTheLogIsFilteredInSequence) {
  BatchConfig<float> config = joint_of_log();
  const Log<float> log = quiet_log<float>(0, 8000);
  config.process_noise_variance_Nm2[1] = 0.0F;
  const Filtered never = filtered(config, log, {});
  EXPECT_EQ(never.report.chunk_count, 1U);
  const Filtered sequence = filtered(config, log, {.in_sequence = true});
  EXPECT_EQ(never.log.clean_Nm, sequence.log.clean_Nm);
}

}  // namespace
