#include "strainwave/units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace {

using strainwave::EncoderCounter;
using strainwave::order_fraction;
using strainwave::Phase;
using strainwave::Rational;

/// Numbers over the whole of 64 bits, the same on every run (splitmix64).
class Random {
 public:
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

 private:
  std::uint64_t state_ = 1;
};

/// order x angle modulo one, in 128 bits: no step can lose anything.
std::uint32_t fraction_in_128_bits(Phase phase, Rational order) {
  __extension__ using Wide = __int128;
  const Wide units = (Wide{phase.turns} << 32U) + phase.fraction;
  const Wide cycle = Wide{order.denominator} << 32U;
  Wide rest = (units % cycle) * order.numerator % cycle;
  if (rest < 0) {
    rest += cycle;
  }
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(rest / order.denominator));
}

TEST(Units, OrderFractionAgainst128Bits) {
  Random random;
  for (int i = 0; i < 200'000; ++i) {
    const std::uint64_t a = random.next();
    const std::uint64_t b = random.next();
    const auto bits = static_cast<std::uint32_t>(b >> 58U) % 31U;
    const Rational order{1U + static_cast<std::uint32_t>(a >> 33U) % (1U << bits),
                         1U + static_cast<std::uint32_t>(b & 0x7FFFFFFEU) % (1U << (30U - bits))};
    const Phase phase{static_cast<std::int64_t>(random.next()) >> (i % 64),
                      static_cast<std::uint32_t>(random.next())};
    ASSERT_EQ(order_fraction(phase, order), fraction_in_128_bits(phase, order))
        << phase.turns << " " << phase.fraction << " " << order.numerator << "/"
        << order.denominator;
  }
}

TEST(Units, OrderFractionOfExtremes) {
  const std::uint32_t top = strainwave::largest_rational_part;
  for (const Rational order : {Rational{1, top}, Rational{top, 1}, Rational{top, top - 1}}) {
    for (const std::int64_t turns :
         {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0},
          std::int64_t{1}, std::numeric_limits<std::int64_t>::max()}) {
      for (const std::uint32_t fraction : {0U, 1U, 0x80000000U, 0xFFFFFFFFU}) {
        const Phase phase{turns, fraction};
        EXPECT_EQ(order_fraction(phase, order), fraction_in_128_bits(phase, order));
      }
    }
  }
}

TEST(Units, MisalignmentPhaseAfterThirtyDaysAt6000Rpm) {
  // 30 days x 144,000 turns: the output's phase is the remainder of whole turns, to the bit.
  const std::int64_t turns = std::int64_t{30} * 24 * 60 * 6000;
  for (const std::uint32_t ratio : {100U, 161U}) {
    const auto rest = static_cast<std::uint64_t>(turns % ratio);
    EXPECT_EQ(order_fraction({turns, 0}, {1, ratio}),
              static_cast<std::uint32_t>((rest << 32U) / ratio));
  }
  const auto rest = static_cast<std::uint64_t>(2 * turns % 241);  // ratio 120.5
  EXPECT_EQ(order_fraction({turns, 0}, {2, 241}), static_cast<std::uint32_t>((rest << 32U) / 241));
}

TEST(Units, DifferencesOfOrderFractionsDoNotDrift) {
  Random random;
  Phase last{};
  std::uint32_t sum = 0;
  const Rational order{2, 241};
  for (int i = 0; i < 100'000; ++i) {
    const Phase now = last + Phase{0, static_cast<std::uint32_t>(random.next() >> 36U)};
    sum += order_fraction(now, order) - order_fraction(last, order);
    last = now;
  }
  EXPECT_EQ(sum, order_fraction(last, order));
}

