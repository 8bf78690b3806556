//! Other libraries' filters on the same model, with the same tuning, in the same frame: positions
//! relative to the newest count, so that f32 suffices.

use estimator_core::{Count, CountsPerTick, Model, NoInput, Sample, Signals, VelocityEstimator};
use idsp::kalman::{Direct, Estimate, Transition};
use nalgebra::{Matrix3, RowVector3, Vector3};

const fn to_f32(m: &[[f64; 3]; 3]) -> [[f32; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            out[i][j] = m[i][j] as f32;
            j += 1;
        }
        i += 1;
    }
    out
}

const fn diagonal(d: &[f64; 3]) -> [[f32; 3]; 3] {
    let [x, v, a] = *d;
    to_f32(&[[x, 0.0, 0.0], [0.0, v, 0.0], [0.0, 0.0, a]])
}

/// The triple integrator by `idsp::kalman`.
pub(crate) struct IdspKalman {
    transition: Transition<f32, 3>,
    observation: Direct<f32, 0>,
    prior: [[f32; 3]; 3],
}

impl IdspKalman {
    /// The filter of `model`.
    pub(crate) const fn new(model: &Model<3, NoInput>) -> Self {
        let (a, q) = (to_f32(model.transition()), to_f32(model.process_noise()));
        Self {
            transition: Transition::new(a, q),
            observation: Direct::new(model.measurement_noise() as f32),
            prior: diagonal(model.prior()),
        }
    }
}

impl VelocityEstimator for IdspKalman {
    type State = (Count, Estimate<f32, 3>);
    type Output = CountsPerTick;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> Self::State {
        (first.large, Estimate::new([0.0; 3], self.prior))
    }

    #[inline]
    fn update(&self, (anchor, estimate): &mut Self::State, sample: &Sample) -> CountsPerTick {
        let step = (sample.large - *anchor).to_f32();
        *anchor = sample.large;
        self.transition.predict(estimate);
        self.observation.correct(estimate, step);
        estimate.state[0] -= step;
        CountsPerTick(estimate.state[1])
    }
}

/// The triple integrator written with `nalgebra`'s matrices, as a textbook has it.
pub(crate) struct NalgebraKalman {
    a: [[f32; 3]; 3],
    q: [[f32; 3]; 3],
    r: f32,
    prior: [[f32; 3]; 3],
}

impl NalgebraKalman {
    /// The filter of `model`.
    pub(crate) const fn new(model: &Model<3, NoInput>) -> Self {
        Self {
            a: to_f32(model.transition()),
            q: to_f32(model.process_noise()),
            r: model.measurement_noise() as f32,
            prior: diagonal(model.prior()),
        }
    }
}

impl VelocityEstimator for NalgebraKalman {
    type State = (Count, Vector3<f32>, Matrix3<f32>);
    type Output = CountsPerTick;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> Self::State {
        (first.large, Vector3::zeros(), Matrix3::from(self.prior))
    }

    #[inline]
    fn update(&self, (anchor, x, p): &mut Self::State, sample: &Sample) -> CountsPerTick {
        let step = (sample.large - *anchor).to_f32();
        *anchor = sample.large;
        // Arrays are columns to nalgebra.
        let a = Matrix3::from(self.a).transpose();
        let h = RowVector3::new(1.0, 0.0, 0.0);
        *x = a * *x;
        *p = a * *p * a.transpose() + Matrix3::from(self.q);
        let s = (h * *p * h.transpose())[0] + self.r;
        let k = *p * h.transpose() / s;
        *x += k * (step - (h * *x)[0]);
        *p = (Matrix3::identity() - k * h) * *p;
        x[0] -= step;
        CountsPerTick(x[1])
    }
}
