//! Exchange of estimators at run time: no step of the velocity, and no state of the old estimator.

use estimator_core::{
    Count, EndFit, FiniteDifference, Foaw, Handover, Hertz, Model, Sample, Side, SteadyKalman,
    SteadyKalmanTriple, VelocityEstimator,
};
use proptest::prelude::*;

use crate::motion::any_motion;

const SETTLE: u16 = 60;
const FADE: u16 = 40;

type Both = Handover<Foaw<15, EndFit>, SteadyKalmanTriple>;

fn filter() -> SteadyKalmanTriple {
    let model = Model::triple_integrator(4096, Hertz(1000.0), 2e4).unwrap();
    SteadyKalman::new(&model).unwrap()
}

fn both() -> Both {
    Handover::new(Foaw::new(15, 1).unwrap(), filter(), SETTLE, FADE).unwrap()
}

/// Velocity of an estimator at each sample but the first.
fn run<E>(estimator: &E, samples: &[Sample], mut each: impl FnMut(usize, &mut E::State)) -> Vec<f32>
where
    E: VelocityEstimator,
{
    let mut state = estimator.start(&samples[0]);
    samples[1..]
        .iter()
        .enumerate()
        .map(|(k, sample)| {
            each(k, &mut state);
            estimator.update(&mut state, sample).0
        })
        .collect()
}

/// Taken back before its first tick, a change ends with the estimator that was in charge, even the longest one.
#[test]
fn change_that_is_taken_back_at_once_is_none() {
    for (settle, fade) in [(SETTLE, FADE), ((1 << 15) - 1, 1 << 15)] {
        let estimator = Handover::new(FiniteDifference, filter(), settle, fade).unwrap();
        let samples: Vec<Sample> = (0..100).map(|k| Sample::new(Count(7 * k))).collect();
        let velocities = run(&estimator, &samples, |k, state| match k {
            50 => state.select(Side::Second),
            51 => state.select(Side::First),
            52 => assert_eq!(state.in_charge(), Some(Side::First), "{settle} {fade}"),
            _ => {}
        });
        assert!(velocities.iter().all(|v| *v == 7.0), "{settle} {fade}");
    }
}

#[test]
fn change_of_estimator_does_not_alter_a_constant_velocity() {
    let samples: Vec<Sample> = (0..1000).map(|k| Sample::new(Count(7 * k))).collect();
    let estimator = both();
    let mut in_charge = Vec::new();
    let velocities = run(&estimator, &samples, |k, state| {
        match k {
            300 => state.select(Side::Second),
            600 => state.select(Side::First),
            _ => {}
        }
        in_charge.push(state.in_charge());
    });
    assert!(velocities[100..].iter().all(|v| (v - 7.0).abs() < 1e-3));
    assert_eq!(in_charge[300], Some(Side::First));
    assert_eq!(in_charge[310], None);
    assert_eq!(in_charge[500], Some(Side::Second));
    assert_eq!(in_charge[900], Some(Side::First));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// For any number of selections at any ticks, the output changes from tick to tick by at most
    /// the steps of the two estimators and of the fade.
    #[test]
    fn steps_during_a_fade_are_bounded_by_the_estimators_and_the_fade(
        motion in any_motion(),
        changes in proptest::collection::vec((0usize..600, any::<bool>()), 0..8),
    ) {
        let samples = motion.samples(u32::MAX - 20);
        let (estimator, window, filter) = (both(), Foaw::<15, EndFit>::new(15, 1).unwrap(), filter());
        let mut state = estimator.start(&samples[0]);
        // Each of the two alone, started at the ticks at which the handover starts it.
        let (mut a, mut b) = (window.start(&samples[0]), filter.start(&samples[0]));
        let mut last: Option<[f32; 3]> = None;
        let mut output = Vec::new();
        for (k, sample) in samples[1..].iter().enumerate() {
            for (at, second) in &changes {
                if *at == k {
                    state.select(if *second { Side::Second } else { Side::First });
                }
            }
            let before = state.in_charge();
            let v = estimator.update(&mut state, sample).0;
            let now = [v, window.update(&mut a, sample).0, filter.update(&mut b, sample).0];
            match (before, state.in_charge()) {
                (Some(Side::First), None) => b = filter.start(sample),
                (Some(Side::Second), None) => a = window.start(sample),
                _ => {}
            }
            if let Some(last) = last {
                let moved = [0, 1, 2].map(|n: usize| (now[n] - last[n]).abs());
                let apart = (now[1] - now[2]).abs().max((last[1] - last[2]).abs());
                let allowed = match before {
                    Some(Side::First) => moved[1],
                    Some(Side::Second) => moved[2],
                    None => moved[1].max(moved[2]) + apart / f32::from(FADE),
                };
                // With L the largest of the estimates and ε = 2^-23, half an ulp of a number up to
                // n L is n ε L / 2. `old + share (new - old)` rounds a difference up to 2 L, a
                // share of it, their product, and a sum up to L: 3.5 ε L a tick, 7 ε L over two.
                // The difference of the two outputs adds ε L, and `allowed` has 2.6 ε L of its own:
                // a difference up to 2 L and a sum up to 3 L.
                let largest = now.iter().chain(&last).fold(0.0f32, |a, v| a.max(v.abs()));
                let rounding = 10.6 * f32::EPSILON * largest;
                prop_assert!(moved[0] <= allowed + rounding, "{k}: {moved:?} {apart} {rounding}");
            }
            last = Some(now);
            output.push(v);
        }
        // Without a selection the output is that of the first estimator, bit for bit.
        if changes.iter().all(|(_, second)| !second) {
            let alone = run(&Foaw::<15, EndFit>::new(15, 1).unwrap(), &samples, |_, _| ());
            prop_assert!(output.iter().zip(&alone).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

/// For two estimators with a known difference, the fade is linear and reverses from its current
/// weight.
#[test]
fn reversed_fade_continues_from_its_current_weight() {
    // At half a count a tick finite difference says 0 and 1 in turn; its window of two says 1/2.
    let estimator = Handover::new(
        FiniteDifference,
        Foaw::<2, EndFit>::new(2, 1).unwrap(),
        4,
        10,
    )
    .unwrap();
    let samples: Vec<Sample> = (0..80).map(|k| Sample::new(Count(k / 2))).collect();
    let output = run(&estimator, &samples, |k, state| match k {
        10 => state.select(Side::Second),
        21 => state.select(Side::First),
        _ => {}
    });
    // The share of the window, seen in the deviation from 1/2: 1/2 at first, none when faded.
    let share = |k: usize| 1.0 - 2.0 * (output[k] - 0.5).abs();
    for (k, wanted) in [
        (9, 0.0),
        (14, 0.0),
        (15, 0.1),
        (18, 0.4),
        (20, 0.6),
        (21, 0.5),
        (26, 0.0),
        (40, 0.0),
    ] {
        assert!(
            (share(k) - wanted).abs() < 1e-6,
            "{k}: {} not {wanted}",
            share(k)
        );
    }
}

#[test]
fn invalid_fades_are_refused() {
    for (settle, fade) in [(0, 0), (0, u16::MAX), (u16::MAX, 1)] {
        assert!(Handover::new(FiniteDifference, FiniteDifference, settle, fade).is_err());
    }
}
