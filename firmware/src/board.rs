//! NUCLEO-F429ZI: the only file that names a pin, but for the emergency's two enables.

use drivers::{Amplifier, CurrentOutput, DacCode};
use estimator_core::{Amps, Count, Sample};
use firmware_app::config::{REFERENCE, TIMER_HZ};
use haptic_control::{Currents, Stop};
use stm32f4xx_hal::dac::{C1, C2, DacOut, DacPin};
use stm32f4xx_hal::gpio::{Input, Output, Pin};
use stm32f4xx_hal::pac::{self, TIM1, TIM3, TIM4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::{Config, Rcc};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use crate::edge::{Source, Stamps as _};
use crate::encoder::Encoder;
use crate::reset;
use crate::tick::{Clock, Tick};

/// Core clock, Hz.
pub(crate) const CORE_HZ: u32 = 168_000_000;
const _: () = assert!(CORE_HZ.is_multiple_of(TIMER_HZ));

/// Current of the large amplifier at the DAC's ends.
const LARGE_FULL_SCALE: Amps = Amps::new(6.0);
/// Current of the small amplifier at the DAC's ends.
const SMALL_FULL_SCALE: Amps = Amps::new(1.5);
/// What the watchdog is asked for, ms. The HAL rounds to steps of 4 ms and adds one: 28 ms at the
/// 32 kHz of its oscillator, 19 ms at the 47 kHz and 53 ms at the 17 kHz of the datasheet's limits.
const WATCHDOG_MS: u32 = 25;
/// Clock of the core and of its timers from a reset until the clocks are set up, Hz.
const RESET_HZ: u32 = 16_000_000;
/// The watchdog's settings reach it within 5 cycles of its oscillator, 0.3 ms at most, which starts
/// in 0.04 ms at most, us.
const WATCHDOG_STARTS_US: u32 = 400;
/// How long the crystal is waited for, ms.
const CRYSTAL_MS: u32 = 500;

/// The encoders.
pub(crate) struct Encoders {
    large: Encoder<TIM4>,
    small: Encoder<TIM3>,
    stamps: Source,
    reference: Option<Encoder<TIM1>>,
}

impl Encoders {
    /// What they show now, with the current of the large motor over the period just ended.
    pub(crate) fn sample(&mut self, current: Amps) -> Sample {
        let (large, edge) = self.stamps.read(&mut self.large);
        Sample {
            large,
            small: self.small.read(),
            current,
            edge,
        }
    }

    /// The reference encoder on the large motor, where there is one.
    pub(crate) fn reference(&mut self) -> Option<Count> {
        self.reference.as_mut().map(Encoder::read)
    }
}

/// A channel of the DAC as a current command.
struct DacCurrent<C> {
    channel: C,
    full_scale: Amps,
}

impl<C: DacOut<u16>> CurrentOutput for DacCurrent<C> {
    fn command(&mut self, current: Amps) {
        self.channel
            .set_value(DacCode::new(current, self.full_scale).get());
    }
}

/// Both amplifiers.
pub(crate) struct Amplifiers {
    large: Amplifier<DacCurrent<C1>, Pin<'E', 4, Output>, Pin<'E', 2, Input>>,
    small: Amplifier<DacCurrent<C2>, Pin<'E', 5, Output>, Pin<'E', 6, Input>>,
}

impl Amplifiers {
    /// Commands both currents, or disables both.
    pub(crate) fn apply(&mut self, currents: Option<Currents>) {
        if let Some(currents) = currents {
            self.large.drive(currents.large);
            self.small.drive(currents.small);
        } else {
            self.large.disable();
            self.small.disable();
        }
    }

    /// Whether one of them reports a fault.
    pub(crate) fn is_faulty(&mut self) -> bool {
        self.large.is_faulty() || self.small.is_faulty()
    }
}

/// The clock tree.
pub(crate) struct Tree {
    rcc: Rcc,
    crystal: bool,
}

impl Tree {
    /// Whether the crystal never ran, or stopped: then the core is on the internal oscillator.
    /// The NMI comes first; this is for when it did not.
    pub(crate) fn has_failed(&self) -> bool {
        !self.crystal || !self.rcc.cfgr().read().sws().is_pll()
    }
}

/// Everything that the application works with.
pub(crate) struct Board {
    pub(crate) encoders: Encoders,
    pub(crate) amplifiers: Amplifiers,
    pub(crate) tick: Tick,
    pub(crate) watchdog: IndependentWatchdog,
    /// Why the chip was reset.
    pub(crate) reset: Stop,
    /// Whether a supply below 2.7 V resets the chip and says so.
    pub(crate) brown_out_reset: bool,
    pub(crate) clock: Tree,
}

impl Board {
    /// Takes the chip: amplifiers off, then the watchdog, then clocks, then the rest. The tick
    /// runs when this returns.
    pub(crate) fn new(chip: pac::Peripherals) -> Self {
        let mut rcc = chip.RCC.constrain();
        let e = chip.GPIOE.split(&mut rcc);
        // A port without its clock takes no write.
        bare::outputs_safe();
        let large_enable = e.pe4.into_push_pull_output();
        let small_enable = e.pe5.into_push_pull_output();

        // A halted core holds its last current, so a halt must not stop the watchdog.
        bare::undo_debugger();
        let mut watchdog = IndependentWatchdog::new(chip.IWDG);
        watchdog.start(WATCHDOG_MS.millis());
        // A started watchdog counts from its longest period, 16 s, until it is fed with its settings.
        let timer = Clock::start(chip.TIM5, &mut rcc);
        timer.poll(WATCHDOG_STARTS_US * (RESET_HZ / 1_000_000), || {
            watchdog.feed();
            false
        });
        watchdog.feed();
        // A probe reads RTT while the core sleeps.
        chip.DBGMCU.cr().modify(|_, w| w.dbg_sleep().set_bit());

        let reset = reset::cause(&rcc);
        let brown_out_reset = reset::by_brown_out(&chip.FLASH);
        let crystal = reset::crystal_runs(&rcc, |runs| {
            timer.poll(CRYSTAL_MS * (RESET_HZ / 1000), || {
                watchdog.feed();
                runs()
            })
        });
        let clock = if crystal {
            Config::hse(8.MHz()).bypass_hse_oscillator()
        } else {
            Config::hsi()
        };
        let mut rcc = rcc.freeze(clock.sysclk(CORE_HZ.Hz()));
        if crystal {
            rcc.cr().modify(|_, w| w.csson().set_bit());
        }

        let a = chip.GPIOA.split(&mut rcc);
        let b = chip.GPIOB.split(&mut rcc);
        let c = chip.GPIOC.split(&mut rcc);
        let d = chip.GPIOD.split(&mut rcc);
        let pins = (a.pa4.into_analog(), a.pa5.into_analog());
        let (mut large_dac, mut small_dac) = chip.DAC.constrain(pins, &mut rcc);
        large_dac.set_value(DacCode::ZERO.get());
        small_dac.set_value(DacCode::ZERO.get());
        large_dac.enable();
        small_dac.enable();
        let large = DacCurrent {
            channel: large_dac,
            full_scale: LARGE_FULL_SCALE,
        };
        let small = DacCurrent {
            channel: small_dac,
            full_scale: SMALL_FULL_SCALE,
        };

        let reference = REFERENCE
            .then(|| Encoder::new(Qei::new(chip.TIM1, (e.pe9, e.pe11), &mut rcc).release().0));
        let encoders = Encoders {
            stamps: Source::new(chip.TIM2, (a.pa15, b.pb3), &mut rcc),
            large: Encoder::new(Qei::new(chip.TIM4, (d.pd12, d.pd13), &mut rcc).release().0),
            small: Encoder::new(Qei::new(chip.TIM3, (c.pc6, c.pc7), &mut rcc).release().0),
            reference,
        };
        let amplifiers = Amplifiers {
            large: Amplifier::new(large, large_enable, e.pe2.into_pull_up_input()),
            small: Amplifier::new(small, small_enable, e.pe6.into_pull_up_input()),
        };

        defmt::assert!(
            rcc.clocks.timclk1().raw() == TIMER_HZ,
            "timers are not clocked with half of the core's clock"
        );
        Self {
            encoders,
            amplifiers,
            tick: Tick::new(timer),
            watchdog,
            reset,
            brown_out_reset,
            clock: Tree { rcc, crystal },
        }
    }
}
