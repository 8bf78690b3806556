//! The index lines of both encoders, on free channels of the timers that count them.
//!
//! A rising edge of an index copies the counter into the channel's register: no interrupt is taken, and
//! a tick looks whether it happened. Reading the register clears the flag, and a later pulse sets it
//! again, so that no pulse is lost; of two pulses between ticks the later one remains.

use estimator_core::{Count, Skip};
use stm32f4xx_hal::gpio::{Input, PB1, PD14, Pull};
use stm32f4xx_hal::pac::{TIM3, TIM4};

use super::encoder::Encoder;

/// The pins of the large and the small index.
pub(super) type Pins = (PD14<Input>, PB1<Input>);

/// The index lines of an image.
#[cfg(feature = "index-pulse")]
pub(super) type Indices = Captures;
#[cfg(not(feature = "index-pulse"))]
pub(super) type Indices = Skip;

/// Index lines, or nothing in their place.
pub(super) trait Lines {
    /// What a look gives.
    type Pulses;

    /// Starts the captures of both timers, which count.
    fn connect(large: &Encoder<TIM4>, small: &Encoder<TIM3>, pins: Pins) -> Self;

    /// The counts at the latest pulses since the last look. Both encoders have been read since.
    fn look(&self, large: &Encoder<TIM4>, small: &Encoder<TIM3>) -> Self::Pulses;
}

/// Captures on channel 3 of TIM4 and channel 4 of TIM3.
pub(super) struct Captures;

impl Lines for Captures {
    type Pulses = [Option<Count>; 2];

    fn connect(large: &Encoder<TIM4>, small: &Encoder<TIM3>, (large_z, small_z): Pins) -> Self {
        // A line that is not connected has no pulse.
        let _ = (
            large_z.into_alternate::<2>().internal_resistor(Pull::Down),
            small_z.into_alternate::<2>().internal_resistor(Pull::Down),
        );
        // The filter of the encoder's lines, so that count and index are as old. A channel is a comparison
        // with 0 until it is an input, and its flag may be set by that: it is cleared before captures begin.
        large
            .timer
            .ccmr2_input()
            .write(|w| w.cc3s().ti3().ic3f().fck_int_n8());
        large.timer.sr().write(|w| w.cc3if().clear());
        large.timer.ccer().modify(|_, w| w.cc3e().set_bit());
        small
            .timer
            .ccmr2_input()
            .write(|w| w.cc4s().ti4().ic4f().fck_int_n8());
        small.timer.sr().write(|w| w.cc4if().clear());
        small.timer.ccer().modify(|_, w| w.cc4e().set_bit());
        Self
    }

    fn look(&self, large: &Encoder<TIM4>, small: &Encoder<TIM3>) -> Self::Pulses {
        let of_large = large.timer.sr().read().cc3if().bit_is_set();
        let of_small = small.timer.sr().read().cc4if().bit_is_set();
        [
            of_large.then(|| large.captured(large.timer.ccr3().read().ccr().bits())),
            of_small.then(|| small.captured(small.timer.ccr4().read().ccr().bits())),
        ]
    }
}

impl Lines for Skip {
    type Pulses = Self;

    fn connect(_: &Encoder<TIM4>, _: &Encoder<TIM3>, _: Pins) -> Self {
        Self
    }

    fn look(&self, _: &Encoder<TIM4>, _: &Encoder<TIM3>) -> Self {
        Self
    }
}
