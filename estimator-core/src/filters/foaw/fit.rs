//! The two lines that are fitted to a window.

use super::best_fit;
use super::cone::Cone;
use crate::sealed::Sealed;
use crate::units::Count;

/// Line fitted to a window: [`EndFit`] or [`BestFit`].
///
/// This trait is sealed: only types of this crate implement it.
pub trait Fit: Copy + Sealed {
    /// The longest accepted window of at most `n` intervals with noise bound `d`. `older` holds at
    /// most n samples before the newest one, newest first.
    #[doc(hidden)]
    fn longest(older: &[Count], straight: Straight, n: i32, d: i32) -> Window;
}

/// The line through both ends of the window, `z_i / i`. The paper's step 3 describes this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndFit;

/// The least-squares line of the window (eq. 6):
/// `(2 S1 - i S0) / (i (i + 1) (i + 2) / 6)`, with `S0 = Σ z_j`, `S1 = Σ j z_j`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BestFit;

impl Sealed for EndFit {}
impl Sealed for BestFit {}

/// The newest steps that are equal. One line passes through all their samples, so they are an
/// accepted window.
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

/// An accepted window and its slope.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub(super) intervals: u8,
    pub(super) slope: f32,
}

impl Fit for EndFit {
    #[inline(always)]
    fn longest(older: &[Count], straight: Straight, _: i32, d: i32) -> Window {
        let newest = straight.newest;
        let mut cone = Cone::of(straight.rise(), straight.ticks(), d);
        // Number of samples tested, of which only the last may be rejected.
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

impl Fit for BestFit {
    #[inline(always)]
    fn longest(older: &[Count], straight: Straight, n: i32, d: i32) -> Window {
        if best_fit::fits_i32(straight.step, n, d) {
            best_fit::longest::<i32>(older, straight, d)
        } else {
            best_fit::longest::<i64>(older, straight, d)
        }
    }
}
