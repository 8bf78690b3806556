//! What a scene needs, in the type: a part that is not needed is `()`, so it has neither state
//! nor code.

use estimator_core::{AccelerationEstimator, CountsPerTickSquared, Skip, VelocityEstimator};

/// Whether a part is there: [`Wanted`] or [`Skip`].
pub trait Need: Copy + 'static {
    /// Whether the part is there.
    const WANTED: bool;
    /// `T` where the part is wanted, `()` where it is not.
    type Of<T>;
    /// Wanted if either is.
    type Or<Other: Need>: Need;

    /// Makes the part, if it is wanted.
    fn make<T>(make: impl FnOnce() -> T) -> Self::Of<T>;
    /// Uses the part, if it is there.
    fn map<T, R>(part: Self::Of<T>, f: impl FnOnce(T) -> R) -> Self::Of<R>;
    /// Copies the part.
    fn copy<T: Clone>(part: &Self::Of<T>) -> Self::Of<T>;
    /// Whether two parts are the same; those that are not there are.
    fn same<T: PartialEq>(a: &Self::Of<T>, b: &Self::Of<T>) -> bool;
    /// Puts two parts of one need together.
    fn zip<T, U, R>(a: Self::Of<T>, b: Self::Of<U>, f: impl FnOnce(T, U) -> R) -> Self::Of<R>;
    /// Borrows the part where it is kept.
    fn as_ref<T>(part: &Self::Of<T>) -> Self::Of<&T>;
    /// Borrows the part where it is kept, to change it.
    fn as_mut<T>(part: &mut Self::Of<T>) -> Self::Of<&mut T>;
    /// Borrows a part that others keep for everybody, to change it.
    fn lend<T>(part: &mut T) -> Self::Of<&mut T>;
    /// The value, or `absent` where the part is not there.
    fn or<T>(part: Self::Of<T>, absent: T) -> T;
    /// Takes a value of a need that includes this one.
    fn narrow<Other: Need, T: Copy>(part: &<Self::Or<Other> as Need>::Of<T>) -> Self::Of<T>;
}

/// The part is there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted;

impl Need for Wanted {
    const WANTED: bool = true;
    type Of<T> = T;
    type Or<Other: Need> = Self;

    fn make<T>(make: impl FnOnce() -> T) -> T {
        make()
    }

    fn map<T, R>(part: T, f: impl FnOnce(T) -> R) -> R {
        f(part)
    }

    fn copy<T: Clone>(part: &T) -> T {
        part.clone()
    }

    fn same<T: PartialEq>(a: &T, b: &T) -> bool {
        a == b
    }

    fn zip<T, U, R>(a: T, b: U, f: impl FnOnce(T, U) -> R) -> R {
        f(a, b)
    }

    fn as_ref<T>(part: &T) -> &T {
        part
    }

    fn as_mut<T>(part: &mut T) -> &mut T {
        part
    }

    fn lend<T>(part: &mut T) -> &mut T {
        part
    }

    fn or<T>(part: T, _: T) -> T {
        part
    }

    fn narrow<Other: Need, T: Copy>(part: &T) -> T {
        *part
    }
}

impl Need for Skip {
    const WANTED: bool = false;
    type Of<T> = ();
    type Or<Other: Need> = Other;

    fn make<T>(_: impl FnOnce() -> T) {}

    fn map<T, R>((): (), _: impl FnOnce(T) -> R) {}

    fn copy<T: Clone>((): &()) {}

    fn same<T: PartialEq>((): &(), (): &()) -> bool {
        true
    }

    fn zip<T, U, R>((): (), (): (), _: impl FnOnce(T, U) -> R) {}

    fn as_ref<T>((): &()) {}

    fn as_mut<T>((): &mut ()) {}

    fn lend<T>(_: &mut T) {}

    fn or<T>((): (), absent: T) -> T {
        absent
    }

    fn narrow<Other: Need, T: Copy>(_: &<Other as Need>::Of<T>) {}
}

/// A need for an acceleration, of an estimator that gives one if it is [`Wanted`].
pub trait Senses<E: VelocityEstimator>: Need {
    /// The acceleration at the latest update.
    fn acceleration(estimator: &E, state: &E::State) -> Self::Of<CountsPerTickSquared>;
}

impl<E: VelocityEstimator> Senses<E> for Skip {
    fn acceleration(_: &E, _: &E::State) {}
}

impl<E: AccelerationEstimator> Senses<E> for Wanted {
    fn acceleration(estimator: &E, state: &E::State) -> CountsPerTickSquared {
        estimator.acceleration(state)
    }
}
