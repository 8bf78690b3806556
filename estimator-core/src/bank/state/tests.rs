//! Weights, surprise and corrections of the state.

extern crate std;
use super::noise::LEAST_OF_BOUNDARY;
use super::{Judged, ModelBankState, root};
use crate::bank::interval::{Ends, Likelihood};
use crate::bank::{ModelBank, Stamps};
use crate::edge_clock::FreshEdge;
use crate::estimator::VaryingPeriod;
use crate::filters::draws::draw;
use crate::sample::{Edge, Sample};
use crate::units::{ClockTicks, Count, Hertz};

/// What a measurement says that is `off` counts from where the last member expected it.
pub(in crate::bank) fn judged<const K: usize>(likelihoods: [Likelihood; K], off: f32) -> Judged<K> {
    Judged {
        likelihoods,
        variance: 1.0,
        off,
    }
}

#[test]
fn variance_is_that_of_the_mixture() {
    let mut state = ModelBankState::<2>::start(Count(0), 1e-3);
    state.weights = [0.25, 0.75];
    for (member, (velocity, variance)) in state.members.iter_mut().zip([(3.0, 0.5), (-1.0, 0.1)]) {
        member.velocity = velocity;
        member.covariance[3] = variance;
    }
    // Mean 0; 1/4 (1/2 + 9) + 3/4 (1/10 + 1).
    assert_eq!(state.velocity(), 0.0);
    assert!((state.velocity_variance() - 3.2).abs() < 1e-6);
}

#[test]
fn bank_starts_anew_where_a_likelihood_is_no_number() {
    for (k, factor) in [(0, f32::NAN), (1, f32::NAN), (2, f32::INFINITY), (1, -9.0)] {
        let mut state = ModelBankState::<3>::start(Count(7), 1e-3);
        let expected = state;
        state.rung = 9;
        state.weights = [0.2, 0.5, 0.3];
        state.members[1].velocity = 5.0;
        state.members[2].covariance[0] = -0.1;
        state.noise = f32::NAN;
        state.innovation = 2.0;
        state.signs = -1;
        let mut likelihoods = [Likelihood::CERTAIN; 3];
        likelihoods[k].factor = factor;
        state.weigh(&judged(likelihoods, 0.0), 1e-4, 1e-3);
        assert_eq!(state, expected, "{k} {factor}");
    }
}

#[test]
fn weights_follow_likelihoods_that_f32_cannot_hold() {
    let mut state = ModelBankState::<3>::start(Count(0), 1e-3);
    // exp(-1e6) is far below the smallest f32; the ratio of the last two is that of (1 + x / 16)^-16.
    let likelihoods = [1e6, 40.0, 20.0].map(|x| Likelihood::new(1.0, x));
    state.weigh(&judged(likelihoods, 0.0), 0.0, 1e-3);
    let ratio = (2.25f64 / 3.5).powi(16);
    let expected = [0.0, ratio / (1.0 + ratio), 1.0 / (1.0 + ratio)];
    for (weight, expected) in state.weights.iter().zip(expected) {
        assert!((f64::from(*weight) - expected).abs() < 1e-5, "{weight}");
    }
}

#[test]
fn what_surprises_every_member_moves_the_bank_up() {
    let start = ModelBankState::<3>::start(Count(0), 1e-3);
    // e²/2S; one member that expected the measurement is enough.
    for (deviations, moves, hits) in [
        (7.9f32, false, false),
        (8.1, true, false),
        (39.9, true, false),
        (40.1, true, true),
    ] {
        let x = 0.5 * deviations * deviations;
        let likelihoods = [1e5, x, 2e4].map(|x| Likelihood::new(1.0, x));
        let mut state = start;
        state.weigh(&judged(likelihoods, -3.0), 1e-3, 1e-3);
        assert_eq!(state.weights == [0.0, 0.0, 1.0], moves, "{deviations}");
        // After an impact the last member has 0.1 e² and 0.01 e² more.
        let [before, after] = [start, state].map(|state| state.members[2].covariance);
        let struck = [after[3] - before[3], after[5] - before[5]];
        let expected = if hits { [0.9, 0.09] } else { [0.0, 0.0] };
        for (found, expected) in struck.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-4, "{deviations}: {struck:?}");
        }
        assert_eq!(state.members[1], start.members[1]);
        state.follow();
        assert_eq!(state.rung - start.rung, u32::from(moves), "{deviations}");
    }
}

#[test]
fn farthest_impact_leaves_the_variance_of_the_start() {
    let mut state = ModelBankState::<2>::start(Count(0), 1e-3);
    let before = state.members[1].covariance[3];
    let likelihoods = [1e9; 2].map(|x| Likelihood::new(1.0, x));
    state.weigh(&judged(likelihoods, 2e9), 1e-3, 1e-3);
    assert_eq!(state.members[1].covariance[3], before + 1000.0);
}

/// Without an edge an impact is as far off as the interval moves the last member.
#[test]
fn interval_says_how_far_off_the_last_member_is() {
    let mut state = ModelBankState::<2>::start(Count(0), 1e-3);
    for (member, position) in state.members.iter_mut().zip([0.1, -40.0]) {
        member.position = position;
        member.covariance[0] = 1e-2;
    }
    let off = state.correct_by_interval(Ends::of(true), false, false).off;
    assert_eq!(off, state.members[1].position + 40.0);
    // The nearer end of the interval is 0.5 counts from its middle.
    assert!((30.0..41.0).contains(&off), "{off}");
}

