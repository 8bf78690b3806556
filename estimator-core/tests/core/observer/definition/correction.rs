//! What a count or an edge says, and what that corrects.

use nalgebra::{Matrix2, Matrix3, Vector3};

use estimator_core::Sample;

use super::super::CLOCK;
use super::learner::factors;
use super::{Definition, Gain, Kind};

impl Definition {
    /// Innovation, age, part of it that the position takes, gap, and gain, if there is one.
    pub(super) fn innovation(
        &mut self,
        from: f64,
        lead: f64,
        gained: f64,
        rests: bool,
        sample: &Sample,
    ) -> Option<(f64, f64, f64, f64, Gain)> {
        let x = from + lead;
        let outside = (x.abs() > 0.5).then_some(if x > 0.0 { 0.5 - x } else { -0.5 - x });
        match self.kind {
            Kind::CountUpdate => {
                self.gap += 1.0;
                let e = outside?;
                let gap = std::mem::take(&mut self.gap);
                self.waited = gap;
                Some((e, 0.0, 1.0, gap, self.gain(gap)))
            }
            Kind::EdgeUpdate => {
                self.gap += 1.0;
                self.alone += 1.0;
                let edge = sample.edge.and_then(|edge| {
                    let age = f64::from(edge.age.0) * self.rate / CLOCK.0;
                    let above = (edge.boundary - sample.count).0;
                    (age < 1.0 && (0..=1).contains(&above)).then_some((edge.boundary.0, above, age))
                });
                let Some((boundary, above, age)) = edge else {
                    let e = outside?;
                    self.waited = std::mem::take(&mut self.alone);
                    let gap = self.waited + self.unstamped;
                    return Some((e, 0.0, 1.0, 0.0, self.gain(gap)));
                };
                let gap = self.gap - age;
                (self.gap, self.alone) = (age, age);
                self.waited = gap;
                let f = 1.0 - age;
                let there = from + lead * f - gained * f * (1.0 - f) / 2.0;
                let offset = &mut self.offsets[boundary as usize % 4];
                let e = f64::from(above) - 0.5 + *offset - there;
                *offset = (*offset - 0.02 * e).clamp(-0.25, 0.25);
                let gain = self.gain(gap);
                Some((e, age, gain.k[0], gap, gain))
            }
            Kind::Quantised => {
                self.gap += 1.0;
                if rests && outside.is_none() {
                    // p stays, g = 0, s = w.
                    self.covariance = Matrix2::new(self.covariance[(0, 0)], 0.0, 0.0, self.white);
                    return None;
                }
                let (phi0, phi1) = (self.a[(1, 1)], self.a[(0, 1)]);
                let a = Matrix2::new(1.0, phi1, 0.0, phi0);
                let w = self.white;
                let q = Matrix2::new(w / 3.0, w / 2.0, w / 2.0, w);
                self.covariance = a * self.covariance * a.transpose() + q;
                let p = self.covariance[(0, 0)];
                let g = self.covariance[(0, 1)] / p;
                let s = self.covariance[(1, 1)] - g * g * p;
                self.started |= s < 64.0 * w;
                let r = self.boundary * self.boundary;
                let variance = p + r;
                self.sigma = (self.sigma + variance / self.sigma) / 2.0;
                let blur = r / (self.sigma * self.sigma);
                let h = 3.0 * self.sigma;
                let y = x.abs() - 0.5;
                let (inwards, kept) = if y < -h {
                    return None;
                } else if y > h {
                    (y, 0.0)
                } else if h > x.abs() + 0.5 {
                    (x.abs() * (1.0 - 0.5 / h), 0.5 / h)
                } else {
                    ((y + h) * (y + h) / (4.0 * h), (h - y) / (2.0 * h))
                };
                let e = -inwards * x.signum() * (1.0 - blur);
                let left = kept + (1.0 - kept) * blur;
                let p = p * left;
                self.covariance = Matrix2::new(p, g * p, g * p, s + g * g * p);
                // From above, so that Newton's next step falls to the root.
                self.sigma *= 0.5 + 0.5 * left;
                if kept == 0.0 {
                    self.sigma = 1.25 * self.boundary;
                }
                let steady = self.gain(1.0).k;
                let disturbance = if self.started {
                    g * steady[2] / steady[1]
                } else {
                    0.0
                };
                let k = Vector3::new(1.0 - blur, g, disturbance);
                let gap = if outside.is_some() {
                    std::mem::take(&mut self.gap)
                } else {
                    0.0
                };
                let gap = if self.started { gap } else { 0.0 };
                Some((
                    e,
                    0.0,
                    1.0,
                    gap,
                    Gain {
                        k,
                        variance,
                        velocity: f64::NAN,
                    },
                ))
            }
        }
    }

    pub(super) fn correct(&mut self, (e, age, position, gap, gain): (f64, f64, f64, f64, Gain)) {
        let within = e.clamp(-65_536.0, 65_536.0);
        let mut k = gain.k;
        let starting = self
            .learner
            .as_mut()
            .and_then(|l| l.starting(e, gap, k[1], self.x[1]));
        if let Some(velocity) = starting {
            k = Vector3::new(k[0], velocity, 0.0);
        }
        let wide = self.learner.as_ref().is_some_and(|l| l.span.wide);
        let edges = self.kind == Kind::EdgeUpdate;
        // A model that may be wrong does not explain more than four standard deviations.
        if wide && edges && starting.is_none() && e.abs() > 4.0 * gain.variance.sqrt() {
            k[1] = k[1].max(1.0 / self.waited.max(1.0));
        }
        let to_position = position + age * k[1];
        self.x[0] += to_position * e;
        self.x[1] += k[1] * within;
        self.x[2] += (1.0 - self.share) * k[2] * within;
        self.friction_correction -= self.share * k[2] * within * self.mean_direction;
        self.friction_correction = self
            .friction_correction
            .clamp(-0.5 * self.friction, 0.5 * self.friction);
        let slow = self.is_slow(self.x[1]);
        let rate = self.rate;
        let Some(learner) = &mut self.learner else {
            return;
        };
        let k = Vector3::new(to_position, k[1], k[2]);
        let h = (learner.sensitivity.row(0) - learner.sensitivity.row(1) * age).transpose();
        learner.sensitivity -= k * h.transpose();
        // In the wide range a count without its edge is learned from too.
        let gap = if learner.span.wide { self.waited } else { gap };
        learner.waiting += gap;
        let early = edges && learner.waiting < 3.5e-3 * rate;
        if learner.is_moving() || gap == 0.0 || early || slow {
            return;
        }
        let (mut d, u) = factors(&learner.p);
        for j in 0..3 {
            let prior = learner.span.prior[j].powi(2);
            d[j] = (d[j] + 0.01 * prior * learner.waiting / rate).min(prior);
        }
        learner.waiting = 0.0;
        let p = u * Matrix3::from_diagonal(&d) * u.transpose();
        let caution = if edges { 2.0 } else { 8.0 };
        let to_p = p * h;
        // Heavy tails, where the model may be wrong.
        let tail = if wide { within * within / 4.0 } else { 0.0 };
        let k = to_p / (h.dot(&to_p) + caution * gain.variance + tail);
        learner.p = p - k * to_p.transpose();
        let mut change = Vector3::zeros();
        let span = &learner.span;
        for j in 0..3 {
            let before = learner.parameters[j];
            learner.parameters[j] = (before + k[j] * within).clamp(span.least[j], span.most[j]);
            change[j] = learner.parameters[j] - before;
        }
        self.x += learner.sensitivity * change;
    }
}
