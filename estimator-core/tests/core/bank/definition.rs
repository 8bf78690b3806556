//! The bank by its definition: f64, matrices of the textbook, exact normal probabilities.

use nalgebra::{Matrix3, SMatrix, Vector3};

const TAU: f64 = 0.02;
const WHITE_SHARE: f64 = 0.025;
const LOWEST: f64 = 10.0;
const RUNGS: usize = 18;

/// One Kalman filter over position, velocity and acceleration, in counts and seconds.
#[derive(Clone)]
struct Filter {
    x: Vector3<f64>,
    p: Matrix3<f64>,
}

/// The bank, after the documentation of `ModelBank`.
pub(super) struct Definition {
    filters: Vec<Filter>,
    weights: Vec<f64>,
    rung: usize,
    period: f64,
    stamps: bool,
    noise: f64,
    innovation: f64,
    second_innovation: f64,
    /// How many innovations in a row had the sign of the one before, and how many the opposite one.
    same: u32,
    opposite: u32,
    /// The change of the count in the tick before, and whether it turned back by one in this tick.
    change: f64,
    turned: bool,
    /// Time without a change, periods.
    still: f64,
}

/// Transition and process noise of density 1 over `period` s, by Van Loan's exponential of a block
/// matrix.
fn discretised(period: f64) -> (Matrix3<f64>, Matrix3<f64>) {
    let a = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0 / TAU);
    let q = Matrix3::from_diagonal(&Vector3::new(0.0, WHITE_SHARE * TAU * TAU, 1.0));
    let mut block = SMatrix::<f64, 6, 6>::zeros();
    block.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-a * period));
    block.fixed_view_mut::<3, 3>(0, 3).copy_from(&(q * period));
    block
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&(a.transpose() * period));
    let exponential = block.exp();
    let transition = exponential.fixed_view::<3, 3>(3, 3).transpose();
    let noise = transition * exponential.fixed_view::<3, 3>(0, 3);
    (transition, noise)
}

fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / core::f64::consts::TAU.sqrt()
}

/// Probability of a standard Gaussian below x.
fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x / core::f64::consts::SQRT_2)
}

/// Shift of the mean and factor of the variance of a standard Gaussian within `a` and `b`, and its
/// probability.
fn truncated(a: f64, b: f64) -> (f64, f64, f64) {
    if a > 0.0 {
        let (shift, kept, probability) = truncated(-b, -a);
        return (-shift, kept, probability);
    }
    let probability = below(b) - below(a);
    if b < -8.0 {
        // Far outside: the near end, and an exponential decay beyond it.
        return (b, 1.0 / (b * b), (density(b) / -b).max(1e-300));
    }
    let shift = (density(a) - density(b)) / probability;
    let kept = 1.0 + (a * density(a) - b * density(b)) / probability - shift * shift;
    (shift, kept, probability)
}

/// As [`truncated`], of an interval whose ends have truncated a density before until it filled the interval:
/// each end by what exceeds its truncation at √3 deviations.
fn truncated_again(a: f64, b: f64) -> (f64, f64, f64) {
    let by_end = |u: f64| {
        if u < -8.0 {
            return (-u, 1.0 / (u * u), (density(u) / -u).max(1e-300));
        }
        let shift = density(u) / below(u);
        (shift, 1.0 - shift * (shift + u), below(u))
    };
    let filled = by_end(3f64.sqrt());
    let (mut shift, mut kept, mut probability) = (0.0, 1.0, 1.0);
    for (u, inwards) in [(-a, 1.0), (b, -1.0)] {
        if u < 3f64.sqrt() {
            let end = by_end(u);
            shift += inwards * (end.0 - filled.0);
            kept -= 1.0 - end.1 / filled.1;
            probability *= end.2 / filled.2;
        }
    }
    (shift, kept, probability)
}

/// Standard deviation above which a Gaussian is wider than the interval.
const WIDE: f64 = 0.35;

impl Definition {
    /// Velocities, counts per tick, of a bank of `members` on counts, and on the edges if given:
    /// boundary and age in ticks.
    pub(super) fn run(
        members: usize,
        rate: f64,
        counts: &[f64],
        edges: Option<&[Option<(f64, f64)>]>,
    ) -> Vec<f64> {
        Self::run_over(members, rate, counts, edges, &vec![1.0; counts.len()])
    }

