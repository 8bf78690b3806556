//! The triple integrator by `adskalman`.

use adskalman::{
    CovarianceUpdateMethod::OptimalKalman, KalmanFilterNoControl, ObservationModel,
    StateAndCovariance, TransitionModelLinearNoControl,
};
use estimator_core::{Count, Model, NoInput, Sample};
use nalgebra::{ArrayStorage, Const, Matrix1, Matrix1x3, Matrix3, Matrix3x1, Vector1, Vector3};

use super::{diagonal, to_f32, transposed};
use crate::subject::Measured;

type State = Const<3>;
type Observation = Const<1>;

pub(crate) struct AdsKalman {
    transition: Motion,
    observation: Counted,
    prior: Matrix3<f32>,
}

struct Motion {
    f: Matrix3<f32>,
    transposed: Matrix3<f32>,
    q: Matrix3<f32>,
}

struct Counted {
    h: Matrix1x3<f32>,
    transposed: Matrix3x1<f32>,
    r: Matrix1<f32>,
}

/// Arrays are columns to nalgebra.
const fn matrix(columns: [[f32; 3]; 3]) -> Matrix3<f32> {
    Matrix3::from_array_storage(ArrayStorage(columns))
}

impl AdsKalman {
    /// The filter of `model`.
    pub(crate) const fn new(model: &Model<3, NoInput>) -> Self {
        let a = to_f32(model.transition());
        Self {
            transition: Motion {
                f: matrix(transposed(&a)),
                transposed: matrix(a),
                q: matrix(to_f32(model.process_noise())),
            },
            observation: Counted {
                h: Matrix1x3::from_array_storage(ArrayStorage([[1.0], [0.0], [0.0]])),
                transposed: Matrix3x1::from_array_storage(ArrayStorage([[1.0, 0.0, 0.0]])),
                r: Matrix1::from_array_storage(ArrayStorage([[model.measurement_noise() as f32]])),
            },
            prior: matrix(diagonal(model.prior())),
        }
    }
}

impl TransitionModelLinearNoControl<f32, State> for Motion {
    fn F(&self) -> &Matrix3<f32> {
        &self.f
    }

    fn FT(&self) -> &Matrix3<f32> {
        &self.transposed
    }

    fn Q(&self) -> &Matrix3<f32> {
        &self.q
    }
}

impl ObservationModel<f32, State, Observation> for Counted {
    fn H(&self) -> &Matrix1x3<f32> {
        &self.h
    }

    fn HT(&self) -> &Matrix3x1<f32> {
        &self.transposed
    }

    fn R(&self) -> &Matrix1<f32> {
        &self.r
    }
}

impl Measured for AdsKalman {
    type State = (Count, StateAndCovariance<f32, State>);

    fn start(&self, first: &Sample) -> Self::State {
        let estimate = StateAndCovariance::new(Vector3::zeros(), self.prior);
        (first.count, estimate)
    }

    #[inline]
    fn update(&self, (anchor, estimate): &mut Self::State, sample: &Sample) -> f32 {
        let step = (sample.count - *anchor).to_f32();
        *anchor = sample.count;
        let filter = KalmanFilterNoControl::new(&self.transition, &self.observation);
        // The cheapest of its three updates, and the same algebra as ours.
        if let Ok(next) = filter.step_with_options(estimate, &Vector1::new(step), OptimalKalman) {
            *estimate = next;
        }
        let x = estimate.state_mut();
        x[0] -= step;
        x[1]
    }
}
