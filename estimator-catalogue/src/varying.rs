//! Whether an estimator takes varying periods, from its type.

use core::marker::PhantomData;

use estimator_core::{
    Confidence, CountsPerTick, Sample, Variance, VaryingPeriod, VelocityEstimator,
};

/// [`VaryingPeriod::update_over`] of an estimator.
pub type UpdateOver<E> =
    fn(&E, &mut <E as VelocityEstimator>::State, &Sample, f32) -> CountsPerTick;

/// [`VaryingPeriod::variance_over`] of an estimator.
pub type VarianceOver<E> = fn(&E, &<E as VelocityEstimator>::State, f32) -> Variance;

/// The functions of an estimator over varying periods, found by its type:
/// `Varying::<Type>::UPDATE_OVER` is `None` for an estimator that assumes a constant period.
///
/// A constant of the type itself goes before that of a trait, and it exists if the type is a
/// [`VaryingPeriod`]. This needs a type that is known where the path is written: it has no effect
/// inside a generic function.
///
/// ```
/// use estimator_catalogue::{AssumesConstantPeriod as _, Varying};
/// use estimator_core::{FiniteDifference, Pll};
///
/// assert!(Varying::<FiniteDifference>::UPDATE_OVER.is_some());
/// assert!(Varying::<Pll>::UPDATE_OVER.is_none());
/// ```
pub struct Varying<E>(PhantomData<E>);

impl<E: VaryingPeriod> Varying<E> {
    /// [`VaryingPeriod::update_over`].
    pub const UPDATE_OVER: Option<UpdateOver<E>> = Some(E::update_over);
}

impl<E: VaryingPeriod + Confidence> Varying<E> {
    /// [`VaryingPeriod::variance_over`].
    pub const VARIANCE_OVER: Option<VarianceOver<E>> = Some(E::variance_over);
}

/// The estimators that are no [`VaryingPeriod`]; see [`Varying`].
pub trait AssumesConstantPeriod {
    /// The estimator.
    type Estimator: VelocityEstimator;
    /// There is no update over a varying period.
    const UPDATE_OVER: Option<UpdateOver<Self::Estimator>> = None;
    /// There is no variance over a varying period.
    const VARIANCE_OVER: Option<VarianceOver<Self::Estimator>> = None;
}

impl<E: VelocityEstimator> AssumesConstantPeriod for Varying<E> {
    type Estimator = E;
}
