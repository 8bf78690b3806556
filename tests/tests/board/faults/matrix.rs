//! Allowed effect and required outcome of each fault.

use haptic_control::Stop;
use virtual_board::fault::Fault;

/// When most faults happen: the device runs in free air.
pub(super) const FAULT_S: f64 = 0.5;
/// When some happen instead: the watchdog runs, and the task of lowest priority has fed it once at
/// most; nothing is enabled.
pub(super) const START_S: f64 = 0.5e-3;

/// Watchdog period at the nominal oscillator of 32 kHz, ms: prescaler 128, reload 6.
const WATCHDOG_MS: f64 = 28.0;
/// The watchdog is fed when the lowest priority has logged a frame, one in a millisecond, so it
/// resets the chip this much before the end of its period at most; and the lockstep sees that a
/// step or two late.
const FED_MS: f64 = 1.1;
const STEP_MS: f64 = 0.05;

/// Threshold of a fingertip, mN. If the currents stay constant while the hand continues to move, the
/// difference must stay below it.
const NOTICED_MN: f64 = 10.0;

/// How a fault has to end.
#[derive(Clone, Copy)]
pub(super) enum End {
    /// Amplifiers off so many ms later, within a range, for this cause.
    Off([f64; 2], Stop),
    /// Amplifiers never on, for this cause.
    NeverOn(Stop),
    /// Amplifiers on, no cause: nothing dangerous, or nothing that is noticed yet.
    On,
}

/// Allowed effect of a fault.
pub(super) struct Bound {
    pub(super) fault: Fault,
    /// When it happens, s.
    pub(super) at_s: f64,
    /// Another one that is there all the time.
    pub(super) with: Option<Fault>,
    /// How long to watch after the fault, s.
    pub(super) watched_s: f64,
    pub(super) end: End,
    /// The one reset, within a range of ms after the fault.
    pub(super) reset_ms: Option<[f64; 2]>,
    /// Largest and smallest difference from the healthy run's torque until the end, mN at the
    /// fingertip. The smaller one says that the fault did happen.
    pub(super) force_mn: [f64; 2],
}

/// A fault in free air, without a reset.
const fn bound(fault: Fault, watched_s: f64, end: End, force_mn: [f64; 2]) -> Bound {
    Bound {
        fault,
        at_s: FAULT_S,
        with: None,
        watched_s,
        end,
        reset_ms: None,
        force_mn,
    }
}

/// Off at once: at the end of the next tick, and a step of the lockstep.
const NEXT_TICK: [f64; 2] = [0.0, 0.15];

/// When a watchdog at this frequency resets a chip that is fed no more, ms.
const fn starved(oscillator_hz: f64) -> [f64; 2] {
    let period = WATCHDOG_MS * 32e3 / oscillator_hz;
    [period - FED_MS, period + STEP_MS]
}

const NOMINAL: [f64; 2] = starved(32e3);
const SLOW: [f64; 2] = starved(17e3);
const FAST: [f64; 2] = starved(47e3);

/// A fault that ends with the watchdog's reset, and with the amplifiers off no earlier.
const fn dies(fault: Fault, when: [f64; 2], force_mn: [f64; 2]) -> Bound {
    Bound {
        reset_ms: Some(when),
        ..bound(fault, 0.2, End::Off(when, Stop::Watchdog), force_mn)
    }
}

/// A core that hangs while the image starts. The watchdog has run for no longer than that, and its
/// first period has to be as short as every other.
const fn dies_at_start(with: Option<Fault>, [least, most]: [f64; 2]) -> Bound {
    let reset_ms = [least + FED_MS - 1e3 * START_S, most];
    Bound {
        at_s: START_S,
        with,
        // No longer, because the run is armed again at 100 ms.
        watched_s: 0.09,
        end: End::NeverOn(Stop::Watchdog),
        reset_ms: Some(reset_ms),
        ..bound(Fault::HungCore, 0.0, End::On, [0.0, 0.0])
    }
}

/// A halt that is over before the watchdog resets the chip: the ticks missed meanwhile stop the
/// device at the end of the first one behind it. A halted core cannot do better.
const fn halted(ms: u16, force_mn: [f64; 2]) -> Bound {
    let [_, late] = NEXT_TICK;
    let end = End::Off([ms as f64, ms as f64 + late], Stop::TickOverrun);
    bound(Fault::Halt(ms), 0.2, end, force_mn)
}

