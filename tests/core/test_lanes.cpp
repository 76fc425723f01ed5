// Arithmetic on lanes at every vector level against the standard library's, number by number.
#include "strainwave/lanes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#if STRAINWAVE_HAS_LANES
#define STRAINWAVE_LEVEL_FILE "../../tests/core/lanes_level_checks.hpp"
#include "strainwave/lanes_each_level.hpp"
#undef STRAINWAVE_LEVEL_FILE

namespace {

using strainwave::VectorLevel;

/// Calls with the functions of each level that this machine has.
#if STRAINWAVE_HAS_X86_LEVELS
#define FOR_EACH_LEVEL(call)                                \
  do {                                                      \
    if (strainwave::is_available(VectorLevel::x86_64_v2)) { \
      call(strainwave::level_v2);                           \
    }                                                       \
    if (strainwave::is_available(VectorLevel::x86_64_v3)) { \
      call(strainwave::level_v3);                           \
    }                                                       \
    if (strainwave::is_available(VectorLevel::x86_64_v4)) { \
      call(strainwave::level_v4);                           \
    }                                                       \
  } while (false)
#else
#define FOR_EACH_LEVEL(call) call(strainwave::level_portable)
#endif

template <class Real>
class LanesOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(LanesOf, Precisions);

TYPED_TEST(LanesOf, CosineAndSineAreGoodToTwoUnitsInTheLastPlace) {
  using Real = TypeParam;
  std::vector<Real> angle_rad;
  for (int i = -8000; i < 8000; ++i) {
    // All quadrants, their borders, and up to the largest rotation within a sample.
    angle_rad.push_back(static_cast<Real>(i % 3 == 0 ? i * 1.25 : i * 0.001));
  }
  std::vector<Real> cosine(angle_rad.size());
  std::vector<Real> sine(angle_rad.size());
#define CHECK_COS_SIN(level)                                                                     \
  level::cos_sin_of_array<Real>(angle_rad.data(), angle_rad.size(), cosine.data(), sine.data()); \
  expect_close()
  const auto expect_close = [&] {
    long double worst = 0.0L;
    for (std::size_t i = 0; i < angle_rad.size(); ++i) {
      const auto exact = static_cast<long double>(angle_rad[i]);
      worst = std::fmax(worst, std::fabs(static_cast<long double>(cosine[i]) - std::cos(exact)));
      worst = std::fmax(worst, std::fabs(static_cast<long double>(sine[i]) - std::sin(exact)));
    }
    EXPECT_LT(worst, 2.0L * static_cast<long double>(std::numeric_limits<Real>::epsilon()));
    EXPECT_GT(worst, 0.0L);
  };
  FOR_EACH_LEVEL(CHECK_COS_SIN);
}

TYPED_TEST(LanesOf, CosineAndSineOfSmallAnglesAreGoodToTheLastPlace) {
  using Real = TypeParam;
  constexpr auto epsilon = static_cast<long double>(std::numeric_limits<Real>::epsilon());
  std::vector<Real> angle_rad;
  for (int i = -3200; i <= 3200; i += 25) {
    angle_rad.push_back(static_cast<Real>(i) * Real(0.03 / 3200));
  }
  angle_rad.resize(272, Real(0));
  std::vector<Real> cosine(angle_rad.size());
  std::vector<Real> sine(angle_rad.size());
#define CHECK_SMALL(level)                                                                       \
  level::cos_sin_of_small<Real>(angle_rad.data(), angle_rad.size(), cosine.data(), sine.data()); \
  expect_close()
  const auto expect_close = [&] {
    for (std::size_t i = 0; i < angle_rad.size(); ++i) {
      const auto exact = static_cast<long double>(angle_rad[i]);
      EXPECT_LE(std::fabs(static_cast<long double>(cosine[i]) - std::cos(exact)), epsilon);
      // A rotation's error adds up from sample to sample: it is to be one of rounding.
      EXPECT_LE(std::fabs(static_cast<long double>(sine[i]) - std::sin(exact)),
                1.5L * epsilon * std::fabs(exact));
    }
  };
  FOR_EACH_LEVEL(CHECK_SMALL);
}

TYPED_TEST(LanesOf, ComparisonAndSelectionAreThoseOfSingleNumbers) {
  using Real = TypeParam;
  using Limits = std::numeric_limits<Real>;
  const Real numbers[] = {Real(0),
                          Real(-0.0),
                          Real(1),
                          Real(-2.5),
                          Real(4),
                          Real(1e30),
                          Limits::infinity(),
                          -Limits::infinity(),
                          Limits::quiet_NaN()};
  std::vector<Real> a;
  std::vector<Real> b;
  for (const Real first : numbers) {
    for (const Real second : numbers) {
      a.push_back(first);
      b.push_back(second);
    }
  }
  a.resize(96, Real(1));
  b.resize(96, Real(2));
  std::vector<Real> result(96);
#define CHECK_SELECTION(level)                                                \
  level::chosen_of_arrays<Real>(a.data(), b.data(), a.size(), result.data()); \
  expect_same()
  const auto expect_same = [&] {
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Real larger = a[i] > b[i] ? a[i] : b[i];
      const Real expected = a[i] < b[i] ? std::sqrt(std::fabs(a[i])) : larger;
      EXPECT_TRUE(result[i] == expected || (std::isnan(result[i]) && std::isnan(expected)))
          << a[i] << ", " << b[i] << ": " << result[i];
    }
  };
  FOR_EACH_LEVEL(CHECK_SELECTION);
}

TYPED_TEST(LanesOf, AnyAndAllAskEveryLane) {
  using Real = TypeParam;
  std::vector<int> answers(64);
#define CHECK_QUESTIONS(level)                                                       \
  for (std::size_t lane = 0; lane < 64; ++lane) {                                    \
    std::vector<Real> numbers(64, Real(2));                                          \
    numbers[lane] = Real(0);                                                         \
    level::asked_of_array<Real>(numbers.data(), 64, Real(1), answers.data());        \
    const std::size_t width = level::count_of_lanes<Real>();                         \
    for (std::size_t i = 0; i < 64; ++i) {                                           \
      EXPECT_EQ(answers[i], i / width == lane / width ? 1 : 0) << lane << ", " << i; \
    }                                                                                \
    level::asked_of_array<Real>(numbers.data(), 64, Real(3), answers.data());        \
    EXPECT_EQ(answers, std::vector<int>(64, 3));                                     \
  }
  FOR_EACH_LEVEL(CHECK_QUESTIONS);
}

}  // namespace

#endif
