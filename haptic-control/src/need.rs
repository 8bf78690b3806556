//! Optional parts of a controller, decided by types: a part that a scene does not need is `()`.
//!
//! A scene states a need as an associated type, [`Wanted`] or [`Skip`]. [`Need::Of`] maps the need
//! and the type of a part to the type that the controller holds:
//!
//! ```text
//!   scene                    controller                        tick
//!
//!   type Continuous          Of<Continuous, (L, Scale, ..)>    Continuous::map(part, |part| ..)
//!     = Wanted  ---------->    = (L, Scale, ..)  ------------>   runs the closure
//!     = Skip    ---------->    = ()              ------------>   does nothing
//!
//!   type Velocity    --.
//!   type Continuous  --+-- Or --> HandleNeed: the handle's velocity is estimated if the scene
//!   type Acceleration -'          reads it, if the slip of the coupler needs it, or if the scene
//!                                 reads the acceleration
//! ```
//!
//! The methods of [`Need`] are those of an `Option` whose variant is a type: `make` and `map` build
//! and use a part, `zip` joins two parts of the same need, `as_ref`, `as_mut` and `lend` borrow a
//! part, `or` replaces an absent part by a value, and `narrow` takes a value of a combined need.
//! The variant is known at compile time, so an absent part has neither state nor code: the
//! controller of [`Off`](crate::Off) is 42 bytes of code.

use estimator_core::{AccelerationEstimator, CountsPerTickSquared, Skip, VelocityEstimator};

/// Whether a part is present: [`Wanted`] or [`Skip`].
pub trait Need: Copy + 'static {
    /// Whether the part is present.
    const WANTED: bool;
    /// `T` where the part is wanted, `()` where it is not.
    type Of<T>;
    /// [`Wanted`] if this need or the other one is.
    type Or<Other: Need>: Need;

    /// Makes the part, if it is wanted.
    fn make<T>(make: impl FnOnce() -> T) -> Self::Of<T>;
    /// Applies `f` to the part, if it is present.
    fn map<T, R>(part: Self::Of<T>, f: impl FnOnce(T) -> R) -> Self::Of<R>;
    /// Copies the part.
    fn copy<T: Clone>(part: &Self::Of<T>) -> Self::Of<T>;
    /// Whether two parts are equal. Two absent parts are equal.
    fn same<T: PartialEq>(a: &Self::Of<T>, b: &Self::Of<T>) -> bool;
    /// Applies `f` to two parts of one need, if they are present.
    fn zip<T, U, R>(a: Self::Of<T>, b: Self::Of<U>, f: impl FnOnce(T, U) -> R) -> Self::Of<R>;
    /// Borrows the part.
    fn as_ref<T>(part: &Self::Of<T>) -> Self::Of<&T>;
    /// Borrows the part to change it.
    fn as_mut<T>(part: &mut Self::Of<T>) -> Self::Of<&mut T>;
    /// Borrows a part that is present for other scenes too, to change it; `()` if it is not wanted.
    fn lend<T>(part: &mut T) -> Self::Of<&mut T>;
    /// The part, or `absent` if it is not present.
    fn or<T>(part: Self::Of<T>, absent: T) -> T;
    /// Takes a value of a need that includes this one.
    fn narrow<Other: Need, T: Copy>(part: &<Self::Or<Other> as Need>::Of<T>) -> Self::Of<T>;
}

/// The part is present.
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

/// A need for the acceleration. [`Wanted`] requires an estimator that gives one.
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
