//! The excitation: what it commands, and what ends it.

use estimator_core::{
    Amps, Count, FiniteDifference, Hertz, Model, NoInput, Sample, SteadyKalman, SteadyKalmanTriple,
    preset,
};
use haptic_control::{
    AnyScene, Controller, Currents, DualStage, Excite, LoopPoles, Rig, Switchboard,
};

const DEVICE: DualStage = DualStage::DEFAULT;

/// The currents of `ticks` at a rate, with the handle where `handle` says it is, counts.
fn run(rate_hz: f64, ticks: u32, handle: impl Fn(u32) -> i32) -> Vec<Currents> {
    let rate = Hertz(rate_hz);
    let rig = Rig::new(&DEVICE, rate, LoopPoles::DEFAULT).unwrap();
    let excite = Excite::new(&DEVICE, rate).unwrap();
    let controller = Controller::new(excite, FiniteDifference, FiniteDifference, &rig);
    let mut state = controller.start(&Sample::default());
    (0..ticks)
        .map(|k| {
            let sample = Sample::default().with_small(Count(handle(k) as u32));
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
fn it_ends_by_itself_at_zero_and_stays_there() {
    let currents = run(1e3, 60_000, |_| 0);
    let last = currents.iter().rposition(|c| !is_off(c)).unwrap();
    assert!((15_000..17_000).contains(&last), "{last} ms");
}

/// Millisecond of the last current that is not zero, and one.
fn ended(currents: &[Currents]) -> usize {
    currents.iter().rposition(|c| !is_off(c)).unwrap() + 1
}

/// 20 000 counts a turn: 2 rad are 6366.2 counts, 25 rad/s are 79.6 counts a millisecond.
#[test]
fn a_handle_that_goes_too_far_either_way_ends_it_within_a_millisecond() {
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
fn a_handle_that_is_too_fast_either_way_ends_it_within_a_millisecond() {
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
fn angles_count_from_where_it_began() {
    let rig = Rig::new(&DEVICE, Hertz(1e3), LoopPoles::DEFAULT).unwrap();
    let excite = Excite::new(&DEVICE, Hertz(1e3)).unwrap();
    let controller = Controller::new(excite, FiniteDifference, FiniteDifference, &rig);
    let here = Sample::default().with_small(Count(1_000_000));
    let mut state = controller.start(&here);
    let currents: Vec<_> = (0..17_000)
        .map(|_| controller.step(&mut state, &here).currents)
        .collect();
    assert_eq!(currents, run(1e3, 17_000, |_| 0));
}

#[test]
fn the_switchboard_commands_the_same() {
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
fn a_device_that_it_could_drive_too_fast_or_that_cannot_follow_is_refused() {
    let refused = |device: &DualStage, rate_hz| Excite::new(device, Hertz(rate_hz)).is_err();
    assert!(!refused(&DEVICE, 10e3));
    assert!(refused(&DEVICE, 999.0) && refused(&DEVICE, 200e3) && refused(&DEVICE, f64::NAN));
    let mut device = DEVICE;
    device.large.current_limit = 0.8;
    assert!(refused(&device, 10e3));
    device = DEVICE;
    device.small.current_limit = 0.1;
    assert!(refused(&device, 10e3));
    device = DEVICE;
    device.damping *= 0.7;
    assert!(refused(&device, 10e3));
}
