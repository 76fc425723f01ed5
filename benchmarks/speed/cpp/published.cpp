// SPDX-License-Identifier: Apache-2.0
// The core's published filter: one channel, step by step, as a control loop calls it.
#include "case.hpp"
#include "filters.hpp"

namespace speed {

namespace {

/// The configuration is a constant, as on a microcontroller and as with Eigen.
template <class Real>
Case constant_configuration(const Recording& recording) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [inputs = oscillator_samples<Real>(recording)](std::size_t samples, Real* ripple_Nm) {
        auto state = strainwave::initial_state(published<Real>);
        for (std::size_t k = 0; k < samples; ++k) {
          ripple_Nm[k] = strainwave::step(published<Real>, state, inputs[k]).ripple_Nm;
        }
      });
}

/// The configuration is read, as from a joint file.
template <class Real>
Case run_time_configuration(const Recording& recording) {
  return single_channel(
      std::vector<Real>(recording.samples()),
      [inputs = oscillator_samples<Real>(recording)](std::size_t samples, Real* ripple_Nm) {
        auto config = published<Real>;
        asm volatile("" : : "r"(&config) : "memory");
        auto state = strainwave::initial_state(config);
        for (std::size_t k = 0; k < samples; ++k) {
          ripple_Nm[k] = strainwave::step(config, state, inputs[k]).ripple_Nm;
        }
      });
}

}  // namespace

void add_published(Cases& cases) {
  cases["published_float"] = constant_configuration<float>;
  cases["published_double"] = constant_configuration<double>;
  cases["published_float_run_time"] = run_time_configuration<float>;
}

}  // namespace speed
