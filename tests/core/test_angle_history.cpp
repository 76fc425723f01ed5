#include "strainwave/angle_history.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "ripple_examples.hpp"

namespace {

using strainwave::AngleHistory;
using strainwave::duration_of;
using strainwave::remember;
using strainwave::rotation_during;

template <class Real>
class AngleHistoryOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(AngleHistoryOf, Precisions);

/// Given where the record is long enough for it not to matter.
template <class Real>
constexpr Real unused_speed = Real(1e9);

TYPED_TEST(AngleHistoryOf, BeforeTheRecordTheMotorTurnedAtTheGivenSpeed) {
  using Real = TypeParam;
  AngleHistory<Real> history;
  EXPECT_EQ(duration_of(history), Real(0));
  EXPECT_EQ(rotation_during(history, Real(0.01), Real(0)), Real(0));
  EXPECT_NEAR(rotation_during(history, Real(0.01), Real(-70)), Real(-0.7), Real(1e-6));
  remember(history, Real(0.01), Real(0.001), Real(0.2));
  EXPECT_EQ(duration_of(history), Real(0.001));
  EXPECT_NEAR(rotation_during(history, Real(0.01), Real(0)), Real(0.2), Real(1e-6));
  EXPECT_NEAR(rotation_during(history, Real(0.01), Real(50)), Real(0.2 + 0.45), Real(1e-6));
  EXPECT_NEAR(rotation_during(history, Real(0.0005), Real(50)), Real(0.1), Real(1e-6));
  EXPECT_EQ(rotation_during(history, Real(0), Real(50)), Real(0));
}

TYPED_TEST(AngleHistoryOf, DurationIsThatOfThePointsAndWhatCameSince) {
  using Real = TypeParam;
  AngleHistory<Real> history;
  for (int k = 1; k <= 40; ++k) {  // points 1 ms apart: a twelfth of 12 ms
    remember(history, Real(0.012), Real(0.00055), Real(0.1));
    const double expected_s = 0.00055 * (k <= 32 ? k : 32 + k % 2);
    ASSERT_NEAR(static_cast<double>(duration_of(history)), expected_s, 1e-8) << k;
  }
}

TYPED_TEST(AngleHistoryOf, ConstantSpeedIsExactForEveryDelay) {
  using Real = TypeParam;
  for (const double delay_s : {1e-4, 0.0023, 0.01, 0.05}) {
    for (const double interval_s : {5e-5, 1.25e-4, 1e-3, 2.5e-3}) {
      AngleHistory<Real> history;
      for (int k = 0; k < 3000; ++k) {
        remember(history, static_cast<Real>(delay_s), static_cast<Real>(interval_s),
                 static_cast<Real>(-150.0 * interval_s));
        if (k * interval_s > delay_s) {
          ASSERT_NEAR(static_cast<double>(
                          rotation_during(history, static_cast<Real>(delay_s), unused_speed<Real>)),
                      -150.0 * delay_s, 150.0 * delay_s * (sizeof(Real) == 4 ? 2e-5 : 1e-12))
              << delay_s << " " << interval_s << " " << k;
        }
      }
    }
  }
}

/// Largest error of the rotation during the delay while the motor speeds up, turns back and
/// jitters.
template <class Real>
double largest_error_rad(double delay_s, double mean_interval_s, double jitter) {
  const auto angle = [](double t) { return 80.0 * t + 30.0 * std::sin(5.0 * t) + 3.0 * t * t; };
  AngleHistory<Real> history;
  Random random(7);
  double time_s = 0.0;
  double worst = 0.0;
  while (time_s < 2.0) {
    const double interval_s = mean_interval_s * (1.0 + jitter * random.uniform());
    const double before = angle(time_s);
    time_s += interval_s;
    remember(history, static_cast<Real>(delay_s), static_cast<Real>(interval_s),
             static_cast<Real>(angle(time_s) - before));
    if (time_s > 2.0 * delay_s) {
      const double expected = angle(time_s) - angle(time_s - delay_s);
      const auto found = static_cast<double>(
          rotation_during(history, static_cast<Real>(delay_s), unused_speed<Real>));
      worst = std::fmax(worst, std::fabs(found - expected));
    }
  }
  return worst;
}

TYPED_TEST(AngleHistoryOf, ChangingSpeedIsInterpolatedBetweenPoints) {
  // A chord of an arc: an eighth of the acceleration, 756 rad/s^2, times the points' distance
  // squared; the distance is a sample or a twelfth of the delay and up to a sample more.
  const double acceleration = 756.0;
  for (const double delay_s : {0.0023, 0.0101, 0.05}) {
    for (const double interval_s : {5e-5, 1.25e-4, 1e-3}) {
      for (const double jitter : {0.0, 0.5}) {
        const double longest_s = (1.0 + jitter) * interval_s;
        const double distance_s =
            interval_s * (1.0 - jitter) >= delay_s / 12.0 ? longest_s : delay_s / 12.0 + longest_s;
        const double bound = acceleration / 8.0 * distance_s * distance_s;
        const double worst = largest_error_rad<TypeParam>(delay_s, interval_s, jitter);
        EXPECT_LT(worst, 1.02 * bound + (sizeof(TypeParam) == 4 ? 2e-5 : 1e-12))
            << delay_s << " " << interval_s << " " << jitter;
        EXPECT_GT(worst, 0.02 * bound) << delay_s << " " << interval_s;
      }
    }
  }
}

TYPED_TEST(AngleHistoryOf, CapacityHoldsTheLongestDelayAtTheHighestRate) {
  using Real = TypeParam;
  const auto delay_s = static_cast<Real>(strainwave::longest_delay_s);
  for (const double interval_s : {5e-5, 1e-3, 4.1e-3, 4.2e-3, 0.03, 0.2}) {
    AngleHistory<Real> history;
    for (int k = 0; k < 5000; ++k) {
      remember(history, delay_s, static_cast<Real>(interval_s), Real(1));
      ASSERT_LE(history.count, AngleHistory<Real>::capacity);
      ASSERT_LT(history.newest, AngleHistory<Real>::capacity);
    }
    double span_s = 0.0;
    for (const Real part : history.intervals_s) {
      span_s += static_cast<double>(part);
    }
    EXPECT_GT(span_s, static_cast<double>(delay_s) * 1.2);
    EXPECT_NEAR(static_cast<double>(rotation_during(history, delay_s, unused_speed<Real>)),
                static_cast<double>(delay_s) / interval_s,
                static_cast<double>(delay_s) / interval_s * 1e-3);
  }
}

TYPED_TEST(AngleHistoryOf, AGapIsOnePieceOfTheRecord) {
  using Real = TypeParam;
  AngleHistory<Real> history;
  for (int k = 0; k < 100; ++k) {
    remember(history, Real(0.01), Real(0.001), Real(0.1));
  }
  remember(history, Real(0.01), Real(1), Real(50));
  EXPECT_NEAR(rotation_during(history, Real(0.01), unused_speed<Real>), Real(0.5), Real(1e-5));
  remember(history, Real(0.01), Real(0.001), Real(0.1));
  EXPECT_NEAR(rotation_during(history, Real(0.01), unused_speed<Real>), Real(0.1 + 0.45),
              Real(1e-5));
}

}  // namespace
