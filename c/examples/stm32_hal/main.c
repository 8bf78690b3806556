/* STM32 with ST's HAL: TIM3 counts a quadrature encoder, TIM6 interrupts every millisecond.
 *
 * TIM3: encoder mode, both inputs, period 0xffff (CubeMX: Combined Channels: Encoder Mode TI1 and TI2).
 * TIM6: 1 kHz, interrupt enabled.
 *
 *   arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -O2 -c main.c
 *
 * parameters.h: host-sim export --estimator imm --counts-per-rev 4096 --rate 1000 --c --out parameters.h
 */
#include "stm32f4xx_hal.h"

#include "limpid.h"
#include "parameters.h"

extern TIM_HandleTypeDef htim3;
extern TIM_HandleTypeDef htim6;

/* Velocity at the latest tick, rad/s, and its variance, (counts per tick)^2. */
volatile float velocity_rad_per_s;
volatile float variance;

static limpid_imm_state_t state;
static uint32_t count;

static limpid_sample_t measured(void)
{
    count = limpid_extended(count, (uint16_t)__HAL_TIM_GET_COUNTER(&htim3));
    return limpid_count(count);
}

/* Call after MX_TIM3_Init() and MX_TIM6_Init(). */
void velocity_start(void)
{
    limpid_sample_t first;
    HAL_TIM_Encoder_Start(&htim3, TIM_CHANNEL_ALL);
    first = measured();
    limpid_imm_start(&limpid_imm_parameters, &state, &first);
    HAL_TIM_Base_Start_IT(&htim6);
}

/* The HAL calls this in the interrupt of TIM6. */
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer)
{
    if (timer == &htim6) {
        limpid_sample_t sample = measured();
        float v = limpid_imm_update(&limpid_imm_parameters, &state, &sample);
        velocity_rad_per_s = LIMPID_RAD_PER_S(v, LIMPID_IMM_COUNTS_PER_REV, LIMPID_IMM_RATE_HZ);
        variance = limpid_imm_variance(&limpid_imm_parameters, &state);
    }
}
