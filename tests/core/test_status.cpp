#include "strainwave/status.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace {

using strainwave::EventCounters;
using strainwave::mask;
using strainwave::record;
using strainwave::Status;
using strainwave::StatusFlag;

TEST(Status, NumbersThatLogsKeep) {
  EXPECT_EQ(mask(StatusFlag::torque_not_finite), 1U);
  EXPECT_EQ(mask(StatusFlag::rotation_invalid), 2U);
  EXPECT_EQ(mask(StatusFlag::expected_torque_not_finite), 4U);
  EXPECT_EQ(mask(StatusFlag::gauge_saturated), 8U);
  EXPECT_EQ(mask(StatusFlag::temperature_not_finite), 16U);
  EXPECT_EQ(mask(StatusFlag::sample_repeated), 32U);
  EXPECT_EQ(mask(StatusFlag::sample_out_of_order), 64U);
  EXPECT_EQ(mask(StatusFlag::time_not_finite), 128U);
  EXPECT_EQ(mask(StatusFlag::gauges_insufficient), 256U);
  EXPECT_EQ(mask(StatusFlag::variance_limited), 0x1000U);
  EXPECT_EQ(mask(StatusFlag::covariance_reset), 0x2000U);
  EXPECT_EQ(mask(StatusFlag::at_rest), 0x100000U);
  EXPECT_EQ(mask(StatusFlag::samples_missing), 0x200000U);
  EXPECT_EQ(mask(StatusFlag::order_above_nyquist), 0x400000U);
  EXPECT_EQ(mask(StatusFlag::temperature_out_of_range), 0x800000U);
  EXPECT_EQ(mask(StatusFlag::gauge_lost), 0x1000000U);
  EXPECT_EQ(mask(StatusFlag::gauge_suspected), 0x2000000U);
  EXPECT_EQ(mask(StatusFlag::gauges_disagree), 0x4000000U);
}

TEST(Status, MasksDivideAllBits) {
  EXPECT_EQ(strainwave::fault_mask | strainwave::limit_mask | strainwave::warning_mask,
            0xFFFFFFFFU);
  EXPECT_EQ(strainwave::fault_mask & strainwave::limit_mask, 0U);
  EXPECT_EQ(strainwave::fault_mask & strainwave::warning_mask, 0U);
  EXPECT_EQ(strainwave::limit_mask & strainwave::warning_mask, 0U);
  EXPECT_NE(mask(StatusFlag::sample_out_of_order) & strainwave::fault_mask, 0U);
  EXPECT_NE(mask(StatusFlag::covariance_reset) & strainwave::limit_mask, 0U);
  EXPECT_NE(mask(StatusFlag::at_rest) & strainwave::warning_mask, 0U);
}

TEST(Status, CountsSamplesFaultsAndEachBit) {
  EventCounters counters;
  record(counters, 0);
  record(counters, mask(StatusFlag::torque_not_finite) | mask(StatusFlag::rotation_invalid));
  record(counters, mask(StatusFlag::at_rest));
  record(counters, mask(StatusFlag::variance_limited) | 0x80000000U);
  EXPECT_EQ(counters.samples, 4U);
  EXPECT_EQ(counters.faults, 1U);
  std::uint32_t sum = 0;
  for (const std::uint32_t count : counters.by_bit) {
    sum += count;
  }
  EXPECT_EQ(sum, 5U);
  EXPECT_EQ(counters.by_bit[0], 1U);
  EXPECT_EQ(counters.by_bit[1], 1U);
  EXPECT_EQ(counters.by_bit[12], 1U);
  EXPECT_EQ(counters.by_bit[20], 1U);
  EXPECT_EQ(counters.by_bit[31], 1U);
}

TEST(Status, CountersStayAtTheirLargestValue) {
  EventCounters counters;
  counters.samples = 0xFFFFFFFEU;
  counters.by_bit[0] = 0xFFFFFFFFU;
  record(counters, 1U);
  record(counters, 1U);
  EXPECT_EQ(counters.samples, 0xFFFFFFFFU);
  EXPECT_EQ(counters.by_bit[0], 0xFFFFFFFFU);
  EXPECT_EQ(counters.faults, 2U);
}

}  // namespace
