// SPDX-License-Identifier: Apache-2.0
// Compiled once for each level, with SPEED_LEVEL, SPEED_NAMESPACE and its -march.  Level 2 has no
// fused product and sum: there it is one instruction of each.
#include "multiply_add.hpp"

namespace speed {

namespace {

constexpr int vector_bytes = 4 << SPEED_LEVEL;  // 16, 32, 64
/// Enough chains to hide the latency of two units, few enough for the registers.
constexpr int chains = 12;

template <class Real>
double run(long rounds) {
  using Vector [[gnu::vector_size(vector_bytes)]] = Real;
  volatile Real factor_now = Real(0.999);
  volatile Real summand_now = Real(1e-3);
  const Vector factor = Vector{} + factor_now;
  const Vector summand = Vector{} + summand_now;
  // Each begins with a number of its own: chains that are alike are one to the compiler.
  volatile Real beginning_now = Real(0);
  Vector sums[chains];
  for (Vector& sum : sums) {
    sum = Vector{} + beginning_now;
  }
  for (long round = 0; round < rounds; ++round) {
    for (Vector& sum : sums) {
      sum = sum * factor + summand;
    }
  }
  Vector all{};
  for (const Vector& sum : sums) {
    all += sum;
  }
  return static_cast<double>(all[0]);
}

template <class Real>
Rate rate() {
  constexpr int lanes = vector_bytes / static_cast<int>(sizeof(Real));
  return {lanes, 2.0 * lanes * chains, run<Real>};
}

}  // namespace

namespace SPEED_NAMESPACE {

Rate rate_of_float() { return rate<float>(); }
Rate rate_of_double() { return rate<double>(); }

}  // namespace SPEED_NAMESPACE

}  // namespace speed
