// A program on a host that uses the installed core as any consumer would: sensors with either
// filter turn one gauge's converter codes into torque, and a notch removes a ripple.
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "strainwave/torque_sensor.hpp"
#include "strainwave/tracking_notch.hpp"

namespace {

constexpr double gain_Nm_per_V = 6.60;

/// One code through a chain: 1 V, to half a step of the converter.
template <class Config>
bool is_one_volt(const Config& config) {
  if (const auto violation = strainwave::check(config); !violation.ok()) {
    std::printf("%s: expected %s\n", violation.parameter, violation.expected);
    return false;
  }
  auto state = strainwave::initial_state(config);
  strainwave::TorqueSensorSample<1, double> sample;
  sample.codes[0] = strainwave::to_code(config.converter, 1.0);
  const auto reading = strainwave::step(config, state, sample);

  const double half_step_Nm = 0.5 * gain_Nm_per_V * strainwave::step_V(config.converter);
  const double error_Nm = std::fabs(reading.torque_measured_Nm - gain_Nm_per_V);
  std::printf("1 V is %g Nm\n", reading.torque_measured_Nm);
  return error_Nm <= 1.01 * half_step_Nm;
}

double ripple_Nm(double motor_angle_rad) { return std::cos(2 * motor_angle_rad); }

/// Twenty motor turns with ripple of 1 Nm; the largest torque of the last one.
template <class Step>
double rest_of_ripple_Nm(Step step) {
  double worst_Nm = 0.0;
  for (int k = 0; k < 1200; ++k) {
    const double motor_angle_rad = 0.1 * k;
    const double torque_Nm = step(static_cast<std::uint32_t>(k), motor_angle_rad);
    worst_Nm = k < 1137 ? 0.0 : std::fmax(worst_Nm, std::fabs(torque_Nm));
  }
  std::printf("1 Nm of ripple becomes %g Nm\n", worst_Nm);
  return worst_Nm;
}

}  // namespace

int main() {
  strainwave::TorqueSensorConfig<double, 1, 2> published;
  published.calibration.gain_Nm_per_V = gain_Nm_per_V;
  published.filter = strainwave::taghirad1999_4<double, 2>();

  constexpr strainwave::RippleSensorConfig<double, 1, 2> config{
      .calibration = {.gain_Nm_per_V = gain_Nm_per_V}};
  static_assert(check(config).ok());

  auto state = strainwave::initial_state(config);
  const double after_chain_Nm = rest_of_ripple_Nm([&](std::uint32_t k, double motor_angle_rad) {
    strainwave::TorqueSensorSample<1, double> sample;
    sample.codes[0] =
        strainwave::to_code(config.converter, ripple_Nm(motor_angle_rad) / gain_Nm_per_V);
    sample.motor_phase = strainwave::phase_from_radians(motor_angle_rad);
    sample.sequence = k;
    return strainwave::step(config, state, sample).torque_Nm;
  });

  strainwave::TrackingNotchConfig<double, 1> notch;
  notch.bandwidth_Hz = 10.0;
  auto notch_state = strainwave::initial_state(notch);
  const double after_notch_Nm = rest_of_ripple_Nm([&](std::uint32_t, double motor_angle_rad) {
    strainwave::TrackingNotchSample<double> sample;
    sample.measured_torque_Nm = ripple_Nm(motor_angle_rad);
    sample.motor_phase = strainwave::phase_from_radians(motor_angle_rad);
    return strainwave::step(notch, notch_state, sample).torque_Nm;
  });

  const bool good = is_one_volt(published) && is_one_volt(config) && check(notch).ok() &&
                    after_chain_Nm < 0.02 && after_notch_Nm < 0.02;
  return good ? 0 : 1;
}
