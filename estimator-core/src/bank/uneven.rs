//! Prediction over an interval between samples that is not one tick.

use super::ladder::{Ladder, Predict, WHITE_SHARE};
use super::member::Member;
use crate::interval::{HALVINGS, SHORT};

/// Prediction over an interval that is not one tick.
///
/// The series of F and Q of an interval up to τ/4 are exact to the rounding of an f32. A longer one is
/// halved until it is that short. F and Q of twice an interval are those of the interval and again of
/// the interval:
/// ```text
/// F = F F      Q = F Q Fᵀ + Q
/// ```
pub(super) struct Interval<'a> {
    ladder: &'a Ladder,
    /// F_01.
    length: f32,
    /// F_02, F_12 and F_22.
    position_by_acceleration: f32,
    velocity_by_acceleration: f32,
    left: f32,
    /// Q of q T⁵ = 1: 00, 01, 02, 11, 12, 22.
    noise: [f32; 6],
}

/// Number of terms of a series up to τ/4: the next one is below 1e-8 of the sum.
const TERMS: usize = 9;

/// Coefficients of φ2, the series of F_02.
const POSITION_SERIES: [f32; TERMS] = position_series();

/// Coefficients of the series of Q of the decaying acceleration, in the order of [`Interval::noise`].
const NOISE_SERIES: [[f32; TERMS]; 6] = [
    noise_series(0, 0),
    noise_series(0, 1),
    noise_series(0, 2),
    noise_series(1, 1),
    noise_series(1, 2),
    noise_series(2, 2),
];

const fn position_series() -> [f32; TERMS] {
    let mut series = [0.0; TERMS];
    let mut n = 0;
    while n < TERMS {
        series[n] = (sign(n) / factorial(n + 2)) as f32;
        n += 1;
    }
    series
}

/// The integral of `f_i f_j` over x from 0 to 1, with `f_i = Σ (-s)ⁿ x^(n+2-i) / (n+2-i)!`.
const fn noise_series(i: usize, j: usize) -> [f32; TERMS] {
    let mut series = [0.0; TERMS];
    let mut m = 0;
    while m < TERMS {
        let mut sum = 0.0;
        let mut n = 0;
        while n <= m {
            sum += 1.0 / (factorial(n + 2 - i) * factorial(m - n + 2 - j));
            n += 1;
        }
        series[m] = (sign(m) * sum / (m + 5 - i - j) as f64) as f32;
        m += 1;
    }
    series
}

const fn sign(n: usize) -> f64 {
    if n % 2 == 0 { 1.0 } else { -1.0 }
}

const fn factorial(n: usize) -> f64 {
    let mut product = 1.0;
    let mut k = 2;
    while k <= n {
        product *= k as f64;
        k += 1;
    }
    product
}

fn sum(series: &[f32; TERMS], x: f32) -> f32 {
    let mut sum = 0.0;
    for n in (0..TERMS).rev() {
        sum = sum * x + series[n];
    }
    sum
}

impl<'a> Interval<'a> {
    /// The prediction of `ladder` over `period` ticks.
    pub(super) fn new(ladder: &'a Ladder, period: f32) -> Self {
        let (mut length, mut decay) = (period, period * ladder.rate);
        let mut halvings = 0;
        while decay > SHORT && halvings < HALVINGS {
            (length, decay) = (0.5 * length, 0.5 * decay);
            halvings += 1;
        }
        let mut interval = Self::short(ladder, length, decay);
        for _ in 0..halvings {
            interval.double();
        }
        interval
    }

    /// The prediction over `length` ticks, which are `decay` τ, at most 1/4.
    fn short(ladder: &'a Ladder, length: f32, decay: f32) -> Self {
        let phi2 = sum(&POSITION_SERIES, decay);
        let phi1 = 1.0 - decay * phi2;
        let h = length;
        let [g00, g01, g02, g11, g12, g22] = NOISE_SERIES.map(|series| sum(&series, decay));
        let white = WHITE_SHARE as f32 / (ladder.rate * ladder.rate);
        Self {
            ladder,
            length,
            position_by_acceleration: h * h * phi2,
            velocity_by_acceleration: h * phi1,
            left: 1.0 - decay * phi1,
            noise: [
                h * h * h * (h * h * g00 + white / 3.0),
                h * h * (h * h * g01 + white / 2.0),
                h * h * h * g02,
                h * (h * h * g11 + white),
                h * h * g12,
                h * g22,
            ],
        }
    }

