//! The correction by a quantisation interval whose ends are noisy, the noise that is learned, and the choice of two
//! members.

extern crate std;

use super::interval::{Ends, Likelihood};
use super::ladder::Ladder;
use super::member::Member;
use super::state::tests::judged;
use super::state::{LEAST_OF_COUNT, ModelBankState};
use super::{ModelBank, NoStamps};
use crate::edge_clock::FreshEdge;
use crate::estimator::VaryingPeriod;
use crate::sample::Sample;
use crate::units::{Count, Hertz};

/// Probability that a position plus noise is inside ±1/2, and mean and variance of the position if so, by
/// summation over both.
fn summed(mean: f64, variance: f64, ends: f64) -> [f64; 3] {
    let steps = 400;
    let grid = move |variance: f64| {
        let deviation = variance.sqrt();
        (0..steps).map(move |step| {
            let y = 12.0 * ((f64::from(step) + 0.5) / f64::from(steps) - 0.5);
            (deviation * y, (-0.5 * y * y).exp())
        })
    };
    let (mut all, mut sums) = (0.0, [0.0; 3]);
    for (off, density) in grid(variance) {
        for (noise, of_noise) in grid(ends) {
            let (x, weight) = (mean + off, density * of_noise);
            all += weight;
            if (x + noise).abs() < 0.5 {
                sums[0] += weight;
                sums[1] += weight * x;
                sums[2] += weight * x * x;
            }
        }
    }
    let after = sums[1] / sums[0];
    [sums[0] / all, after, sums[2] / sums[0] - after * after]
}

#[test]
fn interval_with_noisy_ends_corrects_less() {
    for (mean, variance, ends) in [
        (0.45f32, 0.02, 0.1),
        (-0.45, 0.02, 0.1),
        (0.3, 0.08, 0.05),
        (-0.7, 0.04, 0.04),
    ] {
        let mut member = Member::START;
        member.position = mean;
        member.covariance = [variance, 0.0, 0.0, 1.0, 0.0, 1.0];
        let [probability, position, after] =
            summed(f64::from(mean), f64::from(variance), f64::from(ends));
        let likelihood = member.correct_by_interval(Ends::of(true), ends).likelihood;
        // The truncation is approximated to 2 % of the deviation and 4 % of the variance, and its
        // probability to 4 %.
        let sum = f64::from(variance + ends);
        let share = f64::from(variance) / sum;
        let off = f64::from(member.position) - position;
        assert!(off.abs() < 0.02 * share * sum.sqrt(), "{mean}: {off}");
        let off = f64::from(member.covariance[0]) - after;
        assert!(
            off.abs() < 0.04 * share * f64::from(variance),
            "{mean}: {off}"
        );
        let off = f64::from(likelihood.relative(1.0)) - probability;
        assert!(off.abs() < 0.04, "{mean}: {off}");
    }
}

#[test]
fn bank_takes_the_ends_for_as_noisy_as_told() {
    let ends = 0.1;
    let mut state = ModelBankState::<2>::start(Count(0), 1e-3);
    // Moves every position by 0.4 counts.
    state.drive(0.8);
    state.noise = ends;
    let likelihoods = state
        .correct_by_interval(Ends::of(true), false, false)
        .likelihoods;
    let variance = f64::from(Member::START.covariance[0]);
    let [noisy, exact] = [ends, 1e-9].map(|ends| summed(0.4, variance, f64::from(ends))[0]);
    for likelihood in likelihoods {
        let found = f64::from(likelihood.relative(1.0));
        // The error of the truncation, as above.
        assert!((found - noisy).abs() < 0.04, "{found} {noisy} {exact}");
    }
}

