// SPDX-License-Identifier: Apache-2.0
#include "common.hpp"

NB_MODULE(_core, m) {
  m.doc() = "The C++ core of strainwave: the same headers that run on the microcontroller.";
  using namespace strainwave::bindings;
  // Objects that a program keeps until it ends are no leak worth a page of warnings to its user.
  nb::set_leak_warnings(false);
  bind_units(m);
  bind_status(m);
  bind_gear(m);
  bind_fluctuation(m);
  bind_bridge(m);
  bind_gains(m);
  bind_gauge_monitor(m);
  bind_calibration(m);
  bind_oscillator_filter(m);
  bind_batch(m);
  bind_ripple_config(m);
  bind_ripple_filter(m);
  bind_batch_ripple(m);
  bind_ripple_smoother(m);
  bind_torque_sensor(m);
  bind_tracking_notch(m);
  bind_empty_step(m);
}
