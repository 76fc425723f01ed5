// A program on a host that uses the installed core as any consumer would: a sensor configured for
// one gauge turns a converter code into torque.
#include <cmath>
#include <cstdio>

#include "strainwave/torque_sensor.hpp"

int main() {
  strainwave::TorqueSensorConfig<double, 1, 2> config;
  config.calibration.gain_Nm_per_V = 6.60;
  config.filter = strainwave::taghirad1999_4<double, 2>();
  if (const auto violation = strainwave::check(config); !violation.ok()) {
    std::printf("%s: expected %s\n", violation.parameter, violation.expected);
    return 1;
  }

  auto state = strainwave::initial_state(config);
  strainwave::TorqueSensorSample<1, double> sample;
  sample.codes[0] = strainwave::to_code(config.converter, 1.0);
  const auto reading = strainwave::step(config, state, sample);

  const double half_step_Nm = 0.5 * 6.60 * strainwave::step_V(config.converter);
  const double error_Nm = std::fabs(reading.torque_measured_Nm - 6.60);
  std::printf("1 V is %g Nm\n", reading.torque_measured_Nm);
  return error_Nm <= 1.01 * half_step_Nm ? 0 : 1;
}
