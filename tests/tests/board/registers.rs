//! Registers of the chip after boot, against a table that is written from the reference manual (RM0090)
//! and the datasheet: what each field has to be for the wiring and the clocks of docs/board.md.

use virtual_board::run::{CoreAccess, Setup};

use crate::image::run_image;

/// An image with every input but the edges and the reference encoder.
const IMAGE: &str = "large-adaptive,current-monitor,index-pulse,supply-monitor";
/// An image with these two.
const WITH_EDGES: &str = "large-adaptive,edge-capture,reference";

/// Some bits of a register.
struct Field {
    address: u32,
    /// Lowest bit, and number of bits.
    bits: (u32, u32),
    value: u32,
    /// Register, field, and meaning of the value.
    what: &'static str,
}

const fn field(address: u32, bits: (u32, u32), value: u32, what: &'static str) -> Field {
    Field {
        address,
        bits,
        value,
        what,
    }
}

const RCC: u32 = 0x4002_3800;
const FLASH: u32 = 0x4002_3C00;
const GPIOA: u32 = 0x4002_0000;
const GPIOB: u32 = 0x4002_0400;
const GPIOC: u32 = 0x4002_0800;
const GPIOD: u32 = 0x4002_0C00;
const GPIOE: u32 = 0x4002_1000;
const GPIOF: u32 = 0x4002_1400;
const TIM1: u32 = 0x4001_0000;
const TIM2: u32 = 0x4000_0000;
const TIM3: u32 = 0x4000_0400;
const TIM4: u32 = 0x4000_0800;
const TIM5: u32 = 0x4000_0C00;
const TIM8: u32 = 0x4001_0400;
const DAC: u32 = 0x4000_7400;
const IWDG: u32 = 0x4000_3000;
const USART3: u32 = 0x4000_4800;
const ADC1: u32 = 0x4001_2000;
const ADC2: u32 = 0x4001_2100;
const ADC3: u32 = 0x4001_2200;
const ADC_COMMON: u32 = 0x4001_2300;
const DBGMCU: u32 = 0xE004_2000;
const NVIC: u32 = 0xE000_E000;

