//! Invariants of every velocity estimator.

use std::sync::LazyLock;

use estimator_core::{Amps, ClockTicks, Count, Edge, Sample, Signals};
use proptest::prelude::*;

use crate::every::{Case, everywhere};
use crate::motion::{Draws, Motion, Stretch, any_motion, medley};

static EVERY: LazyLock<Vec<Case>> = LazyLock::new(everywhere);

/// Rounding of an f32 result, with room for the few operations that lead to it.
const ROUNDING: f64 = 1e-6;

fn bits(outputs: &[f32]) -> Vec<u32> {
    outputs.iter().map(|output| output.to_bits()).collect()
}

/// The first tick at which two runs differ in a bit.
fn first_difference(one: &[f32], other: &[f32]) -> Option<usize> {
    assert_eq!(one.len(), other.len());
    (0..one.len()).find(|&tick| one[tick].to_bits() != other[tick].to_bits())
}

#[track_caller]
fn assert_identical(case: &Case, one: &[f32], other: &[f32], what: &str) {
    if let Some(tick) = first_difference(one, other) {
        panic!(
            "{}: {what}: {} against {} at tick {tick}",
            case.name, one[tick], other[tick]
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn shift_by_any_count_changes_nothing(motion in any_motion(), shift: u32) {
        for case in EVERY.iter() {
            let (here, there) = (case.run(&motion.samples(0)), case.run(&motion.samples(shift)));
            assert_identical(case, &here, &there, "shifted");
        }
    }

    #[test]
    fn mirrored_motion_gives_mirrored_velocity(motion in any_motion(), start: u32) {
        for case in EVERY.iter() {
            let forth = case.run(&motion.samples(start));
            // Adding zero turns the negative zero into the positive one.
            let forth: Vec<f32> = forth.iter().map(|v| 0.0 - v).collect();
            let back = case.run(&motion.mirrored().samples(start));
            let back: Vec<f32> = back.iter().map(|v| v + 0.0).collect();
            assert_identical(case, &forth, &back, "mirrored");
        }
    }

    #[test]
    fn sixteen_bit_counter_gives_the_same(motion in any_motion(), start: u32) {
        let wide = motion.samples(start);
        let mut count = wide[0].count;
        let narrow: Vec<Sample> = wide.iter().map(|sample| {
            count = count.extended(sample.count.0 as u16);
            Sample { count, ..*sample }
        }).collect();
        for case in EVERY.iter() {
            assert_identical(case, &case.run(&wide), &case.run(&narrow), "16 bits");
        }
    }

    #[test]
    fn restart_is_a_fresh_start(before in any_motion(), motion in any_motion(), start: u32) {
        for case in EVERY.iter() {
            let samples = motion.samples(start);
            let mut used = case.make();
            let past = before.samples(!start);
            used.start(&past[0]);
            for sample in &past[1..] {
                used.update(sample);
            }
            used.start(&samples[0]);
            let again: Vec<f32> = samples[1..].iter().map(|sample| used.update(sample)).collect();
            assert_identical(case, &case.run(&samples), &again, "restarted");
        }
    }

    #[test]
    fn bounded_input_gives_bounded_output(motion in any_motion(), start: u32) {
        let fastest = motion.fastest() as f64;
        for case in EVERY.iter() {
            // Currents are within 1 A. A late current is one of them all the same.
            let bound = fastest * case.per_count + case.per_amp;
            for output in case.run(&motion.samples(start)) {
                prop_assert!(
                    f64::from(output.abs()) <= bound * (1.0 + ROUNDING),
                    "{}: {output} beyond {bound}", case.name
                );
            }
        }
    }

    #[test]
    fn signals_not_needed_are_not_read(motion in any_motion(), start: u32, seed: u64) {
        let mut draws = Draws(seed);
        let bare = motion.samples(start);
        let dressed: Vec<Sample> = bare.iter().map(|sample| {
            let edge = Edge { boundary: Count(draws.bits() as u32), age: ClockTicks(draws.bits() as u32) };
            sample.with_coupled(Count(draws.bits() as u32)).with_edge(edge)
        }).collect();
        for case in EVERY.iter() {
            prop_assert!(case.needs.within(Signals::COUNT_AND_CURRENT), "{}", case.name);
            assert_identical(case, &case.run(&bare), &case.run(&dressed), "other signals");
            let other: Vec<Sample> = bare.iter()
                .map(|sample| sample.with_current(Amps::new(5.0 * draws.unit() as f32)))
                .collect();
            let same = bits(&case.run(&bare)) == bits(&case.run(&other));
            // In a short motion a current may have no effect.
            prop_assert!(same || case.needs.current, "{} reads the current", case.name);
            prop_assert!(!same || !case.needs.current || bare.len() < 4, "{} ignores it", case.name);
        }
    }
}

#[test]
fn wrap_at_any_tick_does_not_change_the_velocity() {
    let motion = medley();
    for case in EVERY.iter() {
        let far_from_any_wrap = case.run(&motion.samples(1 << 30));
        for moment in (1..motion.counts.len()).step_by(31) {
            // The counter passes its end, or the sign of its word, at this very sample.
            for boundary in [0u32, 1 << 31] {
                let start = boundary.wrapping_sub(motion.counts[moment] as u32);
                let wrapped = case.run(&motion.samples(start));
                assert_identical(case, &far_from_any_wrap, &wrapped, "wrapped");
            }
        }
    }
}

#[test]
fn velocity_is_zero_after_a_start_at_rest_at_any_count() {
    let mut draws = Draws(5);
    let counts = [0, 1, 0x7FFF_FFFF, 0x8000_0000, u32::MAX, 1_000_000_000];
    let counts = counts
        .into_iter()
        .chain((0..100).map(|_| draws.bits() as u32));
    for count in counts {
        let rest = vec![Sample::new(Count(count)); 300];
        for case in EVERY.iter() {
            assert!(
                case.run(&rest).iter().all(|output| *output == 0.0),
                "{}: jumps at {count}",
                case.name
            );
        }
    }
}

#[test]
fn first_step_is_relative_to_the_first_sample() {
    for case in EVERY.iter() {
        for start in [0u32, 12_345_678, 1 << 31, u32::MAX] {
            let samples = [
                Sample::new(Count(start)),
                Sample::new(Count(start) + estimator_core::Counts(3)),
            ];
            let output = f64::from(case.run(&samples)[0]);
            assert!(
                output >= 0.0 && output <= 3.0 * case.per_count * (1.0 + ROUNDING),
                "{}: {output} after 3 counts from {start}",
                case.name
            );
        }
    }
}

/// The medley contains each kind of motion that the tests above rely on.
#[test]
fn test_signal_has_rest_creep_and_speed() {
    let motion = medley();
    assert!(motion.fastest() >= 2900 && motion.fastest() < 1 << 15);
    assert!(motion.counts.windows(50).any(|w| w[0] == w[49]));
    let slow = Motion::of(&[(Stretch::Creep(50, true), 500)], 0);
    assert_eq!(slow.counts.last(), Some(&10));
}
