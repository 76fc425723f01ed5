// Clean torque of one exported joint, printed fifty times a second.
//
// Beside this sketch belong the three files of `strainwave export wrist.toml --out .`: wrist.hpp,
// strainwave_joint.h and strainwave_joint.cpp.  The board's compiler has to be set to C++20, see the
// library's documentation.
#include <strainwave_arduino.h>

#include "wrist.hpp"

namespace joint = strainwave::joints::wrist;

// Pins of the four gauges' amplifiers.  The joint file's converter has to be the board's: bits and
// voltage range.
const int gauge_pins[joint::gauge_capacity] = {A0, A1, A2, A3};
const unsigned long sample_period_us = 125;

joint::State sensor_state;
bool usable = false;
std::uint32_t sample_number = 0;
unsigned long next_us = 0;

// The encoder's count; replace by the board's quadrature counter.
std::uint32_t read_encoder() { return 0; }
strainwave::EncoderCounter encoder;

void setup() {
  Serial.begin(115200);
  usable = joint::joint_is_intact();
  if (!usable) {
    Serial.println("the joint's configuration is corrupt: no torque");
    return;
  }
  sensor_state = joint::power_up_state();
  next_us = micros();
}

void loop() {
  if (!usable || static_cast<long>(micros() - next_us) < 0) {
    return;
  }
  next_us += sample_period_us;
  joint::Sample sample;
  sample.temperature_degC = joint::config.calibration.reference_temperature_degC;
  for (std::size_t j = 0; j < joint::gauge_capacity; ++j) {
    sample.codes[j] = {analogRead(gauge_pins[j])};
  }
  sample.motor_phase = strainwave::phase_from_counts(encoder.update(read_encoder()), 16384);
  sample.sequence = sample_number;
  const joint::Reading reading = step(joint::config, sensor_state, sample);
  if (++sample_number % 160 == 0) {
    Serial.println(reading.torque_Nm);
  }
}
