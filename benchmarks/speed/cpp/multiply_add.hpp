// SPDX-License-Identifier: Apache-2.0
/// @file multiply_add.hpp
/// How many floating-point operations a core does a second at an x86-64 level.
#pragma once

namespace speed {

/// Operations of one call that does so many rounds of `operations_a_round`.
struct Rate {
  int lanes;
  double operations_a_round;
  /// The values that came out, so that nothing is left out.
  double (*run)(long rounds);
};

namespace v2 {
Rate rate_of_float();
Rate rate_of_double();
}  // namespace v2
namespace v3 {
Rate rate_of_float();
Rate rate_of_double();
}  // namespace v3
namespace v4 {
Rate rate_of_float();
Rate rate_of_double();
}  // namespace v4

}  // namespace speed
