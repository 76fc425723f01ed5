// SPDX-License-Identifier: Apache-2.0
/// @file default_3_orders_load_speed.cpp
/// The ripple filter with orders 2, 4 and 6 and a load and a speed term each: nineteen states.

#include "ripple.hpp"

namespace {

constexpr auto config = three_orders<9>(true);
static_assert(check(config).ok());

struct Subject : Ripple<9> {
  static State initial() { return strainwave::initial_state(config); }
};

volatile float torque_Nm;

}  // namespace

extern "C" [[gnu::noinline, gnu::flatten]] void sample_path(Subject::State& state,
                                                            const Subject::Sample& sample) {
  torque_Nm = strainwave::step(config, state, sample).torque_Nm;
}

int main() { return measure::run<Subject>(sample_path); }
