// SPDX-License-Identifier: Apache-2.0
// The core's default ripple filter with 15 states: one channel, step by step, as a control loop calls it.
#include "case.hpp"
#include "filters.hpp"

namespace speed {

namespace {

/// The configuration is a constant, as on a microcontroller and as with the dense peers.
template <class Real>
Case constant_configuration(const Recording& recording) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [inputs = ripple_samples<Real>(recording)](std::size_t samples, Real* ripple_Nm) {
        auto state = strainwave::initial_state(default_15<Real>);
        for (std::size_t k = 0; k < samples; ++k) {
          ripple_Nm[k] = strainwave::step(default_15<Real>, state, inputs[k]).ripple_Nm;
        }
      });
}

/// The configuration is read, as from a joint file.
template <class Real>
Case run_time_configuration(const Recording& recording) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [inputs = ripple_samples<Real>(recording)](std::size_t samples, Real* ripple_Nm) {
        auto config = default_15<Real>;
        asm volatile("" : : "r"(&config) : "memory");
        auto state = strainwave::initial_state(config);
        for (std::size_t k = 0; k < samples; ++k) {
          ripple_Nm[k] = strainwave::step(config, state, inputs[k]).ripple_Nm;
        }
      });
}

}  // namespace

void add_default(Cases& cases) {
  cases["default_float"] = constant_configuration<float>;
  cases["default_double"] = constant_configuration<double>;
  cases["default_float_run_time"] = run_time_configuration<float>;
}

}  // namespace speed
