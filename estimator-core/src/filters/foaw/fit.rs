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
        match d {
            1 => end_fit(recent, n, 1),
            _ => end_fit(recent, n, d),
        }
    }
}

#[inline(always)]
fn end_fit<const N: usize>(recent: &Recent<N, Stretches<N>>, n: usize, d: i32) -> Window {
    let straight = recent.straight();
    let newest = straight.newest;
    // The last sample is always inside.
    let (intervals, last) = if Stretches::<N>::KEPT {
        let (samples, stretches) = recent.by_age(n);
        let intervals = accepted_of_stretches(samples, stretches, straight, d);
        (intervals, samples.get(usize::from(intervals)))
    } else {
        let older = recent.older(n);
        let intervals = accepted_of_samples(older, straight, d);
        (intervals, older.get(usize::from(intervals).wrapping_sub(1)))
    };
    Window {
        intervals,
        slope: (newest - *last.unwrap_or(&newest)).to_f32() / f32::from(intervals),
    }
}

/// Number of accepted intervals. Every sample is tested.
#[inline(always)]
fn accepted_of_samples(older: &[Count], straight: Straight, d: i32) -> u8 {
    let mut cone = Cone::of(straight.rise(), straight.ticks(), d);
    // Number of samples tested, of which only the last may be rejected.
    let mut seen = straight.intervals;
    let mut accepted = true;
    while accepted && seen < older.len() {
        // Always inside.
        let Some(count) = older.get(seen) else { break };
        seen += 1;
        accepted = cone.narrow_from_inside((straight.newest - *count).0, seen as i32, d);
    }
    seen as u8 - u8::from(!accepted)
}

/// Number of accepted intervals. Of a stretch of equal steps only the oldest sample is tested: its samples lie on
/// a line, along which the slope of the window and the limits of a sample are monotone.
#[inline(always)]
fn accepted_of_stretches(samples: &[Count], stretches: &[u8], straight: Straight, d: i32) -> u8 {
    let newest = straight.newest;
    let mut cone = Cone::of(straight.rise(), straight.ticks(), d);
    let mut age = straight.intervals;
    while let Some(stretch) = stretches.get(age) {
        age += usize::from(*stretch);
        let Some(count) = samples.get(age) else {
            age = samples.len() - 1;
            break;
        };
        if !cone.narrow_from_inside((newest - *count).0, age as i32, d) {
            break;
        }
    }
    // The sample of age 1 is always accepted, and the one before it not read.
    let outside = match (samples.get(age - 1), samples.get(age)) {
        (Some(newer), Some(oldest)) => {
            cone.outside((newest - *oldest).0, age as i32, (*newer - *oldest).0)
        }
        _ => 0,
    };
    (age - outside as usize) as u8
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
