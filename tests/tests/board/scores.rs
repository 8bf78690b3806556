//! Parasitic force and error of the velocity: the board against the host simulation.

use std::f64::consts::TAU;

use estimator_core::Amps;
use experiments::closed_loop::{Bench, FeedbackEncoder, Hand};
use experiments::compare::interval;
use firmware_app::scene::Core;
use haptic_control::SceneKind;
use rayon::prelude::*;
use scoring::score::{Score, Truth, Wanted};
use simulation::device::Device;
use virtual_board::run::{Outcome, RATE_HZ};
use virtual_board::score::Parasitic;

use crate::image::{SETTLED_S, adaptive_free_air, free_air, of_scene, run_image, wall};

/// Frames a second, at which both are scored.
const FRAMES_HZ: f64 = 1e3;

/// Scores of a run: the velocity's error, and the parasitic force.
#[derive(Debug)]
struct Scores {
    open: Score,
    closed: Parasitic,
}

/// Steps of 10 us after which the board's currents act: instructions, and the lockstep's own step.
const LATE_STEPS: u32 = 3;

/// A frame: the large motor's velocity as estimated and as it is, torque felt and wanted.
struct Row {
    estimate: f32,
    omega: f64,
    felt: f64,
    wanted: f64,
}

fn scores(rows: &[Row]) -> Scores {
    let device = Device::default();
    let omega: Vec<_> = rows.iter().map(|row| row.omega).collect();
    let estimates: Vec<_> = rows.iter().map(|row| row.estimate).collect();
    let truth = Truth::new(&omega, FRAMES_HZ, interval(&device), Wanted::ALL).unwrap();
    let pairs = rows.iter().map(|row| (row.felt, row.wanted));
    Scores {
        open: truth.score(&estimates),
        closed: Parasitic::of(pairs, device.handle.diameter_m).unwrap(),
    }
}

fn rows(run: &Outcome) -> Vec<Row> {
    let rows = run.telemetry.frames.iter().filter_map(|frame| {
        let tick = run.tick(frame)?;
        (tick.at_ns as f64 * 1e-9 >= SETTLED_S).then(|| Row {
            estimate: frame.velocity_large,
            omega: tick.large.omega,
            felt: tick.felt,
            wanted: frame.torque.into(),
        })
    });
    rows.collect()
}

/// The same by the definitions, written out: velocity error (rms, and its part in 50 to 500 Hz),
/// the force that the error makes, and the parasitic force.
fn by_definition(rows: &[Row]) -> [f64; 4] {
    let device = Device::default();
    let n_per_nm = 2.0 / device.handle.diameter_m;
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, n) = values.fold((0.0, 0.0), |(sum, n), x| (sum + x * x, n + 1.0));
        f64::sqrt(sum / n)
    };
    // The first 0.1 s are left out.
    let scored = &rows[(0.1 * FRAMES_HZ) as usize..];
    let errors: Vec<f64> = scored
        .iter()
        .map(|row| f64::from(row.estimate) - row.omega)
        .collect();
    let velocity = rms(&mut errors.iter().copied());
    let force = rows.iter().map(|row| row.felt - row.wanted);
    [
        velocity,
        tactile(&errors),
        1e3 * n_per_nm * device.stages.damping * velocity,
        rms(&mut force.map(|torque| 1e3 * n_per_nm * torque)),
    ]
}

/// RMS of the part of a signal in 50 to 500 Hz: Welch's method, segments of 250 samples or 4 Hz,
/// half overlapping, Hann window, each bin by a sum over the segment.
fn tactile(signal: &[f64]) -> f64 {
    const SEGMENT: usize = 250;
    let window = |i: usize| 0.5 - 0.5 * (TAU * i as f64 / SEGMENT as f64).cos();
    let window_power: f64 = (0..SEGMENT).map(|i| window(i) * window(i)).sum();
    let segments: Vec<_> = signal.windows(SEGMENT).step_by(SEGMENT / 2).collect();
    let mean_square = |bin: usize| {
        let power = segments.iter().map(|segment| {
            let turn = |i: usize| TAU * (bin * i) as f64 / SEGMENT as f64;
            let part = |wave: fn(f64) -> f64| -> f64 {
                let weighed = segment.iter().enumerate();
                weighed.map(|(i, x)| window(i) * x * wave(turn(i))).sum()
            };
            part(f64::cos).powi(2) + part(f64::sin).powi(2)
        });
        let mean = power.sum::<f64>() / segments.len() as f64;
        2.0 * mean / (window_power * SEGMENT as f64)
    };
    // The band begins in the middle of the bin at 52 Hz and ends in that at 500 Hz, the last.
    let parts = (0..=SEGMENT / 2).map(|bin| {
        let middle = 4.0 * bin as f64;
        let low = f64::max(middle - 2.0, 50.0);
        let high = f64::min(middle + 2.0, 500.0);
        f64::max(high - low, 0.0) / 4.0 * mean_square(bin)
    });
    f64::sqrt(parts.sum())
}

