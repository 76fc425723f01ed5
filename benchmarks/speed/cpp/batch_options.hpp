// SPDX-License-Identifier: Apache-2.0
/// @file batch_options.hpp
/// A case's options as the core's.
#pragma once

#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "case.hpp"
#include "strainwave/batch.hpp"

namespace speed {

inline constexpr std::array<std::pair<std::string_view, strainwave::VectorLevel>, 4> levels = {{
    {"portable", strainwave::VectorLevel::portable},
    {"v2", strainwave::VectorLevel::x86_64_v2},
    {"v3", strainwave::VectorLevel::x86_64_v3},
    {"v4", strainwave::VectorLevel::x86_64_v4},
}};

/// Vector level and threads of a case; without a level, the best one.
[[nodiscard]] inline strainwave::BatchOptions batch_options(const Options& options) {
  strainwave::BatchOptions batch;
  batch.thread_count = number(options, "threads", 1);
  if (const auto level = options.find("level"); level != options.end()) {
    for (const auto& [name, value] : levels) {
      if (name == level->second) {
        batch.level = value;
        return batch;
      }
    }
    throw std::invalid_argument("level");
  }
  return batch;
}

}  // namespace speed
