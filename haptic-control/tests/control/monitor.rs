//! The monitor: what it stops, and that it stops nothing else.

use estimator_core::{Amps, Count, Sample};
use haptic_control::{CurrentLimits, Monitor, Stop};

const MONITOR: Monitor = Monitor {
    slot: 10,
    handle_window: 400,
    large_window: 500,
    jump: 1000,
    stall: 200,
    stall_milliamps: 500,
    push_milliamps: 80,
    pull: 256,
};

/// The first cause over `ticks` of a motion, and the tick.
fn first(ticks: u32, motion: impl Fn(u32) -> Sample) -> Option<(u32, Stop)> {
    let mut state = MONITOR.start(&motion(0));
    (1..ticks).find_map(|k| {
        MONITOR
            .check(&mut state, &motion(k))
            .map(|cause| (k, cause))
    })
}

fn sample(large: u32, small: u32, amps: f32) -> Sample {
    Sample::new(Count(large))
        .with_coupled(Count(small))
        .with_current(Amps::new(amps))
}

#[test]
fn ordinary_motion_over_the_wrap_causes_no_stop() {
    let start = u32::MAX - 20_000;
    // Both at their limits, in both directions, with current.
    let there = |k: u32| sample(start.wrapping_add(10 * k), start.wrapping_add(8 * k), 3.0);
    let back = |k: u32| sample(start.wrapping_sub(10 * k), start.wrapping_sub(8 * k), -3.0);
    assert_eq!(first(10_000, there), None);
    assert_eq!(first(10_000, back), None);
}

/// Until the slot ends in tick 80.
#[test]
fn displacement_equal_to_the_bound_is_no_jump() {
    for (from, to) in [(5, 1005), (1005, 5)] {
        let at = |k: u32| if k < 77 { from } else { to };
        assert_eq!(first(79, |k| sample(at(k), 0, 0.0)), None);
        assert_eq!(first(79, |k| sample(0, at(k), 0.0)), None);
    }
}

/// A caller with a schedule: [`Monitor::follow`] in every tick, [`Monitor::end_slot`] in the last one of a slot.
#[test]
fn parts_of_a_tick_find_what_the_whole_tick_finds() {
    let motions: [&dyn Fn(u32) -> Sample; 4] = [
        &|k| sample(if k < 77 { 5 } else { 1006 }, 0, 0.0),
        &|k| sample(0, if k < 80 { 5 } else { 1006 }, 0.0),
        &|k| sample(0, if k < 200 { 0 } else { 9 * (k - 200) }, 0.0),
        &|_| sample(3, 0, -0.51),
    ];
    for motion in motions {
        let mut state = MONITOR.start(&motion(0));
        let parts = (1..5000).find_map(|k| {
            let sample = motion(k);
            MONITOR.follow(&mut state, &sample);
            if k % MONITOR.slot == 0 {
                MONITOR.end_slot(&mut state, &sample);
            }
            state.cause().map(|cause| (k, cause))
        });
        assert!(parts.is_some());
        assert_eq!(parts, first(5000, motion));
    }
}

#[test]
fn each_cause_is_detected_within_its_time() {
    let runaway = first(1000, |k| {
        sample(0, if k < 200 { 0 } else { 9 * (k - 200) }, 0.0)
    });
    assert!(
        matches!(runaway, Some((201..=300, Stop::HandleOverspeed))),
        "{runaway:?}"
    );
    let runaway = first(1000, |k| sample(0_u32.wrapping_sub(11 * k), 0, 0.0));
    assert!(
        matches!(runaway, Some((1..=50, Stop::LargeOverspeed))),
        "{runaway:?}"
    );
    let jump = first(1000, |k| sample(if k < 77 { 5 } else { 1006 }, 0, 0.0));
    assert_eq!(jump, Some((77, Stop::Jump)));
    let jump = first(1000, |k| {
        sample(0, if k < 77 { 5 } else { 5_u32.wrapping_sub(1001) }, 0.0)
    });
    assert_eq!(jump, Some((77, Stop::Jump)));
    let stall = first(5000, |_| sample(3, 0, -0.51));
    assert_eq!(stall, Some((2010, Stop::Stall)));
}

#[test]
fn motion_or_zero_current_clears_the_stall() {
    assert_eq!(first(20_000, |k| sample(k / 600, 0, 2.0)), None);
    assert_eq!(
        first(20_000, |k| sample(
            0,
            0,
            if k % 2000 == 0 { 0.0 } else { 2.0 }
        )),
        None
    );
    assert_eq!(first(20_000, |_| sample(0, 0, 0.5)), None);
}

#[test]
fn the_first_cause_is_latched() {
    let mut state = MONITOR.start(&sample(0, 0, 0.0));
    assert_eq!(
        MONITOR.check(&mut state, &sample(2000, 0, 0.0)),
        Some(Stop::Jump)
    );
    for k in 0..100 {
        let runaway = sample(2000, 900 * k, 0.0);
        assert_eq!(MONITOR.check(&mut state, &runaway), Some(Stop::Jump));
    }
}

/// Two faults, one of which is found at the end of a slot and the other one in its tick: whichever comes first is the
/// cause.
#[test]
fn cause_stays_when_another_fault_follows() {
    let fast = |k: u32| sample(0, 9 * k, 0.0);
    let jumps = |k: u32| sample(2000 * (k % 2), 0, 0.0);
    let faults: [(&dyn Fn(u32) -> Sample, Stop); 2] =
        [(&fast, Stop::HandleOverspeed), (&jumps, Stop::Jump)];
    for (i, (motion, stop)) in faults.into_iter().enumerate() {
        let mut state = MONITOR.start(&motion(0));
        for k in 1..=60 {
            MONITOR.check(&mut state, &motion(k));
        }
        assert_eq!(state.cause(), Some(stop));
        let other = faults[1 - i].0;
        for k in 61..200 {
            assert_eq!(MONITOR.check(&mut state, &other(k)), Some(stop), "{k}");
        }
    }
}