/// Scores of the velocity in the telemetry of a run against the plant.
#[test]
fn scores_of_a_run_agree_with_their_definitions() {
    for run in [free_air(), wall()] {
        let rows = rows(run);
        let Scores { open, closed } = scores(&rows);
        let found = [open.rms_rad_s, open.noise_rad_s, open.force_mn].map(Option::unwrap);
        let [rms, noise, force, parasitic] = by_definition(&rows);
        let pairs = found.into_iter().zip([rms, noise, force]);
        for (found, wanted) in pairs.chain([(closed.rms_mn, parasitic)]) {
            assert!((found / wanted - 1.0).abs() < 1e-9, "{found} {wanted}");
        }
        // The truth is the motion of the plant: the shaft turns as far as it says.
        let (mut turned, mut said) = (0.0, 0.0);
        for pair in run.ticks.windows(2) {
            let [before, after] = pair else {
                unreachable!("pairs");
            };
            let mean = 0.5 * (before.large.omega + after.large.omega);
            let seconds = (after.at_ns - before.at_ns) as f64 * 1e-9;
            turned += mean * (after.large.angle - before.large.angle);
            said += mean * mean * seconds;
        }
        assert!((turned / said - 1.0).abs() < 1e-3, "{turned} {said}");
    }
}

/// Times at which the device is armed on the host, s. By that, counts and noise fall otherwise and scores move by
/// some per cent.
const ARMED_S: [f64; 4] = [0.1, 0.101, 0.102, 0.103];

/// The image's control core in the loop of `host-sim`: no processor, no DAC, no lateness.
fn on_host(scene: u8, hand: Hand) -> Vec<Scores> {
    let run = |armed_s: &f64| on_host_armed(scene, hand, *armed_s, 10.0);
    ARMED_S.par_iter().map(run).collect()
}

fn on_host_armed(scene: u8, hand: Hand, armed_s: f64, seconds: f64) -> Scores {
    let (device, step) = (Device::default(), 10e-6);
    let mut bench = Bench::new(&device, hand, FeedbackEncoder::Own, RATE_HZ, 1, step);
    let mut motion = hand.motion(1.0 / RATE_HZ, 1);
    let mut sample = bench.sample(Amps::ZERO);
    let mut core = Core::start(&sample);
    let armed = (armed_s * RATE_HZ) as u64;
    let mut rows = Vec::new();
    for k in 0..(seconds * RATE_HZ) as u64 {
        if k == armed {
            core = Core::start(&sample);
            core.select(scene, &sample);
        }
        let action = core.step(&sample);
        let currents = action.currents;
        let grip = motion.grip(k);
        if k as f64 >= SETTLED_S * RATE_HZ && k.is_multiple_of(10) {
            rows.push(Row {
                estimate: action.large_velocity.0,
                omega: bench.plant.large().omega,
                felt: bench.plant.handle_torque(&grip, 0.0),
                wanted: action.torque.0.into(),
            });
        }
        for j in 0..10_u32 {
            if j == LATE_STEPS {
                let [large, small] = [currents.large, currents.small].map(Amps::get);
                bench.plant.command(large.into(), small.into());
            }
            bench.step(&grip, f64::from(j) * step, step, &mut (), &mut ());
        }
        sample = bench.sample(currents.large);
    }
    scores(&rows)
}

/// A DAC code is 3 mA, and the image began to count its angles some ms later: each score has to be within those of
/// the host, and this part of them more. The delay is the shift of least RMS, which is flat there: a quarter of a
/// millisecond.
fn agree(board: &Scores, host: &[Scores]) {
    const PART: f64 = 0.03;
    println!("board {board:#?}");
    let near = |name: &str, of: &dyn Fn(&Scores) -> f64| {
        let hosts: Vec<f64> = host.iter().map(of).collect();
        let least = hosts.iter().copied().fold(f64::INFINITY, f64::min);
        let most = hosts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let board = of(board);
        println!("{name}: {board} {hosts:?}");
        let found = ((1.0 - PART) * least..(1.0 + PART) * most).contains(&board);
        assert!(found, "{name}: {board} {hosts:?}");
    };
    near("velocity, rms", &|s| s.open.rms_rad_s.unwrap());
    near("velocity, noise", &|s| s.open.noise_rad_s.unwrap());
    near("velocity, force", &|s| s.open.force_mn.unwrap());
    near("parasitic force, rms", &|s| s.closed.rms_mn);
    for host in host {
        let delay = [board, host].map(|s| s.open.delay_ms.unwrap());
        assert!((delay[0] - delay[1]).abs() < 0.25, "delay {delay:?} ms");
    }
    assert!(board.closed.samples > 9500 && board.closed.rms_mn > 1.0);
}

#[test]
fn scores_of_free_air_agree_with_the_host_simulation() {
    agree(&scores(&rows(free_air())), &on_host(1, Hand::Moving));
}

/// Instructions of a tick, mean, and the parasitic force of a run in free air.
fn tick_and_force(run: &Outcome) -> (f64, Parasitic) {
    let settled = run.ticks.iter().filter(|tick| tick.enabled == [true; 2]);
    let counts: Vec<f64> = settled.map(|tick| f64::from(tick.instructions)).collect();
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    (mean, scores(&rows(run)).closed)
}

/// docs/feel.md states these figures. A bank that estimates the handle's velocity costs instructions and
/// takes parasitic force off.
#[test]
fn bank_on_the_handle_takes_force_off_for_its_instructions() {
    let setup = of_scene(SceneKind::FreeAir, Hand::Moving, 10.0);
    let bank = run_image("large-adaptive,handle-imm", &setup);
    let [(tick, filter), (longer, bank)] = [adaptive_free_air(), &bank].map(tick_and_force);
    println!("{tick} instructions, {filter:?}; with the bank {longer}, {bank:?}");
    assert!((540.0..600.0).contains(&(longer - tick)), "{tick} {longer}");
    assert!((4.7..5.7).contains(&filter.rms_mn), "{filter:?}");
    assert!((3.3..4.3).contains(&bank.rms_mn), "{bank:?}");
}

#[test]
fn scores_of_the_wall_agree_with_the_host_simulation() {
    agree(&scores(&rows(wall())), &on_host(2, Hand::Pushing));
}
