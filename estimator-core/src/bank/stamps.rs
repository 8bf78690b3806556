//! Whether a bank reads edge time stamps.

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

    /// The edge that came within the last `period` control periods.
    #[doc(hidden)]
    #[expect(private_interfaces, reason = "the trait is sealed")]
    fn fresh_within(&self, sample: &Sample, period: f32) -> Option<FreshEdge>;

    /// The variance of the ends of a quantisation interval, counts², where that of a boundary is
    /// `boundary`. Counts alone do not tell it.
    #[doc(hidden)]
    fn noise_of_ends(boundary: f32) -> f32;
}

/// Counts alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct NoStamps;

memory!(NoStamps {});

impl Sealed for NoStamps {}

impl Stamps for NoStamps {
    const NEEDS: Signals = Signals::COUNT;

    #[inline(always)]
    #[expect(private_interfaces, reason = "the trait is sealed")]
    fn fresh_within(&self, _: &Sample, _: f32) -> Option<FreshEdge> {
        None
    }

    #[inline(always)]
    fn noise_of_ends(_: f32) -> f32 {
        // Adding -0 changes no number and costs no instruction; adding 0 changes -0.
        -0.0
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

    #[inline(always)]
    #[expect(private_interfaces, reason = "the trait is sealed")]
    fn fresh_within(&self, sample: &Sample, period: f32) -> Option<FreshEdge> {
        self.clock.fresh_within(sample, period)
    }

    #[inline(always)]
    fn noise_of_ends(boundary: f32) -> f32 {
        boundary
    }
}
