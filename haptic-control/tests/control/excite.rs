//! The excitation: what it commands, and what ends it.

use estimator_core::{
    Amps, Count, FiniteDifference, Hertz, Model, NoInput, Sample, SteadyKalman, SteadyKalmanTriple,
    preset,
};
use haptic_control::{
    AnyScene, Controller, Currents, DesignError, DualStage, Excite, LoopPoles, Rig, Switchboard,
};

const DEVICE: DualStage = DualStage::DEFAULT;
/// Durations of the sections, ms.
const STROKES_MS: usize = 972;
const LEVELS_MS: usize = 3050;

/// The currents of `ticks` at a rate, with the handle where `handle` says it is, counts.
fn run(rate_hz: f64, ticks: u32, handle: impl Fn(u32) -> i32) -> Vec<Currents> {
    run_on(&DEVICE, rate_hz, ticks, handle)
}

fn run_on(
    device: &DualStage,
    rate_hz: f64,
    ticks: u32,
    handle: impl Fn(u32) -> i32,
) -> Vec<Currents> {
    let rate = Hertz(rate_hz);
    let rig = Rig::new(device, rate, LoopPoles::DEFAULT).unwrap();
    let excite = Excite::new(device, rate).unwrap();
    let controller = Controller::new(excite, FiniteDifference, FiniteDifference, &rig);
    let mut state = controller.start(&Sample::default());
    (0..ticks)
        .map(|k| {
            let sample = Sample::default().with_coupled(Count(handle(k) as u32));
            controller.step(&mut state, &sample).currents
        })
        .collect()
}

fn is_off(currents: &Currents) -> bool {
    *currents == Currents::default()
}

#[test]
fn currents_are_bounded_balanced_and_held_over_whole_milliseconds() {
    let fast = run(10e3, 170_000, |_| 0);
    let (mut sums, mut changes) = ([0.0_f64; 2], 0);
    for (k, currents) in fast.iter().enumerate() {
        let [large, small] = [currents.large, currents.small].map(|amps| f64::from(amps.get()));
        assert!(
            large.abs() <= 0.9 && small.abs() <= 0.3,
            "tick {k}: {currents:?}"
        );
        sums = [sums[0] + large, sums[1] + small];
        if k > 0 && *currents != fast[k - 1] {
            assert_eq!(k % 10, 0, "changed inside a millisecond");
            changes += 1;
        }
    }
    assert!(changes > 500, "{changes}");
    // Every pass has one of the other sign.
    assert!(sums[0].abs() < 1e-2 && sums[1].abs() < 1e-2, "{sums:?}");
    // The same pattern at another rate.
    let slow = run(1e3, 17_000, |_| 0);
    assert!(
        slow.iter()
            .zip(fast.iter().step_by(10))
            .all(|(a, b)| a == b)
    );
}

#[test]
fn excitation_ends_at_zero_current_and_stays_there() {
    let currents = run(1e3, 60_000, |_| 0);
    let last = currents.iter().rposition(|c| !is_off(c)).unwrap();
    assert!((15_000..17_000).contains(&last), "{last} ms");
}

/// Two sections, strokes and levels, each four times with alternating sign.
#[test]
fn pattern_has_two_sections_of_four_passes() {
    let currents = run(1e3, 20_000, |_| 0);
    let at = |ms: usize| [currents[ms].large, currents[ms].small].map(Amps::get);
    let mut begin = 0;
    for duration in [STROKES_MS, LEVELS_MS] {
        for k in 0..3 * duration {
            let [now, next] = [begin + k, begin + k + duration].map(at);
            assert_eq!(now, next.map(|amps| -amps), "{begin}: {k} ms");
        }
        // It is no shorter pass that repeats.
        for shorter in 1..duration {
            let differs = |k: usize| at(begin + k) != at(begin + k + shorter).map(|amps| -amps);
            assert!((0..duration).any(differs), "{begin}: {shorter} ms");
        }
        begin += 4 * duration;
    }
    assert!(currents[begin..].iter().all(is_off));
    // 0.9 A and 0.15 A at most.
    let largest = |of: fn(&Currents) -> Amps| {
        let sizes = currents.iter().map(|now| of(now).get().abs());
        sizes.fold(0.0, f32::max)
    };
    assert_eq!(largest(|now| now.large), 0.9);
    assert_eq!(largest(|now| now.small), 0.15);

    // A pass of levels ends with two sweeps of 40 steps of 20 mA, 16 ms each, and 100 ms of rest.
    let end = 4 * STROKES_MS + LEVELS_MS - 100;
    for k in 0..640 {
        let step = (k / 16) as f32;
        let [down, up] = [end - 1280 + k, end - 640 + k].map(|ms| at(ms)[0]);
        assert!((down - (0.9 - 0.02 * step)).abs() < 1e-6, "{k}: {down}");
        assert!((up - (0.1 + 0.02 * step)).abs() < 1e-6, "{k}: {up}");
    }
    assert!(currents[end..end + 100].iter().all(is_off));
}

