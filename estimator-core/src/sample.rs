//! What one tick knows.

use crate::units::{Amps, ClockTicks, Count};

/// What the controller knows at one tick, and all that an estimator may look at.
///
/// A part that the device does not have keeps its default; an estimator that reads it says so in
/// [`VelocityEstimator::NEEDS`](crate::VelocityEstimator::NEEDS). A part that an estimator does
/// not read costs it nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// Encoder of the large motor: the one whose velocity is estimated.
    pub large: Count,
    /// Encoder of the small motor, on the handle.
    pub small: Count,
    /// Current commanded to the large motor over the period that ends with this sample.
    pub current: Amps,
    /// Latest edge of the large encoder, if one has been stamped yet.
    pub edge: Option<Edge>,
}

impl Sample {
    /// A sample of a device that has nothing but the large encoder.
    #[must_use]
    pub const fn new(large: Count) -> Self {
        Self {
            large,
            small: Count(0),
            current: Amps::ZERO,
            edge: None,
        }
    }

    /// The same sample with the current applied over the period that ends with it.
    #[must_use]
    pub const fn with_current(self, current: Amps) -> Self {
        Self { current, ..self }
    }

    /// The same sample with the small encoder.
    #[must_use]
    pub const fn with_small(self, small: Count) -> Self {
        Self { small, ..self }
    }

    /// The same sample with the latest edge.
    #[must_use]
    pub const fn with_edge(self, edge: Edge) -> Self {
        Self {
            edge: Some(edge),
            ..self
        }
    }
}

/// One encoder edge and when it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Edge {
    /// The boundary crossed: boundary `e` lies between counts `e - 1` and `e`.
    pub boundary: Count,
    /// Time from the edge to this sample, in ticks of the capture clock, saturating.
    pub age: ClockTicks,
}

/// Which parts of a [`Sample`], besides the large count, an estimator reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    /// The large motor's current.
    pub current: bool,
    /// The small encoder.
    pub small: bool,
    /// Edge time stamps of the large encoder.
    pub edge: bool,
}

impl Signals {
    /// The large count alone.
    pub const COUNT: Self = Self {
        current: false,
        small: false,
        edge: false,
    };

    /// The large count and the current.
    pub const COUNT_AND_CURRENT: Self = Self {
        current: true,
        ..Self::COUNT
    };

    /// What either needs.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            current: self.current | other.current,
            small: self.small | other.small,
            edge: self.edge | other.edge,
        }
    }

    /// Whether everything in `self` is in `available`.
    #[must_use]
    pub const fn within(self, available: Self) -> bool {
        (!self.current | available.current)
            & (!self.small | available.small)
            & (!self.edge | available.edge)
    }
}
