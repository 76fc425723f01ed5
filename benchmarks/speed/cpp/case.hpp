// SPDX-License-Identifier: Apache-2.0
/// @file case.hpp
/// One implementation, or one way of running it: what is timed and what it found.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "inputs.hpp"

namespace speed {

/// A case that has its inputs ready.
struct Case {
  /// Filters so many samples of each channel from the start; returns how many that were together.
  std::function<std::size_t(std::size_t)> run;
  /// Ripple of the last run's first channel, Nm.
  std::function<std::vector<double>()> ripple_Nm;
  /// Makes the inputs for so many samples, outside of the time that is taken.
  std::function<void(std::size_t)> prepare = [](std::size_t /*samples*/) {};
  /// What is to be said beside the time, JSON members each after a comma.
  std::function<std::string()> remarks = [] { return std::string{}; };
};

/// What follows a case's name: batch_published:channels=64:threads=2.
using Options = std::map<std::string, std::string>;

[[nodiscard]] inline std::size_t number(const Options& options, const std::string& name,
                                        std::size_t otherwise) {
  const auto found = options.find(name);
  return found == options.end() ? otherwise : std::stoul(found->second);
}

/// What makes each case from the recording, by name.
using Cases = std::map<std::string, std::function<Case(const Recording&, const Options&)>>;

/// All cases of a program.
[[nodiscard]] Cases all_cases();

/// A case of one channel: `filter` goes over its inputs and writes the ripple.
template <class Real, class Filter>
Case single_channel(std::vector<Real> ripple_Nm, Filter filter) {
  auto ripple = std::make_shared<std::vector<Real>>(std::move(ripple_Nm));
  auto last = std::make_shared<std::size_t>(0);
  return {[ripple, last, filter](std::size_t samples) {
            if (samples > ripple->size()) {
              throw std::out_of_range("the recording is shorter than that");
            }
            filter(samples, ripple->data());
            *last = samples;
            return samples;
          },
          [ripple, last] {
            return std::vector<double>(ripple->begin(),
                                       ripple->begin() + static_cast<std::ptrdiff_t>(*last));
          }};
}

}  // namespace speed
