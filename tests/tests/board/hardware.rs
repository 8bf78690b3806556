//! The image and its chip: debugger, watchdog, tick, reset and exceptions.

use haptic_control::{Mode, Stop};
use std::num::NonZeroU64;

use virtual_board::command::Command;
use virtual_board::fault::Fault;
use virtual_board::run::{CoreAccess, Outcome, Setup};
use virtual_board::trace::Kind;

use crate::image::{free_air, run};
use crate::second_core::records;

/// `DEMCR`, its vector catches and the trace enable that is no catch.
const DEMCR: u32 = 0xE000_EDFC;
const CATCHES: u32 = 0x07F1;
/// `DBGMCU_APB1_FZ` and what OpenOCD sets in it when it connects: both watchdogs stop in a halt. TIM2 to
/// TIM5 do so by bits 0 to 3.
const FREEZE: u32 = 0xE004_2008;
const WATCHDOGS: u32 = 0x1800;
const TIMERS: u32 = 0xF;

/// State and cause in the last frame.
fn last(run: &Outcome) -> (Mode, Stop) {
    let frame = run.telemetry.frames.last().expect("frames");
    (frame.state, frame.cause)
}

#[test]
fn debug_settings_are_cleared_while_the_image_runs() {
    let accesses = vec![
        (0.200, CoreAccess::Store(DEMCR, CATCHES)),
        (0.200, CoreAccess::Store(FREEZE, WATCHDOGS | TIMERS)),
        (0.202, CoreAccess::Load(DEMCR)),
        (0.202, CoreAccess::Load(FREEZE)),
    ];
    let run = run(&Setup {
        seconds: 0.25,
        accesses,
        ..Setup::default()
    });
    let [.., catches, freezes] = run.values[..] else {
        panic!("{:?}", run.values)
    };
    assert_eq!(run.values[..2], [CATCHES, WATCHDOGS | TIMERS]);
    assert_eq!((catches & CATCHES, freezes & (WATCHDOGS | TIMERS)), (0, 0));
    assert_eq!(last(&run), (Mode::Running, Stop::None));
}

/// A system reset leaves them, and the start may last half a second.
#[test]
fn debug_settings_are_cleared_at_the_start() {
    let run = run(&Setup {
        seconds: 0.12,
        accesses: vec![
            (0.1, CoreAccess::Store(FREEZE, WATCHDOGS | TIMERS)),
            (0.1001, CoreAccess::Store(RESET.0, RESET.1)),
            (0.1004, CoreAccess::Load(FREEZE)),
        ],
        ..Setup::default()
    });
    assert_eq!(run.restarts.len(), 1);
    let freezes = run.values.last().expect("a value");
    assert_eq!(freezes & (WATCHDOGS | TIMERS), 0);
}

/// Whoever sets them ever again holds the outputs in the next halt.
#[test]
fn arming_is_refused_while_debug_settings_come_back() {
    // Bit 3 stops TIM5, which makes the control tick.
    for (address, bits) in [
        (DEMCR, CATCHES),
        (DEMCR, 1 << 10),
        (FREEZE, WATCHDOGS),
        (FREEZE, 1 << 3),
    ] {
        let at = (0..500).map(|tick| 0.08 + 1e-4 * f64::from(tick));
        let run = run(&Setup {
            seconds: 0.25,
            commands: vec![(0.1, Command::Arm), (0.2, Command::Arm)],
            accesses: at.map(|s| (s, CoreAccess::Store(address, bits))).collect(),
            ..Setup::default()
        });
        let of = |from: f64, to: f64| {
            let enables = run.enables.iter();
            enables
                .filter(|(ns, on)| (from..to).contains(&(*ns as f64 * 1e-9)) && on.contains(&true))
                .count()
        };
        let refused = run
            .telemetry
            .frames
            .iter()
            .find(|frame| frame.cause == Stop::Debugger);
        assert_eq!(
            refused.map(|frame| frame.state),
            Some(Mode::Safe),
            "{address:#x}"
        );
        assert_eq!((of(0.0, 0.2), of(0.2, 0.25)), (0, 1), "{address:#x}");
        assert_eq!(last(&run), (Mode::Armed, Stop::None), "{address:#x}");
    }
}

/// Interrupt control and state: what it sets pending.
const ICSR: u32 = 0xE000_ED04;
const NMI: u32 = 1 << 31;
const PEND_SV: u32 = 1 << 28;
/// Counter of TIM4.
const LARGE_COUNTER: &str = "0x40000824";

/// What the image says while it runs scene and amplifiers, and takes this exception at 0.2 s: with
/// the amplifiers off within 20 us it says `message`, and it starts again for `cause`.
fn ends_with(pending: u32, message: &str, cause: Stop) {
    let run = run(&Setup {
        seconds: 0.3,
        accesses: vec![(0.2, CoreAccess::Store(ICSR, pending))],
        ..Setup::default()
    });
    let off = run.off_after(0.2).expect("amplifiers are on");
    // It runs when the processor wakes.
    assert!(off < 120e-6, "{message}: {off} s");
    let log = &run.telemetry.log;
    assert!(log.iter().any(|said| said.contains(message)), "{log:?}");
    assert_eq!((run.restarts.len(), last(&run)), (1, (Mode::Safe, cause)));
    assert_eq!(run.enables.last().map(|(_, on)| *on), Some([false; 2]));
}

