//! What is learned from blocks of ticks, how fast it is forgotten, and the input that follows from it.

extern crate std;

use super::{BLOCK, BankInput, LOW_PASS, LearnedCurrent, LearnedCurrentState, MEMORY, TERMS};
use crate::bank::ModelBankState;
use crate::filters::draws::draw;
use crate::sample::Sample;
use crate::units::{Amps, Count, Hertz};

const RATE: Hertz = Hertz(1000.0);

fn uniform(seed: &mut u64) -> f32 {
    (draw(seed) >> 40) as f32 / (1 << 23) as f32 - 1.0
}

fn start(input: &LearnedCurrent) -> LearnedCurrentState {
    input.start(&Sample::new(Count(0)))
}

/// Adds `seconds` in which the acceleration in each tick is the sum of `gains` times terms that are drawn
/// anew. `velocity` is that of the shaft, counts/tick.
fn accelerate(
    input: &LearnedCurrent,
    state: &mut LearnedCurrentState,
    gains: [f32; TERMS],
    velocity: &mut f64,
    seconds: f64,
) {
    let mut seed = 11;
    for _ in 0..(seconds * RATE.0) as usize {
        state.terms = [(); TERMS].map(|()| uniform(&mut seed));
        let products = state.terms.iter().zip(gains);
        let acceleration: f64 = products.map(|(term, gain)| f64::from(term * gain)).sum();
        let moved = *velocity + 0.5 * acceleration;
        *velocity += acceleration;
        state.collect(moved as f32, input);
    }
}

#[test]
fn gains_are_those_of_the_accelerations_of_each_tick() {
    for rate in [Hertz(500.0), RATE, Hertz(10_000.0)] {
        let input = LearnedCurrent::new(rate).unwrap();
        let mut state = start(&input);
        let gains = [3.0, -2.0, 1.0, 0.5];
        accelerate(&input, &mut state, gains, &mut 0.0, 10.0);
        assert!(state.known);
        for (found, gain) in state.gains.iter().zip(gains) {
            // The ridge is a thousandth, and the shrinkage another one.
            assert!((found - gain).abs() < 0.02, "{rate:?}: {found} for {gain}");
        }
        assert!((state.gain() - 2.0).abs() < 0.05);
        assert!((state.friction() - 0.5).abs() < 0.02);
    }
}

#[test]
fn old_gains_are_forgotten_with_the_memory() {
    let input = LearnedCurrent::new(RATE).unwrap();
    let mut state = start(&input);
    let (before, after) = ([2.0, 1.0, -1.0, 0.5], [-1.0, 1.0, 2.0, 0.5]);
    let mut velocity = 0.0;
    accelerate(&input, &mut state, before, &mut velocity, 40.0);
    for seconds in [3.0f64, 7.0, 10.0] {
        let (mut state, mut velocity) = (state, velocity);
        accelerate(&input, &mut state, after, &mut velocity, seconds);
        let old = (-seconds / MEMORY).exp();
        let share =
            old * (1.0 - (-40.0 / MEMORY).exp()) / (1.0 - (-(40.0 + seconds) / MEMORY).exp());
        for ((found, before), after) in state.gains.iter().zip(before).zip(after) {
            let expected = after + share as f32 * (before - after);
            assert!(
                (found - expected).abs() < 0.25,
                "{seconds} s: {found} for {expected}"
            );
        }
    }
}

#[test]
fn nothing_is_learned_while_the_count_stands_still() {
    let input = LearnedCurrent::new(RATE).unwrap();
    let mut state = start(&input);
    accelerate(&input, &mut state, [1.0; TERMS], &mut 0.0, 5.0);
    // One block is between motion and rest.
    let rest = |state: &mut LearnedCurrentState, ticks: u32| {
        for _ in 0..ticks {
            state.terms = [0.7; TERMS];
            state.collect(0.0, &input);
        }
    };
    let moving = state;
    rest(&mut state, input.block);
    assert_ne!(state.regression, moving.regression);
    let learned = state;
    rest(&mut state, 5000);
    assert_eq!(state.gains, learned.gains);
    assert_eq!(state.regression, learned.regression);
}

#[test]
fn low_passed_currents_are_one_and_two_time_constants_late() {
    for rate in [Hertz(500.0), RATE, Hertz(10_000.0)] {
        let input = LearnedCurrent::new(rate).unwrap();
        let mut state = start(&input);
        let bank = ModelBankState::<3>::start(Count(0), 1e-3);
        let sample = Sample::new(Count(0)).with_current(Amps::new(2.0));
        let mut late = [0.0; 3];
        for _ in 0..(0.2 * rate.0) as usize {
            assert_eq!(input.input(&mut state, &sample, &bank), None);
            for (late, term) in late.iter_mut().zip(&state.terms) {
                *late += (1.0 - f64::from(*term) / 2.0) / rate.0;
            }
        }
        // The mean delay of n poles, to a tick.
        for (n, late) in late.iter().enumerate() {
            let expected = n as f64 * LOW_PASS;
            assert!(
                (late - expected).abs() <= 1.0 / rate.0,
                "{rate:?} {n}: {late}"
            );
        }
        assert_eq!(f64::from(input.block), BLOCK * rate.0);
    }
}

#[test]
fn input_is_the_sum_of_the_terms_and_friction_takes_at_most_half_of_the_velocity() {
    let input = LearnedCurrent::new(RATE).unwrap();
    for (velocity, friction, expected) in [
        // -g v |v| / (v² + σ²), with σ² = 1024 counts²/tick² at the start of a bank.
        (32.0, 2.0, -1.0),
        (-32.0, 2.0, 1.0),
        (32.0, 1000.0, -16.0),
        (-32.0, 1000.0, 16.0),
        // Friction cannot drive.
        (32.0, -2.0, 0.0),
    ] {
        let mut state = start(&input);
        state.known = true;
        state.gains = [0.5, 0.25, -2.0, friction];
        let mut bank = ModelBankState::<3>::start(Count(0), 1e-3);
        bank.drive(velocity);
        let found = input.input(&mut state, &Sample::new(Count(0)), &bank);
        assert!(
            (found.unwrap() - expected).abs() < 1e-5,
            "{velocity} {friction}: {found:?}"
        );
        // A current of 4 A that has lasted.
        state.terms = [4.0; TERMS];
        let sample = Sample::new(Count(0)).with_current(Amps::new(4.0));
        let found = input.input(&mut state, &sample, &bank).unwrap();
        let driven = 4.0 * (0.5 + 0.25 - 2.0);
        assert!((found - expected - driven).abs() < 1e-5, "{found}");
    }
}
