//! Pins, peripherals and clocks, and how they start.

use drivers::{Amplifier, Amplifiers, CurrentOutput, DacCode, DacScale, FULL_SCALES, Settings};
use estimator_core::{Amps, Count, Sample};
use firmware_app::ammeter::Measured;
use firmware_app::config::{DEVICE, REFERENCE, TIMER_HZ};
use firmware_app::control::Faults;
use firmware_app::index::Pulses;
use firmware_app::supply::Reading;
use haptic_control::Currents;
use stm32f4xx_hal::dac::{C1, C2, DacOut, DacPin};
use stm32f4xx_hal::gpio::{Input, PE2, PE6};
use stm32f4xx_hal::pac::rcc::cfgr::SWSR;
use stm32f4xx_hal::pac::{self, TIM1, TIM3, TIM4};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::{Config, Rcc};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use super::ammeters::{Monitors, Wires};
use super::converters;
use super::edge::{Source, Stamps as _};
use super::enables::Outputs;
use super::encoder::Encoder;
use super::indices::{Indices, Lines as _};
use super::memory::Flash;
use super::port::Usart;
use super::reset::{self, LateCrystal};
use super::supply::{Supply, Wire};
use super::tick::{Clock, Tick};
use crate::boards::{Board, Start, Watchdog};

/// Core clock, Hz.
pub(crate) const CORE_HZ: u32 = 168_000_000;
const _: () = assert!(CORE_HZ.is_multiple_of(TIMER_HZ));

