//! Voltage of the amplifiers' supply, in an image with `supply-monitor`.

use estimator_core::{Hertz, Skip};
use haptic_control::{Supply, SupplyFinding, SupplyState, Volts};

use crate::config::{DECIMATION, RATE_HZ};

/// The voltage is read beside each telemetry frame.
const SUPPLY: Supply = Supply::new(
    Supply::RANGE_24_V,
    Hertz(RATE_HZ as f64 / DECIMATION as f64),
);

/// The voltmeter of the image.
#[cfg(feature = "supply-monitor")]
pub type Voltmeter = SupplyState;
/// The voltmeter of the image.
#[cfg(not(feature = "supply-monitor"))]
pub type Voltmeter = Skip;

/// A reading of the supply: [`Volts`], or [`Skip`] in an image that reads none.
pub type Reading = <Voltmeter as Watch>::Reading;

/// A voltmeter, or nothing in its place.
pub trait Watch: SupplyFinding + Copy {
    /// Whether the voltage is read.
    const WANTED: bool;
    /// A reading.
    type Reading: Voltage;

    /// A voltmeter without a reading.
    fn unread() -> Self;

    /// Takes a reading, one for each telemetry frame.
    fn take(&mut self, reading: &Self::Reading);
}

/// A voltage, or nothing in its place.
pub trait Voltage: Copy {
    /// The voltage, if it is read.
    fn volts(self) -> Option<Volts>;
}

impl Watch for SupplyState {
    const WANTED: bool = true;
    type Reading = Volts;

    fn unread() -> Self {
        Self::START
    }

    fn take(&mut self, reading: &Volts) {
        SUPPLY.update(self, *reading);
    }
}

impl Voltage for Volts {
    fn volts(self) -> Option<Volts> {
        Some(self)
    }
}

/// No voltmeter: no state and no code.
impl Watch for Skip {
    const WANTED: bool = false;
    type Reading = Self;

    fn unread() -> Self {
        Self
    }

    fn take(&mut self, _: &Self) {}
}

impl Voltage for Skip {
    fn volts(self) -> Option<Volts> {
        None
    }
}