/// Three shifts of alternating signs are noise, two are less of it if the count turns and else none, and those of one
/// sign are a motion that the members lag. R also follows the size of the shifts. Far inside its interval a position
/// says little, and the shifts before and after it are neighbours.
#[test]
fn noise_of_a_count_grows_where_shifts_alternate() {
    #[derive(Clone, Copy, PartialEq)]
    enum Newest {
        Stays,
        Comes,
        Turns,
    }
    use Newest::{Comes, Stays, Turns};
    let among = |positions: &[f32], learns: bool, count: Newest| {
        let mut state = ModelBankState::<3>::start(Count(0), 0.01);
        state.still = u32::from(count == Stays);
        for position in positions {
            for member in &mut state.members {
                *member = Member::START;
                member.position = *position;
                if position.abs() < 0.5 {
                    member.covariance[0] = 1e-4;
                }
            }
            state.correct_by_interval(Ends::of(true), learns, count == Turns);
        }
        state.noise
    };
    let after = |positions: &[f32]| among(positions, true, Comes);
    // 5 deviations outside: the interval removes nearly all of the variance, of which the usual size is 0.5 at most.
    // The size counts as 1.5, and of V 0.01 counts² beyond R. The product counts as V.
    let by_size = |noise: f32| 0.03 * (1.5 - 0.5) * (noise + 0.01);
    let by_product = |noise: f32| 0.02 * (1.0 / 12.0 + noise);
    let near = |found: f32, expected: f32| {
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    };
    let first = 0.01 + by_size(0.01);
    let second = first + by_size(first);
    near(after(&[2.0]), first);
    near(after(&[2.0, -2.0]), second);
    near(among(&[2.0, -2.0], true, Turns), second + 0.02 * 0.25);
    near(
        after(&[2.0, -2.0, 2.0]),
        second + by_size(second) + by_product(second),
    );
    near(after(&[2.0, 2.0]), second - by_product(first));
    near(after(&[0.0; 40]), 0.01 * 0.998_f32.powi(40));
    let apart = [2.0, 0.0, 0.0, -2.0, 0.0, 2.0, 0.0];
    assert_eq!(among(&apart, true, Stays), after(&[2.0, -2.0, 2.0]));
    assert_eq!(among(&[2.0, -2.0, 2.0], false, Turns), 0.01);
    // Near an end the size is less than usual.
    let [comes, stays] = [Comes, Stays].map(|count| among(&[0.45], true, count) - 0.01);
    assert!(comes < -1e-6 && (stays / comes - 0.2).abs() < 0.01);
    // From the ninth shift of one sign on the members lag.
    let mut shifts = [2.0; 20];
    shifts[0] = -2.0;
    for (number, falls) in [(8, false), (9, true), (15, true)] {
        let [before, now] = [number, number + 1].map(|end| after(&shifts[..end]));
        assert_eq!((now / before - 0.95).abs() < 1e-3, falls, "{before} {now}");
    }
    assert_eq!(after(&[2.0; 200]), LEAST_OF_COUNT);
}

/// R grows in the mean where it is a quarter of what is right, and falls where it is four times as large: positions with a
/// known error, and the counts of their noisy ends.
#[test]
fn size_of_the_shifts_finds_the_noise_that_is_there() {
    let mut seed = 1_u32;
    let mut uniform = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (f64::from(seed) + 0.5) / 4_294_967_296.0
    };
    // Of a variance of the position itself, and its noise.
    for (own, noise) in [(1e-4, 0.01), (1e-3, 0.01), (1e-3, 0.2), (1.0, 4.0)] {
        let change = |assumed: f32, uniform: &mut dyn FnMut() -> f64| {
            let mut sum = 0.0;
            for _ in 0..20_000 {
                let mut state = ModelBankState::<2>::start(Count(0), assumed);
                let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
                let mean = uniform();
                let end = mean + normal * f64::from(own + noise).sqrt();
                for member in &mut state.members {
                    member.position = (mean - end.floor() - 0.5) as f32;
                    member.covariance[0] = own;
                }
                state.correct_by_interval(Ends::of(true), true, false);
                sum += f64::from(state.noise / assumed - 1.0);
            }
            sum
        };
        let [low, high] = [0.25, 4.0].map(|factor| change(noise * factor, &mut uniform));
        std::println!("{own} {noise}: {low:.1} {high:.1}");
        assert!(low > 0.0 && high < 0.0, "{own} {noise}: {low} {high}");
    }
}