#[test]
fn the_two_members_that_are_left_keep_their_rungs() {
    let mut state = ModelBankState::<3>::start(Count(0), 1e-3);
    state.rung = 5;
    for (weights, rung) in [([0.3, 0.5, 0.2], 5), ([0.2, 0.5, 0.3], 6)] {
        state.weights = weights;
        assert_eq!(state.narrowed().rung, rung);
    }
}

#[test]
fn a_change_of_the_noise_keeps_every_member_possible() {
    let mut state = ModelBankState::<2>::start(Count(0), 1e-3);
    state.weights = [0.0, 1.0];
    state.weigh(&judged([Likelihood::CERTAIN; 2], 0.0), 0.25, 1e-3);
    assert!((state.weights[0] - 0.25 / 1.5).abs() < 1e-6);
}

/// Members of any uncertainty, up to far beyond that of the ladder: the position has the correlation
/// with the velocity that a tick of white acceleration leaves, or nearly 1 as after many ticks.
#[test]
fn an_edge_after_any_uncertainty_leaves_numbers() {
    let mut seed = 5;
    let mut uniform = || (draw(&mut seed) >> 40) as f32 / (1u32 << 24) as f32;
    for _ in 0..200_000 {
        let mut state = ModelBankState::<2>::start(Count(0), 1e-3);
        state.noise = LEAST_OF_BOUNDARY;
        let variance = 10f32.powf(14.0 * uniform() - 6.0);
        let ticks = 10f32.powf(3.0 * uniform());
        let own = variance * uniform();
        for member in &mut state.members {
            // Position = ticks * velocity + another part.
            let velocity = variance / (ticks * ticks);
            member.covariance = [variance + own, ticks * velocity, 0.0, velocity, 0.0, 1e-3];
            member.position = 0.5 * variance.sqrt();
        }
        let edge = FreshEdge {
            phase: 0,
            position: -0.5,
            age: uniform() * uniform(),
        };
        let before = state;
        let likelihoods = state
            .correct_by_edge(&edge, Ends::of(true), true)
            .likelihoods;
        for (member, likelihood) in state.members.iter().zip(likelihoods) {
            let case = std::format!("{edge:?} {:?} {member:?}", before.members[0]);
            let near = 2.0 + edge.age * variance.sqrt();
            assert!(member.position.abs() < near, "{case}");
            let near = 10.0 + 3.0 * variance.sqrt();
            assert!(member.velocity.abs() < near, "{case}");
            assert!(member.acceleration.abs() < near, "{case}");
            assert!(likelihood.factor.is_finite(), "{case}");
        }
    }
}

#[test]
fn root_is_approximated_to_8_percent() {
    let mut x = 0.1f32;
    while x <= 10.0 {
        let off = root(x) / x.sqrt() - 1.0;
        assert!(off.abs() < 0.08, "{x}: {off}");
        x *= 1.01;
    }
}

/// The pivots of Cholesky's decomposition of P.
fn pivots(covariance: [f32; 6]) -> [f64; 3] {
    let [p00, p01, p02, p11, p12, p22] = covariance.map(f64::from);
    let second = p11 - p01 * p01 / p00;
    let cross = p12 - p01 * p02 / p00;
    [p00, second, p22 - p02 * p02 / p00 - cross * cross / second]
}

/// Checks P of all members after every sample of 20 000 constant velocities of up to 100 counts/tick, a third
/// of them 0, for 2 to 500 samples each. The interval between samples is a tick, or 0.3 to 4.3 ticks if
/// `varies`.
fn assert_definite<S: Stamps>(bank: &ModelBank<3, S>, clock: Hertz, rate: Hertz, varies: bool) {
    let mut seed = 5;
    let mut uniform = || (draw(&mut seed) >> 40) as f64 / f64::from(1u32 << 24);
    let mut state = ModelBankState::<3>::start(Count(0), 1e-3);
    let (mut now, mut position) = (0.0, 0.3f64);
    let (mut crossed, mut boundary) = (0.0, 0.0);
    for stretch in 0..20_000 {
        let direction = f64::from((uniform() * 3.0) as u32) - 1.0;
        let velocity = direction * 10f64.powf(5.0 * uniform() - 3.0);
        for _ in 0..(2.0 * 250f64.powf(uniform())) as u32 {
            let period = if varies { 0.3 + 4.0 * uniform() } else { 1.0 };
            let before = position;
            position += velocity * period;
            now += period;
            if before.floor() != position.floor() {
                boundary = position.floor() + if velocity > 0.0 { 0.0 } else { 1.0 };
                crossed = now - (position - boundary) / velocity;
            }
            let edge = Edge {
                boundary: Count(boundary as i64 as u32),
                age: ClockTicks(((now - crossed) * clock.0 / rate.0) as u32),
            };
            let count = Count(position.floor() as i64 as u32);
            let sample = Sample::new(count).with_edge(edge);
            bank.update_over(&mut state, &sample, period as f32);
            for member in &state.members {
                let found = pivots(member.covariance);
                assert!(
                    found.into_iter().all(|pivot| pivot > 0.0),
                    "{rate:?} {stretch} {velocity} {found:?} {member:?}"
                );
            }
        }
    }
}

#[test]
fn covariances_stay_positive_definite() {
    let clock = Hertz(1e8);
    for rate in [1e2, 1e3, 1e4, 1e5].map(Hertz) {
        for varies in [false, true] {
            let counts = ModelBank::new(rate).expect("valid");
            assert_definite(&counts, clock, rate, varies);
            let edges = ModelBank::with_edges(clock, rate).expect("valid");
            assert_definite(&edges, clock, rate, varies);
        }
    }
}
