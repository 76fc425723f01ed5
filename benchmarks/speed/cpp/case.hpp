// SPDX-License-Identifier: Apache-2.0
/// @file case.hpp
/// One implementation, or one way of running it: what is timed and what it found.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "inputs.hpp"

namespace speed {

/// A case that has its inputs ready.
struct Case {
  /// Filters so many samples from the start; returns how many channel-samples that were.
  std::function<std::size_t(std::size_t)> run;
  /// Ripple of the last run's first channel, Nm.
  std::function<std::vector<double>()> ripple_Nm;
  /// What is to be said beside the time, JSON members each after a comma.
  std::function<std::string()> remarks = [] { return std::string{}; };
};

/// What makes each case from the recording, by name.
using Cases = std::map<std::string, std::function<Case(const Recording&)>>;

void add_published(Cases& cases);
void add_default(Cases& cases);
void add_published_eigen(Cases& cases);
void add_default_eigen(Cases& cases);
void add_states(Cases& cases);
void add_batch(Cases& cases);
void add_long_log(Cases& cases);

/// A case of one channel: `filter` goes over signals and writes the ripple.
template <class Real, class Filter>
Case single_channel(std::vector<Real> ripple_Nm, Filter filter) {
  auto ripple = std::make_shared<std::vector<Real>>(std::move(ripple_Nm));
  auto last = std::make_shared<std::size_t>(0);
  return {[ripple, last, filter](std::size_t samples) {
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
