//! The triple integrator by `idsp::kalman`.

use estimator_core::{Count, Model, NoInput, Sample};
use idsp::kalman::{Direct, Estimate, Transition};

use super::{diagonal, to_f32};
use crate::subject::Measured;

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

impl Measured for IdspKalman {
    type State = (Count, Estimate<f32, 3>);

    fn start(&self, first: &Sample) -> Self::State {
        (first.count, Estimate::new([0.0; 3], self.prior))
    }

    #[inline]
    fn update(&self, (anchor, estimate): &mut Self::State, sample: &Sample) -> f32 {
        let step = (sample.count - *anchor).to_f32();
        *anchor = sample.count;
        self.transition.predict(estimate);
        self.observation.correct(estimate, step);
        estimate.state[0] -= step;
        estimate.state[1]
    }
}
