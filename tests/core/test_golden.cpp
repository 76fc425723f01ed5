// The golden vectors on the host: samples, and answers of five chains in double and float.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "../golden/golden_chains.hpp"

namespace {

TEST(Golden, SamplesAreThoseOfThePythonSide) {
  golden::Inputs inputs;
  golden::Checksum checksum;
  for (std::uint32_t k = 0; k < golden::sample_count; ++k) {
    add(checksum, inputs.next());
  }
  EXPECT_EQ(checksum.value(), golden::inputs_checksum);
}

TEST(Golden, SamplesContainWhatTheyShall) {
  golden::Inputs inputs;
  golden::RawSample before = inputs.next();
  int encoder_wraps = 0;
  int sequence_wraps = 0;
  for (std::uint32_t k = 1; k < golden::sample_count; ++k) {
    const golden::RawSample now = inputs.next();
    // The sign of the count changes although it moved by little.
    encoder_wraps += ((now.encoder ^ before.encoder) >> 31U) != 0U ? 1 : 0;
    sequence_wraps += now.sequence < 0x40000000U && before.sequence > 0xC0000000U ? 1 : 0;
    before = now;
  }
  EXPECT_EQ(encoder_wraps, 3);
  EXPECT_EQ(sequence_wraps, 1);
}

TEST(Golden, ConfigurationOfTheChainIsSound) {
  const auto violation = check(golden::Chain<double>::told());
  EXPECT_TRUE(violation.ok()) << violation.parameter;
}

template <class Real>
class GoldenAnswers : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GoldenAnswers, Precisions);

/// Bit for bit: products are rounded before they are added, here as in the Python package.
TYPED_TEST(GoldenAnswers, HaveTheSameBits) {
  using Real = TypeParam;
  constexpr bool is_float = std::is_same_v<Real, float>;
  golden::for_each_chain<Real>([](const golden::Golden& expected, auto chain) {
    const double* const torque_Nm = is_float ? expected.float_Nm : expected.double_Nm;
    const std::uint32_t* const status = is_float ? expected.float_status : expected.double_status;
    golden::Inputs inputs;
    golden::Checksum checksum;
    int other_torques = 0;
    int other_statuses = 0;
    double from_double_Nm = 0;
    for (std::uint32_t k = 0; k < golden::sample_count; ++k) {
      const golden::Answer<Real> answer = chain.take(inputs.next());
      add(checksum, answer);
      if ((k + 1) % golden::every == 0) {
        const std::size_t i = k / golden::every;
        const auto found_Nm = static_cast<double>(answer.torque_Nm);
        other_torques += found_Nm == torque_Nm[i] ? 0 : 1;
        other_statuses += answer.status == status[i] ? 0 : 1;
        const double far_Nm = strainwave::absolute(found_Nm - expected.double_Nm[i]);
        from_double_Nm = far_Nm > from_double_Nm ? far_Nm : from_double_Nm;
      }
    }
    EXPECT_EQ(other_torques, 0) << expected.name;
    EXPECT_EQ(other_statuses, 0) << expected.name;
    EXPECT_LE(from_double_Nm, 1e-4 * golden::full_scale_Nm) << expected.name;
    EXPECT_EQ(checksum.value(), is_float ? expected.float_checksum : expected.double_checksum)
        << expected.name;
  });
}

}  // namespace
