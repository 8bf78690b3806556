//! Correction by counts, with a gain table.

use super::correction::{Correction, excess};
use super::gain::Gain;
use super::gain_table::GainTable;
use super::innovation::{Innovation, Prediction};
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;

/// Correction by counts alone, with a gain table.
///
/// A count restricts the position to one quantisation interval, ±1/2 count. A prediction inside it
/// is kept. A prediction outside it is moved to the nearest boundary, with the steady gain of a
/// filter that is corrected as rarely.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CountUpdate {
    pub(super) table: GainTable,
}

memory!(CountUpdate { table });

impl Sealed for CountUpdate {}

impl Correction for CountUpdate {
    /// Ticks since the last correction.
    type State = f32;
    type Gain<'a> = &'a Gain;
    const NEEDS: Signals = Signals::COUNT;
    const DENSE: bool = false;

    fn start(&self) -> f32 {
        0.0
    }

    fn velocity_variance(&self, gap: &f32) -> f32 {
        self.table.velocity_variance(*gap)
    }

    #[inline(always)]
    fn innovation<'a>(
        &'a self,
        gap: &mut f32,
        prediction: Prediction,
        _: &Sample,
    ) -> Option<(Innovation, &'a Gain)> {
        *gap += 1.0;
        let error = excess(prediction.from + prediction.displacement)?;
        let innovation = Innovation {
            error,
            age: 0.0,
            position_gain: 1.0,
            gap: *gap,
            waited: *gap,
        };
        *gap = 0.0;
        Some((innovation, self.table.gain(innovation.gap)))
    }
}
