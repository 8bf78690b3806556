//! The current monitors of the amplifiers, on two converters.
//!
//! Each converter converts its input again and again, and a tick reads the latest result: nothing
//! starts a conversion, waits for one or can miss one. Without DMA a result replaces one that was
//! not read, and no overrun stops the converter (RM0090, bit `EOCS` of `ADC_CR2`).

use drivers::AdcScale;
use estimator_core::{Amps, Skip};
use firmware_app::config::TIMER_HZ;
use haptic_control::Currents;
use stm32f4xx_hal::gpio::{Input, PA3, PC0};
use stm32f4xx_hal::pac::{ADC1, ADC2, adc1};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::converters::STABLE_US;
use super::tick::Clock;

/// Current of the large amplifier at the lower end of its monitor, a quarter above its full scale.
const LARGE_FULL_SCALE: Amps = Amps::new(7.5);
/// Current of the small amplifier at the lower end of its monitor.
const SMALL_FULL_SCALE: Amps = Amps::new(1.875);

/// Channels of PA3 and PC0.
const LARGE_CHANNEL: u8 = 3;
const SMALL_CHANNEL: u8 = 10;

/// The wires of an image.
#[cfg(feature = "current-monitor")]
pub(super) type Monitors = Wired;
#[cfg(not(feature = "current-monitor"))]
pub(super) type Monitors = Skip;

/// Current monitors, or nothing in their place.
pub(super) trait Wires {
    /// Whether the wires have converters.
    const WANTED: bool;
    /// What a reading gives.
    type Reading;

    /// Starts the converters, on the monitors of the large and the small amplifier.
    fn start(
        converters: (ADC1, ADC2),
        pins: (PA3<Input>, PC0<Input>),
        timer: &Clock,
        rcc: &mut Rcc,
    ) -> Self;

    /// The latest readings.
    fn read(&self) -> Self::Reading;
}

/// Both current monitors, on their converters.
pub(super) struct Wired {
    large: (ADC1, AdcScale),
    small: (ADC2, AdcScale),
}

impl Wires for Wired {
    const WANTED: bool = true;
    type Reading = Currents;

    fn start(
        (large, small): (ADC1, ADC2),
        (large_pin, small_pin): (PA3<Input>, PC0<Input>),
        timer: &Clock,
        rcc: &mut Rcc,
    ) -> Self {
        let _ = (large_pin.into_analog(), small_pin.into_analog());
        ADC1::enable(rcc);
        ADC2::enable(rcc);
        // A conversion takes 56 + 12 cycles of 21 MHz, 3.2 us.
        large.smpr2().write(|w| w.smp3().cycles56());
        small.smpr1().write(|w| w.smp10().cycles56());
        let converters: [(&adc1::RegisterBlock, u8); 2] =
            [(&large, LARGE_CHANNEL), (&small, SMALL_CHANNEL)];
        for (converter, channel) in converters {
            firmware_rt::convert_channel(converter, channel);
            converter
                .cr2()
                .write(|w| w.cont().set_bit().adon().set_bit());
        }
        timer.poll(STABLE_US * (TIMER_HZ / 1_000_000), || false);
        for (converter, _) in converters {
            converter.cr2().modify(|_, w| w.swstart().set_bit());
        }
        Self {
            large: (large, defmt::unwrap!(AdcScale::new(LARGE_FULL_SCALE))),
            small: (small, defmt::unwrap!(AdcScale::new(SMALL_FULL_SCALE))),
        }
    }

    fn read(&self) -> Currents {
        let (large, large_scale) = &self.large;
        let (small, small_scale) = &self.small;
        Currents {
            large: large_scale.current(large.dr().read().data().bits()),
            small: small_scale.current(small.dr().read().data().bits()),
        }
    }
}

impl Wires for Skip {
    const WANTED: bool = false;
    type Reading = Self;

    fn start(_: (ADC1, ADC2), _: (PA3<Input>, PC0<Input>), _: &Clock, _: &mut Rcc) -> Self {
        Self
    }

    fn read(&self) -> Self {
        Self
    }
}
