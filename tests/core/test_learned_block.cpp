// Learned coefficients over a power cycle: whole and of this joint, or refused.
#include "strainwave/learned_block.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

namespace {

using strainwave::BlockFault;
using strainwave::LearnedBlock;
using strainwave::LearnedRipple;
using strainwave::RippleSensorConfig;
using strainwave::RippleSensorState;
using strainwave::TorqueSensorSample;

template <class Real>
using Config = RippleSensorConfig<Real, 1, 3>;
template <class Real>
using State = RippleSensorState<Real, 1, 3>;
template <class Real>
using Block = LearnedBlock<Real, 3>;

template <class Real>
Config<Real> example() {
  Config<Real> config;
  config.filter.order_count = 2;
  config.filter.orders[0].with_speed = true;
  config.filter.orders[1].order = {1, 100};
  return config;
}

/// A sensor that has seen ten turns of ripple.
template <class Real>
State<Real> taught(const Config<Real>& config) {
  State<Real> state = initial_state(config);
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const double angle_rad = 0.03 * k;
    TorqueSensorSample<1, Real> sample;
    sample.codes[0] = to_code(config.converter, static_cast<Real>(2.0 * std::cos(2 * angle_rad)));
    sample.motor_phase = strainwave::phase_from_radians(angle_rad);
    sample.sequence = k;
    (void)step(config, state, sample);
  }
  return state;
}

template <class Real>
class LearnedBlocks : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(LearnedBlocks, Reals);

TYPED_TEST(LearnedBlocks, BringBackEveryBit) {
  const auto config = example<TypeParam>();
  const auto before = taught(config);
  Block<TypeParam> block;
  save_learned(config, before, block);
  State<TypeParam> after = initial_state(config);
  ASSERT_EQ(restore_learned(config, after, block), BlockFault::none);
  const auto kept = learned(config.filter, before.filter);
  EXPECT_GT(strainwave::absolute(kept.coefficients_Nm[0]), TypeParam(1));
  const auto again = restored(config.filter, kept);
  for (std::size_t i = 1; i < 7; ++i) {
    EXPECT_EQ(after.filter.states_Nm[i], before.filter.states_Nm[i]) << i;
    EXPECT_EQ(strainwave::detail::element_of(after.filter.covariance, i - 1, i - 1),
              strainwave::detail::element_of(again.covariance, i - 1, i - 1));
  }
  EXPECT_EQ(after.filter.innovation_scale_Nm, again.innovation_scale_Nm);
}

TYPED_TEST(LearnedBlocks, EveryFlippedBitIsFound) {
  const auto config = example<TypeParam>();
  Block<TypeParam> block;
  save_learned(config, taught(config), block);
  for (std::uint32_t& word : block.words) {
    for (unsigned bit = 0; bit < 32; ++bit) {
      word ^= 1U << bit;
      State<TypeParam> state = initial_state(config);
      ASSERT_NE(restore_learned(config, state, block), BlockFault::none);
      ASSERT_EQ(state.filter.states_Nm[1], TypeParam(0)) << "a refused block changes nothing";
      word ^= 1U << bit;
    }
  }
  State<TypeParam> state = initial_state(config);
  EXPECT_EQ(restore_learned(config, state, block), BlockFault::none);
}

TYPED_TEST(LearnedBlocks, ErasedAndCutShortAreDamaged) {
  const auto config = example<TypeParam>();
  State<TypeParam> state = initial_state(config);
  const Block<TypeParam> zeros;
  EXPECT_EQ(restore_learned(config, state, zeros), BlockFault::damaged);
  Block<TypeParam> erased;
  for (std::uint32_t& word : erased.words) {
    word = 0xFFFFFFFFU;
  }
  EXPECT_EQ(restore_learned(config, state, erased), BlockFault::damaged);
  Block<TypeParam> whole;
  save_learned(config, taught(config), whole);
  for (std::size_t written = 2; written < Block<TypeParam>::size; ++written) {
    Block<TypeParam> cut = erased;
    for (std::size_t i = 0; i < written; ++i) {
      cut.words[i] = whole.words[i];
    }
    EXPECT_EQ(restore_learned(config, state, cut), BlockFault::damaged) << written;
  }
}

TYPED_TEST(LearnedBlocks, OfAnotherFilterOrLayoutAreRefused) {
  const auto config = example<TypeParam>();
  Block<TypeParam> block;
  save_learned(config, taught(config), block);
  auto other = config;
  other.filter.orders[1].order = {1, 101};
  State<TypeParam> state = initial_state(other);
  EXPECT_EQ(restore_learned(other, state, block), BlockFault::other_filter);

  LearnedRipple<TypeParam, 3> huge = learned(config.filter, state.filter);
  huge.coefficients_Nm[2] = TypeParam(1e12);
  pack(huge, block);
  EXPECT_EQ(restore_learned(config, state, block), BlockFault::other_filter);

  block.words[1] = strainwave::detail::learned_block_layout<
      std::conditional_t<std::is_same_v<TypeParam, float>, double, float>, 3>;
  EXPECT_EQ(restore_learned(config, state, block), BlockFault::other_format);
}

}  // namespace
