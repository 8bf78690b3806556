//! NUCLEO-F429ZI: the only file that names a pin.

use cortex_m::peripheral::DWT;
use estimator_core::{Amps, Sample};
use haptic_control::Currents;
use stm32f4xx_hal::dac::{C1, C2, DacOut, DacPin};
use stm32f4xx_hal::gpio::{Input, Output, Pin};
use stm32f4xx_hal::pac::{self, TIM3, TIM4, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::timer::{CounterHz, Event, Flag};

use crate::dac_code::DacCode;
use crate::encoder::Encoder;

/// Core clock, Hz.
pub(crate) const CORE_HZ: u32 = 168_000_000;
/// Control ticks a second, 1000 to 20 000.
pub(crate) const RATE_HZ: u32 = 10_000;
const _: () = assert!(RATE_HZ >= 1000 && RATE_HZ <= 20_000);

/// Current of the large amplifier at the DAC's ends.
const LARGE_FULL_SCALE: Amps = Amps::new(6.0);
/// Current of the small amplifier at the DAC's ends.
const SMALL_FULL_SCALE: Amps = Amps::new(1.5);

/// Both encoders.
pub(crate) struct Encoders {
    large: Encoder<TIM4>,
    small: Encoder<TIM3>,
}

impl Encoders {
    /// What they show now, with the current of the large motor over the period just ended.
    pub(crate) fn sample(&mut self, current: Amps) -> Sample {
        Sample::new(self.large.read())
            .with_small(self.small.read())
            .with_current(current)
    }
}

/// Both amplifiers.
pub(crate) struct Amplifiers {
    dac: (C1, C2),
    enable: (Pin<'E', 4, Output>, Pin<'E', 5, Output>),
    fault: (Pin<'E', 2, Input>, Pin<'E', 6, Input>),
}

impl Amplifiers {
    /// Commands both currents.
    pub(crate) fn set(&mut self, currents: Currents) {
        self.dac
            .0
            .set_value(DacCode::new(currents.large, LARGE_FULL_SCALE).get());
        self.dac
            .1
            .set_value(DacCode::new(currents.small, SMALL_FULL_SCALE).get());
    }

    /// Enables or disables both.
    pub(crate) fn enable(&mut self, on: bool) {
        self.enable.0.set_state(on.into());
        self.enable.1.set_state(on.into());
    }

    /// Whether one of them reports a fault.
    pub(crate) fn is_faulty(&self) -> bool {
        self.fault.0.is_low() || self.fault.1.is_low()
    }
}

/// The control tick's timer.
pub(crate) struct Tick(CounterHz<TIM5>);

impl Tick {
    /// Takes the interrupt.
    pub(crate) fn acknowledge(&mut self) {
        self.0.clear_flags(Flag::Update);
    }
}

/// Everything the application works with.
pub(crate) struct Board {
    pub(crate) encoders: Encoders,
    pub(crate) amplifiers: Amplifiers,
    pub(crate) tick: Tick,
}

impl Board {
    /// Takes the chip: outputs off first, then clocks, then the rest; the tick runs.
    pub(crate) fn new(core: &mut cortex_m::Peripherals, chip: pac::Peripherals) -> Self {
        let mut rcc = chip.RCC.constrain();
        let e = chip.GPIOE.split(&mut rcc);
        let enable = (e.pe4.into_push_pull_output(), e.pe5.into_push_pull_output());
        let fault = (e.pe2.into_pull_up_input(), e.pe6.into_pull_up_input());

        let mut rcc = rcc.freeze(
            Config::hse(8.MHz())
                .bypass_hse_oscillator()
                .sysclk(CORE_HZ.Hz()),
        );

        let a = chip.GPIOA.split(&mut rcc);
        let mut dac = chip
            .DAC
            .constrain((a.pa4.into_analog(), a.pa5.into_analog()), &mut rcc);
        dac.0.set_value(DacCode::ZERO.get());
        dac.1.set_value(DacCode::ZERO.get());
        dac.0.enable();
        dac.1.enable();

        let c = chip.GPIOC.split(&mut rcc);
        let d = chip.GPIOD.split(&mut rcc);
        let (large, _) = Qei::new(chip.TIM4, (d.pd12, d.pd13), &mut rcc).release();
        let (small, _) = Qei::new(chip.TIM3, (c.pc6, c.pc7), &mut rcc).release();

        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();

        let mut tick = chip.TIM5.counter_hz(&mut rcc);
        tick.listen(Event::Update);
        if tick.start(RATE_HZ.Hz()).is_err() {
            defmt::panic!("control rate out of the timer's range");
        }
        Self {
            encoders: Encoders {
                large: Encoder::new(large),
                small: Encoder::new(small),
            },
            amplifiers: Amplifiers { dac, enable, fault },
            tick: Tick(tick),
        }
    }
}

/// Core clock cycles, modulo 2^32.
pub(crate) fn cycles() -> u32 {
    DWT::cycle_count()
}