const _: () = assert!(
    DEVICE.large.current_limit <= FULL_SCALES[0].get() as f64
        && DEVICE.small.current_limit <= FULL_SCALES[1].get() as f64,
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
/// Period of the watchdog while a sector of the flash is erased, ms: twice the longest time of the
/// datasheet, and the oscillator may be 1.5 times as fast.
const ERASES_MS: u32 = 2400;
/// How long the crystal is waited for, ms.
const CRYSTAL_MS: u32 = 500;

/// The encoders.
struct Encoders {
    large: Encoder<TIM4>,
    small: Encoder<TIM3>,
    stamps: Source,
    indices: Indices,
    reference: Option<Encoder<TIM1>>,
}

/// A channel of the DAC as a current command.
struct DacCurrent<C> {
    channel: C,
    scale: DacScale,
}

impl<C: DacOut<u16>> CurrentOutput for DacCurrent<C> {
    fn command(&mut self, current: Amps) {
        self.channel.set_value(self.scale.code(current).get());
    }
}

/// The large amplifier and its ready line.
type Large = Amplifier<DacCurrent<C1>, PE2<Input>>;
/// The small amplifier and its ready line.
type Small = Amplifier<DacCurrent<C2>, PE6<Input>>;

/// The clock tree.
struct Tree {
    rcc: Rcc,
    /// Field `SWS` of the crystal's PLL; [`NO_SOURCE`] without the crystal.
    source: u8,
}

/// A value that the field `SWS` never has.
const NO_SOURCE: u8 = u8::MAX;

/// The parts that the control task works with.
pub(super) struct Parts {
    encoders: Encoders,
    amplifiers: Amplifiers<Large, Small, Outputs>,
    monitors: Monitors,
    supply: Supply,
    tick: Tick,
    clock: Tree,
}

impl Board for Parts {
    fn begin_tick(&mut self) -> u32 {
        self.tick.enter()
    }

    fn currents(&mut self) -> Measured {
        Wires::read(&self.monitors)
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

    fn pulses(&mut self) -> Pulses {
        let Encoders {
            large,
            small,
            indices,
            ..
        } = &self.encoders;
        indices.look(large, small)
    }

    fn supply(&mut self) -> Reading {
        Wire::read(&self.supply)
    }

    fn reference(&mut self) -> Option<Count> {
        self.encoders.reference.as_mut().map(Encoder::read)
    }

    fn faults(&mut self) -> Faults {
        let not_ready = !self.amplifiers.are_ready();
        let interlock = self.amplifiers.enables().interlock_was_open();
        // The NMI comes first; this is for when it did not.
        let clock = self.clock.rcc.cfgr().read().sws().bits() != self.clock.source;
        Faults::NONE
            .with(Faults::NOT_READY, not_ready)
            .with(Faults::INTERLOCK, interlock)
            .with(Faults::CLOCK, clock)
    }

    fn calibrate(&mut self, settings: &Settings) {
        let (large, small) = self.amplifiers.outputs();
        [large.scale, small.scale] = settings.dac_scales();
    }

    fn apply(&mut self, currents: Option<Currents>) {
        match currents {
            Some(currents) => self.amplifiers.drive(currents),
            None => self.amplifiers.disable(),
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

/// Starts the watchdog, or changes its period. `timer` counts at this rate.
fn watch(watchdog: &mut IndependentWatchdog, period_ms: u32, timer: &Clock, timer_hz: u32) {
    watchdog.start(period_ms.millis());
    // A started watchdog counts from its longest period, 16 s, until it is fed with its settings.
    timer.poll(WATCHDOG_STARTS_US * (timer_hz / 1_000_000), || {
        watchdog.feed();
        false
    });
    watchdog.feed();
}

/// Starts the board: amplifiers off, then the watchdog, then the clocks, then the rest. The tick runs
/// when this returns.
pub(super) fn start(chip: pac::Peripherals) -> (Parts, Start<Guard, Usart, Flash>) {
    let mut rcc = chip.RCC.constrain();
    let enables = Outputs::new(chip.TIM8, &mut rcc);
    let a = chip.GPIOA.split(&mut rcc);
    let c = chip.GPIOC.split(&mut rcc);
    Outputs::connect(c.pc8, c.pc9, a.pa6);

    // A halt must disable the outputs, and must not stop the watchdog.
    firmware_rt::undo_debugger();
    let mut watchdog = IndependentWatchdog::new(chip.IWDG);
    let timer = Clock::start(chip.TIM5, &mut rcc);
    watch(&mut watchdog, WATCHDOG_MS, &timer, RESET_HZ);
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

    let (mut memory, settings) = Flash::open(chip.FLASH);
    memory.prepare(|erase| {
        watch(&mut watchdog, ERASES_MS, &timer, TIMER_HZ);
        erase();
        watch(&mut watchdog, WATCHDOG_MS, &timer, TIMER_HZ);
    });
    let b = chip.GPIOB.split(&mut rcc);
    let d = chip.GPIOD.split(&mut rcc);
    let e = chip.GPIOE.split(&mut rcc);
    let pins = (a.pa4.into_analog(), a.pa5.into_analog());
    let (mut large_dac, mut small_dac) = chip.DAC.constrain(pins, &mut rcc);
    large_dac.set_value(DacCode::MIDDLE.get());
    small_dac.set_value(DacCode::MIDDLE.get());
    large_dac.enable();
    small_dac.enable();
    let [large_scale, small_scale] = settings.unwrap_or_default().dac_scales();
    let large = DacCurrent {
        channel: large_dac,
        scale: large_scale,
    };
    let small = DacCurrent {
        channel: small_dac,
        scale: small_scale,
    };

    let reference =
        REFERENCE.then(|| Encoder::new(Qei::new(chip.TIM1, (e.pe9, e.pe11), &mut rcc).release().0));
    let stamps = Source::new(chip.TIM2, (a.pa15, b.pb3), &mut rcc);
    let large_encoder = Encoder::new(Qei::new(chip.TIM4, (d.pd12, d.pd13), &mut rcc).release().0);
    let small_encoder = Encoder::new(Qei::new(chip.TIM3, (c.pc6, c.pc7), &mut rcc).release().0);
    let encoders = Encoders {
        stamps,
        indices: Indices::connect(&large_encoder, &small_encoder, (d.pd14, b.pb1)),
        large: large_encoder,
        small: small_encoder,
        reference,
    };
    // A broken wire and an amplifier without supply are not ready.
    let amplifiers = Amplifiers::new(
        Amplifier::new(large, e.pe2.into_pull_down_input()),
        Amplifier::new(small, e.pe6.into_pull_down_input()),
        enables,
    );

    if <Monitors as Wires>::WANTED || <Supply as Wire>::WANTED {
        converters::prepare(&chip.ADC_COMMON, &mut rcc);
    }
    let monitors =
        <Monitors as Wires>::start((chip.ADC1, chip.ADC2), (a.pa3, c.pc0), &timer, &mut rcc);
    let supply = <Supply as Wire>::start(chip.ADC3, chip.GPIOF, &timer, &mut rcc);

    let port = Usart::start(chip.USART3, chip.DMA1, (d.pd8, d.pd9), &mut rcc);
    let port = defmt::unwrap!(port, "the clocks do not give the baud rate of the port");

    defmt::assert!(
        rcc.clocks.timclk1().raw() == TIMER_HZ,
        "timers are not clocked with half of the core's clock"
    );
    defmt::assert!(
        rcc.clocks.timclk2().raw() == CORE_HZ,
        "the timer of the enables is not clocked like the core"
    );
    let source = if crystal { SWSR::Pll as u8 } else { NO_SOURCE };
    let parts = Parts {
        encoders,
        amplifiers,
        monitors,
        supply,
        tick: Tick::new(timer),
        clock: Tree { rcc, source },
    };
    let start = Start {
        watchdog: Guard {
            watchdog,
            crystal: LateCrystal::new(crystal),
        },
        port,
        memory,
        reset,
        brown_out_reset,
        settings,
    };
    (parts, start)
}
