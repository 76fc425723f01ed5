// SPDX-License-Identifier: Apache-2.0
// Cases that are compiled for any x86-64 and find the vector level when they run, as packages do.
#include "cases.hpp"

namespace speed {

Cases all_cases() {
  Cases cases;
  add_batch(cases);
  add_long(cases);
  add_issue(cases);
  return cases;
}

}  // namespace speed
