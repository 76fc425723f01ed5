#include "strainwave/arithmetic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace {

using strainwave::cos_sin_of_fraction;
using strainwave::cos_sin_of_radians;
using strainwave::CosSin;

/// Distance of a result from a reference in units in the last place of Real at 1.
template <class Real>
double error_in_epsilon(Real value, long double reference) {
  const long double distance = std::fabs(static_cast<long double>(value) - reference);
  return static_cast<double>(distance /
                             static_cast<long double>(std::numeric_limits<Real>::epsilon()));
}

template <class Real>
double error_of_pair(const CosSin<Real>& pair, long double angle_rad) {
  return std::max(error_in_epsilon(pair.cosine, std::cos(angle_rad)),
                  error_in_epsilon(pair.sine, std::sin(angle_rad)));
}

template <class Real>
class Arithmetic : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Arithmetic, Precisions);

TYPED_TEST(Arithmetic, FinitenessOfEveryKindOfNumber) {
  using Limits = std::numeric_limits<TypeParam>;
  static_assert(strainwave::is_finite(TypeParam(0)));
  EXPECT_TRUE(strainwave::is_finite(Limits::max()));
  EXPECT_TRUE(strainwave::is_finite(Limits::lowest()));
  EXPECT_TRUE(strainwave::is_finite(Limits::denorm_min()));
  EXPECT_FALSE(strainwave::is_finite(Limits::infinity()));
  EXPECT_FALSE(strainwave::is_finite(-Limits::infinity()));
  EXPECT_FALSE(strainwave::is_finite(Limits::quiet_NaN()));
}

TYPED_TEST(Arithmetic, SquareRootIsCorrectlyRounded) {
  EXPECT_EQ(strainwave::square_root(TypeParam(2)), std::sqrt(TypeParam(2)));
  EXPECT_EQ(strainwave::square_root(TypeParam(0)), TypeParam(0));
  EXPECT_EQ(strainwave::square_root(TypeParam(6.25)), TypeParam(2.5));
}

TYPED_TEST(Arithmetic, AbsoluteKeepsZeroAndNaN) {
  EXPECT_EQ(strainwave::absolute(TypeParam(-3)), TypeParam(3));
  EXPECT_EQ(strainwave::absolute(TypeParam(3)), TypeParam(3));
  EXPECT_TRUE(std::isnan(strainwave::absolute(std::numeric_limits<TypeParam>::quiet_NaN())));
}

TYPED_TEST(Arithmetic, CosSinOfFractionOverTheWholeTurn) {
  // 2^22 fractions: every 1021st (a prime: all low bits occur) over the turn.
  double worst = 0.0;
  for (std::uint64_t fraction = 0; fraction < (std::uint64_t{1} << 32U); fraction += 1021) {
    const auto pair = cos_sin_of_fraction<TypeParam>(static_cast<std::uint32_t>(fraction));
    const long double angle =
        static_cast<long double>(fraction) * 0x1p-32L * 6.283185307179586476925286766559005768L;
    worst = std::max(worst, error_of_pair(pair, angle));
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_GT(worst, 0.25);  // a reference that agreed better would be the same code
}

TYPED_TEST(Arithmetic, QuartersOfATurnAreExact) {
  const std::uint32_t quarter = 1U << 30U;
  const int cosines[4] = {1, 0, -1, 0};
  const int sines[4] = {0, 1, 0, -1};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto pair = cos_sin_of_fraction<TypeParam>(i * quarter);
    EXPECT_EQ(pair.cosine, TypeParam(cosines[i]));
    EXPECT_EQ(pair.sine, TypeParam(sines[i]));
  }
}

TYPED_TEST(Arithmetic, CosSinOfFractionIsContinuousWhereTheOctantsMeet) {
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    for (std::uint32_t offset = 0; offset < 5; ++offset) {
      const std::uint32_t fraction = (octant << 29U) + offset - 2U;
      const long double angle =
          static_cast<long double>(fraction) * 0x1p-32L * 6.283185307179586476925286766559005768L;
      EXPECT_LT(error_of_pair(cos_sin_of_fraction<TypeParam>(fraction), angle), 1.0) << fraction;
    }
  }
}

