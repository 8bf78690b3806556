//! The supertrait of the sealed traits of this crate.

/// Supertrait of every sealed trait. Types outside the crate cannot name it.
pub trait Sealed {}