/// A handle that nobody holds comes back: each group of strokes is followed by its mirror image.
#[test]
fn strokes_come_in_mirrored_groups() {
    let currents = run(1e3, STROKES_MS as u32, |_| 0);
    let at = |ms: usize| [currents[ms].large, currents[ms].small].map(Amps::get);
    let mut begin = 40;
    for duration in [154, 152, 160] {
        let group = begin..begin + duration;
        for ms in group.clone() {
            let mirror = at(ms + duration).map(|amps| -amps);
            assert_eq!(at(ms), mirror, "{ms} ms");
        }
        // It begins with the large motor, and both motors push both ways.
        assert!(at(begin)[0] > 0.0);
        for motor in 0..2 {
            let pushes = |sign: f32| group.clone().any(|ms| sign * at(ms)[motor] > 0.0);
            assert!(motor == 0 || pushes(1.0) && pushes(-1.0), "{begin}");
        }
        begin += 2 * duration;
    }
    assert_eq!(begin, STROKES_MS);
    let largest =
        |of: fn(&Currents) -> Amps| currents.iter().map(|it| of(it).get()).fold(0.0, f32::max);
    let strokes = [Excite::STROKES.large, Excite::STROKES.small].map(Amps::get);
    assert_eq!([largest(|it| it.large), largest(|it| it.small)], strokes);
}

#[test]
fn pass_of_levels_has_400_ms_negative_and_2490_ms_positive_current() {
    let currents = run(1e3, 20_000, |_| 0);
    let pass = &currents[4 * STROKES_MS..4 * STROKES_MS + LEVELS_MS];
    let [negative, positive] = [-1.0, 1.0].map(|sign| {
        let is_there = |now: &&Currents| sign * now.large.get() > 0.0;
        pass.iter().filter(is_there).count()
    });
    assert_eq!((negative, positive), (400, 2490));
    assert!(pass.iter().all(|now| now.small == Amps::ZERO));
}

/// Millisecond of the last current that is not zero, and one.
fn ended(currents: &[Currents]) -> usize {
    currents.iter().rposition(|c| !is_off(c)).unwrap() + 1
}

/// 20 000 counts a turn: 2 rad are 6366.2 counts, 25 rad/s are 79.6 counts a millisecond.
#[test]
fn handle_beyond_the_angle_limit_ends_the_excitation_within_a_millisecond() {
    for sign in [1, -1] {
        // Half a count a millisecond reaches 6367 at 12 734 ms. A current of zero comes before.
        let end = ended(&run(1e3, 17_000, |k| sign * (k / 2) as i32));
        assert!((12_700..=12_734).contains(&end), "{sign}: {end}");
        // A handle that stays just inside does not end it, one just outside does.
        let inside = |k: u32| sign * (k as i32).min(6366);
        assert!(ended(&run(1e3, 17_000, inside)) > 15_000, "{sign}");
        let outside = |k: u32| sign * (k as i32).min(6367);
        assert!((6300..=6367).contains(&ended(&run(1e3, 17_000, outside))));
        // Once ended it does not begin again.
        let back = |k: u32| if k < 7000 { sign * k as i32 } else { 0 };
        assert!(ended(&run(1e3, 17_000, back)) <= 6367, "{sign}");
    }
}

#[test]
fn handle_above_the_speed_limit_ends_the_excitation_within_a_millisecond() {
    for sign in [1, -1] {
        let spin = |speed: i32| move |k: u32| sign * speed * k.saturating_sub(2000) as i32;
        let end = ended(&run(1e3, 17_000, spin(80)));
        assert!((1990..=2001).contains(&end), "{sign}: {end}");
        // Just below the speed it is the angle, 80 ms later, that ends it.
        let end = ended(&run(1e3, 17_000, spin(79)));
        assert!((2060..=2081).contains(&end), "{sign}: {end}");
        // A jolt of a millisecond that stays where it went.
        let jolt = |counts: i32| move |k: u32| if k < 2000 { 0 } else { sign * counts };
        assert!((1990..=2001).contains(&ended(&run(1e3, 17_000, jolt(80)))));
        assert!(ended(&run(1e3, 17_000, jolt(79))) > 15_000, "{sign}");
    }
}

#[test]
fn angle_limit_is_relative_to_the_start() {
    let rig = Rig::new(&DEVICE, Hertz(1e3), LoopPoles::DEFAULT).unwrap();
    let excite = Excite::new(&DEVICE, Hertz(1e3)).unwrap();
    let controller = Controller::new(excite, FiniteDifference, FiniteDifference, &rig);
    let here = Sample::default().with_coupled(Count(1_000_000));
    let mut state = controller.start(&here);
    let currents: Vec<_> = (0..17_000)
        .map(|_| controller.step(&mut state, &here).currents)
        .collect();
    assert_eq!(currents, run(1e3, 17_000, |_| 0));
}

