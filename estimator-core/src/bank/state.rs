//! State of the bank: members, weights, and where on the ladder they stand.

use super::interval::{Ends, Likelihood};
use super::ladder::{FIRST_RUNG, Predict, RUNGS};
use super::member::{Innovation, Member};
use crate::branch::unlikely;
use crate::design::const_math::limited;
use crate::edge_clock::FreshEdge;
use crate::interval::smaller;
use crate::units::Count;

/// State of a [`ModelBank`](crate::ModelBank).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelBankState<const K: usize> {
    pub(super) anchor: Count,
    /// Time since the last change of the count and the last edge, 1/1024 ticks.
    pub(super) still: u32,
    /// Whether the shaft is at rest.
    pub(super) resting: bool,
    members: [Member; K],
    /// Weights of the members; their sum is 1.
    weights: [f32; K],
    /// Rung of the first member.
    rung: u32,
    /// Variance R of the position of a boundary, counts².
    boundary: f32,
    /// Innovation of the edge before, counts.
    innovation: f32,
}

/// A member with less weight is reset.
const IMPROBABLE: f32 = 0.003;

/// Weight of a member after its reset.
const RESET_WEIGHT: f32 = 0.06;

/// Weight of the outermost member above which the bank moves.
const HEAVY: f32 = 0.9;

/// Standard deviations from which on a measurement surprises a member. If it surprises every member, all
/// covariances are too small, and the likelihoods cannot tell by how much: all innovations are alike.
const SURPRISING: f32 = 8.0;

/// Standard deviations from which on it is an impact, after which velocity and acceleration are other ones.
const IMPACT: f32 = 40.0;

/// Variances of velocity and acceleration after an impact, over the square of the innovation.
const STRUCK: [f32; 2] = [0.1, 0.01];

/// Largest square of an innovation that counts, counts²: the variance of the velocity is then that of the
/// start.
const FARTHEST: f32 = 1e4;

/// Divisor of the likelihood of a measurement that is `deviations` off.
const fn divisor(deviations: f32) -> f32 {
    Likelihood::new(1.0, 0.5 * deviations * deviations).divisor
}

/// Weight of a new member.
const NEW_WEIGHT: f32 = 0.2;

/// R at the start, and its range, counts².
const BOUNDARY: f32 = 1e-3;
const LEAST_BOUNDARY: f32 = 3e-4;
const LARGEST_BOUNDARY: f32 = 0.1;

/// Variance of the position after an edge, over that of the innovation, below which it is rounding: some
/// 30 units in the last place.
const ROUNDING: f32 = 4e-6;

/// What a measurement says about the members.
pub(super) struct Judged<const K: usize> {
    /// Likelihoods, times the root of `variance`.
    pub(super) likelihoods: [Likelihood; K],
    /// Variance of the middle member's innovation, counts²; 1 without an edge.
    pub(super) variance: f32,
    /// Innovation of the last member, counts; without an edge the shift of its position.
    pub(super) off: f32,
}

/// Change of R by an edge.
const BOUNDARY_GAIN: f32 = 0.1;

impl<const K: usize> ModelBankState<K> {
    pub(super) const fn start(anchor: Count) -> Self {
        Self {
            anchor,
            still: 0,
            resting: false,
            members: [Member::START; K],
            weights: [1.0 / K as f32; K],
            rung: FIRST_RUNG,
            boundary: BOUNDARY,
            innovation: 0.0,
        }
    }

    /// The variance R of the position of a boundary, counts², as estimated from the innovations of
    /// edges.
    #[must_use]
    pub const fn boundary_variance(&self) -> f32 {
        self.boundary
    }

    /// The weighted mean of `part` of each member.
    #[inline(always)]
    fn mean(&self, part: impl Fn(&Member) -> f32) -> f32 {
        let mut sum = 0.0;
        for i in 0..K {
            sum += self.weights[i] * part(&self.members[i]);
        }
        sum
    }

    /// Adds the effect of the known acceleration `input` over the tick before, counts/tick².
    #[inline(always)]
    pub(super) fn drive(&mut self, input: f32) {
        for member in &mut self.members {
            member.position += 0.5 * input;
            member.velocity += input;
        }
    }

    /// The mean velocity, counts/tick.
    #[inline(always)]
    pub(super) fn velocity(&self) -> f32 {
        self.mean(|member| member.velocity)
    }

    /// The mean acceleration, counts/tick².
    pub(super) fn acceleration(&self) -> f32 {
        self.mean(|member| member.acceleration)
    }

    /// The variance of the velocity, (counts/tick)²: that of the mixture.
    pub(super) fn velocity_variance(&self) -> f32 {
        let velocity = self.velocity();
        self.mean(|member| {
            let off = member.velocity - velocity;
            member.velocity_variance() + off * off
        })
    }

    /// Sets velocity and acceleration to rest.
    #[inline(always)]
    pub(super) fn stop(&mut self) {
        self.resting = true;
        for member in &mut self.members {
            member.velocity = 0.0;
            member.acceleration = 0.0;
        }
    }

