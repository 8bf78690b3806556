//! Telemetry off the board's RTT as a recording, and what commands set.

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::closed_loop::Hand;
use experiments::compare::interval;
use experiments::replay::replay;
use haptic_control::{Mode, SceneKind, Stop};
use recordings::record::{choose, csv};
use recordings::recording::{BoardColumns, Recording};
use recordings::telemetry::Frame;
use simulation::device::Device;
use virtual_board::command::Command;
use virtual_board::fault::Fault;
use virtual_board::run::{Outcome, Setup};

use crate::image::{free_air, image, of_scene, run, run_image};
use crate::link::{of_port, telemetry};

/// The recording made of raw bytes, as `host-sim record --image` makes it.
fn recorded(bytes: &[u8], rate_hz: Option<f64>) -> String {
    let telemetry = rtt::decode(image("").elf(), bytes).unwrap();
    let runs = telemetry.runs();
    let run = choose(&runs, None).unwrap();
    csv(run, run.rate_hz().or(rate_hz).unwrap(), |_| None)
}

fn parse(text: &str) -> Recording {
    Recording::parse(text.as_bytes(), "r").unwrap()
}

#[test]
fn recording_from_rtt_bytes_equals_that_of_the_run() {
    let run = free_air();
    let direct = parse(&run.csv().unwrap());
    let text = recorded(&run.rtt, None);
    let recording = parse(&text);
    assert_eq!(recording.t, direct.t);
    assert_eq!(recording.trace.counts_large, direct.trace.counts_large);
    assert_eq!(recording.trace.counts_small, direct.trace.counts_small);
    assert_eq!(recording.trace.current, direct.trace.current);
    // What the plant's encoders read at those ticks, not only what both decode from one stream.
    for (row, frame) in run.telemetry.frames.iter().enumerate() {
        let tick = run.tick(frame).unwrap();
        let counts = tick.counts[0].unwrap();
        assert_eq!(recording.trace.counts_large[row] as u16, counts);
    }
    let kinds: Vec<_> = Kind::all().iter().collect();
    let (device, parameters) = (Device::default(), Parameters::default());
    let estimates = [&recording, &direct].map(|recording| {
        replay(recording, "r", &kinds, &device, &parameters, &|| ())
            .unwrap()
            .estimates
    });
    assert!(estimates[0].len() >= 7);
    for (a, b) in estimates[0].iter().zip(&estimates[1]) {
        assert_eq!((a.estimator, &a.velocity), (b.estimator, &b.velocity));
    }
    let board = BoardColumns::parse(text.as_bytes(), "r").unwrap();
    let own = board.column("velocity_large").unwrap();
    let truth = direct.trace.true_omega.unwrap();
    let inside = own.iter().zip(&truth);
    let inside =
        inside.filter(|(w, truth)| (*w - *truth).abs() < interval(&device).tolerance(**truth));
    assert!(inside.count() * 10 > 8 * truth.len());
}

/// What `host-sim record --image` writes of an image that stamps edges, and what `replay` makes of
/// it: the observer with stamps is by far the better of the two.
#[test]
fn edge_stamps_of_the_board_are_recorded_and_replayed() {
    const IMAGE: &str = "edge-capture";
    let run = run_image(IMAGE, &of_scene(SceneKind::FreeAir, Hand::Moving, 3.0));
    let telemetry = rtt::decode(image(IMAGE).elf(), &run.rtt).unwrap();
    let runs = telemetry.runs();
    let chosen = choose(&runs, None).unwrap();
    let truth = |frame: &Frame| run.tick(frame).map(|tick| tick.large.omega);
    let recording = parse(&csv(chosen, chosen.rate_hz().unwrap(), truth));
    let edges = recording.trace.edges.as_ref().unwrap();
    assert!(edges.iter().flatten().count() * 10 > 9 * edges.len());
    let kinds = ["observer", "observer-edge"].map(|name| Kind::named(name).unwrap());
    let (device, parameters) = (Device::default(), Parameters::default());
    let replayed = replay(&recording, "r", &kinds, &device, &parameters, &|| ()).unwrap();
    assert_eq!(replayed.left_out, []);
    let [counts, stamps] = [0, 1].map(|i| replayed.rows[i].score.rms_rad_s.unwrap());
    println!("observer {counts} rad/s, observer-edge {stamps} rad/s");
    assert!(
        stamps < 0.6 * counts && stamps > 0.01 * counts,
        "{stamps} of {counts}"
    );
}

#[test]
fn incomplete_stream_loses_only_the_missing_frames() {
    let run = free_air();
    let whole = parse(&run.csv().unwrap());
    let (from, hole, end) = (run.rtt.len() / 3, run.rtt.len() / 2, run.rtt.len());
    let bytes = [&run.rtt[from..hole], &run.rtt[hole + 1001..end - 5]].concat();
    let telemetry = rtt::decode(image("").elf(), &bytes).unwrap();
    let runs = telemetry.runs();
    let run = choose(&runs, None).unwrap();
    assert_eq!((run.rate_hz(), run.gaps.places), (None, 1));
    assert!((20..40).contains(&run.gaps.frames), "{:?}", run.gaps);
    let part = parse(&csv(run, 1e4, |_| None));
    let first = whole.t.len() - run.frames.len() - run.gaps.frames as usize - 1;
    for (t, counts) in part.t.iter().zip(&part.trace.counts_large) {
        let row = first + (t * 1e3).round() as usize;
        assert_eq!(*counts, whole.trace.counts_large[row], "{t} s");
    }
}

/// Torque by telemetry at a time, N.m.
fn torque_at(run: &Outcome, t: f64) -> f32 {
    let tick = (t * 1e4) as u32;
    let frame = run.telemetry.frames.iter().find(|frame| frame.tick >= tick);
    frame.expect("a frame at that time").torque
}

