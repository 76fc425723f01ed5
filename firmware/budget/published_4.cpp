// SPDX-License-Identifier: Apache-2.0
/// @file published_4.cpp
/// The filter of Taghirad & Belanger 1999, section V: orders 2 and 4, four states.

#include "published.hpp"

namespace {

constexpr auto config = strainwave::taghirad1999_4<float, 2>();
static_assert(check(config).ok());

struct Subject : Published<2> {
  static State initial() { return strainwave::initial_state(config); }
};

volatile float torque_Nm;

}  // namespace

extern "C" [[gnu::noinline, gnu::flatten]] void sample_path(Subject::State& state,
                                                            const Subject::Sample& sample) {
  torque_Nm = strainwave::step(config, state, sample).torque_Nm;
}

int main() { return measure::run<Subject>(sample_path); }
