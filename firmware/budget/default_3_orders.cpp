// SPDX-License-Identifier: Apache-2.0
/// @file default_3_orders.cpp
/// The ripple filter as it is by default, with orders 2, 4 and 6: seven states.

#include "ripple.hpp"

namespace {

constexpr auto config = three_orders<3>(false);
static_assert(check(config).ok());

struct Subject : Ripple<3> {
  static State initial() { return strainwave::initial_state(config); }
};

volatile float torque_Nm;

}  // namespace

extern "C" [[gnu::noinline, gnu::flatten]] void sample_path(Subject::State& state,
                                                            const Subject::Sample& sample) {
  torque_Nm = strainwave::step(config, state, sample).torque_Nm;
}

int main() { return measure::run<Subject>(sample_path); }
