//! The two ways to draw a line through a window.

use super::best_fit;
use super::cone::Cone;
use crate::units::Count;

/// How a line is fitted to a window: [`EndFit`] or [`BestFit`].
pub trait Fit: Sealed {}

/// The line through both ends of the window, `z_i / i`. The paper's step 3 describes this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndFit;

/// The least-squares line of the window (eq. 6):
/// `(2 S1 - i S0) / (i (i + 1) (i + 2) / 6)`, with `S0 = Σ z_j`, `S1 = Σ j z_j`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BestFit;

impl Fit for EndFit {}
impl Fit for BestFit {}

/// The arithmetic of a fit, kept inside the crate.
pub trait Sealed: Copy {
    /// The longest accepted window of at most `n` intervals with noise bound `d`. The samples before
    /// the newest are `older`, newest first, at most n of them.
    #[doc(hidden)]
    fn longest(older: &[Count], straight: Straight, n: i32, d: i32) -> Window;
}

/// The newest steps that are equal: a line through all their samples, so a window that is accepted.
#[derive(Clone, Copy, Debug)]
pub struct Straight {
    pub(super) newest: Count,
    pub(super) intervals: usize,
    pub(super) step: i32,
}

impl Straight {
    #[inline(always)]
    pub(super) const fn ticks(&self) -> i32 {
        self.intervals as i32
    }

    #[inline(always)]
    pub(super) const fn rise(&self) -> i32 {
        self.step * self.ticks()
    }
}

/// A window and its slope.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub(super) intervals: u8,
    pub(super) slope: f32,
}

impl Sealed for EndFit {
    #[inline(always)]
    fn longest(older: &[Count], straight: Straight, _: i32, d: i32) -> Window {
        let newest = straight.newest;
        let mut cone = Cone::of(straight.rise(), straight.ticks(), d);
        // Samples looked at, of which only the last may be refused: one counter does for the loop.
        let mut seen = straight.intervals;
        let mut accepted = true;
        while accepted && seen < older.len() {
            // Always inside.
            let Some(count) = older.get(seen) else { break };
            seen += 1;
            accepted = cone.narrow_from_inside((newest - *count).0, seen as i32, d);
        }
        let intervals = seen as u8 - u8::from(!accepted);
        // Always inside.
        let oldest = older
            .get(usize::from(intervals).wrapping_sub(1))
            .copied()
            .unwrap_or(newest);
        Window {
            intervals,
            slope: (newest - oldest).to_f32() / f32::from(intervals),
        }
    }
}

impl Sealed for BestFit {
    #[inline(always)]
    fn longest(older: &[Count], straight: Straight, n: i32, d: i32) -> Window {
        if best_fit::fits_i32(straight.step, n, d) {
            best_fit::longest::<i32>(older, straight, d)
        } else {
            best_fit::longest::<i64>(older, straight, d)
        }
    }
}
