//! Allowed effect and required outcome of each fault.

use haptic_control::Stop;
use virtual_board::fault::Fault;

/// When most faults happen: the device runs in free air.
pub(super) const FAULT_S: f64 = 0.5;
/// When some happen instead: the watchdog runs, and the task of lowest priority has fed it once at
/// most; nothing is enabled.
pub(super) const START_S: f64 = 0.5e-3;
/// When the device is armed, s.
pub(super) const ARM_S: f64 = 0.1;

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
    /// Amplifiers off so many ms later, within a range, and a core that never runs again.
    Halted([f64; 2]),
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
    /// The end at other instants of the same fault, with its forces.
    pub(super) or: Option<(End, [f64; 2])>,
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
        or: None,
        reset_ms: None,
        force_mn,
    }
}

/// No motion in spite of the push: the loop pushes ever harder until the balance or the monitor misses the
/// motion. The balance is checked every 20 ms, and the monitor waits for 50 ms.
const STALLS: (End, [f64; 2]) = (End::Off([0.0, 200.0], Stop::TorqueBalance), [300.0, 10.0]);

/// One phase alone counts to and fro. By the instant of the fault, this is motion against the push or no
/// motion.
const fn one_phase(fault: Fault) -> Bound {
    Bound {
        or: Some(STALLS),
        ..bound(
            fault,
            0.3,
            End::Off([0.0, 10.0], Stop::RunawayDirection),
            [60.0, 10.0],
        )
    }
}

/// Off at once: at the end of the next tick, and a step of the lockstep.
const NEXT_TICK: [f64; 2] = [0.0, 0.15];

/// Off by hardware, without the firmware: a step of the lockstep.
const AT_ONCE: [f64; 2] = [0.0, STEP_MS];

/// The enables lapse 16 periods after the last control task.
const LAPSED: [f64; 2] = [1.5 - STEP_MS, 1.6 + STEP_MS];

/// When a watchdog at this frequency resets a chip that is fed no more, ms.
const fn starved(oscillator_hz: f64) -> [f64; 2] {
    let period = WATCHDOG_MS * 32e3 / oscillator_hz;
    [period - FED_MS, period + STEP_MS]
}

const NOMINAL: [f64; 2] = starved(32e3);
const SLOW: [f64; 2] = starved(17e3);
const FAST: [f64; 2] = starved(47e3);

/// A fault that ends with the watchdog's reset, and with the amplifiers off at `off`.
const fn dies(fault: Fault, off: [f64; 2], when: [f64; 2]) -> Bound {
    Bound {
        reset_ms: Some(when),
        ..bound(fault, 0.2, End::Off(off, Stop::Watchdog), [1.0, 0.0])
    }
}

/// A control task that runs no more: the enables lapse, then the watchdog resets the chip.
const fn lapses(fault: Fault, when: [f64; 2]) -> Bound {
    Bound {
        force_mn: [NOTICED_MN, 0.0],
        ..dies(fault, LAPSED, when)
    }
}

