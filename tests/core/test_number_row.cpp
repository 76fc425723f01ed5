#include "strainwave/number_row.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "strainwave/oscillator_covariance.hpp"
#include "strainwave/ripple_covariance.hpp"

#if defined(STRAINWAVE_NUMBER_ROWS)

namespace {

using strainwave::detail::NumberRow;
using strainwave::detail::row_lane_count;

/// Numbers whose sum depends on the order of the additions.
template <class Real, std::size_t Count>
struct Row {
  Real values[Count] = {};

  explicit Row(std::uint32_t seed) {
    for (Real& each : values) {
      seed = seed * 1664525U + 1013904223U;
      each = static_cast<Real>(static_cast<std::int32_t>(seed)) / Real(1U << (seed % 31U));
    }
  }
};

template <class Real, std::size_t Count>
void expect_lanes_are_numbers_side_by_side() {
  using Of = NumberRow<Real, Count>;
  for (std::uint32_t seed = 1; seed < 200; ++seed) {
    const Row<Real, Count> a(seed);
    const Row<Real, Count> b(seed + 1000);
    Real sums[Count];
    Real differences[Count];
    Real products[Count];
    Real gathered[Count];
    Of::gathered(a.values).store(gathered);
    (Of::load(a.values) + Of::load(b.values)).store(sums);
    (Of::load(a.values) - Of::load(b.values)).store(differences);
    (Of::load(a.values) * Of::all(b.values[0])).store(products);
    for (std::size_t i = 0; i < Count; ++i) {
      ASSERT_EQ(sums[i], a.values[i] + b.values[i]);
      ASSERT_EQ(differences[i], a.values[i] - b.values[i]);
      ASSERT_EQ(products[i], a.values[i] * b.values[0]);
      ASSERT_EQ(gathered[i], a.values[i]);
    }
  }
}

template <class Real, std::size_t Count>
void expect_join_at_every_lane() {
  using Of = NumberRow<Real, Count>;
  for (std::size_t first = 0; first <= Count; ++first) {
    Real joined[Count];
    Of::joined(static_cast<std::ptrdiff_t>(first), Of::all(Real(1)), Of::all(Real(2)))
        .store(joined);
    for (std::size_t i = 0; i < Count; ++i) {
      ASSERT_EQ(joined[i], i < first ? Real(1) : Real(2)) << first << ' ' << i;
    }
  }
}

/// The sum over lanes is that of a processor without them, to the last bit.
template <class Real, std::size_t Count>
void expect_sum_of_a_processor_without_lanes() {
  using Of = NumberRow<Real, Count>;
  Real ones[Count];
  Of::all(Real(1)).store(ones);
  for (std::uint32_t seed = 1; seed < 200; ++seed) {
    const Row<Real, Count> a(seed);
    ASSERT_EQ(Of::load(a.values).sum(),
              strainwave::detail::sum_of_products(Count, a.values, ones, Real(0)));
  }
}

template <class Real, std::size_t Count>
void expect_product_sum_of_a_processor_without_lanes() {
  using Of = strainwave::detail::WideRow<Real, Count>;
  for (std::uint32_t seed = 1; seed < 200; ++seed) {
    const Row<Real, Count> a(seed);
    const Row<Real, Count> b(seed + 1000);
    ASSERT_EQ(strainwave::detail::product_sum_by_fours<Of>(a.values, b.values),
              strainwave::detail::product_sum(Count, a.values, b.values));
  }
}

template <class Real, std::size_t Count>
void expect_all() {
  if constexpr (Count >= 4) {
    expect_product_sum_of_a_processor_without_lanes<Real, Count>();
  }
  expect_lanes_are_numbers_side_by_side<Real, Count>();
  expect_join_at_every_lane<Real, Count>();
  expect_sum_of_a_processor_without_lanes<Real, Count>();
}

template <class Real>
class NumberRowOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(NumberRowOf, Precisions);

TYPED_TEST(NumberRowOf, AreNumbersSideBySideInEveryLength) {
  expect_all<TypeParam, 2>();
  expect_all<TypeParam, 4>();
  expect_all<TypeParam, row_lane_count>();
  expect_all<TypeParam, 2 * row_lane_count>();
  expect_all<TypeParam, 3 * row_lane_count>();
}

TYPED_TEST(NumberRowOf, SignOfZeroIsKept) {
  TypeParam zeros[4];
  NumberRow<TypeParam, 4>::all(-TypeParam(0)).store(zeros);
  for (const TypeParam each : zeros) {
    EXPECT_TRUE(std::signbit(each));
  }
}

}  // namespace

#endif
