//! State of the bank: members, weights, and where on the ladder they stand.

mod noise;

use super::interval::{Ends, Likelihood};
use super::ladder::{FIRST_RUNG, Predict, RUNGS};
use super::member::{Innovation, Member};
use crate::branch::unlikely;
use crate::edge_clock::FreshEdge;
use crate::interval::smaller;
use crate::units::{Count, Counts};
pub(super) use noise::LEAST_OF_COUNT;

/// State of a [`ModelBank`](crate::ModelBank).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelBankState<const K: usize> {
    pub(super) anchor: Count,
    /// Time since the last change of the count and the last edge, 1/1024 ticks.
    pub(super) still: u32,
    /// Whether the shaft is at rest.
    pub(super) resting: bool,
    pub(super) members: [Member; K],
    /// Weights of the members; their sum is 1.
    weights: [f32; K],
    /// Rung of the first member.
    rung: u32,
    /// Variance R of the noise of a boundary, or of a count where no stamps are used, counts².
    pub(super) noise: f32,
    /// Innovation of the edge before, or the last shift by a count that was not 0, counts.
    innovation: f32,
    /// Innovation of the edge before that one, counts.
    second_innovation: f32,
    /// How many in a row had the sign of the one before; -1 where it had the opposite one.
    signs: i8,
    /// Change of the count in the tick before if it was one of a single count, else 0.
    heading: i8,
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

/// What a measurement says about the members.
pub(super) struct Judged<const K: usize> {
    /// Likelihoods, times the root of `variance`.
    pub(super) likelihoods: [Likelihood; K],
    /// Variance of the middle member's innovation, counts²; 1 without an edge.
    pub(super) variance: f32,
    /// Innovation of the last member, counts; without an edge the shift of its position.
    pub(super) off: f32,
}

impl<const K: usize> ModelBankState<K> {
    /// The state at the count `anchor`, with the variance R = `noise`.
    pub(super) const fn start(anchor: Count, noise: f32) -> Self {
        Self {
            anchor,
            still: 0,
            resting: false,
            members: [Member::START; K],
            weights: [1.0 / K as f32; K],
            rung: FIRST_RUNG,
            noise,
            innovation: 0.0,
            second_innovation: 0.0,
            signs: 0,
            heading: 0,
        }
    }

    /// Weights of the members after an update; their sum is 1.
    #[must_use]
    pub const fn weights(&self) -> &[f32; K] {
        &self.weights
    }

    /// P_00, P_01, P_02, P_11, P_12 and P_22 of each member, of position, velocity and acceleration in counts and ticks.
    #[must_use]
    pub fn covariances(&self) -> [[f32; 6]; K] {
        self.members.each_ref().map(|member| member.covariance)
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
    /// correlation of the innovation with the two before, by its product with the one before if the tick before
    /// `moved` too, and by the shift of the position.
    #[inline(always)]
    pub(super) fn correct_by_edge(
        &mut self,
        edge: &FreshEdge,
        ends: &Ends,
        moved: bool,
    ) -> Judged<K> {
        let mut innovations = [Innovation::default(); K];
        let (mut error, mut variance, mut shift) = (0.0, 0.0, 0.0);
        for i in 0..K {
            let member = &mut self.members[i];
            innovations[i] = member.correct_by_edge(edge, self.noise);
            shift += self.weights[i] * member.correct_by_interval(ends, self.noise).shift;
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
        self.learn_noise_of_edges(error, variance, shift, moved);
        Judged {
            likelihoods,
            variance: middle,
            off: innovations[K - 1].error,
        }
    }

    /// Takes the change of the count, and returns whether the count turned back: by one, as it came in the tick
    /// before.
    #[inline(always)]
    pub(super) const fn turns(&mut self, displacement: Counts) -> bool {
        let heading = if displacement.0.unsigned_abs() == 1 {
            displacement.0 as i8
        } else {
            0
        };
        let turns = heading * self.heading < 0;
        self.heading = heading;
        turns
    }

    /// Corrects all members by the quantisation interval of the count, whose ends have truncated `ends` before,
    /// and R by the shifts if `learns`.
    #[inline(always)]
    pub(super) fn correct_by_interval(
        &mut self,
        ends: &Ends,
        learns: bool,
        turns: bool,
    ) -> Judged<K> {
        let expected = self.members[K - 1].position;
        let mut likelihoods = [Likelihood::default(); K];
        let (mut shift, mut variance, mut removed) = (0.0, 1.0, 0.0);
        for i in 0..K {
            let correction = self.members[i].correct_by_interval(ends, self.noise);
            likelihoods[i] = correction.likelihood;
            shift += self.weights[i] * correction.shift;
            removed += self.weights[i] * correction.removed;
            variance = correction.variance;
        }
        if learns {
            self.learn_noise_of_counts(shift, variance, removed, turns);
        }
        Judged {
            likelihoods,
            variance: 1.0,
            off: self.members[K - 1].position - expected,
        }
    }

    /// Updates the weights by the likelihoods, with the probability `change` of a change of q. Returns
    /// the likelihood of the bank. A bank that starts anew has R = `noise`.
    #[inline(always)]
    pub(super) fn weigh(&mut self, judged: &Judged<K>, change: f32, noise: f32) -> Likelihood {
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
        if !(per_sum > 0.0) {
            unlikely();
            return self.restart(noise);
        }
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

    /// Starts anew: the weights are no numbers. With definite covariances no input is known that leads here.
    #[inline(always)]
    fn restart(&mut self, noise: f32) -> Likelihood {
        for member in &mut self.members {
            *member = Member::START.copied();
        }
        self.weights = [1.0 / K as f32; K];
        self.rung = FIRST_RUNG;
        self.noise = noise;
        self.innovation = 0.0;
        self.second_innovation = 0.0;
        self.signs = 0;
        Likelihood::CERTAIN
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
            noise: self.noise,
            innovation: self.innovation,
            second_innovation: self.second_innovation,
            signs: self.signs,
            heading: self.heading,
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
pub(super) mod tests;