    /// As [`Definition::run`], with each sample `intervals` periods after the one before.
    pub(super) fn run_over(
        members: usize,
        rate: f64,
        counts: &[f64],
        edges: Option<&[Option<(f64, f64)>]>,
        intervals: &[f64],
    ) -> Vec<f64> {
        let filter = Filter {
            x: Vector3::new(counts[0] + 0.5, 0.0, 0.0),
            p: Matrix3::from_diagonal(&Vector3::new(
                1.0 / 12.0,
                1024.0 * rate * rate,
                rate.powi(4),
            )),
        };
        let mut bank = Self {
            filters: vec![filter; members],
            weights: vec![1.0 / members as f64; members],
            rung: 4,
            period: 1.0 / rate,
            stamps: edges.is_some(),
            noise: if edges.is_some() { 1e-3 } else { 1e-5 },
            innovation: 0.0,
            second_innovation: 0.0,
            same: 0,
            opposite: 0,
            change: 0.0,
            turned: false,
            still: 0.0,
        };
        let mut velocities = vec![0.0];
        for tick in 1..counts.len() {
            let edge = edges.and_then(|edges| edges[tick]);
            let change = counts[tick] - counts[tick - 1];
            let changed = change != 0.0;
            bank.turned = change.abs() == 1.0 && bank.change == -change;
            bank.change = change;
            velocities.push(bank.update(counts[tick], changed, edge, intervals[tick]) / rate);
        }
        velocities
    }

