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
    /// The longest accepted window up to `newest` of the samples `older`, newest first. The newest
    /// `straight` steps are all `step`, so that the window of as many intervals is accepted.
    #[doc(hidden)]
    fn longest(
        older: &[Count],
        newest: Count,
        straight: usize,
        step: i32,
        n: i32,
        d: i32,
    ) -> Window;
}

/// A window and its slope.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub(super) intervals: i32,
    pub(super) slope: f32,
}

impl Sealed for EndFit {
    #[inline(always)]
    fn longest(
        older: &[Count],
        newest: Count,
        straight: usize,
        step: i32,
        _: i32,
        d: i32,
    ) -> Window {
        let mut cone = Cone::of(step * straight as i32, straight as i32, d);
        let mut age = straight;
        while let Some(count) = older.get(age) {
            if !cone.narrow((newest - *count).0, age as i32 + 1, d, 0) {
                break;
            }
            age += 1;
        }
        // Always inside.
        let oldest = older.get(age.wrapping_sub(1)).copied().unwrap_or(newest);
        let rise = (newest - oldest).0;
        Window {
            intervals: age as i32,
            slope: rise as f32 / age as f32,
        }
    }
}

impl Sealed for BestFit {
    #[inline(always)]
    fn longest(
        older: &[Count],
        newest: Count,
        straight: usize,
        step: i32,
        n: i32,
        d: i32,
    ) -> Window {
        if (d as u32).checked_mul(((n + 2) as u32).pow(4)).is_some() {
            best_fit::longest::<i32>(older, newest, straight, step, d)
        } else {
            best_fit::longest::<i64>(older, newest, straight, step, d)
        }
    }
}
