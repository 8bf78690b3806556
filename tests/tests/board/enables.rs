//! The enables of the amplifiers: what hardware does to them without the firmware, and what the
//! firmware cannot override.

use haptic_control::{Mode, Stop};
use virtual_board::command::Command;
use virtual_board::fault::Fault;
use virtual_board::run::{CoreAccess, Outcome, Setup};

use crate::image::run;

/// The break register of TIM8 and its bits.
const BDTR: u32 = 0x4001_0444;
const MOE: u32 = 1 << 15;
const AOE: u32 = 1 << 14;
const BKP: u32 = 1 << 13;
const BKE: u32 = 1 << 12;
const OSSI: u32 = 1 << 10;
const LOCK: u32 = 0b11 << 8;
const LOCK_LEVEL_2: u32 = 0b10 << 8;
/// Control register 2 of TIM8: idle levels of its outputs.
const CR2: u32 = 0x4001_0404;
/// Enables and polarities of the outputs of TIM8; those of channels 3 and 4.
const CCER: u32 = 0x4001_0420;
const OUTPUTS: u32 = 0x3300;
const BOTH_ACTIVE_HIGH: u32 = 0x1100;
/// Counter of TIM8.
const COUNTER: u32 = 0x4001_0424;
/// `DBGMCU_APB2_FZ` and `DBG_TIM8_STOP`.
const FREEZE: u32 = 0xE004_200C;
const STOPS_TIM8: u32 = 1 << 1;

/// A step of the lockstep, in which the enables are recorded, s.
const STEP_S: f64 = 10e-6;
/// Between two control ticks, which come at multiples of 0.1 ms after 0.04 ms, s.
const BETWEEN_S: f64 = 0.200_08;

/// Each change of the enables from a time on, s.
fn changes(run: &Outcome, from_s: f64) -> Vec<(f64, [bool; 2])> {
    let all = run.enables.iter().map(|(ns, on)| (*ns as f64 * 1e-9, *on));
    all.filter(|(s, _)| *s >= from_s).collect()
}

/// State and cause in the last frame before a time, s.
fn state(run: &Outcome, at_s: f64) -> (Mode, Stop) {
    let mut frames = run.telemetry.frames.iter().filter(|frame| {
        run.tick(frame)
            .is_some_and(|tick| tick.at_ns as f64 * 1e-9 <= at_s)
    });
    let frame = frames.next_back().expect("a frame");
    (frame.state, frame.cause)
}

/// Whether a control task ran in the time between, s.
fn ticks(run: &Outcome, from_s: f64, to_s: f64) -> usize {
    let times = run.ticks.iter().map(|tick| tick.at_ns as f64 * 1e-9);
    times.filter(|s| (from_s..to_s).contains(s)).count()
}

/// The enables change once after the fault, in the step in which the fault begins and before the
/// next control task.
fn off_without_the_firmware(run: &Outcome) {
    let after = changes(run, BETWEEN_S - STEP_S);
    let [(off_s, enables)] = after[..] else {
        panic!("{after:?}")
    };
    assert_eq!(enables, [false; 2]);
    assert!(off_s - BETWEEN_S < 2.0 * STEP_S, "{off_s} s");
    assert_eq!(ticks(run, BETWEEN_S, off_s + STEP_S), 0);
}

fn with(fault: Fault) -> Outcome {
    run(&Setup {
        seconds: 0.25,
        faults: vec![(BETWEEN_S, fault)],
        ..Setup::default()
    })
}

#[test]
fn hardware_disables_the_amplifiers_between_two_ticks() {
    for (fault, cause) in [
        (Fault::EmergencyStop, Stop::Interlock),
        (Fault::InterlockGlitch, Stop::Interlock),
        (Fault::Unpowered, Stop::Interlock),
        (Fault::CrystalFails, Stop::ClockFailure),
    ] {
        let run = with(fault);
        off_without_the_firmware(&run);
        assert_eq!(state(&run, 0.25), (Mode::Safe, cause), "{fault:?}");
        // The first control task after the fault finds the cause.
        let first = run
            .ticks
            .iter()
            .position(|tick| tick.at_ns as f64 * 1e-9 > BETWEEN_S);
        assert_eq!(
            run.ticks[first.expect("a tick")].codes,
            [Some(2048); 2],
            "{fault:?}"
        );
    }
}

