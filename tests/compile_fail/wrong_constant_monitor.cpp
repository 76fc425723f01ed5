// expected: static assertion failed
#include "strainwave/torque_sensor.hpp"

constexpr strainwave::GaugeMonitorConfig<float, 5> configured() {
  strainwave::GaugeMonitorConfig<float, 5> config;
  config.active = true;
#ifdef STRAINWAVE_CONTROL
  config.stuck_samples = 12;
#else
  config.stuck_samples = 1;  // every sample would look stuck
#endif
  return config;
}

static_assert(check(configured(), 5).ok());
