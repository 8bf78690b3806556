//! The same control on the host, fed with what the image read: the same bits.

use drivers::Settings;
use estimator_core::{AccelerationEstimator, Amps, Count, Sample, Skip, VelocityEstimator};
use experiments::closed_loop::Hand;
use firmware_app::config::RATE;
use firmware_app::control::{Control, Faults, Inputs, Message, SETTLE};
use firmware_app::large::{self, Large, LargeEstimator as _};
use firmware_app::scene::{HANDLE, RIG};
use firmware_app::telemetry::Record;
use haptic_control::{
    Action, AnyScene, Currents, FreeAir, Mode, Request, SceneKind, Stop, Switchboard,
};
use recordings::telemetry::Frame;
use virtual_board::run::{ControlTick, Outcome};

use crate::image::{
    adaptive_free_air, free_air, kalman_free_air, kalman_track, of_scene, run_image, soak, tour,
    wall,
};

/// The counts of every tick of `run`, widened from what the counters show at first.
struct Samples([Count; 2]);

impl Samples {
    fn new(run: &Outcome) -> (Self, Sample) {
        let start = run.first_counts.map(|read| Count(u32::from(read.unwrap())));
        let first = Sample::new(start[0]).with_coupled(start[1]);
        (Self(start), first)
    }

    fn next(&mut self, tick: &ControlTick, current: Amps) -> Sample {
        for (count, read) in self.0.iter_mut().zip(tick.counts) {
            *count = count.extended(read.expect("each tick reads both encoders"));
        }
        Sample::new(self.0[0])
            .with_coupled(self.0[1])
            .with_current(current)
    }
}

/// A command that the control task hears.
#[derive(Clone, Copy, PartialEq)]
enum Heard {
    Request(Request),
    Estimator(u8),
}

/// What was asked for and at which tick. A command is taken from the channel when the tick after
/// its last byte has woken the processor, and obeyed at the tick after that.
fn requests(run: &Outcome) -> Vec<(usize, Heard)> {
    let obeyed = |(at_ns, bytes): &(u64, Vec<u8>)| {
        let heard = match bytes[..3] {
            [0xA5, 1, _] => Heard::Request(Request::Arm),
            [0xA5, 3, scene] => Heard::Request(Request::Select(scene)),
            [0xA5, 7, number] => Heard::Estimator(number),
            _ => return None,
        };
        let next = run.ticks.partition_point(|tick| tick.at_ns <= *at_ns);
        Some((next + 1, heard))
    };
    run.sent.iter().filter_map(obeyed).collect()
}

/// Runs the firmware's control over the counts of every tick of `run`: what it orders, what it
/// reports.
pub(crate) fn mirrored(run: &Outcome) -> Vec<(Option<Currents>, Record)> {
    let (mut samples, first) = Samples::new(run);
    let mut control = Control::new(&first, Stop::None, true, &Settings::COMMISSIONED);
    let requests = requests(run);
    let step = |(k, tick): (usize, &ControlTick)| {
        let flow = control.flow(&Skip);
        let sample = samples.next(tick, flow.currents.large);
        let heard = requests.iter().find(|(at, _)| *at == k);
        let message = heard.map(|(_, heard)| match heard {
            Heard::Request(request) => Message::Request(*request),
            Heard::Estimator(number) => {
                Message::Estimator(Large::choice(*number).expect("it is there"))
            }
        });
        control.check(&sample, &flow, &Skip);
        let request = control.accept(message);
        let inputs = Inputs {
            faults: Faults::NONE,
            missed: 0,
            debugger: || false,
            request: Some(request.unwrap_or(Request::KeepAlive)),
        };
        let outputs = control.step(&sample, &inputs);
        (outputs.currents, control.record(&sample, &outputs.action))
    };
    run.ticks.iter().enumerate().map(step).collect()
}

/// Fails unless every frame has the values that the host's core computed at its tick. Returns the
/// number of frames of a moving device.
pub(crate) fn same_bits(run: &Outcome, host: &[(Option<Currents>, Record)]) -> usize {
    let mut moving = 0;
    assert_eq!(run.telemetry.malformed, [""; 0]);
    numbered_from_the_first_tick(run);
    for frame in &run.telemetry.frames {
        let k = run.tick_index(frame).expect("a frame tells of a tick");
        let Record {
            tick,
            sample,
            action,
            state,
            cause,
            ..
        } = host[k].1;
        assert_eq!(
            (frame.tick, frame.counts_large, frame.counts_small),
            (tick, sample.count.0, sample.coupled.0)
        );
        assert_eq!((frame.state, frame.cause), (state, cause), "{frame:?}");
        same_action(frame, &action);
        moving += usize::from(action.large_velocity.0 != 0.0 && action.handle_velocity.0 != 0.0);
    }
    moving
}

