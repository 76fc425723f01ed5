#include "strainwave/sample_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using strainwave::has;
using strainwave::SampleClock;
using strainwave::StatusFlag;
using strainwave::take_stamp;

/// A clock that has run for 1000 samples at 1 kHz, until 1.999 s.
SampleClock running() {
  SampleClock clock;
  for (int k = 0; k < 1000; ++k) {
    (void)take_stamp(clock, 1.0 + 1e-3 * k);
  }
  return clock;
}

TEST(SampleClock, TheFirstStampBeginsAndTheNextOnesAreIntervals) {
  SampleClock clock;
  const auto first = take_stamp(clock, 1e9);
  EXPECT_EQ(first.interval_s, 0.0);
  EXPECT_EQ(first.status, 0U);
  const double stamps[] = {1e9 + 0.001, 1e9 + 0.0025, 1e9 + 0.003};
  double before = 1e9;
  for (const double stamp : stamps) {
    const auto next = take_stamp(clock, stamp);
    EXPECT_EQ(next.interval_s, stamp - before);  // as recorded, to the last bit
    EXPECT_EQ(next.status, 0U);
    before = stamp;
  }
}

TEST(SampleClock, GapsAreTakenAsTheyAreAndSaid) {
  SampleClock clock = running();
  const auto gap = take_stamp(clock, 3.0);
  EXPECT_NEAR(gap.interval_s, 1.001, 1e-12);
  EXPECT_EQ(gap.status, strainwave::mask(StatusFlag::samples_missing));
  EXPECT_NEAR(clock.typical_interval_s, 1e-3 * (1.0 + 1.0 / 64.0), 1e-9);
  const auto after = take_stamp(clock, 3.001);
  EXPECT_EQ(after.status, 0U);
  EXPECT_FALSE(has(take_stamp(clock, 3.0058).status, StatusFlag::samples_missing));  // 4.8
  EXPECT_TRUE(has(take_stamp(clock, 3.0120).status, StatusFlag::samples_missing));   // 6.2
}

TEST(SampleClock, ANewRateIsLearned) {
  SampleClock clock = running();
  int missing = 0;
  for (int k = 1; k <= 1000; ++k) {
    missing += take_stamp(clock, 1.999 + 0.01 * k).status != 0 ? 1 : 0;
  }
  EXPECT_GT(missing, 20);
  EXPECT_LT(missing, 150);
  EXPECT_NEAR(clock.typical_interval_s, 0.01, 1e-4);
}

TEST(SampleClock, OlderAndEqualStampsAreRefused) {
  SampleClock clock = running();
  for (const double stamp : {1.999, 1.998, -1.0, 0.0}) {
    const auto late = take_stamp(clock, stamp);
    EXPECT_EQ(late.interval_s, 0.0);
    EXPECT_EQ(late.status, strainwave::mask(StatusFlag::sample_out_of_order));
  }
  const auto next = take_stamp(clock, 2.0);
  EXPECT_NEAR(next.interval_s, 0.001, 1e-12);
  EXPECT_EQ(next.status, 0U);
}

TEST(SampleClock, StampsThatAreNoNumbersChangeNothing) {
  SampleClock clock = running();
  for (const double stamp :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    const auto unusable = take_stamp(clock, stamp);
    EXPECT_EQ(unusable.interval_s, 0.0);
    EXPECT_EQ(unusable.status, strainwave::mask(StatusFlag::time_not_finite));
  }
  EXPECT_NEAR(take_stamp(clock, 2.0).interval_s, 0.001, 1e-12);
  SampleClock fresh;
  (void)take_stamp(fresh, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(fresh.started);
}

TEST(SampleClock, SetBackIsAcceptedAfterTenRows) {
  SampleClock clock = running();
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(take_stamp(clock, 0.5 + 1e-3 * k).status,
              strainwave::mask(StatusFlag::sample_out_of_order));
  }
  const auto accepted = take_stamp(clock, 0.510);
  EXPECT_EQ(accepted.status, strainwave::mask(StatusFlag::samples_missing));
  EXPECT_NEAR(accepted.interval_s, 11e-3, 1e-9);  // typical ones: this row's and ten refused
  const auto next = take_stamp(clock, 0.511);
  EXPECT_NEAR(next.interval_s, 0.001, 1e-12);
  EXPECT_EQ(next.status, 0U);
}

TEST(SampleClock, AGoodStampBetweenForgetsTheOlderOnes) {
  SampleClock clock = running();
  for (int round = 0; round < 5; ++round) {
    for (int k = 0; k < 9; ++k) {
      EXPECT_TRUE(has(take_stamp(clock, 0.5).status, StatusFlag::sample_out_of_order));
    }
    EXPECT_EQ(take_stamp(clock, 2.0 + 1e-3 * round).status, 0U);
  }
}

TEST(SampleClock, IntervalsStayNumbersWhateverTheStamps) {
  const double wild[] = {1e300,  -1e300, 1.7e308,  -1.7e308, 0.0, 1.0,
                         5e-324, NAN,    INFINITY, 1e15,     2.0, 2.001};
  SampleClock clock;
  std::uint32_t state = 1;
  for (int k = 0; k < 20'000; ++k) {
    state = state * 1664525U + 1013904223U;
    const auto interval = take_stamp(clock, wild[(state >> 16U) % 12U]);
    // Beyond double's range an interval may be infinite, which the filter refuses; never NaN.
    ASSERT_FALSE(std::isnan(interval.interval_s)) << k;
    ASSERT_GE(interval.interval_s, 0.0) << k;
  }
}

}  // namespace