#[test]
fn an_nmi_disables_the_amplifiers_and_is_reported_after_the_reset() {
    ends_with(NMI, "clock failure", Stop::ClockFailure);
}

#[test]
fn an_exception_without_a_handler_disables_the_amplifiers_and_is_reported() {
    ends_with(PEND_SV, "exception -2", Stop::Exception);
}

/// An assertion that fails while the device runs: the outputs are off at once, the message is logged,
/// and the cause is there after the watchdog's reset.
#[test]
fn a_panic_disables_the_amplifiers_and_is_reported_after_the_reset() {
    let run = run(&Setup {
        seconds: 0.3,
        faults: vec![(0.2, Fault::Panic)],
        ..Setup::default()
    });
    let log = &run.telemetry.log;
    assert!(
        log.iter().any(|said| said.contains("panicked at")),
        "{log:?}"
    );
    assert_eq!(
        (run.restarts.len(), last(&run)),
        (1, (Mode::Safe, Stop::Panic))
    );
    // Up to a tick until the task of lowest priority is woken, and a step of the lockstep.
    let off_ms = 1e3 * run.off_after(0.2).expect("off");
    assert!(off_ms < 0.15, "{off_ms} ms");
    assert_eq!(run.enables.last().map(|(_, on)| *on), Some([false; 2]));
}

/// `DAC_DHR12RD`, and both channels at mid-scale in it.
const BOTH_CHANNELS: u32 = 0x4000_7420;
const NO_CURRENT: u32 = 0x0800_0800;

/// An enable line that is broken leaves the amplifier on: it gets no current either. The board starts with the
/// same.
#[test]
fn a_panic_commands_no_current() {
    let run = run(&Setup {
        seconds: 0.21,
        faults: vec![(0.2, Fault::Panic)],
        trace: true,
        ..Setup::default()
    });
    let writes = records(&run.trace)
        .into_iter()
        .filter_map(|(kind, _, address, value, _)| {
            (kind == Kind::Write as u8 && address == BOTH_CHANNELS).then_some(value)
        });
    assert_eq!(writes.collect::<Vec<_>>(), [NO_CURRENT; 2]);
}

/// A control task would command its currents again.
#[test]
fn no_control_task_begins_between_a_panic_and_the_reset() {
    const AT_S: f64 = 0.2;
    let run = run(&Setup {
        seconds: 0.25,
        faults: vec![(AT_S, Fault::Panic)],
        ..Setup::default()
    });
    let [restart] = &run.restarts[..] else {
        panic!("{:?}", run.restarts)
    };
    let off_s = AT_S + run.off_after(AT_S).expect("off");
    // A step of the lockstep.
    let between = off_s + 1e-5..restart.at_s;
    let begins = run.ticks.iter().map(|tick| tick.at_ns as f64 * 1e-9);
    let late: Vec<_> = begins.filter(|at_s| between.contains(at_s)).collect();
    assert_eq!(late, [0.0; 0]);
    // The watchdog waits 28 ms.
    assert!(restart.at_s - off_s > 0.02, "{} s", restart.at_s);
}

#[test]
fn cause_of_a_reset_is_told_once() {
    let run = run(&Setup {
        seconds: 0.5,
        faults: vec![(0.2, Fault::Panic)],
        accesses: vec![(0.4, CoreAccess::Store(RESET.0, RESET.1))],
        ..Setup::default()
    });
    let frames = &run.telemetry.frames;
    assert!(frames.iter().any(|frame| frame.cause == Stop::Panic));
    assert_eq!(
        (run.restarts.len(), last(&run)),
        (2, (Mode::Boot, Stop::None))
    );
}

/// A core so slow that the control task interrupts the log: a fault of the control task drops the
/// frame that is being written, not its own.
#[test]
fn fault_during_a_frame_is_logged() {
    let slow = |faults| {
        run(&Setup {
            seconds: 0.3,
            faults,
            instructions_per_second: NonZeroU64::new(25_000_000).expect("not zero"),
            ..Setup::default()
        })
    };
    let healthy = slow(Vec::new());
    let at_s = |k: u32| 0.2 + 1e-4 * f64::from(k);
    let mut in_a_frame = 0;
    for k in 0..10 {
        let fault = slow(vec![(at_s(k), Fault::BusError)]);
        let log = &fault.telemetry.log;
        let said = log.iter().find(|said| said.starts_with("hard fault at"));
        let said = said.unwrap_or_else(|| panic!("{k}: {log:?}"));
        for word in ["cfsr=0x8200 ", "hfsr=0x40000000 ", LARGE_COUNTER] {
            assert!(said.contains(word), "{k}: {said}");
        }
        assert_eq!(last(&fault), (Mode::Safe, Stop::HardFault));
        let tick = healthy
            .ticks
            .iter()
            .find(|tick| tick.at_ns as f64 * 1e-9 >= at_s(k));
        in_a_frame += u32::from(!tick.expect("a tick").asleep);
    }
    assert!(in_a_frame > 0, "the log is never interrupted");
}