/// Fails unless frames are numbered from 0, each tells of the tenth tick after the last, from tick
/// 0 on, and has the counts that the board's counters showed at that tick. The emulator saw those:
/// no code of the firmware is on this side.
fn numbered_from_the_first_tick(run: &Outcome) {
    for (k, frame) in run.telemetry.frames.iter().enumerate() {
        assert_eq!(
            (frame.seq, frame.tick),
            (k as u32, 10 * k as u32),
            "{frame:?}"
        );
        let read = run.ticks[10 * k].counts.map(Option::unwrap);
        assert_eq!(
            [frame.counts_large as u16, frame.counts_small as u16],
            read,
            "{frame:?}"
        );
    }
}

fn same_action(frame: &Frame, action: &Action) {
    let image = [
        frame.velocity_large,
        frame.velocity_small,
        frame.torque,
        frame.current,
        frame.current_small,
    ];
    let currents = [action.currents.large.get(), action.currents.small.get()];
    let wanted = [
        action.large_velocity.0,
        action.handle_velocity.0,
        action.torque.0,
        currents[0],
        currents[1],
    ];
    assert_eq!(
        image.map(f32::to_bits),
        wanted.map(f32::to_bits),
        "{frame:?} {wanted:?}"
    );
}

#[test]
fn scene_free_air_agrees_with_the_host_bit_for_bit() {
    let run = free_air();
    let moving = same_bits(run, &mirrored(run));
    assert!(moving > 8000, "{moving} frames of a moving device");
}

/// A minute of chirps and reversals, over wraps of both counters.
#[test]
fn tracking_agrees_with_the_host_bit_for_bit_for_a_minute_and_over_wraps() {
    let run = soak();
    assert!(run.ticks.len() > 601_000, "{} ticks", run.ticks.len());
    assert_eq!((run.unclosed, run.restarts.len()), (0, 0));
    let moving = same_bits(run, &mirrored(run));
    assert!(moving > 55_000, "{moving} frames of a moving device");
    for (k, frame) in run.telemetry.frames.iter().enumerate() {
        assert_eq!(frame.seq as usize, k);
        assert_eq!((frame.overruns, frame.drops), (0, 0), "{frame:?}");
    }
    let last = run.telemetry.frames.last().unwrap();
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    for encoder in [0, 1] {
        let counts = run.ticks.iter().map(|tick| tick.counts[encoder].unwrap());
        let counts: Vec<_> = counts.collect();
        let wraps = counts
            .windows(2)
            .filter(|pair| pair[0].abs_diff(pair[1]) > 1 << 15);
        let wraps = wraps.count();
        assert!(wraps > 0, "encoder {encoder} wraps {wraps} times");
    }
}

#[test]
fn changes_of_scene_agree_with_the_host_bit_for_bit() {
    let run = tour();
    let host = mirrored(run);
    same_bits(run, &host);
    let changes = requests(run).len();
    assert_eq!(
        changes,
        1 + SceneKind::environments().count(),
        "arm and every scene"
    );
    let last = run.telemetry.frames.last().unwrap();
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    // At every tick, not at every frame alone: the codes of both converters.
    codes_are_the_hosts(run, &host);
}

#[test]
fn every_dac_code_agrees_with_the_hosts_current() {
    let run = free_air();
    let moved = codes_are_the_hosts(run, &mirrored(run));
    assert!(moved > 90_000, "{moved}");
}

fn codes_are_the_hosts(run: &Outcome, host: &[(Option<Currents>, Record)]) -> usize {
    let mut moved = 0;
    for (tick, (order, _)) in run.ticks.iter().zip(host) {
        assert_eq!(tick.enabled, [order.is_some(); 2]);
        let currents = order.unwrap_or_default();
        let currents = [currents.large, currents.small];
        for n in [0, 1] {
            let exact = 2048.0 + f64::from(currents[n].get()) / [6.0, 1.5][n] * 2047.0;
            let code = f64::from(tick.codes[n].expect("the channel is on"));
            let miss = (code - exact.clamp(1.0, 4095.0)).abs();
            assert!(miss < 0.501, "{code} {exact} {tick:?}");
            moved += usize::from(code != 2048.0);
        }
    }
    moved
}

