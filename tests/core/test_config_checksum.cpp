// The checksum of a configuration: a published number, the same from compiler and memory, and every
// bit of every value counts.
#include "strainwave/config_checksum.hpp"

#include <gtest/gtest.h>

namespace {

using strainwave::Checksum;
using strainwave::checksum_of;
using strainwave::GearConfig;
using strainwave::is_intact;
using strainwave::LearnedRipple;
using strainwave::RippleSensorConfig;
using strainwave::take_count;
using strainwave::TorqueSensorConfig;
using strainwave::value_of;

template <class Real>
constexpr RippleSensorConfig<Real, 3, 4> ripple_example() {
  RippleSensorConfig<Real, 3, 4> config;
  config.gains.count = 3;
  config.gains.values[1] = Real(0.9);
  config.calibration.gain_Nm_per_V = Real(6.6);
  config.filter.order_count = 2;
  config.filter.orders[1].order = {4, 1};
  config.filter.orders[1].with_load = true;
  config.filter.frozen_count = 1;
  config.filter.frozen[0].sine_Nm = Real(-0.0);
  config.monitor.active = true;
  config.monitor.without[2].available = true;
  return config;
}

TEST(Checksum, IsThePublishedOne) {
  // The check value of CRC-32 in the catalogues: of the nine digits in ASCII.
  Checksum checksum;
  for (const char digit : {'1', '2', '3', '4', '5', '6', '7', '8', '9'}) {
    strainwave::take(checksum, static_cast<std::uint8_t>(digit));
  }
  EXPECT_EQ(value_of(checksum), 0xCBF43926U);
}

TEST(Checksum, NumbersAreTakenLowestByteFirst) {
  Checksum words;
  strainwave::take(words, std::uint32_t{0x34333231U});
  strainwave::take(words, std::uint64_t{0x3938373635ULL});
  Checksum bytes;
  for (const unsigned byte :
       {0x31U, 0x32U, 0x33U, 0x34U, 0x35U, 0x36U, 0x37U, 0x38U, 0x39U, 0U, 0U, 0U}) {
    strainwave::take(bytes, static_cast<std::uint8_t>(byte));
  }
  EXPECT_EQ(value_of(words), value_of(bytes));
  Checksum count;
  take_count(count, std::size_t{7});
  Checksum wide;
  strainwave::take(wide, std::uint64_t{7});
  EXPECT_EQ(value_of(count), value_of(wide));
}

template <class Config>
class EveryConfig : public testing::Test {};

using Configs =
    testing::Types<RippleSensorConfig<float, 3, 4>, RippleSensorConfig<double, 3, 4>,
                   TorqueSensorConfig<float, 2, 3>, LearnedRipple<double, 3>, GearConfig<float>>;
TYPED_TEST_SUITE(EveryConfig, Configs);

TYPED_TEST(EveryConfig, CompilerAndMemoryAgree) {
  static constexpr TypeParam config = {};
  constexpr std::uint32_t stored = checksum_of(config);
  EXPECT_EQ(checksum_of(config), stored);
  EXPECT_TRUE(is_intact(stored, config));
}

/// Bytes of an object of which every bit changes its checksum.
template <class Config>
std::size_t guarded_bytes(const Config& original) {
  Config config = original;
  const std::uint32_t stored = checksum_of(config);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
  auto* const bytes = reinterpret_cast<unsigned char*>(&config);
  std::size_t guarded = 0;
  for (std::size_t i = 0; i < sizeof(config); ++i) {
    unsigned found = 0;
    for (unsigned bit = 0; bit < 8; ++bit) {
      bytes[i] = static_cast<unsigned char>(bytes[i] ^ (1U << bit));
      found += is_intact(stored, config) ? 0U : 1U;
      bytes[i] = static_cast<unsigned char>(bytes[i] ^ (1U << bit));
    }
    EXPECT_TRUE(found == 0 || found == 8) << "byte " << i;
    guarded += found == 8 ? 1U : 0U;
  }
  return guarded;
}

// Sizes of the declared members, added up by hand: nothing but padding is left out.
constexpr std::size_t count = sizeof(std::size_t);
constexpr std::size_t ratio = 8;

constexpr std::size_t chain_without_filter(std::size_t real, std::size_t gauges) {
  const std::size_t converter = 4 + 2 * real + 4;
  const std::size_t gains = count + gauges * real;
  const std::size_t calibration = (3 + 4 + 5) * real;
  const std::size_t parity = 4 + count + 9 * gauges * real + count + ratio + gauges * 4 * 2 * real +
                             gauges * real + 3 * real;
  const std::size_t without = gauges * (1 + gains + 2 * real);
  const std::size_t monitor = 1 + 4 + 2 * real + 1 + real + 4 + 4 * real + parity + real + without;
  return converter + gains + calibration + monitor;
}

template <class Real>
class GuardedConfig : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(GuardedConfig, Reals);

TYPED_TEST(GuardedConfig, EveryBitOfEveryMemberCounts) {
  constexpr std::size_t real = sizeof(TypeParam);
  const std::size_t ripple =
      count + 4 * (ratio + 4) + 8 * real + count + 8 * (ratio + 2 * real) + real;
  EXPECT_EQ(guarded_bytes(ripple_example<TypeParam>()), chain_without_filter(real, 3) + ripple);
  const std::size_t oscillator = count + 3 * ratio + 3 * real + 3 * real + 1 + 3 * real;
  EXPECT_EQ(guarded_bytes(TorqueSensorConfig<TypeParam, 2, 3>{}),
            chain_without_filter(real, 2) + oscillator);
  EXPECT_EQ(guarded_bytes(LearnedRipple<TypeParam, 3>{}),
            count + 3 * (ratio + 4) + 12 * real + real);
  EXPECT_EQ(guarded_bytes(GearConfig<TypeParam>{}), 1 + ratio + 4 + real);
}

TEST(ConfigChecksum, NegativeZeroIsAnotherValue) {
  auto config = ripple_example<float>();
  const std::uint32_t stored = checksum_of(config);
  config.filter.frozen[0].sine_Nm = 0.0F;
  EXPECT_FALSE(is_intact(stored, config));
}

TEST(ConfigChecksum, PartsCountInTheirOrder) {
  constexpr auto config = ripple_example<double>();
  constexpr GearConfig<double> gear;
  EXPECT_NE(checksum_of(gear, config), checksum_of(config, gear));
  EXPECT_NE(checksum_of(config), checksum_of(gear, config));
  EXPECT_NE(checksum_of(config), checksum_of(ripple_example<float>()));
}

TEST(ConfigChecksum, AWrongStoredOneIsFound) {
  constexpr auto config = ripple_example<float>();
  std::uint32_t stored = checksum_of(config);
  EXPECT_TRUE(is_intact(stored, config));
  stored ^= 0x100U;
  EXPECT_FALSE(is_intact(stored, config));
}

}  // namespace
