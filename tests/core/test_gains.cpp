#include "strainwave/gains.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace {

using strainwave::Gains;

template <class Real>
class GainsOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GainsOf, Precisions);

TYPED_TEST(GainsOf, WeightedSumOfExactNumbers) {
  const Gains<TypeParam, 4> gains{3, {TypeParam(0.5), TypeParam(-2), TypeParam(4)}};
  const TypeParam signals[4] = {TypeParam(8), TypeParam(0.25), TypeParam(-1), TypeParam(1e6)};
  EXPECT_EQ(strainwave::weighted_sum(gains, signals), TypeParam(-0.5));  // the fourth is not read
}

TYPED_TEST(GainsOf, NoiseFactorOfKnownGains) {
  const Gains<TypeParam, 5> equal{
      5, {TypeParam(2), TypeParam(2), TypeParam(2), TypeParam(2), TypeParam(2)}};
  EXPECT_EQ(strainwave::noise_factor(equal), TypeParam(1));
  const Gains<TypeParam, 5> one{2, {TypeParam(1), TypeParam(0)}};
  EXPECT_EQ(strainwave::noise_factor(one), TypeParam(2));
  // The gains of Godler's experiment, sum 3: 1.0022 from the three numbers by hand.
  const Gains<TypeParam, 5> godler{3, {TypeParam(1.0586), TypeParam(0.9966), TypeParam(0.9448)}};
  EXPECT_NEAR(strainwave::noise_factor(godler), TypeParam(1.00216), TypeParam(1e-5));
}

TYPED_TEST(GainsOf, ConvertedKeepsCountAndValues) {
  const Gains<double, 3> gains{3, {1.0586, 0.9966, 0.9448}};
  const auto copy = strainwave::converted<TypeParam, 8>(gains);
  ASSERT_EQ(copy.count, 3U);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_EQ(copy.values[j], static_cast<TypeParam>(gains.values[j]));
  }
}

TYPED_TEST(GainsOf, CheckNamesTheElement) {
  Gains<TypeParam, 3> gains{3, {TypeParam(1), TypeParam(1), TypeParam(1)}};
  EXPECT_TRUE(check(gains).ok());
  gains.values[1] = std::numeric_limits<TypeParam>::quiet_NaN();
  EXPECT_STREQ(check(gains).parameter, "gains");
  EXPECT_EQ(check(gains).index, 1);
  gains = {3, {TypeParam(1), TypeParam(-2), TypeParam(1)}};
  EXPECT_FALSE(check(gains).ok());  // the sum cancels the torque
  gains = {0, {}};
  EXPECT_FALSE(check(gains).ok());
  gains.count = 4;
  EXPECT_FALSE(check(gains).ok());
}

TYPED_TEST(GainsOf, CheckRefusesASumThatOverflows) {
  const TypeParam largest = std::numeric_limits<TypeParam>::max();
  const Gains<TypeParam, 2> gains{2, {largest, largest}};
  EXPECT_FALSE(check(gains).ok()) << "the sum of the gains is infinite";
}

}  // namespace
