// SPDX-License-Identifier: Apache-2.0
// Cases that are compiled for this very machine: one channel, the core beside Eigen.
#include "cases.hpp"

namespace speed {

Cases all_cases() {
  Cases cases;
  add_core(cases);
  add_series(cases);
  add_states(cases);
  add_sequential(cases);
#ifdef SPEED_HAS_EIGEN
  add_published_eigen(cases);
  add_default_eigen(cases);
#endif
  return cases;
}

}  // namespace speed
