#include <cstdio>
#include <strainwave/torque_sensor.hpp>

int main() {
  strainwave::TorqueSensorConfig<float, 1, 2> config;  // one bridge, two orders
  config.calibration.gain_Nm_per_V = 6.60F;
  config.filter = strainwave::with_orders<float>({{2, 1}, {4, 1}});
  static_assert(check(strainwave::with_orders<float>({{2, 1}, {4, 1}})).ok());
  auto state = initial_state(config);
  strainwave::TorqueSensorSample<1, float> sample;
  sample.codes[0].value = 36000;  // from the converter
  sample.motor_speed_rad_s = 156.0F;
  const auto reading = step(config, state, sample);
  std::printf("%.3f Nm, status %x\n", static_cast<double>(reading.torque_Nm), reading.status);
}