/// A frame says how long the longest task took since the frame before, its own tick's included,
/// from the instant it was due.
#[test]
fn cycles_are_those_of_the_longest_task_since_the_last_frame() {
    let run = free_air();
    let mut compared = 0;
    for pair in run.telemetry.frames.windows(2) {
        let [before, frame] = pair else {
            unreachable!()
        };
        let (Some(from), Some(to)) = (run.tick_index(before), run.tick_index(frame)) else {
            continue;
        };
        let longest = run.ticks[from..to].iter().map(|tick| tick.instructions);
        let longest = longest.max().expect("ticks");
        // Entry and return are the core's, and the clock is read before the last instructions.
        let beside = frame.cycles.abs_diff(longest);
        assert!(
            beside <= 40,
            "{} cycles, {longest} instructions",
            frame.cycles
        );
        compared += 1;
    }
    assert!(compared > 9000, "{compared}");
}

#[test]
fn image_waits_half_a_second_for_the_crystal() {
    let run = run(&Setup {
        seconds: 1.0,
        crystal_from_s: 0.45,
        commands: vec![(0.7, Command::Arm), (0.75, Setup::default().commands[0].1)],
        ..Setup::default()
    });
    assert_eq!(
        (last(&run), run.restarts.len()),
        ((Mode::Running, Stop::None), 0)
    );
}

/// Without its crystal the board is safe and cannot be armed. Once the crystal has run for 0.1 s, the
/// board restarts, is safe still, and can be armed.
#[test]
fn crystal_that_starts_later_restarts_the_board() {
    let until = |seconds| {
        run(&Setup {
            seconds,
            crystal_from_s: 0.8,
            commands: vec![
                (0.6, Command::Arm),
                (0.85, Command::Arm),
                (1.3, Command::Arm),
                (1.35, Setup::default().commands[0].1),
            ],
            ..Setup::default()
        })
    };
    let refused = until(1.25);
    assert_eq!(last(&refused), (Mode::Safe, Stop::ClockFailure));
    assert_eq!(refused.enables.len(), 1, "never on: {:?}", refused.enables);
    let armed = until(1.5);
    assert_eq!(last(&armed), (Mode::Running, Stop::None));
    let [restart] = &armed.restarts[..] else {
        panic!("{:?}", armed.restarts)
    };
    // A frame a millisecond, and the looks are as many frames apart as there are.
    let late = restart.at_s - 0.8;
    assert!(
        (0.099..0.102).contains(&late),
        "{late} s, {}",
        restart.cause
    );
}

/// `RCC_CR` of a board that runs on its internal oscillator, with the crystal off and on.
const CLOCK_CONTROL: u32 = 0x4002_3800;
const CRYSTAL_OFF: u32 = 0x0104_0081;
const CRYSTAL_ON: u32 = 0x0105_0081;

/// The 0.1 s begin again with each interruption.
#[test]
fn crystal_that_is_interrupted_restarts_the_board_later() {
    let run = run(&Setup {
        seconds: 1.0,
        crystal_from_s: 0.8,
        accesses: vec![
            (0.85, CoreAccess::Store(CLOCK_CONTROL, CRYSTAL_OFF)),
            (0.86, CoreAccess::Store(CLOCK_CONTROL, CRYSTAL_ON)),
        ],
        ..Setup::default()
    });
    let [restart] = &run.restarts[..] else {
        panic!("{:?}", run.restarts)
    };
    let late = restart.at_s - 0.86;
    assert!((0.099..0.102).contains(&late), "{late} s");
}

/// Option keys, option control register, and the core's reset request.
const OPTION_KEYS: u32 = 0x4002_3C08;
const OPTIONS: u32 = 0x4002_3C14;
const RESET: (u32, u32) = (0xE000_ED0C, 0x05FA_0004);

/// From the factory the detector is off.
#[test]
fn boot_line_has_the_brown_out_level() {
    let stores = [
        (OPTION_KEYS, 0x0819_2A3B),
        (OPTION_KEYS, 0x4C5D_6E7F),
        (OPTIONS, 0x0FFF_AAE0),
        (OPTIONS, 0x0FFF_AAE2),
    ];
    let at = (0..).map(|k| 0.05 + 1e-3 * f64::from(k));
    let stores = at
        .zip(stores)
        .map(|(s, (at, bits))| (s, CoreAccess::Store(at, bits)));
    let reset = (0.1, CoreAccess::Store(RESET.0, RESET.1));
    let run = run(&Setup {
        seconds: 0.2,
        commands: Vec::new(),
        accesses: stores.chain([reset]).collect(),
        ..Setup::default()
    });
    let boots = run
        .telemetry
        .log
        .iter()
        .filter(|said| said.starts_with("boot "));
    let said: Vec<_> = boots
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            words.find_map(|word| word.strip_prefix("brown-out-reset="))
        })
        .collect();
    assert_eq!(said, ["false", "true"]);
}
