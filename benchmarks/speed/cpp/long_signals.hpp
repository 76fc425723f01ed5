// SPDX-License-Identifier: Apache-2.0
/// @file long_signals.hpp
/// A log of any length: the recording over and over, which ends at the angle where it began.
#pragma once

#include <cstddef>
#include <vector>

#include "inputs.hpp"

namespace speed {

/// The recording's values repeated up to a length, from a sample of it on.
template <class To, class From>
void repeat(const std::vector<From>& values, std::size_t length, std::vector<To>& repeated,
            std::size_t from = 0) {
  repeated.resize(length);
  std::size_t at = from % values.size();
  for (To& each : repeated) {
    each = static_cast<To>(values[at]);
    at = at + 1 < values.size() ? at + 1 : 0;
  }
}

}  // namespace speed