#[test]
fn halted_core_has_its_amplifiers_disabled_while_the_watchdog_is_frozen() {
    let run = with(Fault::FrozenHalt);
    off_without_the_firmware(&run);
    assert_eq!((run.restarts.len(), ticks(&run, BETWEEN_S, 0.25)), (0, 0));
}

#[test]
fn fault_that_passes_does_not_end_one_that_lasts() {
    let both = |lasting, passing| {
        run(&Setup {
            seconds: 0.35,
            faults: vec![(BETWEEN_S, lasting), (BETWEEN_S + 0.01, passing)],
            commands: vec![(0.3, Command::Arm)],
            ..Setup::default()
        })
    };
    let open = both(Fault::EmergencyStop, Fault::InterlockGlitch);
    assert_eq!(state(&open, 0.35), (Mode::Safe, Stop::Interlock));
    assert_eq!(changes(&open, 0.25), []);
    let frozen = both(Fault::FrozenHalt, Fault::Halt(5));
    assert_eq!(ticks(&frozen, BETWEEN_S, 0.35), 0);
}

/// The enables lapse, and stay so.
#[test]
fn halted_core_has_its_amplifiers_disabled_while_timers_continue() {
    let run = with(Fault::FrozenHaltTimerOn);
    let after = changes(&run, 0.15);
    let [(off_s, enables)] = after[..] else {
        panic!("{after:?}")
    };
    assert_eq!(enables, [false; 2]);
    // 16 periods after the last control task.
    let last_s = run.ticks.last().expect("ticks").at_ns as f64 * 1e-9;
    assert!((off_s - last_s - 1.6e-3).abs() < 3e-5, "{}", off_s - last_s);
    assert_eq!(run.restarts.len(), 0);
}

/// A control task that continues after the enables have lapsed does not bring them back.
#[test]
fn lapsed_enables_stay_off_when_the_counter_is_restarted() {
    // The counter is set to a count before the match.
    let run = run(&Setup {
        seconds: 0.3,
        accesses: vec![(0.2, CoreAccess::Store(COUNTER, 1599))],
        ..Setup::default()
    });
    let after = changes(&run, 0.15);
    assert_eq!(after.len(), 1, "{after:?}");
    assert_eq!(after[0].1, [false; 2]);
    // The amplifiers are no longer ready.
    assert_eq!(state(&run, 0.3), (Mode::Safe, Stop::AmplifierFault));
}

/// The counter runs while the amplifiers are disabled, so that it may be at any count when they are enabled.
#[test]
fn enables_have_their_whole_time_when_they_begin() {
    // The store follows a control task. At the next one, which may be the one that arms, the counter is some 40 us
    // before the match.
    for k in -2..12 {
        let run = run(&Setup {
            seconds: 0.12,
            commands: vec![(0.1, Command::Arm)],
            accesses: vec![(0.1 + 1e-4 * f64::from(k), CoreAccess::Store(COUNTER, 1475))],
            ..Setup::default()
        });
        let after = changes(&run, 0.05);
        let [(_, enables)] = after[..] else {
            panic!("{k}: {after:?}")
        };
        assert_eq!(enables, [true; 2], "{k}");
    }
}

