//! The triple integrator written with `nalgebra`'s matrices, as a textbook has it.

use estimator_core::{Count, Model, NoInput, Sample};
use nalgebra::{Matrix3, RowVector3, Vector3};

use super::{diagonal, to_f32};
use crate::subject::Measured;

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

impl Measured for NalgebraKalman {
    type State = (Count, Vector3<f32>, Matrix3<f32>);

    fn start(&self, first: &Sample) -> Self::State {
        (first.count, Vector3::zeros(), Matrix3::from(self.prior))
    }

    #[inline]
    fn update(&self, (anchor, x, p): &mut Self::State, sample: &Sample) -> f32 {
        let step = (sample.count - *anchor).to_f32();
        *anchor = sample.count;
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
        x[1]
    }
}