/// Before the device is armed.
const AFTER_BOOT: &[Field] = &[
    // 8 MHz / 4 is in the 1 to 2 MHz of the PLL's input, times 168 in the 100 to 432 MHz of its
    // oscillator, halved is the core's 168 MHz.
    field(RCC, (16, 1), 1, "RCC_CR.HSEON"),
    field(RCC, (18, 1), 1, "RCC_CR.HSEBYP: a clock and no crystal"),
    field(RCC, (19, 1), 1, "RCC_CR.CSSON"),
    field(RCC, (24, 1), 1, "RCC_CR.PLLON"),
    field(RCC + 0x04, (0, 6), 4, "RCC_PLLCFGR.PLLM"),
    field(RCC + 0x04, (6, 9), 168, "RCC_PLLCFGR.PLLN"),
    field(RCC + 0x04, (16, 2), 0, "RCC_PLLCFGR.PLLP: by 2"),
    field(RCC + 0x04, (22, 1), 1, "RCC_PLLCFGR.PLLSRC: HSE"),
    field(RCC + 0x08, (0, 2), 2, "RCC_CFGR.SW: PLL"),
    field(RCC + 0x08, (2, 2), 2, "RCC_CFGR.SWS: PLL"),
    field(RCC + 0x08, (4, 4), 0, "RCC_CFGR.HPRE: by 1"),
    field(
        RCC + 0x08,
        (10, 3),
        0b101,
        "RCC_CFGR.PPRE1: by 4, 45 MHz at most",
    ),
    field(
        RCC + 0x08,
        (13, 3),
        0b100,
        "RCC_CFGR.PPRE2: by 2, 90 MHz at most",
    ),
    // Five wait states from 150 to 180 MHz at 2.7 to 3.6 V.
    field(FLASH, (0, 4), 5, "FLASH_ACR.LATENCY"),
    // Inputs and their pulls: 1 up, 2 down.
    field(GPIOA, (12, 2), 2, "GPIOA_MODER6: function"),
    field(GPIOA + 0x20, (24, 4), 3, "GPIOA_AFR6: TIM8"),
    field(GPIOA + 0x0C, (12, 2), 2, "GPIOA_PUPDR6: interlock down"),
    field(GPIOE, (4, 2), 0, "GPIOE_MODER2: input"),
    field(GPIOE + 0x0C, (4, 2), 2, "GPIOE_PUPDR2: large ready down"),
    field(GPIOE, (12, 2), 0, "GPIOE_MODER6: input"),
    field(GPIOE + 0x0C, (12, 2), 2, "GPIOE_PUPDR6: small ready down"),
    field(GPIOD + 0x0C, (18, 2), 1, "GPIOD_PUPDR9: serial port up"),
    // Enables: push-pull outputs of TIM8, without a pull.
    field(GPIOC, (16, 4), 0b1010, "GPIOC_MODER8, 9: function"),
    field(GPIOC + 0x04, (8, 2), 0, "GPIOC_OTYPER8, 9: push-pull"),
    field(GPIOC + 0x0C, (16, 4), 0, "GPIOC_PUPDR8, 9: none"),
    field(GPIOC + 0x24, (0, 8), 0x33, "GPIOC_AFR8, 9: TIM8"),
    // Analogue: both DAC outputs and both monitors.
    field(GPIOA, (8, 4), 0b1111, "GPIOA_MODER4, 5: analogue"),
    field(GPIOA, (6, 2), 0b11, "GPIOA_MODER3: analogue"),
    field(GPIOC, (0, 2), 0b11, "GPIOC_MODER0: analogue"),
    // Enables off by the main output enable, driven low then, never on by themselves.
    field(TIM8 + 0x44, (15, 1), 0, "TIM8_BDTR.MOE"),
    field(TIM8 + 0x44, (14, 1), 0, "TIM8_BDTR.AOE"),
    field(TIM8 + 0x44, (13, 1), 0, "TIM8_BDTR.BKP: low is a break"),
    field(TIM8 + 0x44, (12, 1), 1, "TIM8_BDTR.BKE"),
    field(TIM8 + 0x44, (10, 1), 1, "TIM8_BDTR.OSSI: driven while off"),
    field(TIM8 + 0x44, (8, 2), 2, "TIM8_BDTR.LOCK: level 2"),
    field(
        TIM8 + 0x04,
        (12, 3),
        0,
        "TIM8_CR2.OIS3, OIS3N, OIS4: low while off",
    ),
    field(
        TIM8 + 0x20,
        (8, 2),
        0b01,
        "TIM8_CCER.CC3E, CC3P: active high",
    ),
    field(
        TIM8 + 0x20,
        (12, 2),
        0b01,
        "TIM8_CCER.CC4E, CC4P: active high",
    ),
    // A probe reads RTT while the core sleeps. A halt disables the enables, and does not stop the watchdog.
    field(DBGMCU + 0x04, (0, 1), 1, "DBGMCU_CR.DBG_SLEEP"),
    field(DBGMCU + 0x0C, (1, 1), 1, "DBGMCU_APB2_FZ.DBG_TIM8_STOP"),
    field(
        DBGMCU + 0x08,
        (11, 2),
        0,
        "DBGMCU_APB1_FZ: watchdogs run on",
    ),
    // Encoder mode 3: both edges of both inputs count.
    field(TIM4 + 0x08, (0, 3), 3, "TIM4_SMCR.SMS"),
    field(TIM4 + 0x18, (0, 2), 1, "TIM4_CCMR1.CC1S: TI1"),
    field(TIM4 + 0x18, (8, 2), 1, "TIM4_CCMR1.CC2S: TI2"),
    field(TIM4 + 0x18, (4, 4), 3, "TIM4_CCMR1.IC1F: 8 samples"),
    field(TIM4 + 0x18, (12, 4), 3, "TIM4_CCMR1.IC2F: 8 samples"),
    field(TIM4 + 0x2C, (0, 16), 0xFFFF, "TIM4_ARR"),
    field(TIM4, (0, 1), 1, "TIM4_CR1.CEN"),
    field(TIM3 + 0x08, (0, 3), 3, "TIM3_SMCR.SMS"),
    field(TIM3 + 0x18, (0, 2), 1, "TIM3_CCMR1.CC1S: TI1"),
    field(TIM3 + 0x18, (8, 2), 1, "TIM3_CCMR1.CC2S: TI2"),
    field(TIM3 + 0x18, (4, 4), 3, "TIM3_CCMR1.IC1F: 8 samples"),
    field(TIM3 + 0x18, (12, 4), 3, "TIM3_CCMR1.IC2F: 8 samples"),
    field(TIM3 + 0x2C, (0, 16), 0xFFFF, "TIM3_ARR"),
    field(TIM3, (0, 1), 1, "TIM3_CR1.CEN"),
    // Index lines: the rising edge of channel 3 of TIM4 (PD14) and of channel 4 of TIM3 (PB1) captures, after
    // 8 samples that agree, without an interrupt.
    field(GPIOD, (28, 2), 0b10, "GPIOD_MODER14: function"),
    field(GPIOD + 0x24, (24, 4), 2, "GPIOD_AFR14: TIM4"),
    field(GPIOD + 0x0C, (28, 2), 2, "GPIOD_PUPDR14: index down"),
    field(GPIOB, (2, 2), 0b10, "GPIOB_MODER1: function"),
    field(GPIOB + 0x20, (4, 4), 2, "GPIOB_AFR1: TIM3"),
    field(GPIOB + 0x0C, (2, 2), 2, "GPIOB_PUPDR1: index down"),
    field(TIM4 + 0x1C, (0, 4), 0b01, "TIM4_CCMR2.CC3S, IC3PSC: TI3"),
    field(TIM4 + 0x1C, (4, 4), 3, "TIM4_CCMR2.IC3F: 8 samples"),
    field(TIM4 + 0x20, (8, 4), 1, "TIM4_CCER.CC3E, CC3P, CC3NP: rises"),
    field(TIM4 + 0x0C, (0, 15), 0, "TIM4_DIER: no interrupt"),
    field(TIM3 + 0x1C, (8, 4), 0b01, "TIM3_CCMR2.CC4S, IC4PSC: TI4"),
    field(TIM3 + 0x1C, (12, 4), 3, "TIM3_CCMR2.IC4F: 8 samples"),
    field(
        TIM3 + 0x20,
        (12, 4),
        1,
        "TIM3_CCER.CC4E, CC4P, CC4NP: rises",
    ),
    field(TIM3 + 0x0C, (0, 15), 0, "TIM3_DIER: no interrupt"),
    // The tick: one comparison of a counter of 32 bits that does not start again.
    field(TIM5, (0, 1), 1, "TIM5_CR1.CEN"),
    field(TIM5 + 0x0C, (0, 15), 1 << 1, "TIM5_DIER: CC1IE alone"),
    field(TIM5 + 0x28, (0, 16), 0, "TIM5_PSC: 84 MHz"),
    field(TIM5 + 0x2C, (0, 32), u32::MAX, "TIM5_ARR"),
    // Interrupt 50 is the only one.
    field(NVIC + 0x100, (0, 32), 0, "NVIC_ISER0"),
    field(
        NVIC + 0x104,
        (0, 32),
        1 << (50 - 32),
        "NVIC_ISER1: TIM5 alone",
    ),
    field(NVIC + 0x108, (0, 32), 0, "NVIC_ISER2"),
    // 32 kHz / 128 times 7 counts is 28 ms.
    field(IWDG + 0x04, (0, 3), 5, "IWDG_PR: by 128"),
    field(IWDG + 0x08, (0, 12), 6, "IWDG_RLR"),
    field(DAC, (0, 3), 0b001, "DAC_CR.EN1, BOFF1, TEN1"),
    field(DAC, (16, 3), 0b001, "DAC_CR.EN2, BOFF2, TEN2"),
    // 42 MHz / 28 is 1.5 Mbaud; both directions by DMA, without an interrupt.
    field(USART3 + 0x08, (0, 16), 28, "USART3_BRR"),
    field(USART3 + 0x0C, (13, 1), 1, "USART3_CR1.UE"),
    field(USART3 + 0x0C, (2, 2), 0b11, "USART3_CR1.TE, RE"),
    field(USART3 + 0x0C, (4, 5), 0, "USART3_CR1: no interrupt"),
    field(USART3 + 0x14, (6, 2), 0b11, "USART3_CR3.DMAT, DMAR"),
    // 84 MHz / 4 is below the 36 MHz of the converters. One conversion again and again, never an overrun.
    field(ADC_COMMON + 0x04, (16, 2), 1, "ADC_CCR.ADCPRE: by 4"),
    field(ADC1 + 0x08, (0, 2), 0b11, "ADC1_CR2.ADON, CONT"),
    field(ADC1 + 0x08, (8, 3), 0, "ADC1_CR2.DMA, DDS, EOCS"),
    field(ADC1 + 0x2C, (20, 4), 0, "ADC1_SQR1.L: one"),
    field(ADC1 + 0x34, (0, 5), 3, "ADC1_SQR3.SQ1: PA3"),
    field(ADC1 + 0x10, (9, 3), 3, "ADC1_SMPR2.SMP3: 56 cycles"),
    field(ADC2 + 0x08, (0, 2), 0b11, "ADC2_CR2.ADON, CONT"),
    field(ADC2 + 0x08, (8, 3), 0, "ADC2_CR2.DMA, DDS, EOCS"),
    field(ADC2 + 0x2C, (20, 4), 0, "ADC2_SQR1.L: one"),
    field(ADC2 + 0x34, (0, 5), 10, "ADC2_SQR3.SQ1: PC0"),
    field(ADC2 + 0x0C, (0, 3), 3, "ADC2_SMPR1.SMP10: 56 cycles"),
    field(GPIOF, (6, 2), 0b11, "GPIOF_MODER3: analogue"),
    field(ADC3 + 0x08, (0, 2), 0b11, "ADC3_CR2.ADON, CONT"),
    field(ADC3 + 0x08, (8, 3), 0, "ADC3_CR2.DMA, DDS, EOCS"),
    field(ADC3 + 0x2C, (20, 4), 0, "ADC3_SQR1.L: one"),
    field(ADC3 + 0x34, (0, 5), 9, "ADC3_SQR3.SQ1: PF3"),
    field(ADC3 + 0x10, (27, 3), 7, "ADC3_SMPR2.SMP9: 480 cycles"),
];