/// Neither a command nor a store to the timer enables the amplifiers while the loop is open.
#[test]
fn open_interlock_cannot_be_overridden() {
    let stores = (0..200).map(|k| (0.2 + 1e-4 * f64::from(k), CoreAccess::Store(BDTR, MOE)));
    let run = run(&Setup {
        seconds: 0.3,
        faults: vec![(0.15, Fault::EmergencyStop)],
        commands: vec![
            (0.1, Command::Arm),
            (0.18, Command::Arm),
            (0.25, Command::Disarm),
            (0.26, Command::Arm),
        ],
        accesses: stores.collect(),
        ..Setup::default()
    });
    assert_eq!(changes(&run, 0.12).len(), 1);
    assert_eq!(state(&run, 0.24), (Mode::Safe, Stop::Interlock));
    assert_eq!(state(&run, 0.258), (Mode::Boot, Stop::None));
    assert_eq!(state(&run, 0.3), (Mode::Safe, Stop::Interlock));
}

/// Closing the loop does not enable the amplifiers. Arming does.
#[test]
fn closed_interlock_needs_a_new_arm() {
    let run = run(&Setup {
        seconds: 0.3,
        faults: vec![(0.2, Fault::InterlockGlitch)],
        commands: vec![(0.1, Command::Arm), (0.25, Command::Arm)],
        ..Setup::default()
    });
    let after = changes(&run, 0.15);
    let [(_, off), (on_s, on)] = after[..] else {
        panic!("{after:?}")
    };
    assert_eq!((off, on), ([false; 2], [true; 2]));
    assert!((0.25..0.252).contains(&on_s), "{on_s}");
    assert_eq!(state(&run, 0.249), (Mode::Safe, Stop::Interlock));
    assert_eq!(state(&run, 0.3), (Mode::Armed, Stop::None));
}

/// The settings that make the outputs fail-safe, from the manual: they are made at boot, and a
/// program gone wild does not change them.
#[test]
fn settings_of_the_break_are_locked() {
    let loads = [BDTR, CR2, CCER].map(CoreAccess::Load);
    let wild = [
        CoreAccess::Store(BDTR, MOE | AOE | BKP),
        CoreAccess::Store(CR2, u32::MAX),
        CoreAccess::Store(CCER, u32::MAX),
    ];
    let all = loads.into_iter().chain(wild).chain(loads).enumerate();
    let run = run(&Setup {
        seconds: 0.1,
        commands: Vec::new(),
        accesses: all.map(|(k, one)| (0.02 + 1e-3 * k as f64, one)).collect(),
        ..Setup::default()
    });
    let [bdtr, cr2, ccer, _, _, _, bdtr_after, cr2_after, ccer_after] = run.values[..] else {
        panic!("{:?}", run.values)
    };
    assert_eq!(bdtr, BKE | OSSI | LOCK_LEVEL_2);
    // Disabled again by the next control task.
    assert_eq!(bdtr_after & !MOE, bdtr, "{bdtr_after:#x}");
    assert_eq!(bdtr_after & (MOE | AOE | BKP | LOCK), LOCK_LEVEL_2);
    // Idle levels of all channels.
    assert_eq!((cr2 & 0x7F00, cr2_after & 0x7F00), (0, 0));
    assert_eq!(ccer & OUTPUTS, BOTH_ACTIVE_HIGH);
    assert_eq!(ccer_after & OUTPUTS, BOTH_ACTIVE_HIGH);
}

#[test]
fn enables_are_stopped_by_a_halt_and_arming_needs_it() {
    let clears = (0..400).map(|k| (0.08 + 1e-4 * f64::from(k), CoreAccess::Store(FREEZE, 0)));
    let run = run(&Setup {
        seconds: 0.2,
        commands: vec![(0.1, Command::Arm), (0.15, Command::Arm)],
        accesses: [(0.05, CoreAccess::Load(FREEZE))]
            .into_iter()
            .chain(clears)
            .collect(),
        ..Setup::default()
    });
    assert_eq!(run.values[0] & STOPS_TIM8, STOPS_TIM8);
    assert_eq!(state(&run, 0.12), (Mode::Safe, Stop::Debugger));
    assert_eq!(state(&run, 0.2), (Mode::Armed, Stop::None));
    let after = changes(&run, 0.01);
    assert_eq!(after.len(), 1, "{after:?}");
    assert!(after[0].0 > 0.15);
}