/// A fault at the start, before the device is armed. Arming is refused.
const fn refused(fault: Fault, cause: Stop) -> Bound {
    Bound {
        at_s: START_S,
        ..bound(fault, 0.2, End::NeverOn(cause), [0.0, 0.0])
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

/// A halt that is over before the watchdog resets the chip: hardware has the amplifiers off during
/// the halt, and the ticks missed meanwhile stop the device at the end of the first one behind it.
const fn halted(ms: u16) -> Bound {
    let [_, late] = NEXT_TICK;
    let end = End::Off([0.0, ms as f64 + late], Stop::TickOverrun);
    bound(Fault::Halt(ms), 0.2, end, [NOTICED_MN, 0.0])
}

pub(super) const MATRIX: [Bound; 51] = [
    one_phase(Fault::StuckA),
    one_phase(Fault::StuckB),
    bound(Fault::StuckBoth, 0.5, STALLS.0, STALLS.1),
    // The loop drives the motor the wrong way until the monitor has seen enough of it, or, when its current
    // is small at first, until the window of the balance of torques ends.
    Bound {
        or: Some((End::Off([0.0, 22.0], Stop::TorqueBalance), [250.0, 10.0])),
        ..bound(
            Fault::Swapped,
            0.3,
            End::Off([0.0, 6.0], Stop::RunawayDirection),
            [90.0, 10.0],
        )
    },
    // The large motor rests: the coupler's drag of 0.96 mN.m.s/rad at the hand's 2.95 rad/s, 81 mN, and the
    // friction of 23 mN that is not compensated. Or it turns against the handle, with twice of both.
    bound(Fault::SmallStuck, 1.0, End::On, [110.0, 5.0]),
    bound(
        Fault::SmallSwapped,
        1.0,
        End::Off([0.0, 1000.0], Stop::TorqueBalance),
        [220.0, 5.0],
    ),
    // The lost edges add up until the velocity loop contradicts the counts, or not.
    Bound {
        or: Some((
            End::Off([0.0, 2000.0], Stop::RunawayDirection),
            [100.0, 10.0],
        )),
        ..bound(Fault::LostCounts, 2.0, End::On, [100.0, 10.0])
    },
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
    bound(
        Fault::BrokenReadyWire,
        0.2,
        End::Off(NEXT_TICK, Stop::AmplifierFault),
        [1.0, 0.0],
    ),
    bound(
        Fault::Unpowered,
        0.2,
        End::Off(AT_ONCE, Stop::Interlock),
        [1.0, 0.0],
    ),
    refused(Fault::Unpowered, Stop::Interlock),
    // The hand turns a motor without current, until the loop's current is one that should move it. The
    // hand feels friction, which is 4 mN.m, 114 mN, and inertia.
    bound(
        Fault::OpenLead,
        1.0,
        End::Off([0.0, 1000.0], Stop::TorqueBalance),
        [200.0, 10.0],
    ),
    // Nothing but a measured current shows it. The compensation of the friction of 0.8 mN.m, 23 mN, is
    // missing, and the transients.
    bound(Fault::SmallOpenLead, 1.0, End::On, [60.0, 5.0]),
    // Twice what an open lead misses.
    bound(Fault::SmallReversed, 1.0, End::On, [120.0, 5.0]),
    // This image does not read it.
    bound(Fault::BrokenMonitorWire, 0.2, End::On, [0.0, 0.0]),
    // Nor these.
    bound(Fault::SupplyDrop, 0.2, End::On, [0.0, 0.0]),
    bound(Fault::SupplyRise, 0.2, End::On, [0.0, 0.0]),
    // Settling takes 20 ms in either case. The later edge of the ready line shifts the emulator's blocks of
    // instructions, and an edge at the instant of a reading may be counted a tick later.
    bound(Fault::ReadyAfter(15), 0.3, End::On, [5.0, 0.0]),
    // Refused at the end of settling, which takes 20 ms and begins with the tick after the command.
    Bound {
        at_s: ARM_S,
        ..bound(
            Fault::ReadyAfter(30),
            0.2,
            End::Off([20.0, 20.3], Stop::AmplifierFault),
            [0.0, 0.0],
        )
    },
    bound(
        Fault::EmergencyStop,
        0.2,
        End::Off(AT_ONCE, Stop::Interlock),
        [1.0, 0.0],
    ),
    refused(Fault::EmergencyStop, Stop::Interlock),
    // Shorter than a tick, and over when the control task looks.
    bound(
        Fault::InterlockGlitch,
        0.2,
        End::Off(AT_ONCE, Stop::Interlock),
        [1.0, 0.0],
    ),
    lapses(Fault::HungCore, NOMINAL),
    Bound {
        with: Some(Fault::SlowWatchdog),
        ..lapses(Fault::HungCore, SLOW)
    },
    Bound {
        with: Some(Fault::FastWatchdog),
        ..lapses(Fault::HungCore, FAST)
    },
    dies_at_start(None, NOMINAL),
    dies_at_start(Some(Fault::SlowWatchdog), SLOW),
    dies_at_start(Some(Fault::FastWatchdog), FAST),
    halted(1),
    halted(5),
    halted(20),
    dies(Fault::Halt(100), AT_ONCE, NOMINAL),
    dies(Fault::Halt(500), AT_ONCE, NOMINAL),
    bound(Fault::FrozenHalt, 0.2, End::Halted(AT_ONCE), [1.0, 0.0]),
    bound(
        Fault::FrozenHaltTimerOn,
        0.2,
        End::Halted(LAPSED),
        [NOTICED_MN, 0.0],
    ),
    // Each task that begins late counts as a missed tick, of which four in a row stop the device;
    // five tasks of 120 us bring as many.
    bound(
        Fault::LongTasks,
        0.2,
        End::Off([0.36, 0.85], Stop::TickOverrun),
        [5.0, 0.0],
    ),
    lapses(Fault::HungControl, NOMINAL),
    dies(Fault::HungIdle, NOMINAL, NOMINAL),
    dies(Fault::StarvedIdle, NOMINAL, NOMINAL),
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
    // The clock security system breaks TIM8. The emulator raises no NMI: the control task finds the
    // cause, on a clock of 16 MHz.
    bound(
        Fault::CrystalFails,
        0.2,
        End::Off(AT_ONCE, Stop::ClockFailure),
        [1.0, 0.0],
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