/// The switchboard of an image with another estimator on the large motor or at another control rate: a
/// build of `firmware_app` has one choice.
pub(crate) fn mirrored_by<L, H>(switchboard: &Switchboard<L, H>, run: &Outcome) -> Vec<Action>
where
    L: VelocityEstimator,
    H: AccelerationEstimator,
{
    let (mut samples, first) = Samples::new(run);
    let mut state = switchboard.start(&first);
    let mut applied = Amps::ZERO;
    // How long a command waits depends on the phase of the tick, which depends on the rate.
    let armed = run.ticks.iter().position(|tick| tick.enabled == [true; 2]);
    // Settling takes the same time at every rate.
    let settle = f64::from(SETTLE) * run.rate_hz() / RATE.0;
    let settled = armed.expect("the run arms") + settle as usize;
    let step = |(k, tick): (usize, &ControlTick)| {
        let sample = samples.next(tick, applied);
        let mut action = switchboard.step(&mut state, &sample);
        if k == settled {
            state = switchboard.start(&sample);
            switchboard.select(&mut state, AnyScene::FreeAir(FreeAir), &sample);
            action.currents = Currents::default();
        }
        applied = action.currents.large;
        action
    };
    run.ticks.iter().enumerate().map(step).collect()
}

/// As [`mirrored_by`], at the rate of `firmware_app`.
fn mirrored_with<L: VelocityEstimator>(large: L, run: &Outcome) -> Vec<Action> {
    mirrored_by(&Switchboard::new(large, HANDLE, RIG, RATE), run)
}

/// Fails unless every frame of `run` says what the host computed. Returns the number of frames of a moving
/// device.
pub(crate) fn same_frames(run: &Outcome, host: &[Action]) -> usize {
    let mut moving = 0;
    for frame in &run.telemetry.frames {
        let action = &host[run.tick_index(frame).expect("a frame tells of a tick")];
        same_action(frame, action);
        moving += usize::from(action.large_velocity.0 != 0.0);
    }
    moving
}

/// Fails unless 10 s of `run` agree and move. An observer that knows friction says zero where it holds
/// the rotor.
fn same_ten_seconds(run: &Outcome, host: &[Action]) {
    assert!(run.telemetry.frames.len() > 9980);
    let moving = same_frames(run, host);
    assert!(moving > 8000, "{moving} frames of a moving device");
}

#[test]
fn kalman_image_agrees_with_the_host_bit_for_bit() {
    for run in [kalman_free_air(), kalman_track()] {
        same_ten_seconds(run, &mirrored_with(large::FILTER, run));
    }
}

#[test]
fn adaptive_image_agrees_with_the_host_bit_for_bit() {
    let run = adaptive_free_air();
    same_ten_seconds(run, &mirrored_with(large::ADAPTIVE, run));
}

/// RMS error of the reported velocity of the large motor, rad/s, after a second.
fn velocity_error(run: &Outcome) -> f64 {
    let frames = run.telemetry.frames.iter().skip(1000);
    let square = |frame: &Frame| {
        let truth = run
            .tick(frame)
            .expect("a frame tells of a tick")
            .large
            .omega;
        (f64::from(frame.velocity_large) - truth).powi(2)
    };
    let squares: Vec<f64> = frames.map(square).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// In the loop the error of the observer is a tenth of FOAW's in free air. Against a wall, where
/// the motor turns faster, it is a half, and a quarter of that with stamped edges.
#[test]
fn observers_on_the_board_have_smaller_errors() {
    let [foaw, counts] = [free_air(), adaptive_free_air()].map(velocity_error);
    println!("free air: FOAW {foaw}, adaptive {counts} rad/s");
    assert!(counts < 0.1 * foaw, "{counts} {foaw}");
    let pushed = |features| {
        let setup = of_scene(SceneKind::Wall, Hand::Pushing, 5.0);
        velocity_error(&run_image(features, &setup))
    };
    let errors = [
        velocity_error(wall()),
        pushed("large-adaptive"),
        pushed("large-adaptive,edge-capture"),
    ];
    println!("wall: FOAW, adaptive, with edges {errors:?} rad/s");
    assert!(errors[1] < 0.5 * errors[0], "{errors:?}");
    assert!(errors[2] < 0.9 * errors[1], "{errors:?}");
}
