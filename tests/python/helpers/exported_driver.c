/* The same as exported_driver.cpp through the C interface. */
#include <stdio.h>

#include "strainwave_joint.h"

#define READ(value) (fread(&(value), sizeof(value), 1, stdin) == 1)

int main(void) {
  static strainwave_state state;
  strainwave_inputs inputs = {0};
  strainwave_outputs outputs;
  if (strainwave_step(&state, &inputs, &outputs) != STRAINWAVE_NOT_STARTED ||
      outputs.torque_Nm != 0) {
    return 4;
  }
  const strainwave_result started = strainwave_init(&state);
  strainwave_default_inputs(&inputs);
  if (started == STRAINWAVE_JOINT_CORRUPT) {
    outputs.torque_Nm = 1;
    const strainwave_result refused = strainwave_step(&state, &inputs, &outputs);
    return refused == STRAINWAVE_NOT_STARTED && outputs.torque_Nm == 0 ? 3 : 4;
  }
  uint32_t count = 0;
  while (READ(inputs.codes)) {
    double speed_rad_s, temperature_degC;
    uint32_t phase_valid;
    if (!(READ(inputs.motor_phase.turns) && READ(inputs.motor_phase.fraction) &&
          READ(phase_valid) && READ(inputs.sequence) && READ(speed_rad_s) &&
          READ(temperature_degC))) {
      return 1;
    }
    inputs.phase_valid = phase_valid != 0;
    inputs.motor_speed_rad_s = (strainwave_real)speed_rad_s;
    inputs.temperature_degC = (strainwave_real)temperature_degC;
    if (strainwave_step(&state, &inputs, &outputs) != STRAINWAVE_OK) {
      return 5;
    }
    const double torques[3] = {(double)outputs.torque_measured_Nm, (double)outputs.torque_Nm,
                               (double)outputs.ripple_Nm};
    const uint32_t words[2] = {outputs.status, outputs.left_out_gauge};
    fwrite(torques, sizeof(torques), 1, stdout);
    fwrite(words, sizeof(words), 1, stdout);
    ++count;
  }
  if (strainwave_event_count(&state, 0) != count || strainwave_init(NULL) != STRAINWAVE_NULL_POINTER ||
      strainwave_step(&state, NULL, &outputs) != STRAINWAVE_NULL_POINTER || outputs.torque_Nm != 0) {
    return 6;
  }
  return strainwave_clear_lost_gauge(&state) == STRAINWAVE_OK ? 0 : 7;
}
