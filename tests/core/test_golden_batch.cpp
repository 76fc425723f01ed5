// The golden vectors through lanes, threads and time chunks, at every vector level, and through
// series: the golden answers to rounding, and the same statuses.
#include <gtest/gtest.h>

#include <cstddef>
#include <type_traits>

#include "batch_examples.hpp"
#include "golden_batch_runs.hpp"

namespace {

using golden::Tolerance;
using strainwave::VectorLevel;

template <class Real>
using Published = golden::ChainRun<Real, strainwave::OscillatorFilterConfig, 3>;
template <class Real>
using Ripple = golden::ChainRun<Real, strainwave::RippleFilterConfig, 12>;

template <class Real>
[[nodiscard]] Published<Real> published_4() {
  return {golden::published_4, strainwave::taghirad1999_4<Real, 3>(), golden::signals<Real>()};
}
template <class Real>
[[nodiscard]] Published<Real> published_6() {
  return {golden::published_6, strainwave::taghirad1999<Real, 3>({100, 1}),
          golden::signals<Real>()};
}
template <class Real>
[[nodiscard]] Ripple<Real> default_3_orders() {
  return {golden::default_3_orders, golden::ripple_config<Real, 12>(false, false, false),
          golden::signals<Real>()};
}
template <class Real>
[[nodiscard]] Ripple<Real> all_terms() {
  return {golden::default_3_orders_load_speed_direction,
          golden::ripple_config<Real, 12>(true, true, true), golden::signals<Real>()};
}
template <class Real>
[[nodiscard]] Ripple<Real> behind_gauges() {
  return {golden::chain_4_gauges, golden::ripple_config<Real, 12>(true, true, false),
          golden::signals_behind_gauges<Real>()};
}

template <class Real>
class GoldenBatch : public testing::Test {
 protected:
  /// Tolerances of float and double.
  static constexpr Tolerance of(Tolerance of_float, Tolerance of_double) {
    return std::is_same_v<Real, float> ? of_float : of_double;
  }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GoldenBatch, Precisions);

/// Alone in a block; and beside so many other channels that there are two blocks in float, three in
/// double.
template <class Chain>
void expect_in_lanes(const Chain& chain, Tolerance tolerance) {
  for (const VectorLevel level : vector_levels()) {
    SCOPED_TRACE(testing::Message() << "level " << static_cast<int>(level));
    chain.expect_in_lanes({.level = level}, 1, tolerance);
    chain.expect_in_lanes({.level = level, .thread_count = 1}, 19, tolerance);
    chain.expect_in_lanes({.level = level, .thread_count = 2}, 19, tolerance);
  }
}

/// What is kept of chunks differs by what is left of a wrong start, in either precision: 1e-4 Nm of
/// ripple at a boundary and 1e-2 Nm of a state that is hardly seen there, 2.5e-4 FS.
constexpr Tolerance of_chunks = {1e-9, 1e-4};

template <class Chain>
void expect_in_chunks(const Chain& chain, double memories, std::size_t least_chunks) {
  for (const VectorLevel level : vector_levels()) {
    for (const std::size_t threads : {1U, 2U}) {
      SCOPED_TRACE(testing::Message()
                   << "level " << static_cast<int>(level) << ", threads " << threads);
      const strainwave::LongReport report = chain.expect_in_chunks(
          {.batch = {.level = level, .thread_count = threads}, .warm_up_memories = memories},
          of_chunks);
      EXPECT_GE(report.chunk_count, least_chunks);
      EXPECT_LE(2 * report.repeated_chunks, report.chunk_count);
    }
  }
}

// Lanes round where step() does not and the other way round, and fuse products from x86-64-v3 on:
// tolerances in float are those of fused float on a Cortex-M4F, 5e-5 FS, or less where less was
// found; in double some ten times what was found.

TYPED_TEST(GoldenBatch, Published4InLanes) {
  const auto chain = published_4<TypeParam>();
  chain.expect_step_is_golden();
  expect_in_lanes(chain, this->of({1e-8, 1e-5}, {1e-16, 3e-14}));
}

TYPED_TEST(GoldenBatch, Published6InLanes) {
  const auto chain = published_6<TypeParam>();
  chain.expect_step_is_golden();
  expect_in_lanes(chain, this->of({1e-8, 5e-5}, {1e-16, 1e-13}));
}

TYPED_TEST(GoldenBatch, DefaultInLanes) {
  const auto chain = default_3_orders<TypeParam>();
  chain.expect_step_is_golden();
  expect_in_lanes(chain, this->of({1e-8, 5e-5}, {1e-16, 1e-13}));
}

TYPED_TEST(GoldenBatch, AllTermsInLanes) {
  const auto chain = all_terms<TypeParam>();
  chain.expect_step_is_golden();
  if (strainwave::detail::kind_of(chain.config()).pairs == 0) {
    expect_in_lanes(chain, {0.0, 0.0});  // too many pairs for lanes: step(), bit for bit
  } else {
    expect_in_lanes(chain, this->of({1e-8, 5e-5}, {1e-16, 1e-9}));
  }
}

/// The further pairs' weight is judged in a frame that lanes move at other samples: in double that
/// is 1e-10 FS.
TYPED_TEST(GoldenBatch, FilterBehindGaugesInLanes) {
  const auto chain = behind_gauges<TypeParam>();
  chain.expect_step_is_golden();
  expect_in_lanes(chain, this->of({1e-8, 1e-5}, {1e-16, 1e-9}));
}

/// All in one call; and in pieces of some blocks and a rest.
template <class Chain>
void expect_in_series(const Chain& chain, Tolerance tolerance) {
#if !defined(STRAINWAVE_NUMBER_ROWS)
  tolerance = {0.0, 0.0};  // step() after step()
#endif
  chain.expect_in_series(golden::sample_count, tolerance);
  chain.expect_in_series(211, tolerance);
}

TYPED_TEST(GoldenBatch, Published4InSeries) {
  expect_in_series(published_4<TypeParam>(), this->of({1e-8, 1e-5}, {1e-16, 3e-14}));
}

TYPED_TEST(GoldenBatch, Published6InSeries) {
  expect_in_series(published_6<TypeParam>(), this->of({1e-8, 5e-5}, {1e-16, 1e-13}));
}

// Some warm-ups are shorter than the usual 16 memories, because the golden log is short.

TYPED_TEST(GoldenBatch, Published4InChunks) {
  expect_in_chunks(published_4<TypeParam>(), 16.0, 16);
}

TYPED_TEST(GoldenBatch, Published6InChunks) { expect_in_chunks(published_6<TypeParam>(), 8.0, 2); }

TYPED_TEST(GoldenBatch, DefaultInChunks) {
  expect_in_chunks(default_3_orders<TypeParam>(), 16.0, 3);
}

TYPED_TEST(GoldenBatch, FilterBehindGaugesInChunks) {
  expect_in_chunks(behind_gauges<TypeParam>(), 2.0, 2);
}

}  // namespace