    /// Predicts all members over a tick or another interval, relative to a count that moved by `displacement`.
    #[inline(always)]
    pub(super) fn predict(&mut self, over: &impl Predict, displacement: f32) {
        for i in 0..K {
            over.predict(&mut self.members[i], self.rung as usize + i, displacement);
        }
    }

    /// Corrects all members by an edge and then by the quantisation interval of the count, and R by the
    /// correlation of two innovations.
    #[inline(always)]
    pub(super) fn correct_by_edge(&mut self, edge: &FreshEdge, ends: &Ends) -> Judged<K> {
        let mut innovations = [Innovation::default(); K];
        let (mut error, mut variance) = (0.0, 0.0);
        for i in 0..K {
            let member = &mut self.members[i];
            innovations[i] = member.correct_by_edge(edge, self.boundary);
            // A smaller variance is rounding: the edge alone fixes the position.
            if member.position_variance() > ROUNDING * innovations[i].variance {
                member.correct_by_interval(ends, self.boundary);
            }
            error += self.weights[i] * innovations[i].error;
            variance += self.weights[i] * innovations[i].variance;
        }
        let mut likelihoods = [Likelihood::default(); K];
        let middle = innovations[K / 2].variance;
        for i in 0..K {
            let Innovation {
                error,
                per_variance,
                ..
            } = innovations[i];
            likelihoods[i] = Likelihood::new(
                root(middle * per_variance),
                0.5 * error * error * per_variance,
            );
        }
        let correlation = limited(error * self.innovation / variance, 1.0);
        let boundary = self.boundary * (1.0 - BOUNDARY_GAIN * correlation);
        // Both ends are constants: the panic of `clamp` is removed.
        self.boundary = boundary.clamp(LEAST_BOUNDARY, LARGEST_BOUNDARY);
        self.innovation = error;
        Judged {
            likelihoods,
            variance: middle,
            off: innovations[K - 1].error,
        }
    }

    /// Corrects all members by the quantisation interval of the count, whose ends are known to the
    /// variance `noise` and have truncated `ends` before.
    #[inline(always)]
    pub(super) fn correct_by_interval(&mut self, ends: &Ends, noise: f32) -> Judged<K> {
        let expected = self.members[K - 1].position;
        let mut likelihoods = [Likelihood::default(); K];
        for i in 0..K {
            likelihoods[i] = self.members[i].correct_by_interval(ends, noise);
        }
        Judged {
            likelihoods,
            variance: 1.0,
            off: self.members[K - 1].position - expected,
        }
    }

    /// Updates the weights by the likelihoods, with the probability `change` of a change of q. Returns
    /// the likelihood of the bank.
    #[inline(always)]
    pub(super) fn weigh(&mut self, judged: &Judged<K>, change: f32) -> Likelihood {
        let likelihoods = &judged.likelihoods;
        let mut smallest = likelihoods[0].divisor;
        for likelihood in likelihoods {
            if likelihood.divisor < smallest {
                smallest = likelihood.divisor;
            }
        }
        let mut sum = 0.0;
        for i in 0..K {
            self.weights[i] = (self.weights[i] + change) * likelihoods[i].relative(smallest);
            sum += self.weights[i];
        }
        let per_sum = 1.0 / sum;
        for weight in &mut self.weights {
            *weight *= per_sum;
        }
        if smallest > const { divisor(SURPRISING) } {
            unlikely();
            self.surprise(smallest > const { divisor(IMPACT) }, judged.off);
        }
        Likelihood {
            factor: sum,
            divisor: smallest,
        }
    }

    /// Gives all weight to the last member, which an impact has hit if `is_hit`: the measurement was `off`
    /// counts from where it expected it.
    #[inline(always)]
    fn surprise(&mut self, is_hit: bool, off: f32) {
        self.weights.fill(0.0);
        self.weights[K - 1] = 1.0;
        if is_hit {
            let square = smaller(off * off, FARTHEST);
            let p = &mut self.members[K - 1].covariance;
            p[3] += STRUCK[0] * square;
            p[5] += STRUCK[1] * square;
        }
    }

    /// Resets improbable members.
    #[inline(always)]
    pub(super) fn reset(&mut self) {
        for i in 0..K {
            if self.weights[i] < IMPROBABLE {
                self.members[i] = self.members[self.heaviest()].copied();
                self.weights[i] = RESET_WEIGHT;
            }
        }
    }

    /// The member with the largest weight.
    #[inline(always)]
    fn heaviest(&self) -> usize {
        let mut heaviest = 0;
        for i in 1..K {
            if self.weights[i] > self.weights[heaviest % K] {
                heaviest = i;
            }
        }
        heaviest % K
    }

    /// Moves the bank by a rung if its outermost member is heavy.
    #[inline(always)]
    pub(super) fn follow(&mut self) {
        if self.weights[K - 1] > HEAVY && self.rung as usize + K < RUNGS {
            self.rung += 1;
            for i in 1..K {
                self.members[i - 1] = self.members[i].copied();
                self.weights[i - 1] = self.weights[i];
            }
            self.weights[K - 1] = NEW_WEIGHT;
        } else if self.weights[0] > HEAVY && self.rung > 0 {
            self.rung -= 1;
            for i in (1..K).rev() {
                self.members[i] = self.members[i - 1].copied();
                self.weights[i] = self.weights[i - 1];
            }
            self.weights[0] = NEW_WEIGHT;
        }
    }
}

