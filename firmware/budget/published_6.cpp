// SPDX-License-Identifier: Apache-2.0
/// @file published_6.cpp
/// The filter of Taghirad & Belanger 1999, section VI: orders 2, 4 and 1/100, six states.

#include "published.hpp"

namespace {

constexpr auto config = strainwave::taghirad1999<float, 3>({100, 1});
static_assert(check(config).ok());

struct Subject : Published<3> {
  static State initial() { return strainwave::initial_state(config); }
};

volatile float torque_Nm;

}  // namespace

extern "C" [[gnu::noinline, gnu::flatten]] void sample_path(Subject::State& state,
                                                            const Subject::Sample& sample) {
  torque_Nm = strainwave::step(config, state, sample).torque_Nm;
}

int main() { return measure::run<Subject>(sample_path); }
