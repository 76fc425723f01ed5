// SPDX-License-Identifier: Apache-2.0
/// @file chain_4_gauges.cpp
/// The whole chain: four gauges with their watch, three orders with load and speed terms,
/// misalignment.

#include "gauges.hpp"

namespace {

volatile float torque_Nm;

}  // namespace

extern "C" [[gnu::noinline, gnu::flatten]] void sample_path(Gauges::State& state,
                                                            const Gauges::Sample& sample) {
  torque_Nm = strainwave::step(joint::sensor, state, sample).torque_Nm;
}

int main() { return measure::run<Gauges>(sample_path); }
