//! The two lines that are fitted to a window.

use super::best_fit;
use super::cone::Cone;
use crate::sealed::Sealed;
use crate::units::Count;

/// Line fitted to a window: [`EndFit`] or [`BestFit`].
///
/// This trait is sealed: only types of this crate implement it.
pub trait Fit: Copy + Sealed {
    /// The longest accepted window with noise bound `d`. `older` holds the samples before the newest
    /// one, newest first. `fits_i32` says whether 32 bits hold the products of the least-squares line.
    ///
    /// The search has more values than there are registers. A bound of 1, the usual one, is a constant
    /// there. Another bound that is in `MEMORY` has a function of its own where it would take registers
    /// from the usual one.
    #[doc(hidden)]
    fn longest<const MEMORY: bool>(
        older: &[Count],
        straight: Straight,
        fits_i32: bool,
        d: i32,
    ) -> Window;
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
    fn longest<const MEMORY: bool>(older: &[Count], straight: Straight, _: bool, d: i32) -> Window {
        match d {
            1 => end_fit(older, straight, 1),
            _ => end_fit(older, straight, d),
        }
    }
}

#[inline(always)]
fn end_fit(older: &[Count], straight: Straight, d: i32) -> Window {
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

impl Fit for BestFit {
    #[inline(always)]
    fn longest<const MEMORY: bool>(
        older: &[Count],
        straight: Straight,
        fits_i32: bool,
        d: i32,
    ) -> Window {
        match d {
            1 => best_fit(older, straight, fits_i32, 1),
            _ if MEMORY => best_fit_of_memory(older, straight, fits_i32, d),
            _ => best_fit(older, straight, fits_i32, d),
        }
    }
}

#[inline(never)]
fn best_fit_of_memory(older: &[Count], straight: Straight, fits_i32: bool, d: i32) -> Window {
    best_fit(older, straight, fits_i32, d)
}

#[inline(always)]
fn best_fit(older: &[Count], straight: Straight, fits_i32: bool, d: i32) -> Window {
    if fits_i32 {
        best_fit::longest::<i32>(older, straight, d)
    } else {
        best_fit::longest::<i64>(older, straight, d)
    }
}
