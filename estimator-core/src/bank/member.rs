//! One filter of the bank, and its corrections.

use super::interval::{Ends, Likelihood, truncate};
use crate::edge_clock::FreshEdge;

/// Least variance of an end of the quantisation interval, counts²: no encoder is more exact. Without it the
/// position becomes so certain that a change of velocity looks like an impact.
const LEAST_NOISE: f32 = 1e-6;

/// Share of a variance that a correction leaves at least: some 16 units in the last place. It is more than
/// what rounding takes from a determinant, and P stays positive definite.
const ROUNDING: f32 = 1e-6;
/// Factor of a variance that adds this share.
const KEPT: f32 = 1.0 + ROUNDING;

/// State and covariance of one filter, in counts and ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Member {
    /// Position from the middle of the quantisation interval of the newest count.
    pub(super) position: f32,
    pub(super) velocity: f32,
    pub(super) acceleration: f32,
    /// P_00, P_01, P_02, P_11, P_12, P_22.
    pub(super) covariance: [f32; 6],
}

/// What the quantisation interval says about a member.
#[derive(Clone, Copy, Debug)]
pub(super) struct Correction {
    /// Probability of the interval.
    pub(super) likelihood: Likelihood,
    /// Shift of the position with its noise, counts; 0 inside the interval.
    pub(super) shift: f32,
    /// Variance of the position with its noise, counts².
    pub(super) variance: f32,
    /// Part of this variance that the interval removes, 0 to 1; 0 inside.
    pub(super) removed: f32,
}

/// Innovation of an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Innovation {
    /// e, counts.
    pub(super) error: f32,
    /// S, counts².
    pub(super) variance: f32,
    /// 1 / S.
    pub(super) per_variance: f32,
}

impl Member {
    /// Somewhere in the interval, with a standard deviation of 32 counts a tick and of 1 count a tick².
    pub(super) const START: Self = Self {
        position: 0.0,
        velocity: 0.0,
        acceleration: 0.0,
        covariance: [1.0 / 12.0, 0.0, 0.0, 1024.0, 0.0, 1.0],
    };

    /// The member itself. An assignment calls a routine that copies, whose length no bound of the
    /// instructions knows; this one moves numbers.
    #[inline(always)]
    pub(super) const fn copied(&self) -> Self {
        let [p00, p01, p02, p11, p12, p22] = self.covariance;
        Self {
            position: self.position,
            velocity: self.velocity,
            acceleration: self.acceleration,
            covariance: [p00, p01, p02, p11, p12, p22],
        }
    }

    /// Variance of the velocity, (counts/tick)².
    pub(super) const fn velocity_variance(&self) -> f32 {
        self.covariance[3]
    }

    /// Corrects the state by `error` / `1/per_variance` times its covariances with a measurement, and
    /// removes the part `removed` of what the measurement explains from P.
    #[inline(always)]
    fn correct(&mut self, covariances: [f32; 3], per_variance: f32, error: f32, removed: f32) {
        let [c0, c1, c2] = covariances;
        let step = error * per_variance;
        self.position += c0 * step;
        self.velocity += c1 * step;
        self.acceleration += c2 * step;
        let share = removed * per_variance;
        let [k0, k1, k2] = [c0 * share, c1 * share, c2 * share];
        let p = &mut self.covariance;
        p[0] -= k0 * c0;
        p[1] -= k0 * c1;
        p[2] -= k0 * c2;
        p[3] = p[3] * KEPT - k1 * c1;
        p[4] -= k1 * c2;
        p[5] -= k2 * c2;
    }

    /// Corrects by the position of the shaft at the instant of an edge, known to the variance
    /// `boundary`.
    #[inline(always)]
    pub(super) fn correct_by_edge(&mut self, edge: &FreshEdge, boundary: f32) -> Innovation {
        let t = edge.age;
        let half = 0.5 * t * t;
        let [p00, p01, p02, p11, p12, p22] = self.covariance;
        let c0 = p00 - t * p01 + half * p02;
        let c1 = p01 - t * p11 + half * p12;
        let c2 = p02 - t * p12 + half * p22;
        let variance = c0 - t * c1 + half * c2 + (boundary + ROUNDING * p00);
        let per_variance = 1.0 / variance;
        let error = edge.position - (self.position - t * self.velocity + half * self.acceleration);
        self.correct([c0, c1, c2], per_variance, error, 1.0);
        Innovation {
            error,
            variance,
            per_variance,
        }
    }

    /// Corrects by the knowledge that the position with a noise of the variance `noise` lies in its quantisation
    /// interval, whose ends have truncated `ends` before.
    #[inline(always)]
    pub(super) fn correct_by_interval(&mut self, ends: &Ends, noise: f32) -> Correction {
        let [p00, p01, p02, ..] = self.covariance;
        let variance = p00 * KEPT + LEAST_NOISE + noise;
        let Some(truncated) = truncate(self.position, variance, ends) else {
            return Correction {
                likelihood: Likelihood::CERTAIN,
                shift: 0.0,
                variance,
                removed: 0.0,
            };
        };
        let per_variance = 1.0 / variance;
        let removed = 1.0 - truncated.kept;
        self.correct([p00, p01, p02], per_variance, truncated.shift, removed);
        Correction {
            likelihood: truncated.likelihood,
            shift: truncated.shift,
            variance,
            removed,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::Member;
    use crate::bank::interval::Ends;
    use crate::edge_clock::FreshEdge;
    use nalgebra::{Matrix3, RowVector3, Vector3};

    #[test]
    fn correction_by_an_edge_is_that_of_the_textbook() {
        let p = Matrix3::new(0.3, 0.1, 0.02, 0.1, 0.4, -0.05, 0.02, -0.05, 0.2);
        let x = Vector3::new(0.2, 3.0, -0.7);
        for (position, age, boundary) in [(0.5, 0.0, 1e-3), (-0.5, 0.25, 1e-3), (0.5, 0.9, 0.1)] {
            let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
            let mut member = Member {
                position: x[0] as f32,
                velocity: x[1] as f32,
                acceleration: x[2] as f32,
                covariance: places.map(|at| p[at] as f32),
            };
            let edge = FreshEdge {
                phase: 0,
                position,
                age,
            };
            let innovation = member.correct_by_edge(&edge, boundary);
            let t = f64::from(age);
            let h = RowVector3::new(1.0, -t, 0.5 * t * t);
            let s = (h * p * h.transpose())[0] + f64::from(boundary);
            let e = f64::from(position) - (h * x)[0];
            let k = p * h.transpose() / s;
            let close = |found: f32, expected: f64| (f64::from(found) - expected).abs() < 1e-5;
            assert!(close(innovation.error, e) && close(innovation.variance, s));
            assert!(close(innovation.per_variance * innovation.variance, 1.0));
            let after = x + k * e;
            assert!(close(member.position, after[0]));
            assert!(close(member.velocity, after[1]));
            assert!(close(member.acceleration, after[2]));
            let after = p - k * s * k.transpose();
            for (found, at) in member.covariance.iter().zip(places) {
                assert!(close(*found, after[at]), "{at:?}");
            }
        }
    }

    #[test]
    fn variance_of_any_position_is_positive_after_its_interval() {
        let mut variance = 1e-6f32;
        while variance < 1e8 {
            let mut member = Member::START;
            member.covariance[0] = variance;
            member.correct_by_interval(Ends::of(true), 0.0);
            let left = member.covariance[0];
            assert!(
                left > 0.0 && left < 0.1 + 2e-6 * variance,
                "{variance}: {left}"
            );
            variance *= 1.01;
        }
    }
}