#[test]
fn outputs_are_within_the_limits_for_every_input() {
    let limits = CurrentLimits {
        largest: Amps::new(1.5),
        slew: 0.06,
    };
    let mut before = 0.0_f32;
    let wild = [
        1e30,
        f32::NAN,
        -1e30,
        0.0,
        f32::INFINITY,
        1.0,
        f32::NEG_INFINITY,
        -0.3,
        f32::MIN,
    ];
    for k in 0..100_000 {
        let wanted = wild[(k * 7 + k / 13) % wild.len()];
        let now = limits.applied(wanted, Amps::new(before)).get();
        assert!(now.abs() <= 1.5);
        assert!((now - before).abs() <= 0.060_001 || now == 0.0 && !wanted.is_finite());
        before = now;
    }
    // The bound is reached, not only kept.
    let risen = (0..100).fold(0.0, |current, _| {
        limits.applied(9.0, Amps::new(current)).get()
    });
    assert_eq!(risen, 1.5);
}

#[test]
fn alternating_counts_are_a_stall() {
    let stall = first(5000, |k| sample(7 + k % 3, 0, 2.0));
    assert!(
        matches!(stall, Some((2000..=2010, Stop::Stall))),
        "{stall:?}"
    );
}

#[test]
fn acceleration_against_the_current_is_detected_and_deceleration_is_not() {
    // 1 A on the default device: 4000 rad/s², 0.026 counts a tick each tick.
    let moved = |k: u32| (0.013 * f64::from(k) * f64::from(k)) as u32;
    let away = first(1000, |k| sample(0_u32.wrapping_sub(moved(k)), 0, 1.0));
    assert!(
        matches!(away, Some((51..=150, Stop::RunawayDirection))),
        "{away:?}"
    );
    let away = first(1000, |k| sample(moved(k), 0, -1.0));
    assert!(
        matches!(away, Some((51..=150, Stop::RunawayDirection))),
        "{away:?}"
    );
    let along = first(300, |k| sample(moved(k), 0, 1.0));
    assert_eq!(along, None);
    let braking = first(300, |k| sample(0_u32.wrapping_sub(moved(300 - k)), 0, -1.0));
    assert_eq!(braking, None);
}

#[test]
fn current_balanced_by_the_handle_is_no_stall() {
    // 550 mA, of which the handle's motion takes 70 off: 1 mA for a count in a slot.
    let held = |k: u32| sample(9, 0_u32.wrapping_sub(7 * k), 0.55);
    assert_eq!(first(20_000, held), None);
    let held = |k: u32| sample(9, 7 * k, -0.55);
    assert_eq!(first(20_000, held), None);
    // The same motion the other way is no excuse: a coupler that brings nothing stalls too.
    let stuck = first(20_000, |k| sample(9, 7 * k, 0.55));
    assert!(
        matches!(stuck, Some((2000..=2020, Stop::Stall))),
        "{stuck:?}"
    );
}

#[test]
fn reversing_current_is_no_runaway() {
    // It has just been driven the other way, and slows down late.
    let moved = |k: u32| (0.013 * f64::from(k) * f64::from(k)) as u32;
    let turned = |k: u32| sample(moved(k), 0, if k % 60 < 30 { 1.0 } else { -1.0 });
    assert_eq!(first(190, turned), None);
}

#[test]
fn overspeed_is_detected_at_every_phase_of_the_window() {
    for begin in 200..260 {
        let runaway = first(1000, |k| sample(0, 9 * k.saturating_sub(begin), 0.0));
        let (tick, cause) = runaway.expect("a stop");
        assert_eq!(cause, Stop::HandleOverspeed);
        // 400 counts take 45 ticks, and a slot is 10.
        assert!((45..=56).contains(&(tick - begin)), "{begin}: {tick}");
    }
}

/// Three ticks are missed in the slot of a motor that a constant current has not reversed yet, and in that of a
/// handle close to its limit. The displacement of the longer slot is no acceleration and no overspeed.
#[test]
fn slot_that_is_given_up_takes_no_part_in_a_window() {
    let late = |k: u32| k + if k >= 143 { 3 } else { 0 };
    let motions: [(&dyn Fn(u32) -> Sample, Stop); 2] = [
        (
            &|k| sample(0_u32.wrapping_sub(2 * late(k)), 0, 1.0),
            Stop::RunawayDirection,
        ),
        (&|k| sample(0, 8 * late(k), 0.0), Stop::HandleOverspeed),
    ];
    for (motion, stop) in motions {
        for gives_up in [false, true] {
            let mut state = MONITOR.start(&motion(0));
            for k in 1..1000 {
                if gives_up && k == 143 {
                    state.give_up_slot();
                }
                MONITOR.check(&mut state, &motion(k));
            }
            assert_eq!(state.cause(), (!gives_up).then_some(stop));
        }
    }
}

/// From the slots before and after the one that is given up.
#[test]
fn overspeed_is_detected_around_a_slot_that_is_given_up() {
    let mut state = MONITOR.start(&sample(0, 0, 0.0));
    let found = (1..1000_u32).find(|k| {
        if *k == 143 {
            state.give_up_slot();
        }
        let runaway = sample(0, 9 * k.saturating_sub(120), 0.0);
        MONITOR.check(&mut state, &runaway).is_some()
    });
    // 400 counts take 45 ticks of slots that count.
    assert!(
        found.is_some_and(|k| (120 + 55..=120 + 66).contains(&k)),
        "{found:?}"
    );
}
