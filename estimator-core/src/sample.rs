//! One sample: the inputs of an estimator at one tick.

use crate::units::{Amps, ClockTicks, Count};

/// The measurements of one tick, and the only input of an estimator.
///
/// A part that the device does not measure keeps its default. An estimator states the parts that it
/// reads in [`VelocityEstimator::NEEDS`](crate::VelocityEstimator::NEEDS). A part that an estimator
/// does not read costs no instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// Count of the shaft whose velocity is estimated.
    pub count: Count,
    /// Count of the coupled shaft: the shaft on the other side of the coupling.
    pub coupled: Count,
    /// Motor current commanded over the period that ends with this sample.
    pub current: Amps,
    /// Latest edge of the encoder that gives `count`; `None` before the first time stamp.
    pub edge: Option<Edge>,
}

impl Sample {
    /// A sample with a count and nothing else.
    #[must_use]
    pub const fn new(count: Count) -> Self {
        Self {
            count,
            coupled: Count(0),
            current: Amps::ZERO,
            edge: None,
        }
    }

    /// This sample with the current that was commanded over the period that ends with it.
    #[must_use]
    pub const fn with_current(self, current: Amps) -> Self {
        Self { current, ..self }
    }

    /// This sample with the count of the coupled shaft.
    #[must_use]
    pub const fn with_coupled(self, coupled: Count) -> Self {
        Self { coupled, ..self }
    }

    /// This sample with the latest edge.
    #[must_use]
    pub const fn with_edge(self, edge: Edge) -> Self {
        Self {
            edge: Some(edge),
            ..self
        }
    }
}

/// Largest offset of a boundary that is learned, counts: boundaries within it keep their order.
pub(crate) const LARGEST_OFFSET: f32 = 0.25;

/// One encoder edge with its age.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Edge {
    /// The boundary crossed: boundary `e` lies between counts `e - 1` and `e`.
    pub boundary: Count,
    /// Time from the edge to this sample, in ticks of the capture clock, saturating.
    pub age: ClockTicks,
}

/// The optional parts of a [`Sample`] that an estimator reads. Every estimator reads the count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    /// The motor current.
    pub current: bool,
    /// The count of the coupled shaft.
    pub coupled: bool,
    /// Edge time stamps.
    pub edge: bool,
}

impl Signals {
    /// The count alone.
    pub const COUNT: Self = Self {
        current: false,
        coupled: false,
        edge: false,
    };

    /// The count and the current.
    pub const COUNT_AND_CURRENT: Self = Self {
        current: true,
        ..Self::COUNT
    };

    /// The parts that `self` or `other` contains.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            current: self.current | other.current,
            coupled: self.coupled | other.coupled,
            edge: self.edge | other.edge,
        }
    }

    /// Whether `available` contains every part of `self`.
    #[must_use]
    pub const fn within(self, available: Self) -> bool {
        (!self.current | available.current)
            & (!self.coupled | available.coupled)
            & (!self.edge | available.edge)
    }
}