/// Those of the image with edges and the reference encoder that others do not set.
const OF_EDGES: &[Field] = &[
    // Both edges of A xor B are captured, of a clock of 84 MHz that does not start again, after as many samples
    // as the counter takes, without an interrupt.
    field(GPIOA, (30, 2), 0b10, "GPIOA_MODER15: function"),
    field(GPIOA + 0x24, (28, 4), 1, "GPIOA_AFR15: TIM2"),
    field(GPIOB, (6, 2), 0b10, "GPIOB_MODER3: function"),
    field(GPIOB + 0x20, (12, 4), 1, "GPIOB_AFR3: TIM2"),
    field(TIM2, (0, 1), 1, "TIM2_CR1.CEN"),
    field(TIM2, (8, 2), 0, "TIM2_CR1.CKD: by 1"),
    field(TIM2 + 0x04, (7, 1), 1, "TIM2_CR2.TI1S: xor"),
    field(TIM2 + 0x0C, (0, 15), 0, "TIM2_DIER: no interrupt"),
    field(TIM2 + 0x18, (0, 4), 0b01, "TIM2_CCMR1.CC1S, IC1PSC: TI1"),
    field(TIM2 + 0x18, (4, 4), 3, "TIM2_CCMR1.IC1F: 8 samples"),
    field(
        TIM2 + 0x20,
        (0, 4),
        0b1011,
        "TIM2_CCER.CC1E, CC1P, CC1NP: both edges",
    ),
    field(TIM2 + 0x28, (0, 16), 0, "TIM2_PSC: 84 MHz"),
    field(TIM2 + 0x2C, (0, 32), u32::MAX, "TIM2_ARR"),
    // The timer of the reference encoder has 168 MHz: every other clock is as often as in the other two.
    field(GPIOE, (18, 2), 0b10, "GPIOE_MODER9: function"),
    field(GPIOE, (22, 2), 0b10, "GPIOE_MODER11: function"),
    field(GPIOE + 0x24, (4, 4), 1, "GPIOE_AFR9: TIM1"),
    field(GPIOE + 0x24, (12, 4), 1, "GPIOE_AFR11: TIM1"),
    field(TIM1, (0, 1), 1, "TIM1_CR1.CEN"),
    field(TIM1, (8, 2), 0, "TIM1_CR1.CKD: by 1"),
    field(TIM1 + 0x08, (0, 3), 3, "TIM1_SMCR.SMS"),
    field(TIM1 + 0x18, (0, 2), 1, "TIM1_CCMR1.CC1S: TI1"),
    field(TIM1 + 0x18, (8, 2), 1, "TIM1_CCMR1.CC2S: TI2"),
    field(TIM1 + 0x18, (4, 4), 5, "TIM1_CCMR1.IC1F: 8, by 2"),
    field(TIM1 + 0x18, (12, 4), 5, "TIM1_CCMR1.IC2F: 8, by 2"),
    field(TIM1 + 0x2C, (0, 16), 0xFFFF, "TIM1_ARR"),
];

/// The fields that differ from their table after the boot of an image.
fn differing(features: &'static str, table: &[Field]) -> Vec<String> {
    let at = (0..).map(|k| 0.02 + 2e-4 * f64::from(k));
    let loads = table.iter().map(|field| CoreAccess::Load(field.address));
    let run = run_image(
        features,
        &Setup {
            seconds: 0.06,
            commands: Vec::new(),
            accesses: at.zip(loads).collect(),
            ..Setup::default()
        },
    );
    assert_eq!(run.values.len(), table.len());
    let differing = table.iter().zip(&run.values).filter_map(|(field, word)| {
        let (lowest, number) = field.bits;
        let found = (word >> lowest) & (u32::MAX >> (32 - number));
        let Field { value, what, .. } = field;
        (found != *value).then(|| format!("{what} is {found:#x} instead of {value:#x}"))
    });
    differing.collect()
}

#[test]
fn registers_after_boot_are_those_of_the_manual() {
    assert_eq!(differing(IMAGE, AFTER_BOOT), [""; 0]);
}

#[test]
fn registers_of_edges_and_reference_encoder_are_those_of_the_manual() {
    assert_eq!(differing(WITH_EDGES, OF_EDGES), [""; 0]);
}
