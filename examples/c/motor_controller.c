/* A motor controller's firmware in the style of a chip vendor's examples: the converter's
 * end-of-sequence interrupt at 8 kHz takes the four gauges and the encoder's counter, and leaves the
 * clean torque for the current loop.
 *
 * Registers are those of no real chip: put the vendor's header in place of the block below.  Written
 * for C11 without a C library: -std=c11 -ffreestanding.
 */
#include "strainwave_joint.h"

/* ---- what a vendor's header gives ------------------------------------------------------------- */

typedef struct {
  volatile uint32_t STATUS;
  volatile uint32_t DATA[STRAINWAVE_GAUGES]; /* results of one sequence, 0 to 65535 */
} ADC_Registers;

typedef struct {
  volatile uint32_t COUNT; /* quadrature counter, wraps at 32 bits */
} ENCODER_Registers;

typedef struct {
  volatile uint32_t ENABLE;
} POWER_STAGE_Registers;

#ifndef CHIP_REGISTERS_ELSEWHERE
#define ADC1 ((ADC_Registers *)0x40012000u)
#define ENCODER1 ((ENCODER_Registers *)0x40014000u)
#define POWER_STAGE ((POWER_STAGE_Registers *)0x40016000u)
#else
extern ADC_Registers chip_adc;
extern ENCODER_Registers chip_encoder;
extern POWER_STAGE_Registers chip_power_stage;
#define ADC1 (&chip_adc)
#define ENCODER1 (&chip_encoder)
#define POWER_STAGE (&chip_power_stage)
#endif

#define ADC_STATUS_END_OF_SEQUENCE (1u << 0)
#define ADC_STATUS_OVERRUN (1u << 1)
#define ENCODER_COUNTS_PER_TURN 16384u

/* ---- this firmware ---------------------------------------------------------------------------- */

/* What the current loop reads; written by the interrupt alone. */
typedef struct {
  volatile float torque_Nm;
  volatile uint32_t status;
  volatile bool usable;
} JointTorque;

JointTorque joint_torque;

/* A page that keeps its content over a reset: backup memory, or a copy of a flash page. */
strainwave_learned backup_page;

static strainwave_state sensor;
static strainwave_encoder encoder;
static strainwave_inputs inputs;

void motor_controller_start(void);
void motor_controller_save(void);
void ADC1_IRQHandler(void);

/* Before the interrupt is enabled.  A corrupt image keeps the power stage off. */
void motor_controller_start(void) {
  joint_torque.usable = false;
  joint_torque.torque_Nm = 0.0f;
  if (strainwave_init(&sensor) != STRAINWAVE_OK) {
    POWER_STAGE->ENABLE = 0u;
    return;
  }
  strainwave_default_inputs(&inputs);
  /* Without a sound block the sensor starts with the joint file's coefficients, as it is. */
  (void)strainwave_restore_learned(&sensor, &backup_page);
  POWER_STAGE->ENABLE = 1u;
}

/* At power-down, with the interrupt disabled. */
void motor_controller_save(void) { (void)strainwave_save_learned(&sensor, &backup_page); }

void ADC1_IRQHandler(void) {
  const uint32_t raised = ADC1->STATUS;
  ADC1->STATUS = raised; /* flags are cleared by writing ones */
  if ((raised & ADC_STATUS_END_OF_SEQUENCE) == 0u) {
    return;
  }
  for (uint32_t j = 0; j < STRAINWAVE_GAUGES; ++j) {
    inputs.codes[j] = (int32_t)ADC1->DATA[j];
  }
  inputs.motor_phase = strainwave_encoder_phase(&encoder, ENCODER1->COUNT, ENCODER_COUNTS_PER_TURN);
  /* An overrun has lost a sequence: the step in the number says so. */
  inputs.sequence += (raised & ADC_STATUS_OVERRUN) != 0u ? 2u : 1u;

  strainwave_outputs outputs;
  const strainwave_result result = strainwave_step(&sensor, &inputs, &outputs);
  joint_torque.torque_Nm = outputs.torque_Nm;
  joint_torque.status = outputs.status;
  joint_torque.usable = result == STRAINWAVE_OK && (outputs.status & STRAINWAVE_FAULTS) == 0u;
}
