// SPDX-License-Identifier: Apache-2.0
// Products and sums as a case among others, so that the limit is measured in the same rounds.
#include <stdexcept>
#include <string>

#include "cases.hpp"
#include "multiply_add.hpp"

namespace speed {

namespace {

Rate rate_of(const std::string& level, bool in_double) {
  if (level == "v2") {
    return in_double ? v2::rate_of_double() : v2::rate_of_float();
  }
  if (level == "v3") {
    return in_double ? v3::rate_of_double() : v3::rate_of_float();
  }
  if (level == "v4") {
    return in_double ? v4::rate_of_double() : v4::rate_of_float();
  }
  throw std::invalid_argument("level");
}

/// multiply_add:level=v3:double=1; a sample is an operation.
Case multiply_add(const Recording& /*recording*/, const Options& options) {
  const Rate rate = rate_of(options.at("level"), number(options, "double", 0) != 0);
  Case each;
  each.run = [rate](std::size_t operations) {
    const auto rounds =
        static_cast<long>(static_cast<double>(operations) / rate.operations_a_round);
    const volatile double sink = rate.run(rounds + 1);
    static_cast<void>(sink);
    return static_cast<std::size_t>(static_cast<double>(rounds + 1) * rate.operations_a_round);
  };
  return each;
}

}  // namespace

void add_issue(Cases& cases) { cases["multiply_add"] = multiply_add; }

}  // namespace speed
