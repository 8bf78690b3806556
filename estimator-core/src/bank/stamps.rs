//! Whether a bank reads edge time stamps.

use super::state::LEAST_OF_COUNT;
use crate::design::DesignError;
use crate::edge_clock::{EdgeClock, FreshEdge};
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;
use crate::units::Hertz;

/// Source of edges of a [`ModelBank`](crate::ModelBank).
pub trait Stamps: Sealed + Copy + PartialEq {
    /// The parts of a sample that are read.
    const NEEDS: Signals;

    /// Whether the noise R follows from counts. That of the boundaries follows from their stamps.
    #[doc(hidden)]
    const LEARNS_FROM_COUNTS: bool;

    /// R at the start, counts².
    #[doc(hidden)]
    const NOISE: f32;

    /// The edge that came within the last `period` control periods.
    #[doc(hidden)]
    #[expect(private_interfaces, reason = "the trait is sealed")]
    fn fresh_within(&self, sample: &Sample, period: f32) -> Option<FreshEdge>;
}

/// Counts alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct NoStamps;

memory!(NoStamps {});

impl Sealed for NoStamps {}

impl Stamps for NoStamps {
    const NEEDS: Signals = Signals::COUNT;

    const LEARNS_FROM_COUNTS: bool = true;

    const NOISE: f32 = LEAST_OF_COUNT;

    #[inline(always)]
    #[expect(private_interfaces, reason = "the trait is sealed")]
    fn fresh_within(&self, _: &Sample, _: f32) -> Option<FreshEdge> {
        None
    }
}

/// Counts, and edges with time stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Stamped {
    clock: EdgeClock,
}

memory!(Stamped { clock });

impl Stamped {
    pub(super) const fn new(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        match EdgeClock::new(clock, rate) {
            Ok(clock) => Ok(Self { clock }),
            Err(error) => Err(error),
        }
    }
}

impl Sealed for Stamped {}

impl Stamps for Stamped {
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };

    const LEARNS_FROM_COUNTS: bool = false;

    const NOISE: f32 = 1e-3;

    #[inline(always)]
    #[expect(private_interfaces, reason = "the trait is sealed")]
    fn fresh_within(&self, sample: &Sample, period: f32) -> Option<FreshEdge> {
        self.clock.fresh_within(sample, period)
    }
}
