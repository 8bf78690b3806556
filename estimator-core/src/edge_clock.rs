//! The clock that stamps encoder edges, relative to the control period.

use crate::design::DesignError;
use crate::memory::memory;
use crate::sample::Sample;
use crate::units::Hertz;

/// Capture clock of edge time stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(crate) struct EdgeClock {
    /// Control periods per tick of the capture clock.
    period: f32,
}

memory!(EdgeClock { period });

/// An edge that came since the last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FreshEdge {
    /// Number of the boundary modulo 4: the phase of an encoder line.
    pub(crate) phase: usize,
    /// Position from the middle of the quantisation interval of the newest count: ±1/2 count.
    pub(crate) position: f32,
    /// Age in control periods, 0 to below the interval since the last sample.
    pub(crate) age: f32,
}

/// Largest frequency of a clock, in rates: f32 holds its period.
const LARGEST: f64 = 1e30;

impl EdgeClock {
    /// A capture clock of frequency `clock` at this control rate.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CLOCK`].
    pub(crate) const fn new(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        if !(clock.is_positive() && clock.0 >= rate.0 && clock.0 <= LARGEST * rate.0) {
            return Err(DesignError::CLOCK);
        }
        Ok(Self {
            period: (rate.0 / clock.0) as f32,
        })
    }

    /// The latest edge, if it came since the last sample, one control period ago, and is a boundary of
    /// the newest count's interval. Any other stamp disagrees with the counter and is ignored.
    #[inline(always)]
    pub(crate) fn fresh(&self, sample: &Sample) -> Option<FreshEdge> {
        self.fresh_within(sample, 1.0)
    }

    /// The latest edge as [`EdgeClock::fresh`] gives it, if it is younger than `period` control periods.
    #[inline(always)]
    pub(crate) fn fresh_within(&self, sample: &Sample, period: f32) -> Option<FreshEdge> {
        let edge = sample.edge?;
        let age = edge.age.0 as f32 * self.period;
        let above = (edge.boundary - sample.count).0;
        if age < period && (above == 0 || above == 1) {
            Some(FreshEdge {
                phase: (edge.boundary.0 & 3) as usize,
                position: above as f32 - 0.5,
                age,
            })
        } else {
            None
        }
    }
}
