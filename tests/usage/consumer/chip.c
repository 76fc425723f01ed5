/* The registers of motor_controller.c in memory, and its interrupt called with codes and counts. */
#include <math.h>
#include <stdio.h>

#include "strainwave_joint.h"

typedef struct {
  volatile uint32_t STATUS;
  volatile uint32_t DATA[STRAINWAVE_GAUGES];
} ADC_Registers;
typedef struct {
  volatile uint32_t COUNT;
} ENCODER_Registers;
typedef struct {
  volatile uint32_t ENABLE;
} POWER_STAGE_Registers;
typedef struct {
  volatile float torque_Nm;
  volatile uint32_t status;
  volatile bool usable;
} JointTorque;

ADC_Registers chip_adc;
ENCODER_Registers chip_encoder;
POWER_STAGE_Registers chip_power_stage;
extern JointTorque joint_torque;
extern strainwave_learned backup_page;
void motor_controller_start(void);
void motor_controller_save(void);
void ADC1_IRQHandler(void);

static void interrupt(uint32_t code, uint32_t count) {
  for (int j = 0; j < STRAINWAVE_GAUGES; ++j) {
    chip_adc.DATA[j] = code;
  }
  chip_encoder.COUNT = count;
  chip_adc.STATUS = 1u;
  ADC1_IRQHandler();
}

static int expect(bool good, const char *what) {
  if (!good) {
    printf("not so: %s\n", what);
  }
  return good ? 0 : 1;
}

int main(void) {
  int wrong = 0;
  motor_controller_start();
  wrong += expect(chip_power_stage.ENABLE == 1u, "a sound image enables the power stage");
  wrong += expect(!joint_torque.usable, "no torque before the first sample");
  interrupt(33000u, 0xFFFFFFF0u); /* and over the encoder's wrap */
  wrong += expect(joint_torque.usable, "a sample gives torque");
  interrupt(33001u, 0x00000010u);
  wrong += expect((joint_torque.status & STRAINWAVE_ROTATION_INVALID) == 0u, "the wrap is no jump");
  wrong += expect(fabsf(joint_torque.torque_Nm) < 40.0f, "of the size that the codes say");
  chip_adc.STATUS = 2u;
  const float held_Nm = joint_torque.torque_Nm;
  ADC1_IRQHandler();
  wrong += expect(joint_torque.torque_Nm == held_Nm, "another interrupt changes nothing");
  motor_controller_save();
  wrong += expect(backup_page.words[0] == 0x524C5753u, "the block says what it is");
  motor_controller_start();
  wrong += expect(chip_power_stage.ENABLE == 1u, "starts with what was kept");
  backup_page.words[5] ^= 1u;
  motor_controller_start();
  wrong += expect(chip_power_stage.ENABLE == 1u, "and without, where the block is damaged");
  return wrong;
}
