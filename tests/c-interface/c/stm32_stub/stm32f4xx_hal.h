/* Declarations in the place of ST's HAL, which is not part of this project: what the example calls. */
#ifndef STM32F4XX_HAL_H
#define STM32F4XX_HAL_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CNT;
} TIM_TypeDef;

typedef struct {
    TIM_TypeDef *Instance;
} TIM_HandleTypeDef;

typedef enum { HAL_OK = 0, HAL_ERROR = 1 } HAL_StatusTypeDef;

#define TIM_CHANNEL_ALL 0x3cu
#define __HAL_TIM_GET_COUNTER(handle) ((handle)->Instance->CNT)

HAL_StatusTypeDef HAL_TIM_Encoder_Start(TIM_HandleTypeDef *timer, uint32_t channel);
HAL_StatusTypeDef HAL_TIM_Base_Start_IT(TIM_HandleTypeDef *timer);
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer);
void velocity_start(void);

#endif