TEST(Units, PhaseArithmeticCarriesAndBorrows) {
  EXPECT_EQ((Phase{1, 0xFFFFFFFFU} + Phase{2, 1}), (Phase{4, 0}));
  EXPECT_EQ((Phase{4, 0} - Phase{2, 1}), (Phase{1, 0xFFFFFFFFU}));
  EXPECT_EQ((Phase{0, 0} - Phase{0, 1}), (Phase{-1, 0xFFFFFFFFU}));
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const Phase a{static_cast<std::int64_t>(random.next()) >> 2U,
                  static_cast<std::uint32_t>(random.next())};
    const Phase b{static_cast<std::int64_t>(random.next()) >> 2U,
                  static_cast<std::uint32_t>(random.next())};
    EXPECT_EQ(a + b - b, a);
    EXPECT_EQ(a - b + b, a);
  }
}

TEST(Units, PhaseOfTurns) {
  EXPECT_EQ(strainwave::phase_from_turns(0.25), (Phase{0, 0x40000000U}));
  EXPECT_EQ(strainwave::phase_from_turns(-0.25), (Phase{-1, 0xC0000000U}));
  EXPECT_EQ(strainwave::phase_from_turns(-1e-20), (Phase{0, 0}));
  EXPECT_EQ(strainwave::phase_from_turns(1.0 - 1e-12), (Phase{1, 0}));
  EXPECT_EQ(strainwave::phase_from_turns(-3.0), (Phase{-3, 0}));
  EXPECT_EQ(strainwave::phase_from_turns(1.5F), (Phase{1, 0x80000000U}));
  EXPECT_EQ(strainwave::phase_from_turns(-0x1p40), (Phase{-strainwave::largest_turns, 0}));
}

TEST(Units, RadiansThereAndBack) {
  for (int i = -1356; i <= 1356; ++i) {
    const double angle_rad = 0.7371 * i;
    const Phase phase = strainwave::phase_from_radians(angle_rad);
    EXPECT_NEAR(strainwave::to_radians<double>(phase), angle_rad, 7.4e-10);  // half a unit
  }
}

TEST(Units, DifferencesAreExactAcrossTurnsAndFarFromZero) {
  std::mt19937_64 random(11);  // NOLINT(*-msc32-c,*-msc51-cpp,bugprone-random-generator-seed)
  for (int i = 0; i < 20000; ++i) {
    const auto units = static_cast<std::int64_t>(random()) >> (i % 50 + 12);  // below 2^51
    const std::uint32_t end = i % 2 == 0 ? 0U : 0xFFFFFFFFU;
    const Phase before = {static_cast<std::int64_t>(random()) >> (i % 60 + 2),
                          i % 5 == 0 ? end : static_cast<std::uint32_t>(random())};
    const Phase way = {units >> 32U, static_cast<std::uint32_t>(units)};
    ASSERT_EQ(before + way - before, way) << i;
    ASSERT_EQ(strainwave::to_turns<double>(way), static_cast<double>(units) * 0x1p-32) << i;
  }
}

TEST(Units, SmallNegativeDifferencesKeepTheirDigitsInFloat) {
  const Phase difference = Phase{7, 0} - Phase{7, 3};
  EXPECT_EQ(strainwave::to_turns<float>(difference), -3.0F * 0x1p-32F);
  EXPECT_EQ(strainwave::to_turns<double>(Phase{-1, 0xFFFFFFFFU}), -0x1p-32);
  EXPECT_EQ(strainwave::to_turns<double>(Phase{(1 << 20) - 1, 1}), 1048575.0 + 0x1p-32);
}

TEST(Units, RepresentableAngles) {
  EXPECT_TRUE(strainwave::is_representable_angle(-1e12));
  EXPECT_FALSE(strainwave::is_representable_angle(1e13));
  EXPECT_FALSE(strainwave::is_representable_angle(std::nan("")));
  EXPECT_FALSE(strainwave::is_representable_angle(HUGE_VALF));
}

