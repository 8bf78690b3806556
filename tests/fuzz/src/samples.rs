//! Any samples into every estimator.

use estimator_core::{Count, Sample};
use stress::course::Shown;
use stress::tested::{TestedEstimator, at};

use crate::bytes::Bytes;

/// Every estimator, made once.
#[must_use]
pub fn tested_estimators() -> Vec<TestedEstimator> {
    at(1000.0).into_iter().chain(at(10_000.0)).collect()
}

/// Feeds the samples in `data` to every estimator.
///
/// # Panics
/// If an output is no finite number or a covariance none any more.
pub fn run(tested_estimators: &[TestedEstimator], data: &[u8]) {
    for tested in tested_estimators {
        let mut bytes = Bytes(data);
        let mut pair = tested.pair();
        let mut sample = Sample::new(Count(u32::MAX - 3));
        pair.start(&Shown::of(&sample));
        while let Some(next) = bytes.sample(&sample) {
            sample = next;
            if sample.count.0.is_multiple_of(251) {
                pair.start(&Shown::of(&sample));
            }
            let (output, _) = pair.update(&Shown::of(&sample));
            assert!(output.is_finite(), "{}: {output}", tested.name);
            assert_eq!(pair.fault(), None, "{}", tested.name);
        }
    }
}