impl ModelBankState<3> {
    /// The two neighbouring members with the larger weights.
    pub(super) const fn narrowed(&self) -> ModelBankState<2> {
        let first = if self.weights[0] > self.weights[2] {
            0
        } else {
            1
        };
        let [a, b] = [self.weights[first], self.weights[first + 1]];
        let per_sum = 1.0 / (a + b);
        ModelBankState {
            anchor: self.anchor,
            still: self.still,
            resting: self.resting,
            members: [
                self.members[first].copied(),
                self.members[first + 1].copied(),
            ],
            weights: [a * per_sum, b * per_sum],
            rung: self.rung + first as u32,
            boundary: self.boundary,
            innovation: self.innovation,
        }
    }
}

/// √x: the Padé approximant of order [2/2] at 1, to 8 % from 1/10 to 10. The variances of neighbouring
/// members differ by at most a factor of 10.
#[inline(always)]
pub(super) fn root(x: f32) -> f32 {
    let square = x * x;
    (1.0 + 10.0 * x + 5.0 * square) / (5.0 + 10.0 * x + square)
}

#[cfg(test)]
pub(super) mod tests {
    extern crate std;
    use super::{Judged, LEAST_BOUNDARY, ModelBankState, root};
    use crate::bank::interval::{Ends, Likelihood};
    use crate::edge_clock::FreshEdge;
    use crate::filters::draws::draw;
    use crate::units::Count;

    /// What a measurement says that is `off` counts from where the last member expected it.
    pub(in crate::bank) fn judged<const K: usize>(
        likelihoods: [Likelihood; K],
        off: f32,
    ) -> Judged<K> {
        Judged {
            likelihoods,
            variance: 1.0,
            off,
        }
    }

    #[test]
    fn variance_is_that_of_the_mixture() {
        let mut state = ModelBankState::<2>::start(Count(0));
        state.weights = [0.25, 0.75];
        for (member, (velocity, variance)) in
            state.members.iter_mut().zip([(3.0, 0.5), (-1.0, 0.1)])
        {
            member.velocity = velocity;
            member.covariance[3] = variance;
        }
        // Mean 0; 1/4 (1/2 + 9) + 3/4 (1/10 + 1).
        assert_eq!(state.velocity(), 0.0);
        assert!((state.velocity_variance() - 3.2).abs() < 1e-6);
    }

    #[test]
    fn weights_follow_likelihoods_that_f32_cannot_hold() {
        let mut state = ModelBankState::<3>::start(Count(0));
        // exp(-1e6) is far below the smallest f32; the ratio of the last two is that of (1 + x / 16)^-16.
        let likelihoods = [1e6, 40.0, 20.0].map(|x| Likelihood::new(1.0, x));
        state.weigh(&judged(likelihoods, 0.0), 0.0);
        let ratio = (2.25f64 / 3.5).powi(16);
        let expected = [0.0, ratio / (1.0 + ratio), 1.0 / (1.0 + ratio)];
        for (weight, expected) in state.weights.iter().zip(expected) {
            assert!((f64::from(*weight) - expected).abs() < 1e-5, "{weight}");
        }
    }

    #[test]
    fn what_surprises_every_member_moves_the_bank_up() {
        let start = ModelBankState::<3>::start(Count(0));
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
            state.weigh(&judged(likelihoods, -3.0), 1e-3);
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
        let mut state = ModelBankState::<2>::start(Count(0));
        let before = state.members[1].covariance[3];
        state.weigh(
            &judged([1e9; 2].map(|x| Likelihood::new(1.0, x)), 2e9),
            1e-3,
        );
        assert_eq!(state.members[1].covariance[3], before + 1000.0);
    }

    #[test]
    fn a_change_of_the_noise_keeps_every_member_possible() {
        let mut state = ModelBankState::<2>::start(Count(0));
        state.weights = [0.0, 1.0];
        state.weigh(&judged([Likelihood::CERTAIN; 2], 0.0), 0.25);
        assert!((state.weights[0] - 0.25 / 1.5).abs() < 1e-6);
    }

    /// Members of any uncertainty, up to far beyond that of the ladder: the position has the correlation
    /// with the velocity that a tick of white acceleration leaves, or nearly 1 as after many ticks.
    #[test]
    fn an_edge_after_any_uncertainty_leaves_numbers() {
        let mut seed = 5;
        let mut uniform = || (draw(&mut seed) >> 40) as f32 / (1u32 << 24) as f32;
        for _ in 0..200_000 {
            let mut state = ModelBankState::<2>::start(Count(0));
            state.boundary = LEAST_BOUNDARY;
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
            let likelihoods = state.correct_by_edge(&edge, Ends::of(true)).likelihoods;
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
}