TEST(Units, PhaseOfCountsIsTheNearestUnit) {
  Random random;
  for (const std::uint32_t per_turn : {1U, 3U, 4096U, 10'000U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    for (int i = 0; i < 2000; ++i) {
      const auto counts = static_cast<std::int64_t>(random.next()) >> (i % 60);
      const Phase phase = strainwave::phase_from_counts(counts, per_turn);
      __extension__ using Wide = __int128;
      const Wide units = (Wide{phase.turns} << 32U) + phase.fraction;
      const Wide twice_error = 2 * (units * per_turn - (Wide{counts} << 32U));
      ASSERT_LE(twice_error, Wide{per_turn}) << counts << " of " << per_turn;
      ASSERT_GE(twice_error, -Wide{per_turn}) << counts << " of " << per_turn;
    }
  }
}

TEST(Units, EncoderCounterPassesItsWrapBothWays) {
  EncoderCounter counter;
  EXPECT_EQ(counter.update(0x7FFFFFF0U), 0x7FFFFFF0);
  EXPECT_EQ(counter.update(0x80000010U), 0x80000010LL);
  EXPECT_EQ(counter.update(0xFFFFFFFFU), 0xFFFFFFFFLL);
  EXPECT_EQ(counter.update(5U), 0x100000005LL);
  EXPECT_EQ(counter.update(0xFFFFFFF0U), 0xFFFFFFF0LL);
  EncoderCounter back;
  EXPECT_EQ(back.update(0xFFFFFFFFU), -1);
  EXPECT_EQ(back.update(0U), 0);
  EncoderCounter steps;
  std::uint32_t raw = 0;
  std::int64_t counts = 0;
  for (int i = 0; i < 100; ++i) {  // the largest step both ways
    EXPECT_EQ(steps.update(raw), counts);
    raw += 0x7FFFFFFFU;
    counts += 0x7FFFFFFF;
  }
}

TEST(Units, RationalFromNumbers) {
  using strainwave::rational_from;
  EXPECT_EQ(rational_from(100.0), (Rational{100, 1}));
  EXPECT_EQ(rational_from(120.5), (Rational{241, 2}));
  EXPECT_EQ(rational_from(1.0 / 120.5), (Rational{2, 241}));
  EXPECT_EQ(rational_from(0.1), (Rational{1, 10}));
  EXPECT_EQ(rational_from(101.0 / 100.0), (Rational{101, 100}));
  EXPECT_EQ(rational_from(2147483647.0), (Rational{2147483647U, 1}));
  // Its convergents are 646363/52, off by 9e-12 of it, and one beyond 2^31: between them is enough.
  const double between = 12430.057692196395;
  EXPECT_NEAR(strainwave::to_real<double>(rational_from(between)) / between, 1.0, 1e-12);
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL, 2147483648.0, 1e-10, 5e-324}) {
    EXPECT_FALSE(strainwave::is_valid(rational_from(wrong))) << wrong;
  }
}

TEST(Units, RationalFromIsWithinItsToleranceOrRefuses) {
  Random random;
  for (int i = 0; i < 100'000; ++i) {
    const double mantissa = 1.0 + static_cast<double>(random.next() >> 11U) * 0x1p-53;
    const double value = std::ldexp(mantissa, static_cast<int>(random.next() % 60U) - 30);
    const Rational ratio = strainwave::rational_from(value);
    if (strainwave::is_valid(ratio)) {
      ASSERT_NEAR(strainwave::to_real<double>(ratio) / value, 1.0, 1.001e-12) << value;
    }
  }
}

TEST(Units, ProductsOfRationals) {
  using strainwave::multiply;
  EXPECT_EQ(multiply({241, 2}, {2, 241}), (Rational{1, 1}));
  EXPECT_EQ(multiply({51, 50}, {4, 1}), (Rational{102, 25}));
  EXPECT_FALSE(strainwave::is_valid(multiply({65537, 1}, {65537, 1})));
  EXPECT_EQ(strainwave::reduced(0, 0), (Rational{0, 0}));
  EXPECT_EQ(strainwave::inverse({3, 7}), (Rational{7, 3}));
}

}  // namespace
