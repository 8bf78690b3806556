//! Currents that have flowed: measured ones in an image with `current-monitor`, otherwise those
//! commanded.

use estimator_core::{Amps, Skip};
use haptic_control::{Ammeters, AmmetersState, Currents, Flow};

use crate::config::{DEVICE, RATE};

const AMMETERS: Ammeters = Ammeters::new(&DEVICE, RATE);

/// The ammeters of the image.
#[cfg(feature = "current-monitor")]
pub type Ammeter = Meters;
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

/// Both ammeters, and the means of their currents.
pub struct Meters {
    state: AmmetersState,
    /// Sums of both currents since the means were taken, A.
    sums: [f32; 2],
    ticks: u32,
}

impl Measure for Meters {
    const WANTED: bool = true;
    type Measured = Currents;

    fn new() -> Self {
        Self {
            state: AmmetersState::START,
            sums: [0.0; 2],
            ticks: 0,
        }
    }

    fn update(&mut self, readings: &Currents, commands: &Currents, enabled: bool) -> Flow {
        let commands = enabled.then_some(commands);
        let flow = AMMETERS.update(&mut self.state, readings, commands);
        let measured = self.state.currents();
        self.sums[0] += measured.large.get();
        self.sums[1] += measured.small.get();
        self.ticks += 1;
        flow
    }

    fn restart(&mut self) {
        self.state.restart();
    }

    fn take_means(&mut self) -> Currents {
        let per_tick = 1.0 / self.ticks.max(1) as f32;
        let [large, small] = self.sums.map(|sum| Amps::new(sum * per_tick));
        (self.sums, self.ticks) = ([0.0; 2], 0);
        Currents { large, small }
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
