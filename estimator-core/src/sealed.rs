//! The one way in which traits of this crate are sealed.

/// Supertrait of every sealed trait. Types outside the crate cannot name it.
pub trait Sealed {}
