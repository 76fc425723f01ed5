#include "strainwave/gear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using strainwave::GearConfig;
using strainwave::GearConfiguration;
using strainwave::Rational;

constexpr auto circular = GearConfiguration::fixed_circular_spline;
constexpr auto flexspline = GearConfiguration::fixed_flexspline;

TEST(Gear, NominalRatioOfToothCounts) {  // Godler 2000, eq. (1)
  EXPECT_EQ(strainwave::nominal_ratio(200, 202), (Rational{100, 1}));
  EXPECT_EQ(strainwave::nominal_ratio(100, 102), (Rational{50, 1}));
  EXPECT_EQ(strainwave::nominal_ratio(241, 243), (Rational{241, 2}));  // 120.5
  EXPECT_EQ(strainwave::nominal_ratio(300, 304), (Rational{75, 1}));   // a three-lobe gear's kind
}

TEST(Gear, NominalRatioRefusesImpossibleTeeth) {
  EXPECT_FALSE(strainwave::is_valid(strainwave::nominal_ratio(202, 200)));
  EXPECT_FALSE(strainwave::is_valid(strainwave::nominal_ratio(200, 200)));
  EXPECT_FALSE(strainwave::is_valid(strainwave::nominal_ratio(0, 2)));
}

TEST(Gear, SignedRatioOfBothConfigurations) {  // Godler 2000, eq. (2)
  EXPECT_EQ(strainwave::signed_reduction_ratio<double>(circular, {50, 1}), -50.0);
  EXPECT_EQ(strainwave::signed_reduction_ratio<double>(flexspline, {50, 1}), 51.0);
  EXPECT_EQ(strainwave::signed_reduction_ratio<float>(flexspline, {241, 2}), 121.5F);
}

TEST(Gear, GearFromTeethHasMagnitudeAndDirection) {
  constexpr auto a = strainwave::gear_from_teeth<double>(circular, 200, 202, 40.0);
  EXPECT_EQ(a.ratio, (Rational{100, 1}));
  EXPECT_EQ(a.output_direction, -1);
  EXPECT_TRUE(check(a).ok());
  // Godler's own experiment: flexspline fixed, ratio 51, 100 Nm.
  constexpr auto b = strainwave::gear_from_teeth<double>(flexspline, 100, 102, 100.0);
  EXPECT_EQ(b.ratio, (Rational{51, 1}));
  EXPECT_EQ(b.output_direction, 1);
  EXPECT_TRUE(check(b).ok());
}

/// Turns of the wave generator against the flexspline per motor turn, from how the parts move.
double relative_turns(GearConfiguration configuration, double nominal) {
  // Circular spline fixed: per motor turn the flexspline turns by 1/R_c = -1/R.
  return configuration == circular ? 1.0 - 1.0 / -nominal : 1.0;
}

TEST(Gear, WaveFactorIsTheRelativeRotation) {
  for (const Rational nominal :
       {Rational{50, 1}, Rational{100, 1}, Rational{241, 2}, Rational{161, 1}}) {
    for (const GearConfiguration configuration : {circular, flexspline}) {
      GearConfig<double> gear;
      gear.configuration = configuration;
      gear.ratio = nominal;
      const auto m = strainwave::to_real<double>(strainwave::wave_factor(gear));
      EXPECT_NEAR(m, relative_turns(configuration, strainwave::to_real<double>(nominal)), 1e-15);
    }
  }
  GearConfig<double> gear;
  gear.ratio = {50, 1};
  EXPECT_EQ(strainwave::wave_factor(gear), (Rational{51, 50}));  // not 49/50, as with R_c = -R
}

TEST(Gear, MisalignmentOrderIsOncePerOutputTurn) {
  GearConfig<float> gear;
  gear.ratio = {241, 2};
  EXPECT_EQ(strainwave::misalignment_order(gear), (Rational{2, 241}));
  EXPECT_EQ(multiply(strainwave::misalignment_order(gear), gear.ratio), (Rational{1, 1}));
}

TEST(Gear, WaveFactorOfTheLargestRatiosIsValid) {
  GearConfig<double> gear;
  gear.ratio = {strainwave::largest_rational_part, 1};
  EXPECT_TRUE(!check(gear).ok() || strainwave::is_valid(strainwave::wave_factor(gear)))
      << "a gear that passes its check has a factor m of 0/0";
}

TEST(Gear, CheckNamesTheParameter) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  GearConfig<double> gear;
  EXPECT_TRUE(check(gear).ok());
  gear.ratio = {0, 1};
  EXPECT_STREQ(check(gear).parameter, "ratio");
  gear.ratio = {1, 0};
  EXPECT_STREQ(check(gear).parameter, "ratio");
  gear.ratio = {1, 2};
  EXPECT_STREQ(check(gear).parameter, "ratio");
  gear = {};
  gear.output_direction = 0;
  EXPECT_STREQ(check(gear).parameter, "output_direction");
  gear = {};
  for (const double wrong : {0.0, -1.0, nan, HUGE_VAL}) {
    gear.rated_torque_Nm = wrong;
    EXPECT_STREQ(check(gear).parameter, "rated_torque_Nm") << wrong;
  }
}

}  // namespace