#[test]
fn excitation_is_the_same_alone_and_in_the_switchboard() {
    const RATE: Hertz = Hertz(10e3);
    const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));
    const EXCITE: Excite = preset!(Excite::new(&DEVICE, RATE));
    const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(20_000, RATE, 4e3));
    const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));
    let board = Switchboard::new(FiniteDifference, HANDLE, RIG, RATE);
    let rest = Sample::default().with_current(Amps::ZERO);
    let mut state = board.start(&rest);
    board.select(&mut state, AnyScene::Excite(EXCITE), &rest);
    let alone = run(10e3, 50_000, |_| 0);
    assert!(alone.iter().any(|currents| !is_off(currents)));
    for (k, currents) in alone.iter().enumerate() {
        assert_eq!(
            board.step(&mut state, &rest).currents,
            *currents,
            "tick {k}"
        );
    }
}

#[test]
fn rates_are_accepted_at_the_limits_and_refused_beyond() {
    for (rate_hz, is_taken) in [
        (999.9, false),
        (1e3, true),
        (100e3, true),
        (100.1e3, false),
        (f64::NAN, false),
    ] {
        let excite = Excite::new(&DEVICE, Hertz(rate_hz));
        let refused = Err(DesignError::ExciteRate);
        assert!(
            if is_taken {
                excite.is_ok()
            } else {
                excite == refused
            },
            "{rate_hz}"
        );
    }
}

#[test]
fn currents_are_those_that_the_device_allows() {
    let largest = |device: &DualStage| {
        let largest = Excite::new(device, Hertz(10e3)).unwrap().largest();
        [largest.large, largest.small].map(|amps| f64::from(amps.get()))
    };
    let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        assert!(
            (a - c).abs() < 1e-6 && (b - d).abs() < 1e-7,
            "{a} {b}: {c} {d}"
        );
    };
    near(largest(&DEVICE), [0.9, 0.15]);
    let mut device = DEVICE;
    (device.large.current_limit, device.small.current_limit) = (0.3, 0.05);
    near(largest(&device), [0.3, 0.05]);
    // 0.9 A drive the large motor of a held handle to 60 rad/s.
    for (part, amps) in [(1.001, 0.9), (0.5, 0.45), (1e-3, 0.9e-3)] {
        let mut device = DEVICE;
        device.damping = part * 0.9 * device.large.torque_constant / 60.0;
        near(largest(&device), [amps, 0.15]);
        let speed = device.large.torque_constant * largest(&device)[0] / device.damping;
        assert!(speed < 60.001, "{speed} rad/s");
    }
}

/// Every current of the pattern is the same part of that for the default device.
#[test]
fn smaller_currents_have_the_same_pattern() {
    let mut device = DEVICE;
    (device.large.current_limit, device.small.current_limit) = (0.45, 0.05);
    let whole = run(1e3, 17_000, |_| 0);
    let parts = run_on(&device, 1e3, 17_000, |_| 0);
    for (k, (whole, part)) in whole.iter().zip(&parts).enumerate() {
        let large = part.large.get() - 0.5 * whole.large.get();
        let small = part.small.get() - whole.small.get() / 3.0;
        assert!(large.abs() < 1e-6 && small.abs() < 1e-6, "{k} ms");
    }
}

#[test]
fn duration_does_not_depend_on_the_rate() {
    // 11.6 ticks a millisecond, and a rate that is rounded to whole hertz.
    for (rate_hz, hertz) in [(11.6e3, 11_600), (11_999.6, 12_000)] {
        let ticks = 4 * (STROKES_MS + LEVELS_MS) * hertz / 1000 + 100;
        let last = run(rate_hz, ticks as u32, |_| 0)
            .iter()
            .rposition(|now| !is_off(now))
            .unwrap();
        // The last pass ends with 100 ms of rest.
        let end = (4 * (STROKES_MS + LEVELS_MS) - 100) * hertz / 1000;
        assert!(last.abs_diff(end) <= 1, "{rate_hz}: {last} {end}");
    }
}

#[test]
fn limits_are_relative_to_the_angle_at_selection() {
    const RATE: Hertz = Hertz(1e3);
    const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));
    const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(20_000, RATE, 4e3));
    const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));
    let board = Switchboard::new(FiniteDifference, HANDLE, RIG, RATE);
    let at = |count: i32| Sample::default().with_coupled(Count(count as u32));
    for turned in [5000, -5000] {
        let mut state = board.start(&at(0));
        let scene = AnyScene::Excite(Excite::new(&DEVICE, RATE).unwrap());
        board.select(&mut state, scene, &at(turned));
        // 2 rad are 6366 counts: a creep of one a millisecond on from there, or back over the origin.
        for way in [1, -1] {
            let mut state = state.clone();
            let currents: Vec<_> = (0..12_000)
                .map(|k| board.step(&mut state, &at(turned + way * k)).currents)
                .collect();
            let end = ended(&currents);
            assert!((6300..=6367).contains(&end), "{turned} {way}: {end}");
        }
    }
}
