//! The triple integrator by `minikalman`.

use estimator_core::{Count, Model, NoInput, Sample};
use minikalman::buffers::types::{
    DirectProcessNoiseCovarianceMatrixBuffer, EstimateCovarianceMatrixBuffer,
    InnovationCovarianceMatrixBuffer, InnovationVectorBuffer, KalmanGainMatrixBuffer,
    MeasurementNoiseCovarianceMatrixBuffer, MeasurementVectorBuffer, ObservationMatrixBuffer,
    PredictedStateEstimateVectorBuffer, StateTransitionMatrixBuffer, StateVectorBuffer,
    TemporaryHPMatrixBuffer, TemporaryKHPMatrixBuffer, TemporaryPHTMatrixBuffer,
    TemporaryResidualCovarianceInvertedMatrixBuffer, TemporaryStateMatrixBuffer,
};
use minikalman::prelude::{MatrixDataArray, RowMajorSequentialData, RowMajorSequentialDataMut};
use minikalman::regular::{
    RegularKalman, RegularKalmanBuilder, RegularObservation, RegularObservationBuilder,
};

use super::{diagonal, to_f32};
use crate::subject::Measured;

type Scalar = MatrixDataArray<1, 1, 1, f32>;
type Row = MatrixDataArray<1, 3, 3, f32>;
type Column = MatrixDataArray<3, 1, 3, f32>;
type Square = MatrixDataArray<3, 3, 9, f32>;

type Filter = RegularKalman<
    3,
    f32,
    StateTransitionMatrixBuffer<3, f32, Square>,
    StateVectorBuffer<3, f32, Column>,
    EstimateCovarianceMatrixBuffer<3, f32, Square>,
    DirectProcessNoiseCovarianceMatrixBuffer<3, f32, Square>,
    PredictedStateEstimateVectorBuffer<3, f32, Column>,
    TemporaryStateMatrixBuffer<3, f32, Square>,
>;

type Observation = RegularObservation<
    3,
    1,
    f32,
    ObservationMatrixBuffer<1, 3, f32, Row>,
    MeasurementVectorBuffer<1, f32, Scalar>,
    MeasurementNoiseCovarianceMatrixBuffer<1, f32, Scalar>,
    InnovationVectorBuffer<1, f32, Scalar>,
    InnovationCovarianceMatrixBuffer<1, f32, Scalar>,
    KalmanGainMatrixBuffer<3, 1, f32, Column>,
    TemporaryResidualCovarianceInvertedMatrixBuffer<1, f32, Scalar>,
    TemporaryHPMatrixBuffer<1, 3, f32, Row>,
    TemporaryPHTMatrixBuffer<3, 1, f32, Column>,
    TemporaryKHPMatrixBuffer<3, f32, Square>,
>;

pub(crate) struct MiniKalman {
    a: [f32; 9],
    q: [f32; 9],
    r: f32,
    prior: [f32; 9],
}

const fn flat(m: [[f32; 3]; 3]) -> [f32; 9] {
    let [[a, b, c], [d, e, f], [g, h, i]] = m;
    [a, b, c, d, e, f, g, h, i]
}

impl MiniKalman {
    /// The filter of `model`.
    pub(crate) const fn new(model: &Model<3, NoInput>) -> Self {
        Self {
            a: flat(to_f32(model.transition())),
            q: flat(to_f32(model.process_noise())),
            r: model.measurement_noise() as f32,
            prior: flat(diagonal(model.prior())),
        }
    }
}

impl Measured for MiniKalman {
    // It keeps its parameters and its intermediate results with its state.
    type State = (Count, Filter, Observation);

    fn start(&self, first: &Sample) -> Self::State {
        let filter = RegularKalmanBuilder::new::<3, f32>(
            self.a.into(),
            [0.0; 3].into(),
            self.prior.into(),
            self.q.into(),
            [0.0; 3].into(),
            [0.0; 9].into(),
        );
        let observation = RegularObservationBuilder::new::<3, 1, f32>(
            [1.0, 0.0, 0.0].into(),
            [0.0].into(),
            [self.r].into(),
            [0.0].into(),
            [0.0].into(),
            [0.0; 3].into(),
            [0.0].into(),
            [0.0; 3].into(),
            [0.0; 3].into(),
            [0.0; 9].into(),
        );
        (first.count, filter, observation)
    }

    #[inline]
    fn update(&self, (anchor, filter, observation): &mut Self::State, sample: &Sample) -> f32 {
        let step = (sample.count - *anchor).to_f32();
        *anchor = sample.count;
        filter.predict();
        observation.measurement_vector_mut().set_at(0, 0, step);
        filter.correct(observation);
        let x = filter.state_vector_mut();
        let residual = x.get_at(0, 0) - step;
        x.set_at(0, 0, residual);
        x.get_at(1, 0)
    }
}