    fn update(
        &mut self,
        count: f64,
        changed: bool,
        edge: Option<(f64, f64)>,
        interval: f64,
    ) -> f64 {
        let moved = changed || edge.is_some();
        let rest = (0.3 / self.period).floor();
        let was_at_rest = self.still >= rest;
        let moved_before = self.still == 0.0;
        self.still = if moved { 0.0 } else { self.still + interval };
        if was_at_rest && !moved {
            return 0.0;
        }
        let is_exact = self.stamps && self.noise < 0.1;
        let edge = edge.filter(|_| is_exact);
        self.reset();
        self.shift();
        let (transition, noise) = discretised(interval * self.period);
        let members = self.filters.len();
        let mut likelihoods = Vec::new();
        let (mut error, mut variance) = (0.0, 0.0);
        let mut shifted = 0.0;
        let (mut nearest, mut last) = (f64::INFINITY, 0.0);
        let (mut removed, mut is_inside) = (0.0, true);
        for (i, filter) in self.filters.iter_mut().enumerate() {
            let q = LOWEST * 10f64.powi((self.rung + i) as i32);
            filter.x = transition * filter.x;
            filter.p = transition * filter.p * transition.transpose() + noise * q;
            let mut likelihood = None;
            let mut off = f64::INFINITY;
            if let Some((boundary, age)) = edge {
                let t = age * self.period;
                let h = Vector3::new(1.0, -t, 0.5 * t * t);
                let s = (h.transpose() * filter.p * h)[0] + self.noise;
                let e = boundary - h.dot(&filter.x);
                let k = filter.p * h / s;
                filter.x += k * e;
                filter.p -= k * k.transpose() * s;
                likelihood = Some((1.0 + e * e / (32.0 * s)).powi(-16) / s.sqrt());
                off = e.abs() / s.sqrt();
                last = e;
                error += self.weights[i] * e;
                variance += self.weights[i] * s;
            }
            let deviation = (filter.p[(0, 0)] + self.noise).sqrt();
            let ends = [count, count + 1.0].map(|end| (end - filter.x[0]) / deviation);
            let (shift, kept, probability) = if changed || deviation > WIDE {
                truncated(ends[0], ends[1])
            } else {
                truncated_again(ends[0], ends[1])
            };
            if edge.is_none() {
                let middle = filter.x[0] - (count + 0.5);
                off = if deviation > WIDE {
                    middle.abs() / (deviation * deviation + 1.0 / 12.0).sqrt()
                } else {
                    (middle.abs() - 0.5) / deviation
                };
            }
            nearest = nearest.min(off);
            // Ends farther away than that truncate nothing in the core.
            let reach = if changed { 3.5 } else { 3f64.sqrt() };
            is_inside &= ends[0] < -reach && ends[1] > reach;
            removed += self.weights[i] * (1.0 - kept);
            let k = filter.p.column(0) / deviation;
            shifted += self.weights[i] * deviation * shift;
            if edge.is_none() {
                last = k[0] * shift;
                error += self.weights[i] * deviation * shift;
                variance = deviation * deviation;
            }
            filter.x += k * shift;
            filter.p -= k * k.transpose() * (1.0 - kept);
            likelihoods.push(likelihood.unwrap_or(probability));
        }
        if edge.is_none() && !is_exact && is_inside {
            if moved {
                self.noise = (0.998 * self.noise).max(1e-5);
            }
        } else if edge.is_some() || !is_exact {
            let of_two = self.innovation + 0.5 * self.second_innovation;
            let of_two = (error * of_two / variance).clamp(-1.0, 1.0);
            let correlation = (error * self.innovation / variance).clamp(-1.0, 1.0);
            let is_first = correlation < 0.0 && self.opposite == 0;
            let product = if is_first {
                0.0
            } else {
                correlation * variance
            };
            let turned = if is_first && self.turned {
                (-error * self.innovation).min(0.25)
            } else {
                0.0
            };
            (self.same, self.opposite) = match correlation < 0.0 {
                true => (0, self.opposite + 1),
                false => (self.same + 1, 0),
            };
            self.second_innovation = self.innovation;
            self.innovation = error;
            self.noise = if edge.is_some() {
                let added = if moved_before {
                    0.02 * (-product).max(0.0)
                } else {
                    0.0
                };
                let noise = (self.noise * (1.0 - 0.1 * of_two) + added).clamp(3e-4, 0.1);
                let is_opposed = error * shifted < 0.0 && error * error > 2.0 * variance;
                let contradicts = is_opposed && shifted * shifted > 0.5;
                match contradicts && self.same >= 8 {
                    true => noise.max(shifted * shifted).min(1e4),
                    false => noise,
                }
            } else {
                let size = (error * error / variance).min(1.5) - (0.6 * removed).min(0.5);
                let gain = if size < 0.0 && !moved {
                    0.03 * 0.2
                } else {
                    0.03
                };
                let share = variance.min(self.noise + 0.01);
                let noise = if size > 0.0 && self.same >= 8 {
                    0.95 * self.noise
                } else {
                    self.noise + gain * size * share - 0.02 * product + 0.02 * turned
                };
                noise.clamp(1e-5, 1e4)
            };
        }
        let change = interval * self.period / (members as f64 - 1.0);
        for (weight, likelihood) in self.weights.iter_mut().zip(likelihoods) {
            *weight = (*weight + change) * likelihood;
        }
        let sum: f64 = self.weights.iter().sum();
        for weight in &mut self.weights {
            *weight /= sum;
        }
        if nearest > 8.0 {
            self.weights.fill(0.0);
            self.weights[members - 1] = 1.0;
        }
        if nearest > 40.0 {
            let square = (last * last).min(1e4);
            let p = &mut self.filters[members - 1].p;
            p[(1, 1)] += 0.1 * square / self.period.powi(2);
            p[(2, 2)] += 0.01 * square / self.period.powi(4);
        }
        if self.still >= rest {
            for filter in &mut self.filters {
                filter.x[1] = 0.0;
                filter.x[2] = 0.0;
            }
        }
        let parts = self.weights.iter().zip(&self.filters);
        parts.map(|(weight, filter)| weight * filter.x[1]).sum()
    }

    fn reset(&mut self) {
        let heaviest = (0..self.weights.len())
            .max_by(|&a, &b| self.weights[a].total_cmp(&self.weights[b]))
            .expect("members");
        for i in 0..self.weights.len() {
            if self.weights[i] < 0.003 {
                self.filters[i] = self.filters[heaviest].clone();
                self.weights[i] = 0.06;
            }
        }
    }

    fn shift(&mut self) {
        let last = self.weights.len() - 1;
        if self.weights[last] > 0.9 && self.rung + last + 1 < RUNGS {
            self.rung += 1;
            self.filters.remove(0);
            self.weights.remove(0);
            self.filters.push(self.filters[last - 1].clone());
            self.weights.push(0.2);
        } else if self.weights[0] > 0.9 && self.rung > 0 {
            self.rung -= 1;
            self.filters.pop();
            self.weights.pop();
            self.filters.insert(0, self.filters[0].clone());
            self.weights.insert(0, 0.2);
        }
    }
}