fn refusals(run: &Outcome) -> Option<&str> {
    let log = run.telemetry.log.iter().rev();
    log.map(String::as_str)
        .find(|line| line.starts_with("refused"))
}

#[test]
fn torque_set_point_is_rendered_bounded_and_ends_after_the_command_timeout() {
    let torque = |at, torque| (at, Command::Torque(torque));
    let run = run(&Setup {
        seconds: 2.2,
        keep_alive: false,
        commands: vec![
            // Set before the scene is on, it does not count.
            torque(0.04, 0.02),
            (0.05, Command::Scene(SceneKind::Torque)),
            (0.1, Command::Arm),
            torque(0.4, 0.004),
            torque(0.7, f32::NAN),
            torque(0.71, 0.05),
            torque(0.72, f32::NEG_INFINITY),
            (0.73, Command::KeepAlive),
            torque(1.0, -0.003),
        ],
        ..Setup::default()
    });
    assert_eq!(torque_at(&run, 0.35), 0.0);
    assert_eq!(torque_at(&run, 0.69), 0.004);
    assert_eq!(torque_at(&run, 0.99), 0.004);
    assert_eq!(torque_at(&run, 1.45), -0.003);
    assert_eq!(
        refusals(&run),
        Some("refused not-finite=2 out-of-bounds=1 unknown=0 unverified=0")
    );
    // Half a second after the last word the scene is off, and cause 13 says why.
    let last = run.telemetry.frames.last().unwrap();
    assert_eq!(
        (last.state, last.cause),
        (Mode::Armed, Stop::CommandTimeout)
    );
    let currents = [last.current, last.current_small].map(f32::abs);
    assert!(last.torque == 0.0 && currents < [1e-6; 2], "{currents:?}");
    assert_eq!(last.overruns, 0);
}

#[test]
fn tuning_a_wall_in_contact_causes_no_jump_of_the_torque() {
    let tune = |at, parameter, value| {
        let command = Command::Tune {
            scene: 2,
            parameter,
            value,
        };
        (at, command)
    };
    let run = run(&Setup {
        seconds: 2.0,
        hand: experiments::closed_loop::Hand::Pushing,
        commands: vec![
            (0.05, Command::Scene(SceneKind::Wall)),
            (0.1, Command::Arm),
            tune(1.5, 1, 0.15),
            tune(1.6, 1, 0.4),
            tune(1.6, 9, 0.1),
        ],
        ..Setup::default()
    });
    // The wall does push: half of it goes, and no more than a part of that within 1 ms.
    let change = torque_at(&run, 1.51) / torque_at(&run, 1.49);
    assert!((0.3..0.7).contains(&change), "{change}");
    let frames = &run.telemetry.frames;
    let swap = frames.iter().find(|frame| frame.tick >= 15_000).unwrap();
    let swap = run.tick_index(swap).unwrap();
    let felt = |k: usize| run.ticks[k].felt;
    let total = (felt(swap + 1500) - felt(swap - 100)).abs();
    let steps = (swap - 100..swap + 1500).map(|k| (felt(k + 10) - felt(k)).abs());
    let step = steps.fold(0.0, f64::max);
    assert!(total > 3e-3 && step < 0.3 * total, "{step} of {total} N.m");
    assert_eq!(
        refusals(&run),
        Some("refused not-finite=0 out-of-bounds=1 unknown=1 unverified=0")
    );
    assert_eq!(frames.last().unwrap().state, Mode::Running);
}

/// Frames that were made and did not come, by their numbers, and what the last one says was dropped.
fn missing(run: &Outcome) -> [u32; 2] {
    let frames = &run.telemetry.frames;
    let [first, .., last] = &frames[..] else {
        panic!("no frames");
    };
    let made = last.seq - first.seq + 1;
    [made - frames.len() as u32, last.drops]
}

/// The queue holds 31 frames, and 40 ms make 40. A watchdog at its nominal frequency would end that
/// with a reset, so its oscillator is the slowest that silicon may have.
#[test]
fn frames_dropped_by_the_queue_are_numbered_and_counted() {
    let run = run(&Setup {
        faults: vec![(0.0, Fault::SlowWatchdog), (0.5, Fault::StarvedIdle)],
        ..of_scene(SceneKind::FreeAir, Hand::Moving, 1.0)
    });
    assert_eq!(run.restarts, []);
    let [missing, drops] = missing(&run);
    assert!((8..=10).contains(&missing), "{missing} are missing");
    assert_eq!(drops, missing);
}

/// RTT holds 4096 bytes, and 300 ms make 300 frames of 40 bytes and more.
#[test]
fn frames_dropped_by_rtt_are_counted() {
    let run = run(&Setup {
        faults: vec![(0.5, Fault::DrainPause)],
        ..of_scene(SceneKind::FreeAir, Hand::Moving, 1.0)
    });
    let [missing, drops] = missing(&run);
    assert!((150..300).contains(&missing), "{missing} are missing");
    assert_eq!(drops, missing);
    // The port, which lost none, says so too.
    let frames = telemetry(&of_port(&run).0).frames;
    assert_eq!(frames.last().map(|frame| frame.drops), Some(drops));
}

/// The probe reads nothing from 20 ms to 320 ms, and the watchdog resets the chip 28 ms after the panic.
#[test]
fn message_of_a_panic_waits_for_place_in_the_log() {
    let run = run(&Setup {
        seconds: 0.4,
        faults: vec![(0.02, Fault::DrainPause), (0.3, Fault::Panic)],
        ..Setup::default()
    });
    assert_eq!(run.restarts.len(), 1);
    let log = &run.telemetry.log;
    assert!(
        log.iter().any(|said| said.contains("panicked at")),
        "{log:?}"
    );
}