    /// F P Fᵀ + `share` times Q.
    fn transported(&self, p: [f32; 6], share: f32) -> [f32; 6] {
        let (f01, f02, f12, f22) = (
            self.length,
            self.position_by_acceleration,
            self.velocity_by_acceleration,
            self.left,
        );
        let [p00, p01, p02, p11, p12, p22] = p;
        let r00 = p00 + f01 * p01 + f02 * p02;
        let r01 = p01 + f01 * p11 + f02 * p12;
        let r02 = p02 + f01 * p12 + f02 * p22;
        let r11 = p11 + f12 * p12;
        let r12 = p12 + f12 * p22;
        [
            r00 + f01 * r01 + f02 * r02 + share * self.noise[0],
            r01 + f12 * r02 + share * self.noise[1],
            f22 * r02 + share * self.noise[2],
            r11 + f12 * r12 + share * self.noise[3],
            f22 * r12 + share * self.noise[4],
            f22 * f22 * p22 + share * self.noise[5],
        ]
    }

    /// Becomes the prediction over twice the interval.
    fn double(&mut self) {
        self.noise = self.transported(self.noise, 1.0);
        let (f02, f12, f22) = (
            self.position_by_acceleration,
            self.velocity_by_acceleration,
            self.left,
        );
        self.position_by_acceleration = f02 + self.length * f12 + f02 * f22;
        self.velocity_by_acceleration = f12 + f12 * f22;
        self.left = f22 * f22;
        self.length += self.length;
    }
}

impl Predict for Interval<'_> {
    fn predict(&self, member: &mut Member, rung: usize, displacement: f32) {
        let a = member.acceleration;
        member.position +=
            self.length * member.velocity + self.position_by_acceleration * a - displacement;
        member.velocity += self.velocity_by_acceleration * a;
        member.acceleration = self.left * a;
        member.covariance = self.transported(member.covariance, self.ladder.density(rung));
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::Interval;
    use crate::bank::ladder::tests::van_loan;
    use crate::bank::ladder::{CORRELATION_TIME, LOWEST, Ladder, Predict};
    use crate::bank::member::Member;
    use nalgebra::{Matrix3, Vector3};

    const PLACES: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

    /// Predicted state and covariance of a member and those of the textbook, relative errors.
    fn errors(period: f64, interval: f64, rung: usize) -> [f64; 9] {
        let ladder = Ladder::new(period);
        let density = LOWEST * 10f64.powi(i32::try_from(rung).expect("small"));
        // Van Loan's matrix has the inverse of F, which loses its digits over many τ: steps of τ at most.
        let steps = (interval * period / CORRELATION_TIME).ceil();
        let (mut transition, noise) = van_loan(period, interval / steps, density);
        // The exponential rounds these zeros to 1e-17, times a P_00 of 1e7.
        transition.fill_lower_triangle(0.0, 1);
        let p = Matrix3::new(0.3, 0.1, 0.02, 0.1, 0.4, -0.05, 0.02, -0.05, 0.2);
        let x = Vector3::new(0.2, 3.0, 0.7);
        let mut member = Member {
            position: x[0] as f32,
            velocity: x[1] as f32,
            acceleration: x[2] as f32,
            covariance: PLACES.map(|at| p[at] as f32),
        };
        Interval::new(&ladder, interval as f32).predict(&mut member, rung, 0.0);
        let before = x.iter().copied().chain(PLACES.map(|at| p[at]));
        let (mut y, mut after) = (x, p);
        for _ in 0..steps as u32 {
            y = transition * y;
            after = transition * after * transition.transpose() + noise;
        }
        let expected = y.iter().copied().chain(PLACES.map(|at| after[at]));
        let state = [member.position, member.velocity, member.acceleration];
        let found = state.into_iter().chain(member.covariance).map(f64::from);
        let mut errors = [0.0; 9];
        let values = found.zip(expected).zip(before);
        for (error, ((found, expected), before)) in errors.iter_mut().zip(values) {
            // The rounding of what has decayed is that of what it was.
            let scale = expected.abs().max(1e-3 * f64::abs(before));
            *error = (found - expected) / scale;
        }
        errors
    }

    #[test]
    fn prediction_over_any_interval_is_that_of_the_continuous_model() {
        // Below and above a tick, near the ends of the series, and a gap.
        let intervals = [
            0.001, 0.2, 0.7313, 0.999, 1.0, 1.37, 2.5, 3.0, 24.9, 250.1, 1000.0,
        ];
        for period in [1e-2, 1e-3, 1e-4, 1e-5] {
            for interval in intervals {
                for rung in [0, 9, 17] {
                    for error in errors(period, interval, rung) {
                        // 20 doublings at most, each with a few roundings of 6e-8.
                        assert!(error.abs() < 1e-5, "{period} {interval} {rung}: {error}");
                    }
                }
            }
        }
    }

    #[test]
    fn longest_interval_stays_finite() {
        for period in [1e-2, 1e-5] {
            let ladder = Ladder::new(period);
            let mut member = Member::START;
            member.velocity = 1e4;
            Interval::new(&ladder, 1_048_576.0).predict(&mut member, 17, 0.0);
            assert!(
                member.covariance.iter().all(|p| p.is_finite()),
                "{member:?}"
            );
            assert!(member.position == 1e4 * 1_048_576.0);
        }
    }
}
