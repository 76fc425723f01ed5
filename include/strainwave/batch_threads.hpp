// SPDX-License-Identifier: Apache-2.0
/// @file batch_threads.hpp
/// Work in parts, shared by threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace strainwave::detail {

/// Calls work(part) once for each of `parts`, by up to `thread_count` threads of which the caller
/// is one.  Parts are taken as threads become free; work must not throw.
template <class Work>
void for_each_part(std::size_t parts, std::size_t thread_count, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto take_parts = [&] {
    for (std::size_t part = next++; part < parts; part = next++) {
      work(part);
    }
  };
  const std::size_t helpers = std::min(std::max<std::size_t>(thread_count, 1), parts);
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < helpers; ++i) {
    threads.emplace_back(take_parts);
  }
  take_parts();
}

}  // namespace strainwave::detail
