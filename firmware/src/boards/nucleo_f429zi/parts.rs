//! Pins, peripherals and clocks, and how they start.

use drivers::{Amplifier, CurrentOutput, DacCode};
use estimator_core::{Amps, Count, Sample};
use firmware_app::config::{DEVICE, REFERENCE, TIMER_HZ};
use haptic_control::Currents;
use stm32f4xx_hal::dac::{C1, C2, DacOut, DacPin};
use stm32f4xx_hal::gpio::{Input, Output, Pin};
use stm32f4xx_hal::pac::{self, TIM1, TIM3, TIM4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::{Config, Rcc};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use super::edge::{Source, Stamps as _};
use super::encoder::Encoder;
use super::reset::{self, LateCrystal};
use super::tick::{Clock, Tick};
use crate::boards::{Board, Start, Watchdog};

/// Core clock, Hz.
pub(crate) const CORE_HZ: u32 = 168_000_000;
const _: () = assert!(CORE_HZ.is_multiple_of(TIMER_HZ));

/// Port of the amplifiers' enables.
pub(super) const ENABLE_PORT: char = 'E';
/// Pin of the large amplifier's enable.
pub(super) const LARGE_ENABLE: u8 = 4;
/// Pin of the small amplifier's enable.
pub(super) const SMALL_ENABLE: u8 = 5;

/// Current of the large amplifier at the DAC's ends.
const LARGE_FULL_SCALE: Amps = Amps::new(6.0);
/// Current of the small amplifier at the DAC's ends.
const SMALL_FULL_SCALE: Amps = Amps::new(1.5);
const _: () = assert!(
    DEVICE.large.current_limit <= LARGE_FULL_SCALE.get() as f64
        && DEVICE.small.current_limit <= SMALL_FULL_SCALE.get() as f64,
    "large.current_limit_a or small.current_limit_a of the device file is above what the board's \
     amplifiers give at full scale, 6 A and 1.5 A"
);
/// Period that the watchdog is set to, ms. The HAL rounds to steps of 4 ms and adds one: 28 ms at the
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
struct Encoders {
    large: Encoder<TIM4>,
    small: Encoder<TIM3>,
    stamps: Source,
    reference: Option<Encoder<TIM1>>,
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
struct Amplifiers {
    large: Amplifier<DacCurrent<C1>, Pin<ENABLE_PORT, LARGE_ENABLE, Output>, Pin<'E', 2, Input>>,
    small: Amplifier<DacCurrent<C2>, Pin<ENABLE_PORT, SMALL_ENABLE, Output>, Pin<'E', 6, Input>>,
}

/// The clock tree.
struct Tree {
    rcc: Rcc,
    crystal: bool,
}

/// The parts that the control task works with.
pub(super) struct Parts {
    encoders: Encoders,
    amplifiers: Amplifiers,
    tick: Tick,
    clock: Tree,
}

impl Board for Parts {
    fn begin_tick(&mut self) -> u32 {
        self.tick.enter()
    }

    fn sample(&mut self, current: Amps) -> Sample {
        let Encoders {
            large,
            small,
            stamps,
            ..
        } = &mut self.encoders;
        let (large, edge) = stamps.read(large);
        Sample {
            count: large,
            coupled: small.read(),
            current,
            edge,
        }
    }

    fn reference(&mut self) -> Option<Count> {
        self.encoders.reference.as_mut().map(Encoder::read)
    }

    fn amplifier_fault(&mut self) -> bool {
        self.amplifiers.large.is_faulty() || self.amplifiers.small.is_faulty()
    }

    /// The NMI comes first; this is for when it did not.
    fn clock_failure(&self) -> bool {
        !self.clock.crystal || !self.clock.rcc.cfgr().read().sws().is_pll()
    }

    fn apply(&mut self, currents: Option<Currents>) {
        let Amplifiers { large, small } = &mut self.amplifiers;
        if let Some(currents) = currents {
            large.drive(currents.large);
            small.drive(currents.small);
        } else {
            large.disable();
            small.disable();
        }
    }

    fn take_longest(&mut self) -> u32 {
        self.tick.take_longest()
    }

    fn end_tick(&mut self) {
        self.tick.leave();
    }
}

/// The watchdog, and with it the look at a crystal that is late.
pub(super) struct Guard {
    watchdog: IndependentWatchdog,
    crystal: LateCrystal,
}

impl Watchdog for Guard {
    fn feed(&mut self) {
        self.watchdog.feed();
        self.crystal.look();
    }
}

/// Starts the board: amplifiers off, then the watchdog, then the clocks, then the rest. The tick runs
/// when this returns.
pub(super) fn start(chip: pac::Peripherals) -> (Parts, Start<Guard>) {
    let mut rcc = chip.RCC.constrain();
    let e = chip.GPIOE.split(&mut rcc);
    // A port without its clock takes no write.
    firmware_rt::outputs_safe();
    let large_enable = e.pe4.into_push_pull_output();
    let small_enable = e.pe5.into_push_pull_output();

    // A halted core holds its last current, so a halt must not stop the watchdog.
    firmware_rt::undo_debugger();
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

    let reference =
        REFERENCE.then(|| Encoder::new(Qei::new(chip.TIM1, (e.pe9, e.pe11), &mut rcc).release().0));
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
    let parts = Parts {
        encoders,
        amplifiers,
        tick: Tick::new(timer),
        clock: Tree { rcc, crystal },
    };
    let start = Start {
        watchdog: Guard {
            watchdog,
            crystal: LateCrystal::new(crystal),
        },
        reset,
        brown_out_reset,
    };
    (parts, start)
}