/// Two innovations of alternating signs raise R by a tenth, a third one of edges in every tick by a share of its
/// variance besides. Innovations of one sign lower R.
#[test]
fn noise_of_a_boundary_grows_where_innovations_alternate() {
    let edge = FreshEdge {
        phase: 0,
        position: 0.0,
        age: 0.0,
    };
    let after = |positions: &[f32], moved: bool| {
        let mut state = ModelBankState::<3>::start(Count(0), 0.01);
        for position in positions {
            for member in &mut state.members {
                *member = Member::START;
                member.position = *position;
            }
            state.correct_by_edge(&edge, Ends::of(true), moved);
        }
        assert_eq!(state.reads_stamps(), state.noise < 0.1);
        state.noise
    };
    let near = |found: f32, expected: f32| {
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    };
    let added = 0.02 * (1.0 / 12.0 + 0.011);
    for moved in [true, false] {
        near(after(&[2.0], moved), 0.01);
        near(after(&[2.0, -2.0], moved), 0.011);
        near(after(&[2.0, 2.0], moved), 0.009);
        near(after(&[2.0, -2.0, -2.0], moved), 0.009 * 1.1);
        assert_eq!(after(&[2.0; 50], moved), 3e-4);
    }
    near(after(&[2.0, -2.0, 2.0], false), 0.0121);
    near(after(&[2.0, -2.0, 2.0], true), 0.0121 + added);
    // A product below the variance counts as it is.
    let grown = 1.0 + 0.1 * 0.01 / (1.0 / 12.0 + 0.01);
    near(
        after(&[0.1, -0.1, 0.1], true),
        0.01 * grown * grown + 0.02 * 0.01,
    );
    assert_eq!(after(&[2.0, -2.0].repeat(20), true), 0.1);
}

/// The count says nothing about members that are in the middle of its interval, and each gets a share of the weights of
/// the others: one change a second, to one of K - 1 others.
#[test]
fn weights_mix_by_the_true_time_of_an_interval() {
    let rate = 1000.0;
    let bank = ModelBank::<3, NoStamps>::new(Hertz(rate)).unwrap();
    for period in [0.5_f32, 1.0, 4.0, 16.0] {
        let mut state = ModelBankState::<3>::start(Count(0), 1e-3);
        for member in &mut state.members {
            member.covariance = [1e-6, 0.0, 0.0, 1e-12, 0.0, 1e-12];
        }
        let weights = [0.5, 0.3, 0.2_f32];
        let likelihoods = weights.map(|weight| Likelihood::new(weight, 0.0));
        state.weigh(&judged(likelihoods, 0.0), 0.0, 1e-3);
        bank.update_over(&mut state, &Sample::new(Count(0)), period);
        let change = f64::from(period) / rate / 2.0;
        for (found, weight) in state.weights().iter().zip(weights) {
            let expected = (f64::from(weight) + change) / (1.0 + 3.0 * change);
            let off = f64::from(*found) - expected;
            assert!(off.abs() < 1e-6, "{period}: {found} {expected}");
        }
    }
}

#[test]
fn two_neighbours_with_the_larger_weights_are_kept() {
    let ladder = Ladder::new(1e-3);
    let mut bank = ModelBankState::<3>::start(Count(0), 1e-3);
    bank.drive(3.0);
    for _ in 0..100 {
        bank.predict(&ladder, 3.0);
        bank.correct_by_interval(Ends::of(true), false, false);
    }
    let weighed = |weights: [f32; 3]| {
        let mut bank = bank;
        let likelihoods = weights.map(|weight| Likelihood::new(weight, 0.0));
        bank.weigh(&judged(likelihoods, 0.0), 0.0, 1e-3);
        bank
    };
    // The variance of a member grows with its process noise, from the first to the last.
    let variance = |weights| weighed(weights).velocity_variance();
    for (weights, kept) in [
        ([0.6, 0.3, 0.1], [2.0 / 3.0, 1.0 / 3.0, 0.0]),
        ([0.1, 0.3, 0.6], [0.0, 1.0 / 3.0, 2.0 / 3.0]),
    ] {
        let narrowed = weighed(weights).narrowed();
        let (found, expected) = (narrowed.velocity_variance(), variance(kept));
        let other = variance([kept[2], kept[1], kept[0]]);
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        assert!((found / other - 1.0).abs() > 0.1, "{found} {other}");
        let velocity = weighed(kept).velocity();
        assert!((narrowed.velocity() - velocity).abs() < 1e-5 * velocity.abs());
    }
}
