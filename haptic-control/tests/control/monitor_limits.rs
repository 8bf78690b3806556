//! Both sides of each limit of the monitor, and the limits of a device by their formulas.

use std::f64::consts::TAU;

use estimator_core::{Amps, Count, Hertz, Sample};
use haptic_control::{DualStage, Monitor, Stop};

const MONITOR: Monitor = Monitor {
    slot: 10,
    handle_window: 400,
    large_window: 500,
    jump: 1000,
    stall: 20,
    stall_milliamps: 500,
    push_milliamps: 80,
    pull: 256,
};

fn sample(large: i32, small: i32, milliamps: f32) -> Sample {
    Sample::new(Count(large as u32))
        .with_coupled(Count(small as u32))
        .with_current(Amps::new(milliamps / 1000.0))
}

/// The first cause over `ticks` of a motion, and the tick.
fn first(ticks: i32, motion: impl Fn(i32) -> Sample) -> Option<(i32, Stop)> {
    let mut state = MONITOR.start(&motion(0));
    (1..ticks).find_map(|k| {
        let found = MONITOR.check(&mut state, &motion(k));
        found.map(|cause| (k, cause))
    })
}

#[test]
fn jump_is_detected_beyond_its_limit_on_both_encoders_in_both_directions() {
    for sign in [1, -1] {
        for (counts, stops) in [(1000, false), (1001, true)] {
            // In the middle of a slot; back by as much, so that no window is too long.
            let there = |k: i32| if k == 13 { sign * counts } else { 0 };
            let wanted = stops.then_some((13, Stop::Jump));
            assert_eq!(first(40, |k| sample(there(k), 0, 0.0)), wanted);
            assert_eq!(first(40, |k| sample(0, there(k), 0.0)), wanted);
        }
    }
}

#[test]
fn overspeed_is_detected_beyond_its_limit_over_five_slots_in_both_directions() {
    for sign in [1, -1] {
        // All of it in one tick, within the limit of a jump, or evenly.
        for (counts, stops) in [(400, false), (401, true)] {
            let step = |k: i32| sample(0, if k < 42 { 0 } else { sign * counts }, 0.0);
            let wanted = stops.then_some((50, Stop::HandleOverspeed));
            assert_eq!(first(200, step), wanted);
        }
        for (counts, stops) in [(500, false), (501, true)] {
            let step = |k: i32| sample(if k < 42 { 0 } else { sign * counts }, 0, 0.0);
            let wanted = stops.then_some((50, Stop::LargeOverspeed));
            assert_eq!(first(200, step), wanted);
        }
        // 401 counts in 51 ticks are within a window of 50 wherever it begins.
        for begin in 0..10 {
            let slow = |k: i32| sample(0, sign * 400 * (k - begin).max(0) / 50, 0.0);
            assert_eq!(first(500, slow), None);
        }
        let fast = |k: i32| sample(0, sign * (405 * k / 50), 0.0);
        assert_eq!(first(500, fast), Some((50, Stop::HandleOverspeed)));
    }
    // The handle is named first where both are too fast.
    let both = first(200, |k| sample(20 * k, 20 * k, 0.0));
    assert_eq!(both, Some((30, Stop::HandleOverspeed)));
}

#[test]
fn stall_is_detected_beyond_its_limits_of_current_and_time() {
    for sign in [1, -1] {
        let push = |milliamps: i32| sign as f32 * milliamps as f32;
        for (milliamps, stops) in [(500, false), (502, true)] {
            let rest = |_| sample(7, 0, push(milliamps));
            // The slot in which the push begins is the first of 21.
            let wanted = stops.then_some((210, Stop::Stall));
            assert_eq!(first(1000, rest), wanted, "{milliamps}");
        }
        // Twenty slots of push, and one without.
        let pauses = |k: i32| {
            sample(
                7,
                0,
                if (k - 1) / 10 % 21 == 20 {
                    0.0
                } else {
                    push(600)
                },
            )
        };
        assert_eq!(first(2000, pauses), None);
        let longer = |k: i32| {
            sample(
                7,
                0,
                if (k - 1) / 10 % 22 == 21 {
                    0.0
                } else {
                    push(600)
                },
            )
        };
        assert_eq!(first(2000, longer), Some((210, Stop::Stall)));
        // One tick of less current in each slot is enough.
        let ripple = |k: i32| sample(7, 0, if k % 10 == 4 { push(500) } else { push(600) });
        assert_eq!(first(2000, ripple), None);
        // Two counts are dither, three are motion.
        for (counts, stops) in [(2, true), (3, false)] {
            let there = |k: i32| if k / 100 % 2 == 0 { 0 } else { sign * counts };
            let moves = |k: i32| sample(there(k), 0, push(600));
            let found = first(1000, moves);
            assert_eq!(found.is_some(), stops, "{counts}: {found:?}");
        }
    }
}

/// Not only where the motor was when the monitor began.
#[test]
fn stall_is_detected_where_a_motor_that_turned_comes_to_rest() {
    for sign in [1, -1] {
        // A count in each tick until the slot that ends with tick 510, and 21 slots of rest.
        let jams = |k: i32| sample(sign * k.min(505), 0, sign as f32 * 600.0);
        assert_eq!(first(2000, jams), Some((510 + 210, Stop::Stall)));
    }
}

/// A motion of the large motor that goes on by `before` counts in one window of five slots and by
/// `after` in the next one, against the push and again at the end of every slot.
fn two_windows(before: i32, after: i32) -> impl Fn(i32) -> i32 {
    move |k| {
        let slots = k / 10;
        before * slots.min(20) / 5 + after * (slots - 20).max(0) / 5
    }
}

