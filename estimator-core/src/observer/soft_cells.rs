//! Counts alone, with what they say inside their cell too.

use super::ROWS;
use super::correction::{Correction, Innovation, Path, row};
use super::design::Gain;
use crate::design_error::DesignError;
use crate::sample::{Sample, Signals};
use crate::units::Hertz;

/// Counts alone, as with [`Cells`](super::Cells), but for a prediction that is known to a width k
/// only: the part of it beyond a boundary is impossible, and what is left has its mean further
/// inside. The mean of a truncated bell, by two parabolas:
/// ```text
/// k = min(0.7, growth . time since x was last outside)        y+ = x - 1/2, y- = -x - 1/2
/// q(y) = 0 below -k,  (y + k)² / 4 k,  y above k              e = q(y-) - q(y+)
/// ```
/// A rotor that rests does not get less certain: nothing is corrected then. Above 1 kHz a
/// correction inside the cell counts `1 ms / T` times less, for there are as many more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftCells {
    /// Growth of k, counts a tick.
    growth: f32,
    /// Share of a correction inside the cell.
    share: f32,
}

/// Largest k: beyond it nothing is left of the cell.
const WIDEST: f32 = 0.7;

/// Ticks of this length or longer take a correction inside the cell as it is, s.
const WHOLE: f64 = 1e-3;

impl SoftCells {
    /// `growth`: counts a second.
    pub(super) const fn new(growth: f64, rate: Hertz) -> Result<Self, DesignError> {
        if !rate.is_positive() {
            return Err(DesignError::Rate);
        }
        if !(growth > 0.0 && growth < 1e9) {
            return Err(DesignError::ProcessNoise);
        }
        Ok(Self {
            growth: (growth / rate.0) as f32,
            share: (1.0 / (rate.0 * WHOLE)).min(1.0) as f32,
        })
    }
}

/// How far the mean lies inside of `position`, known to ±`width`.
#[inline(always)]
fn inwards(position: f32, width: f32) -> Option<f32> {
    let away = position.abs();
    let beyond = away - 0.5;
    let near = beyond + width;
    if !(near > 0.0) {
        return None;
    }
    let inwards = if beyond > width {
        beyond
    } else {
        let far = width - 0.5 - away;
        let far = if far > 0.0 { far * far } else { 0.0 };
        (near * near - far) / (4.0 * width)
    };
    Some(if position > 0.0 { -inwards } else { inwards })
}

impl Correction for SoftCells {
    /// Ticks since the prediction was last outside its cell.
    type State = f32;
    const NEEDS: Signals = Signals::COUNT;
    const DENSE: bool = false;

    fn start(&self) -> f32 {
        0.0
    }

    fn since(gap: &f32) -> f32 {
        *gap
    }

    #[inline(always)]
    fn innovation<'a>(
        &self,
        gap: &mut f32,
        path: Path,
        _: &Sample,
        gains: &'a [Gain; ROWS],
    ) -> Option<Innovation<'a>> {
        let since = *gap + 1.0;
        *gap = since;
        let position = path.from + path.lead;
        let outside = position.abs() > 0.5;
        if path.rests && !outside {
            return None;
        }
        let growth = self.growth * since;
        let width = if growth < WIDEST { growth } else { WIDEST };
        let error = inwards(position, width)?;
        let mut innovation = Innovation {
            error: self.share * error,
            age: 0.0,
            position: 1.0,
            gain: row(gains, since),
            gap: 0.0,
        };
        if outside {
            innovation.error = error;
            innovation.gap = since;
            *gap = 0.0;
        }
        Some(innovation)
    }
}

#[cfg(test)]
mod tests {
    use super::{WIDEST, inwards};

    #[test]
    fn it_is_odd_continuous_and_leads_inside() {
        for width in [0.01, 0.2, 0.5, WIDEST] {
            let mut before = None;
            for step in -3000..=3000 {
                let position = step as f32 / 1000.0;
                let error = inwards(position, width).unwrap_or(0.0);
                let mirrored = inwards(-position, width).unwrap_or(0.0);
                assert_eq!(error, -mirrored, "{position}");
                assert!((position + error).abs() <= 0.5 + 1e-6, "{position} {width}");
                assert!(error * position <= 0.0, "{position} {width}");
                if let Some(before) = before {
                    let jump: f32 = error - before;
                    assert!(jump.abs() < 1.1e-3, "{position} {width}: {jump}");
                }
                before = Some(error);
            }
        }
    }
}
