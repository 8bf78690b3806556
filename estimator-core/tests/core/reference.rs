//! Kalman filtering from its definitions, in f64: nothing here looks at the core's code.
//!
//! Units are counts, ticks and ampere. With `s` counts per radian and period T a velocity of
//! 1 count per tick is `1 / (s T)` rad/s.

use estimator_core::MotorModel;
use nalgebra::{SMatrix, SVector};

/// Variance of a uniform error of one count.
pub(crate) const R: f64 = 1.0 / 12.0;

/// A priori standard deviations: half-known position, 32 counts per tick, 1 count per tick².
pub(crate) const PRIOR: [f64; 3] = [R, 32.0 * 32.0, 1.0];

pub(crate) type Matrix<const S: usize> = SMatrix<f64, S, S>;
pub(crate) type Vector<const S: usize> = SVector<f64, S>;

/// `x = A x + B u + w`, `y = x_0 + n`.
#[derive(Clone)]
pub(crate) struct Reference<const S: usize> {
    pub(crate) a: Matrix<S>,
    pub(crate) b: Vector<S>,
    pub(crate) q: Matrix<S>,
    pub(crate) p0: Matrix<S>,
}

fn counts_per_rad(counts_per_rev: u32) -> f64 {
    f64::from(counts_per_rev) / std::f64::consts::TAU
}

/// White jerk of density ρ into three integrators: Van Loan's matrix exponential.
pub(crate) fn triple(counts_per_rev: u32, rate: f64, density: f64) -> Reference<3> {
    // One tick is the unit of time: a density per √Hz takes T³ for the jerk and √(1/T) for the Hz.
    let jerk = density * counts_per_rad(counts_per_rev) * rate.powf(-2.5);
    let f = Matrix::<3>::new(0., 1., 0., 0., 0., 1., 0., 0., 0.);
    let mut block = Matrix::<6>::zeros();
    block.fixed_view_mut::<3, 3>(0, 0).copy_from(&-f);
    block.fixed_view_mut::<3, 3>(3, 3).copy_from(&f.transpose());
    block[(2, 5)] = 1.0;
    let exponential = block.exp();
    let a = exponential.fixed_view::<3, 3>(3, 3).transpose();
    let q = a * exponential.fixed_view::<3, 3>(0, 3) * (jerk * jerk);
    Reference {
        a,
        b: Vector::zeros(),
        q: (q + q.transpose()) / 2.0,
        p0: Matrix::from_diagonal(&Vector::from(PRIOR)),
    }
}

/// The exact transition of `[θ, ω, i]` over a tick in which the current is held.
fn motor_transition(device: &MotorModel, rate: f64) -> Matrix<3> {
    let t = 1.0 / rate;
    let pull = counts_per_rad(device.counts_per_rev) * device.torque_constant * t * t;
    Matrix::<3>::new(
        0.0,
        1.0,
        0.0,
        0.0,
        -device.damping * t / device.inertia,
        pull / device.inertia,
        0.0,
        0.0,
        0.0,
    )
    .exp()
}

/// Eq. 16 as printed: state `[θ, ω, i]`; the third row of A is zero and the measured current
/// enters it as an input, with the error of its measurement as the only process noise.
pub(crate) fn motor(device: &MotorModel, rate: f64, current_noise: f64) -> Reference<3> {
    let mut a = motor_transition(device, rate);
    a.row_mut(2).fill(0.0);
    let mut q = Matrix::zeros();
    q[(2, 2)] = current_noise * current_noise;
    let mut p0 = Matrix::from_diagonal(&Vector::from(PRIOR));
    p0[(2, 2)] = q[(2, 2)];
    Reference {
        a,
        b: Vector::z(),
        q,
        p0,
    }
}

/// The motor model without its third state, for what needs a square Q: gains and bounds.
pub(crate) fn motor_reduced(device: &MotorModel, rate: f64, current_noise: f64) -> Reference<2> {
    let a = motor_transition(device, rate);
    let b = Vector::<2>::new(a[(0, 2)], a[(1, 2)]);
    Reference {
        a: a.fixed_view::<2, 2>(0, 0).into_owned(),
        b,
        q: b * b.transpose() * (current_noise * current_noise),
        p0: Matrix::from_diagonal(&Vector::<2>::new(PRIOR[0], PRIOR[1])),
    }
}

