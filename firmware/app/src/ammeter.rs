//! Currents that have flowed: measured ones in an image with `current-monitor`, otherwise those
//! commanded.

use estimator_core::Skip;
use haptic_control::{Ammeters, AmmetersState, Currents, Flow, Stop};

use crate::config::{DEVICE, RATE};

const AMMETERS: Ammeters = Ammeters::new(&DEVICE, RATE);

/// The ammeters of the image.
#[cfg(feature = "current-monitor")]
pub type Ammeter = AmmetersState;
/// The ammeters of the image.
#[cfg(not(feature = "current-monitor"))]
pub type Ammeter = Skip;

/// Measured currents of the image: [`Currents`], or [`Skip`] in an image that measures none.
pub type Measured = <Ammeter as Measure>::Measured;

/// Ammeters, or nothing in their place.
pub trait Measure {
    /// Whether currents are measured.
    const WANTED: bool;
    /// Measured currents.
    type Measured: Measurement;

    /// Ammeters that have measured nothing.
    fn new() -> Self;

    /// The currents over the period before a tick, from the readings at its begin and the commands
    /// that were in force. Without ammeters they are those commanded.
    fn update(&mut self, readings: &Self::Measured, commands: &Currents, enabled: bool) -> Flow;

    /// Whether the currents disagree with the commands, as in the [`Flow`] of the latest tick.
    fn mismatch(&self) -> Option<Stop>;

    /// Forgets a disagreement with the commands.
    fn restart(&mut self);

    /// Mean currents since the last call, or since the start.
    fn take_means(&mut self) -> Self::Measured;
}

/// Measured currents, or nothing in their place.
pub trait Measurement: Copy {
    /// The currents, if they are measured.
    fn currents(self) -> Option<Currents>;
}

impl Measure for AmmetersState {
    const WANTED: bool = true;
    type Measured = Currents;

    fn new() -> Self {
        Self::START
    }

    fn update(&mut self, readings: &Currents, commands: &Currents, enabled: bool) -> Flow {
        AMMETERS.update(self, readings, enabled.then_some(commands))
    }

    fn mismatch(&self) -> Option<Stop> {
        AMMETERS.mismatch(self)
    }

    fn restart(&mut self) {
        Self::restart(self);
    }

    fn take_means(&mut self) -> Currents {
        Self::take_means(self)
    }
}

impl Measurement for Currents {
    fn currents(self) -> Option<Currents> {
        Some(self)
    }
}

/// No ammeters: no state and no code.
impl Measure for Skip {
    const WANTED: bool = false;
    type Measured = Self;

    fn new() -> Self {
        Self
    }

    fn update(&mut self, _: &Self, commands: &Currents, _: bool) -> Flow {
        Flow {
            currents: *commands,
            mismatch: None,
        }
    }

    fn mismatch(&self) -> Option<Stop> {
        None
    }

    fn restart(&mut self) {}

    fn take_means(&mut self) -> Self {
        Self
    }
}

impl Measurement for Skip {
    fn currents(self) -> Option<Currents> {
        None
    }
}
