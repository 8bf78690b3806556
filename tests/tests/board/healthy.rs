//! The loop closes, on time and at a known cost, and does no harm before it is armed.

use host_sim::closed_loop::{Bench, Eye, Hand};
use host_sim::device::Device;
use virtual_board::run::RATE_HZ;
use virtual_board::score::Parasitic;

use crate::firmware::scene::Core;
use crate::image::{SETTLED_S, free_air};

#[test]
fn the_image_boots_and_closes_the_loop_at_10_khz() {
    let run = free_air();
    assert_eq!(run.complaints, [""; 0], "pins");
    assert_eq!(run.restarts, []);
    assert_eq!(run.unclosed, 0);
    let late = f64::from(u32::try_from(run.ticks[0].at_ns).unwrap()) * 1e-9;
    assert!(late < 0.01, "control began after {late} s");
    let wanted = (4.0 - late) * RATE_HZ;
    assert!((run.ticks.len() as f64 - wanted).abs() < 2.0);
    let period = run.periods().unwrap();
    assert!(period.min > 99_800 && period.max < 100_200, "{period:?}");

    let telemetry = &run.telemetry;
    assert_eq!(telemetry.malformed, [""; 0]);
    assert!(telemetry.frames.len() > 3900);
    for (k, frame) in telemetry.frames.iter().enumerate() {
        assert_eq!(frame.seq as usize, k);
        assert_eq!((frame.overruns, frame.drops), (0, 0));
    }
    // The loop is closed: the large motor follows the handle, driven by the DAC.
    let moving = run
        .ticks
        .iter()
        .filter(|tick| tick.handle.omega.abs() > 1.0);
    let (mut slip, mut speed, mut n) = (0.0, 0.0, 0);
    for tick in moving.filter(|tick| tick.at_ns as f64 * 1e-9 > SETTLED_S) {
        slip += (tick.large.omega - tick.handle.omega).powi(2);
        speed += tick.handle.omega.powi(2);
        n += 1;
    }
    assert!(n > 5000, "{n} ticks");
    let part = (slip / speed).sqrt();
    assert!(part < 0.25, "slip is {part} of the handle's speed");
}

/// Instructions of the control task in free air, by the pinned compiler. Both bounds are meant:
/// less than the lower one means that something is no longer computed.
const MEAN: std::ops::Range<f64> = 2500.0..3400.0;
const LARGEST: std::ops::Range<u64> = 2600..3800;

#[test]
fn the_control_task_costs_what_it_used_to() {
    let cost = free_air().instructions().unwrap();
    assert!(MEAN.contains(&cost.mean), "{cost:?}");
    assert!(LARGEST.contains(&cost.max), "{cost:?}");
}

#[test]
fn nothing_flows_before_the_amplifiers_are_enabled() {
    let run = free_air();
    let first = run.enables.iter().find(|(_, on)| on.contains(&true));
    let (armed_ns, _) = *first.expect("it is armed");
    assert_eq!(run.enables[0], (0, [false; 2]));
    assert!(armed_ns > 90_000_000, "armed after {armed_ns} ns");
    for (k, moment) in run.moments.iter().enumerate() {
        if (k as u64) * 100_000 < armed_ns {
            assert_eq!(moment.currents, [0.0; 2], "{k}");
        }
    }
    // Nor would it if somebody had wired the enables to the supply.
    for tick in run
        .ticks
        .iter()
        .filter(|tick| tick.at_ns + 100_000 < armed_ns)
    {
        assert_eq!(tick.codes, [Some(2048); 2], "at {} ns", tick.at_ns);
    }
    let flowing = run
        .moments
        .iter()
        .filter(|moment| moment.currents[0] != 0.0);
    assert!(flowing.count() > 10_000);
}

/// The image's control core in the loop of `host-sim`: no processor, no DAC, no lateness.
fn parasitic_on_the_host(seed: u64, seconds: f64) -> Parasitic {
    let device = Device::default();
    let (hand, step) = (Hand::Moving, 10e-6);
    let mut bench = Bench::new(&device, hand, Eye::Large, RATE_HZ, seed, step);
    let mut motion = hand.motion(1.0 / RATE_HZ, seed);
    let mut sample = bench.sample(estimator_core::Amps::ZERO);
    let mut core = Core::start(&sample);
    let armed = (0.1 * RATE_HZ) as u64;
    let mut pairs = Vec::new();
    for k in 0..(seconds * RATE_HZ) as u64 {
        if k == armed {
            core = Core::start(&sample);
            core.select(1, &sample);
        }
        let action = core.step(&sample);
        let currents = action.currents;
        bench
            .plant
            .command(currents.large.get().into(), currents.small.get().into());
        let grip = motion.grip(k);
        if k as f64 > SETTLED_S * RATE_HZ {
            let felt = bench.plant.handle_torque(&grip, 0.0);
            pairs.push((felt, f64::from(action.torque.0)));
        }
        for j in 0..10 {
            bench.step(&grip, f64::from(j) * step, step, &mut (), &mut ());
        }
        sample = bench.sample(currents.large);
    }
    Parasitic::of(pairs.into_iter(), device.handle.diameter_m).unwrap()
}

#[test]
fn free_air_feels_as_in_the_host_simulation() {
    let on_board = free_air()
        .parasitic(SETTLED_S, Device::default().handle.diameter_m)
        .unwrap();
    let on_host = parasitic_on_the_host(1, 4.0);
    println!("board {on_board:?}\nhost {on_host:?}");
    assert!(on_board.samples > 3500);
    // The board's currents act some 20 us after their sample; a DAC code is 3 mA.
    let ratio = on_board.rms_mn / on_host.rms_mn;
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}