TYPED_TEST(Arithmetic, CosSinOfRadiansNearZero) {
  double worst = 0.0;
  for (int i = -200'000; i <= 200'000; ++i) {
    const TypeParam angle = static_cast<TypeParam>(i) * TypeParam(6.4e-5);  // within +-12.8 rad
    worst = std::max(worst, error_of_pair(cos_sin_of_radians(angle), angle));
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_GT(worst, 0.25);
}

TYPED_TEST(Arithmetic, CosSinOfRadiansOverItsWholeRange) {
  const auto range = static_cast<TypeParam>(strainwave::largest_reducible_angle_rad);
  double worst = 0.0;
  for (int i = -500'000; i <= 500'000; ++i) {
    const TypeParam angle = range * (static_cast<TypeParam>(i) / TypeParam(500'000));
    worst = std::max(worst, error_of_pair(cos_sin_of_radians(angle), angle));
  }
  EXPECT_LT(worst, 1.5);
}

TYPED_TEST(Arithmetic, CosSinOfRadiansAtMultiplesOfAQuarterTurn) {
  // The hardest angles for the reduction: nothing is left of them but its rounding.
  double worst = 0.0;
  for (int i = -63'000; i <= 63'000; ++i) {
    const auto angle = static_cast<TypeParam>(1.5707963267948966192L * i);
    worst = std::max(worst, error_of_pair(cos_sin_of_radians(angle), angle));
  }
  EXPECT_LT(worst, 1.5);
}

TYPED_TEST(Arithmetic, CosSinOfTinyAndZeroAngles) {
  const TypeParam tiny = std::numeric_limits<TypeParam>::denorm_min();
  EXPECT_EQ(cos_sin_of_radians(TypeParam(0)).cosine, TypeParam(1));
  EXPECT_EQ(cos_sin_of_radians(TypeParam(0)).sine, TypeParam(0));
  EXPECT_EQ(cos_sin_of_radians(tiny).sine, tiny);
  EXPECT_EQ(cos_sin_of_radians(-tiny).sine, -tiny);
}

TYPED_TEST(Arithmetic, EvaluatesInConstantExpressions) {
  static_assert(cos_sin_of_fraction<TypeParam>(1U << 31U).cosine == TypeParam(-1));
  static_assert(cos_sin_of_radians(TypeParam(0)).cosine == TypeParam(1));
}

TYPED_TEST(Arithmetic, AngleOfAVectorIsItsArcTangent) {
  double worst = 0.0;
  for (int i = -100'000; i <= 100'000; ++i) {
    const long double angle = 3.1415L * static_cast<long double>(i) / 100'000.0L;
    for (const double length : {1.0, 1e-3, 7e5}) {
      const auto x = static_cast<TypeParam>(length * static_cast<double>(std::cos(angle)));
      const auto y = static_cast<TypeParam>(length * static_cast<double>(std::sin(angle)));
      const long double expected =
          std::atan2(static_cast<long double>(y), static_cast<long double>(x));
      worst = std::max(worst, error_in_epsilon(strainwave::angle_of(x, y), expected));
    }
  }
  EXPECT_LT(worst, 4.0);  // an angle near pi is rounded to 2 by itself
  EXPECT_GT(worst, 0.25);
}

TYPED_TEST(Arithmetic, AngleOfAVectorOnTheAxesAndDiagonals) {
  using strainwave::angle_of;
  const double pi = 3.14159265358979323846;
  const TypeParam one = 1;
  const double tolerance = 4.0 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  for (std::size_t at = 0; at < 8; ++at) {
    const int x[8] = {-1, 0, 1, 1, 1, 0, -1, -1};  // octants -3 to 4
    const int y[8] = {-1, -1, -1, 0, 1, 1, 1, 0};
    const double octant = static_cast<double>(at) - 3.0;
    EXPECT_NEAR(static_cast<double>(angle_of(one * static_cast<TypeParam>(x[at]),
                                             one * static_cast<TypeParam>(y[at]))),
                octant * pi / 4.0, tolerance)
        << octant;
  }
  EXPECT_EQ(angle_of(one, TypeParam(0)), TypeParam(0));
}

TYPED_TEST(Arithmetic, AngleOfVectorsOfEveryLength) {
  using Limits = std::numeric_limits<TypeParam>;
  using strainwave::angle_of;
  const double eighth = 0.78539816339744830962;
  for (const TypeParam size : {Limits::max(), Limits::min(), TypeParam(1e-30), TypeParam(1e30)}) {
    EXPECT_NEAR(static_cast<double>(angle_of(size, size)), eighth, 1e-6);
    EXPECT_NEAR(static_cast<double>(angle_of(-size, -size)), -3.0 * eighth, 1e-6);
    EXPECT_EQ(angle_of(size, TypeParam(0)), TypeParam(0));
  }
  EXPECT_NEAR(static_cast<double>(angle_of(Limits::max(), Limits::min())), 0.0, 1e-30);
  EXPECT_EQ(angle_of(TypeParam(0), TypeParam(0)), TypeParam(0));
  const TypeParam strange[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()};
  for (const TypeParam value : strange) {
    for (const TypeParam other : {TypeParam(0), TypeParam(1), TypeParam(-2), value}) {
      EXPECT_EQ(angle_of(value, other), TypeParam(0));
      EXPECT_EQ(angle_of(other, value), TypeParam(0));
    }
  }
}

TYPED_TEST(Arithmetic, AngleOfAVectorNeverLeavesItsRange) {
  for (int i = 0; i < 2000; ++i) {
    const TypeParam small = static_cast<TypeParam>(i) * std::numeric_limits<TypeParam>::epsilon();
    for (const TypeParam y : {small, -small}) {
      const TypeParam angle = strainwave::angle_of(TypeParam(-1), y);
      ASSERT_LE(std::fabs(angle), strainwave::pi<TypeParam>);
      ASSERT_GT(std::fabs(angle), TypeParam(3.1));
    }
  }
}

}  // namespace
