//! The voltage of the amplifiers' supply, on a converter of its own.
//!
//! It converts its input again and again, as the current monitors are converted.

use drivers::Divider;
use estimator_core::Skip;
use firmware_app::config::TIMER_HZ;
use haptic_control::Volts;
use stm32f4xx_hal::gpio::GpioExt as _;
use stm32f4xx_hal::pac::{ADC3, GPIOF};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::converters::STABLE_US;
use super::tick::Clock;

/// Supply over the voltage at the pin: 100 kΩ above 10 kΩ, 36.3 V at full scale.
const RATIO: f32 = 11.0;
/// VDDA of the Nucleo, V.
const REFERENCE_V: f32 = 3.3;

/// Channel of PF3.
const CHANNEL: u8 = 9;

/// The wire of an image.
#[cfg(feature = "supply-monitor")]
pub(super) type Supply = Wired;
#[cfg(not(feature = "supply-monitor"))]
pub(super) type Supply = Skip;

/// The supply's voltage, or nothing in its place.
pub(super) trait Wire {
    /// Whether the wire has a converter.
    const WANTED: bool;
    /// What a reading gives.
    type Reading;

    /// Starts the converter on PF3.
    fn start(converter: ADC3, port: GPIOF, timer: &Clock, rcc: &mut Rcc) -> Self;

    /// The latest reading.
    fn read(&self) -> Self::Reading;
}

/// The divider on its converter.
pub(super) struct Wired {
    converter: ADC3,
    divider: Divider,
}

impl Wire for Wired {
    const WANTED: bool = true;
    type Reading = Volts;

    fn start(converter: ADC3, port: GPIOF, timer: &Clock, rcc: &mut Rcc) -> Self {
        let _ = port.split(rcc).pf3.into_analog();
        ADC3::enable(rcc);
        // A conversion takes 480 + 12 cycles of 21 MHz, 23 us, for a divider of 9 kΩ.
        converter.smpr2().write(|w| w.smp9().cycles480());
        firmware_rt::convert_channel(&converter, CHANNEL);
        converter
            .cr2()
            .write(|w| w.cont().set_bit().adon().set_bit());
        timer.poll(STABLE_US * (TIMER_HZ / 1_000_000), || false);
        converter.cr2().modify(|_, w| w.swstart().set_bit());
        Self {
            converter,
            divider: defmt::unwrap!(Divider::new(RATIO, REFERENCE_V)),
        }
    }

    fn read(&self) -> Volts {
        self.divider
            .voltage(self.converter.dr().read().data().bits())
    }
}

impl Wire for Skip {
    const WANTED: bool = false;
    type Reading = Self;

    fn start(_: ADC3, _: GPIOF, _: &Clock, _: &mut Rcc) -> Self {
        Self
    }

    fn read(&self) -> Self {
        Self
    }
}