#[test]
fn runaway_is_an_accelerating_motion_against_the_current() {
    for sign in [1, -1] {
        let run = |milliamps: f32, before: i32, after: i32| {
            let path = two_windows(before, after);
            first(260, |k| sample(-sign * path(k), 0, sign as f32 * milliamps))
        };
        let against = Some((250, Stop::RunawayDirection));
        // Five counts more in a window than in the one before; four may be rounding.
        assert_eq!(run(100.0, 10, 15), against);
        assert_eq!(run(100.0, 10, 14), None);
        assert_eq!(run(100.0, 0, 5), against);
        // Slower, or along the push, is possible.
        assert_eq!(run(100.0, 20, 10), None);
        assert_eq!(run(100.0, -10, -20), None);
        assert_eq!(run(-100.0, 10, 20), None);
        // Along it and slower is faster against it only where it turns.
        assert_eq!(run(100.0, -20, -10), None);
        assert_eq!(run(100.0, -20, 0), None);
        // A push of 80 mA has no certain direction.
        assert_eq!(run(80.0, 10, 20), None);
        assert_eq!(run(82.0, 10, 15), against);
    }
}

#[test]
fn runaway_needs_eleven_slots_of_current() {
    for (slots, stops) in [(10, false), (11, true)] {
        // The push ends with the tick that ends slot 25; before it is none.
        let begin = 250 - 10 * slots;
        let path = two_windows(10, 20);
        let found = first(251, |k| {
            let milliamps = if k > begin { 100.0 } else { 0.0 };
            sample(-path(k), 0, milliamps)
        });
        assert_eq!(found.is_some(), stops, "{slots}: {found:?}");
    }
}

#[test]
fn drive_is_the_smaller_of_the_current_and_the_sum() {
    // 256 of 256 mA for a count of the handle in a slot; 30 counts a slot.
    for sign in [1, -1] {
        let rest = |milliamps: f32, per_tick: i32| {
            let found = first(1000, |k| {
                sample(7, sign * per_tick * k, sign as f32 * milliamps)
            });
            found.map(|(_, cause)| cause)
        };
        // The handle pulls along: the current alone counts.
        assert_eq!(rest(490.0, 3), None);
        assert_eq!(rest(502.0, 3), Some(Stop::Stall));
        // It pulls back: the sum counts.
        assert_eq!(rest(529.0, -3), None);
        assert_eq!(rest(532.0, -3), Some(Stop::Stall));
        // A pull alone is no push.
        assert_eq!(rest(0.0, 7), None);
    }
    // A quarter of it with a quarter of the factor, rounded towards zero.
    let monitor = Monitor {
        pull: 64,
        ..MONITOR
    };
    for (milliamps, stops) in [(507.0, false), (509.0, true)] {
        let mut state = monitor.start(&sample(7, 0, milliamps));
        let found = (1..1000).any(|k| {
            let now = sample(7, -3 * k, milliamps);
            monitor.check(&mut state, &now).is_some()
        });
        assert_eq!(found, stops, "{milliamps}");
    }
}

#[test]
fn limits_of_a_device_agree_with_the_formulas() {
    let fine = DualStage::DEFAULT;
    let mut heavy = fine;
    heavy.large.coulomb_friction = 9e-3;
    heavy.large.counts_per_rev = 20_000;
    heavy.small.counts_per_rev = 4096;
    heavy.damping = 2e-3;
    let mut smooth = fine;
    smooth.large.coulomb_friction = 1e-3;
    for device in [fine, heavy, smooth] {
        for rate in [400.0, 1e3, 2600.0, 10e3, 11.6e3] {
            let monitor = Monitor::new(&device, Hertz(rate));
            // A slot is the nearest to a millisecond, and a window five of them.
            let slot = (rate / 1000.0).round().max(1.0);
            let counts = |rad_per_s: f64, per_rev: u32| {
                (rad_per_s * 5.0 * slot / rate * f64::from(per_rev) / TAU) as u32 + 1
            };
            assert_eq!(monitor.slot, slot as u32, "{rate}");
            assert_eq!(
                monitor.handle_window,
                counts(30.0, device.small.counts_per_rev)
            );
            assert_eq!(
                monitor.large_window,
                counts(150.0, device.large.counts_per_rev)
            );
            assert_eq!(monitor.stall, (0.05 * rate / slot) as u32);
            assert_eq!(monitor.jump, 16_384);
            assert_eq!(monitor.push_milliamps, 80);
            let milliamps = |torque: f64| 1000.0 * torque / device.large.torque_constant;
            let friction = milliamps(2.5 * device.large.coulomb_friction);
            assert_eq!(monitor.stall_milliamps, friction.max(100.0) as i32);
            let speed = TAU / f64::from(device.small.counts_per_rev) * rate / slot;
            let pull = 256.0 * milliamps(device.damping * speed);
            assert!((f64::from(monitor.pull) - pull).abs() <= 1.0, "{rate}");
        }
    }
}

#[test]
fn causes_have_names() {
    let named = [
        (Stop::HandleOverspeed, "handle-overspeed"),
        (Stop::LargeOverspeed, "large-overspeed"),
        (Stop::Jump, "jump"),
        (Stop::Stall, "not-moving"),
        (Stop::RunawayDirection, "against"),
    ];
    for (cause, name) in named {
        assert_eq!(cause.as_str(), name);
    }
}