pub(super) const MATRIX: [Bound; 33] = [
    // One phase alone counts to and fro, which looks like motion against the push.
    bound(
        Fault::StuckA,
        0.3,
        End::Off([0.0, 10.0], Stop::RunawayDirection),
        [60.0, 10.0],
    ),
    bound(
        Fault::StuckB,
        0.3,
        End::Off([0.0, 10.0], Stop::RunawayDirection),
        [60.0, 10.0],
    ),
    // The loop pushes ever harder until the monitor misses the motion.
    bound(
        Fault::StuckBoth,
        0.5,
        End::Off([0.0, 200.0], Stop::Stall),
        [300.0, 10.0],
    ),
    // The loop drives the motor the wrong way until the monitor has seen enough of it.
    bound(
        Fault::Swapped,
        0.3,
        End::Off([0.0, 6.0], Stop::RunawayDirection),
        [90.0, 10.0],
    ),
    bound(Fault::LostCounts, 2.0, End::On, [100.0, 10.0]),
    bound(
        Fault::AmplifierFault,
        0.2,
        End::Off(NEXT_TICK, Stop::AmplifierFault),
        [1.0, 0.0],
    ),
    bound(
        Fault::SmallAmplifierFault,
        0.2,
        End::Off(NEXT_TICK, Stop::AmplifierFault),
        [1.0, 0.0],
    ),
    dies(Fault::HungCore, NOMINAL, [NOTICED_MN, 1.0]),
    Bound {
        with: Some(Fault::SlowWatchdog),
        ..dies(Fault::HungCore, SLOW, [NOTICED_MN, 1.0])
    },
    Bound {
        with: Some(Fault::FastWatchdog),
        ..dies(Fault::HungCore, FAST, [NOTICED_MN, 0.0])
    },
    dies_at_start(None, NOMINAL),
    dies_at_start(Some(Fault::SlowWatchdog), SLOW),
    dies_at_start(Some(Fault::FastWatchdog), FAST),
    halted(1, [NOTICED_MN, 0.0]),
    halted(5, [NOTICED_MN, 0.0]),
    halted(20, [NOTICED_MN, 0.0]),
    dies(Fault::Halt(100), NOMINAL, [NOTICED_MN, 1.0]),
    dies(Fault::Halt(500), NOMINAL, [NOTICED_MN, 1.0]),
    // Each task that begins late counts as a missed tick, of which four in a row stop the device;
    // five tasks of 120 us bring as many.
    bound(
        Fault::LongTasks,
        0.2,
        End::Off([0.36, 0.85], Stop::TickOverrun),
        [5.0, 0.0],
    ),
    dies(Fault::HungControl, NOMINAL, [NOTICED_MN, 1.0]),
    dies(Fault::HungIdle, NOMINAL, [1.0, 0.0]),
    dies(Fault::StarvedIdle, NOMINAL, [1.0, 0.0]),
    // Nothing is missed but frames.
    Bound {
        with: Some(Fault::SlowWatchdog),
        ..bound(Fault::StarvedIdle, 0.3, End::On, [5.0, 0.0])
    },
    // Fed often enough.
    bound(Fault::SlowWatchdog, 0.3, End::On, [0.0, 0.0]),
    bound(Fault::FastWatchdog, 0.3, End::On, [0.0, 0.0]),
    Bound {
        reset_ms: Some(NOMINAL),
        ..bound(
            Fault::BusError,
            0.2,
            End::Off(NEXT_TICK, Stop::HardFault),
            [1.0, 0.0],
        )
    },
    // Up to a tick until the task of lowest priority is woken.
    Bound {
        reset_ms: Some(NOMINAL),
        ..bound(
            Fault::Panic,
            0.2,
            End::Off(NEXT_TICK, Stop::Panic),
            [1.0, 0.0],
        )
    },
    // Never on: there is nothing to compare with.
    bound(
        Fault::DeadCrystal,
        0.3,
        End::NeverOn(Stop::ClockFailure),
        [0.0, 0.0],
    ),
    // The emulator raises no NMI: the control task finds the lost crystal, on a clock of 16 MHz,
    // which makes every tick ten times as long and late.
    bound(
        Fault::CrystalFails,
        0.2,
        End::Off([0.0, 1.5], Stop::ClockFailure),
        [5.0, 0.0],
    ),
    // Control is not touched; but an interrupt that comes an instruction later may take a current
    // over to the next step of the plant, and a count with it. Half of what a fingertip notices.
    bound(Fault::NobodyDrains, 1.0, End::On, [5.0, 0.0]),
    bound(Fault::DrainPause, 1.0, End::On, [5.0, 0.0]),
    bound(Fault::CommandFlood, 1.0, End::On, [5.0, 0.0]),
    Bound {
        reset_ms: Some([0.0, STEP_MS]),
        ..bound(
            Fault::BrownOut,
            0.2,
            End::Off([0.0, STEP_MS], Stop::BrownOut),
            [1.0, 0.0],
        )
    },
];
