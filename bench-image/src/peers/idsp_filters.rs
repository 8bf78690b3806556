//! `idsp`'s tracking loop and low-pass, in its integers.

use core::f64::consts::PI;
use core::num::Wrapping;

use dsp_fixedpoint::Q32;
use dsp_process::SplitProcess;
use estimator_core::{Count, Hertz, Sample};
use idsp::{Lowpass, LowpassState, PLL, PLLState};

use crate::subject::Measured;

/// Units of the loop's phase in a count, a power of two: 2047 counts a tick fit, to 1e-6.
const PHASE_BITS: u32 = 20;

/// The loop of third order, with its own rule for a bandwidth.
pub struct IdspPll(PLL);

impl IdspPll {
    /// As `PLL::from_bandwidth` with a split of 4, which cannot run at compile time.
    #[must_use]
    pub const fn new(bandwidth: Hertz, rate: Hertz) -> Self {
        const SPLIT: f64 = 4.0;
        let a = 2.0 * PI * bandwidth.0 / rate.0;
        let gain = -a * a * SPLIT;
        let (zero, pole) = (1.0 - a / SPLIT, 1.0 - a * SPLIT);
        let bits = [gain, -gain * zero, pole - 1.0];
        Self(PLL {
            ba: [q32(bits[0]), q32(bits[1]), q32(bits[2])],
        })
    }
}

/// In units of 2^-32.
const fn q32(x: f64) -> Q32<32> {
    Q32::from_bits((x * 4_294_967_296.0) as i32)
}

/// The count as a phase; its upper bits wrap away.
const fn phase(count: Count) -> Wrapping<i32> {
    Wrapping((count.0 << PHASE_BITS) as i32)
}

impl Measured for IdspPll {
    type State = PLLState;

    fn start(&self, first: &Sample) -> PLLState {
        // The output settles to the input's complement.
        PLLState {
            y: -phase(first.count),
            ..PLLState::default()
        }
    }

    #[inline]
    fn update(&self, state: &mut PLLState, sample: &Sample) -> f32 {
        self.0.process(state, phase(sample.count));
        const SCALE: f32 = 1.0 / (1_u32 << PHASE_BITS) as f32;
        -state.frequency().0 as f32 * SCALE
    }
}

/// Units of the low-pass's input in a count, a power of two: 2^15 counts a tick fit.
const STEP_BITS: u32 = 16;

/// The low-pass of first order over steps between counts.
pub struct IdspLowPass(Lowpass<1>);

impl IdspLowPass {
    /// With the gain that its documentation gives for a cut-off, which is not the cut-off any more
    /// where that comes near half of the rate.
    #[must_use]
    pub const fn new(cutoff: Hertz, rate: Hertz) -> Self {
        Self(Lowpass([
            (2.0 * PI * cutoff.0 / rate.0 * 2_147_483_648.0) as i32
        ]))
    }
}

impl Measured for IdspLowPass {
    type State = (Count, LowpassState<1>);

    fn start(&self, first: &Sample) -> Self::State {
        (first.count, LowpassState::default())
    }

    #[inline]
    fn update(&self, (last, state): &mut Self::State, sample: &Sample) -> f32 {
        let step = sample.count - *last;
        *last = sample.count;
        const SCALE: f32 = 1.0 / (1_u32 << STEP_BITS) as f32;
        self.0.process(state, step.0 << STEP_BITS) as f32 * SCALE
    }
}
