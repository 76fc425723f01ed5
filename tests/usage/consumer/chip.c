/* The registers of motor_controller.c in memory, and its interrupt called with codes and counts. */
#include <math.h>
#include <stddef.h>
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

/* What each function says where it can do nothing. */
static int refusals(void) {
  static strainwave_state state, fresh;
  strainwave_learned block = {{0}};
  int wrong = 0;
  wrong += expect(strainwave_save_learned(&fresh, &block) == STRAINWAVE_NOT_STARTED, "not started");
  wrong += expect(strainwave_clear_lost_gauge(&fresh) == STRAINWAVE_NOT_STARTED, "not started");
  wrong += expect(strainwave_init(&state) == STRAINWAVE_OK, "starts");
  wrong += expect(strainwave_restore_learned(&state, NULL) == STRAINWAVE_NULL_POINTER, "no block");
  wrong += expect(strainwave_restore_learned(&state, &block) == STRAINWAVE_BLOCK_DAMAGED, "zeros");
  wrong += expect(strainwave_save_learned(&state, &block) == STRAINWAVE_OK, "saves");
  wrong += expect(strainwave_restore_learned(&state, &block) == STRAINWAVE_OK, "brings back");
  block.words[1] += 1u;
  wrong += expect(strainwave_restore_learned(&state, &block) == STRAINWAVE_BLOCK_OTHER_FORMAT,
                  "another layout");
  block.words[1] -= 1u;
  block.words[3] += 1u;
  wrong += expect(strainwave_restore_learned(&state, &block) == STRAINWAVE_BLOCK_DAMAGED, "a bit");
  return wrong;
}

/* Angles of counts: quarters of turns either way, over the wrap, and without a scale. */
static int angles(void) {
  int wrong = 0;
  strainwave_phase phase = strainwave_phase_of_counts(-1, 4u);
  wrong += expect(phase.turns == -1 && phase.fraction == 0xC0000000u, "a quarter back");
  phase = strainwave_phase_of_counts(9, 4u);
  wrong += expect(phase.turns == 2 && phase.fraction == 0x40000000u, "two turns and a quarter");
  phase = strainwave_phase_of_counts(9, 0u);
  wrong += expect(phase.turns == 0 && phase.fraction == 0u, "counts without a scale");
  strainwave_encoder encoder = {0, 0u, false};
  (void)strainwave_encoder_phase(&encoder, 0x7FFFFFFEu, 4u);
  phase = strainwave_encoder_phase(&encoder, 0x80000002u, 4u);
  wrong += expect(phase.turns == 0x20000000 && phase.fraction == 0x80000000u, "over the wrap");
  return wrong;
}

int main(void) {
  int wrong = refusals() + angles();
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