impl<const S: usize> Reference<S> {
    /// Covariance after a prediction.
    pub(crate) fn predicted(&self, p: &Matrix<S>) -> Matrix<S> {
        self.a * p * self.a.transpose() + self.q
    }

    /// Gain for a predicted covariance: its innovation covariance is that of the prediction.
    pub(crate) fn gain(p: &Matrix<S>) -> Vector<S> {
        p.column(0) / (p[(0, 0)] + R)
    }

    /// Covariance after an update, in Joseph's form.
    pub(crate) fn updated(p: &Matrix<S>, k: &Vector<S>) -> Matrix<S> {
        let mut left = Matrix::<S>::identity();
        left.column_mut(0).zip_apply(k, |cell, k| *cell -= k);
        left * p * left.transpose() + k * k.transpose() * R
    }

    /// The gains of the first `ticks` ticks.
    pub(crate) fn gains(&self, ticks: usize) -> Vec<Vector<S>> {
        let mut p = self.p0;
        let tick = |_| {
            let predicted = self.predicted(&p);
            let k = Self::gain(&predicted);
            p = Self::updated(&predicted, &k);
            k
        };
        (0..ticks).map(tick).collect()
    }

    /// The gain where the plain recursion stops changing: by less than 1e-9 while the number of
    /// ticks doubled. With it the doubling that showed it; `None` after 2^20 ticks.
    pub(crate) fn settled(&self) -> Option<(Vector<S>, u32)> {
        let mut p = self.q;
        let mut earlier = Self::gain(&p);
        let mut tick = 1;
        for doubling in 1..=20 {
            while tick < 1usize << doubling {
                p = self.predicted(&Self::updated(&p, &Self::gain(&p)));
                tick += 1;
            }
            let k = Self::gain(&p);
            let moved = (k - earlier).abs() - earlier.abs() * 1e-9;
            if doubling >= 4 && moved.max() <= 0.0 {
                return Some((k, doubling));
            }
            earlier = k;
        }
        None
    }

    /// The gain in the limit, of a filter that has one within reach.
    pub(crate) fn steady_gain(&self) -> Vector<S> {
        self.settled().expect("settles").0
    }

    /// `(I - K H) A`: how an error of the state goes on to the next tick.
    pub(crate) fn closed_loop(&self, k: &Vector<S>) -> Matrix<S> {
        self.a - k * self.a.row(0)
    }

    /// Largest magnitude of an eigenvalue of the closed loop.
    pub(crate) fn spectral_radius(&self, k: &Vector<S>) -> f64 {
        let m = self.closed_loop(k);
        let m = nalgebra::DMatrix::from_iterator(S, S, m.iter().copied());
        let magnitudes = m.complex_eigenvalues().map(|value| value.norm());
        magnitudes.max()
    }

    /// How the velocity after the last of `gains` depends on each displacement and each current.
    ///
    /// Relative to the newest count the state goes `x = (I - K H)(A x + B i) + (K - H^T) step`.
    pub(crate) fn response(&self, gains: &[Vector<S>]) -> (Vec<f64>, Vec<f64>) {
        let mut row = Vector::<S>::zeros().transpose();
        row[1] = 1.0;
        let mut to_steps = Vec::new();
        let mut to_currents = Vec::new();
        for k in gains.iter().rev() {
            let mut inflow = *k;
            inflow[0] -= 1.0;
            to_steps.push((row * inflow)[0]);
            let mut left = Matrix::<S>::identity();
            left.column_mut(0).zip_apply(k, |cell, k| *cell -= k);
            row *= left;
            to_currents.push((row * self.b)[0]);
            row *= self.a;
        }
        to_steps.reverse();
        to_currents.reverse();
        (to_steps, to_currents)
    }
}
