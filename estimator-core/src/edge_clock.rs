//! The clock that stamps encoder edges, against the control period.

use crate::design_error::DesignError;
use crate::sample::Sample;
use crate::units::Hertz;

/// How many ticks of the capture clock a control period has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeClock {
    /// Periods per tick of the clock.
    period: f32,
}

/// An edge since the last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FreshEdge {
    /// Number of the boundary modulo 4: which phase of a line it is.
    pub(crate) phase: usize,
    /// Where it lies, from the middle of the newest count's cell: -1/2 or 1/2 count.
    pub(crate) position: f32,
    /// Its age in control periods, 0 to below 1.
    pub(crate) age: f32,
}

impl EdgeClock {
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CLOCK`].
    pub(crate) const fn new(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::RATE);
        }
        if !(clock.is_positive() && clock.0 >= rate.0) {
            return Err(DesignError::CLOCK);
        }
        Ok(Self {
            period: (rate.0 / clock.0) as f32,
        })
    }

    /// The latest edge, if it came since the last sample and bounds the newest count; one that
    /// does not is a stamp out of step with its counter, and is no edge.
    #[inline(always)]
    pub(crate) fn fresh(&self, sample: &Sample) -> Option<FreshEdge> {
        let edge = sample.edge?;
        let age = edge.age.0 as f32 * self.period;
        let above = (edge.boundary - sample.large).0;
        if age < 1.0 && (above == 0 || above == 1) {
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
