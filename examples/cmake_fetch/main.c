/* Torque of one set of converter codes, given as arguments, through the C interface. */
#include <stdio.h>
#include <stdlib.h>

#include "strainwave_joint.h"

int main(int count, char **arguments) {
  static strainwave_state sensor;
  strainwave_inputs inputs;
  strainwave_outputs outputs;

  if (count != STRAINWAVE_GAUGES + 1) {
    fprintf(stderr, "expected %d converter codes\n", STRAINWAVE_GAUGES);
    return 2;
  }
  if (strainwave_init(&sensor) != STRAINWAVE_OK) {
    fprintf(stderr, "the joint's configuration is corrupt\n");
    return 1;
  }
  strainwave_default_inputs(&inputs);
  for (int j = 0; j < STRAINWAVE_GAUGES; ++j) {
    inputs.codes[j] = (int32_t)strtol(arguments[j + 1], NULL, 10);
  }
  if (strainwave_step(&sensor, &inputs, &outputs) != STRAINWAVE_OK) {
    return 1;
  }
  printf("%.4f Nm measured, %.4f Nm clean\n", (double)outputs.torque_measured_Nm,
         (double)outputs.torque_Nm);
  return 0;
}
