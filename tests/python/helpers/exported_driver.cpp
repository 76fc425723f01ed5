// Runs samples from the standard input through an exported header: -DHEADER, -DJOINT.  Ends with 3
// where the image is corrupt.
#include <cstdio>

#include HEADER

namespace joint = JOINT;

template <class Value>
bool read(Value& value) {
  return std::fread(&value, sizeof(Value), 1, stdin) == 1;
}

int main() {
  if (!joint::joint_is_intact()) {
    return 3;
  }
  joint::State state = joint::power_up_state();
  joint::Sample sample;
  while (read(sample.codes)) {
    double speed_rad_s = 0.0;
    double temperature_degC = 0.0;
    std::uint32_t phase_valid = 0;
    if (!(read(sample.motor_phase.turns) && read(sample.motor_phase.fraction) &&
          read(phase_valid) && read(sample.sequence) && read(speed_rad_s) &&
          read(temperature_degC))) {
      return 1;
    }
    sample.phase_valid = phase_valid != 0;
    sample.motor_speed_rad_s = static_cast<joint::Real>(speed_rad_s);
    sample.temperature_degC = static_cast<joint::Real>(temperature_degC);
    const joint::Reading reading = step(joint::config, state, sample);
    const double torques[3] = {static_cast<double>(reading.torque_measured_Nm),
                               static_cast<double>(reading.torque_Nm),
                               static_cast<double>(reading.ripple_Nm)};
    const std::uint32_t words[2] = {reading.status, reading.left_out_gauge};
    std::fwrite(torques, sizeof(torques), 1, stdout);
    std::fwrite(words, sizeof(words), 1, stdout);
  }
  return 0;
}
