//! The two lines that are fitted to a window.

use core::fmt::Debug;

use super::best_fit;
use super::cone::Cone;
use super::recent::{Recent, Steps, Stretches};
use crate::sealed::Sealed;
use crate::units::Count;

/// Line fitted to a window: [`EndFit`] or [`BestFit`].
///
/// This trait is sealed: only types of this crate implement it.
pub trait Fit: Copy + Eq + Debug + Sealed {
    #[doc(hidden)]
    type Steps<const N: usize>: Steps;

    /// The longest accepted window of at most `n` intervals with noise bound `d`. `fits_i32` says whether
    /// 32 bits hold the products of the least-squares line.
    ///
    /// The search has more values than there are registers. A bound of 1, the usual one, is a constant
    /// there. Another bound that is in `MEMORY` has a function of its own where it would take registers
    /// from the usual one.
    #[doc(hidden)]
    fn longest<const N: usize, const MEMORY: bool>(
        recent: &Recent<N, Self::Steps<N>>,
        n: usize,
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
pub(super) struct Straight {
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
    type Steps<const N: usize> = Stretches<N>;

    #[inline(always)]
    fn longest<const N: usize, const MEMORY: bool>(
        recent: &Recent<N, Stretches<N>>,
        n: usize,
        _: bool,
        d: i32,
    ) -> Window {
        let (older, stretches) = (recent.older(n), recent.stretches(n));
        match d {
            1 => end_fit(older, stretches, recent.straight(), 1),
            _ => end_fit(older, stretches, recent.straight(), d),
        }
    }
}

#[inline(always)]
fn end_fit(older: &[Count], stretches: &[u8], straight: Straight, d: i32) -> Window {
    let newest = straight.newest;
    let n = older.len();
    let mut cone = Cone::of(straight.rise(), straight.ticks(), d);
    // Only samples at which the step changes are tested. Between two of them samples lie on a line, along
    // which the slope of the window and the limits of a sample are monotone.
    let mut bend = straight.intervals;
    while let Some(stretch) = stretches.get(bend - 1) {
        bend += usize::from(*stretch);
        let Some(count) = older.get(bend - 1) else {
            bend = n;
            break;
        };
        if !cone.narrow_from_inside((newest - *count).0, bend as i32, d) {
            break;
        }
    }
    // One interval is always accepted.
    let outside = match older.get(bend.wrapping_sub(2)..bend) {
        Some(&[newer, oldest]) => {
            cone.outside((newest - oldest).0, bend as i32, (newer - oldest).0)
        }
        _ => 0,
    };
    let intervals = bend - outside as usize;
    // Always inside.
    let oldest = older.get(intervals.wrapping_sub(1)).unwrap_or(&newest);
    Window {
        intervals: intervals as u8,
        slope: (newest - *oldest).to_f32() / intervals as f32,
    }
}

impl Fit for BestFit {
    type Steps<const N: usize> = ();

    #[inline(always)]
    fn longest<const N: usize, const MEMORY: bool>(
        recent: &Recent<N, ()>,
        n: usize,
        fits_i32: bool,
        d: i32,
    ) -> Window {
        let (older, straight) = (recent.older(n), recent.straight());
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
