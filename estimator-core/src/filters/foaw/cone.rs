//! The cone of slopes that pass every sample of a window.

use core::ops::{BitOr, Mul, Sub};

use crate::branch::unlikely;

/// A bound on the slope, `rise / run`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    rise: i32,
    run: i32,
}

/// The slopes of the lines through the newest sample that pass within d of all samples so far:
/// from `lowest` to `highest`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    lowest: Bound,
    highest: Bound,
}

impl Cone {
    /// The slopes that pass the sample `rise` counts and `run` ticks ago.
    #[inline(always)]
    pub(super) const fn of(rise: i32, run: i32, d: i32) -> Self {
        let [lowest, highest] = [rise - d, rise + d];
        Self {
            lowest: Bound { rise: lowest, run },
            highest: Bound { rise: highest, run },
        }
    }

    /// Keeps the slopes that also pass the sample `rise` counts and `run` ticks ago, and returns
    /// whether the slope to that sample is in the cone. If it is not, it is outside the same bound as
    /// before, and the other bound is invalid.
    #[inline(always)]
    pub(super) const fn narrow_from_inside(&mut self, rise: i32, run: i32, d: i32) -> bool {
        let Self { lowest, highest } = self;
        // One unsigned comparison finds the usual case: inside, and no narrowing.
        let above = rise * lowest.run - lowest.rise * run;
        let limit = d * lowest.run;
        if above as u32 > limit as u32 {
            if above < limit {
                return false;
            }
            *lowest = Bound {
                rise: rise - d,
                run,
            };
        }
        let below = highest.rise * run - rise * highest.run;
        let limit = d * highest.run;
        if below as u32 > limit as u32 {
            if below < limit {
                return false;
            }
            *highest = Bound {
                rise: rise + d,
                run,
            };
        } else {
            unlikely();
        }
        true
    }

    /// How many samples have a slope outside the cone: those of a stretch of equal steps whose oldest
    /// one is `rise` counts and `run` ticks ago. The sample at its newer end is inside.
    #[inline(always)]
    pub(super) const fn outside(&self, rise: i32, run: i32, step: i32) -> u32 {
        let Self { lowest, highest } = self;
        let above = rise * lowest.run - lowest.rise * run;
        let below = highest.rise * run - rise * highest.run;
        // The margin of the oldest, and what each newer one has more.
        let (margin, more) = if above < 0 {
            (above, lowest.rise - step * lowest.run)
        } else if below < 0 {
            (below, step * highest.run - highest.rise)
        } else {
            return 0;
        };
        // ⌈-margin / more⌉; `more` is never 0, because the newer sample is inside.
        match (!margin as u32).checked_div(more as u32) {
            Some(whole) => whole + 1,
            None => 1,
        }
    }

    /// Keeps the slopes that also pass the sample `rise` counts and `run` ticks ago, and returns
    /// whether any is left.
    #[inline(always)]
    pub(super) const fn narrow(&mut self, rise: i32, run: i32, d: i32) -> bool {
        let Self { lowest, highest } = self;
        let above = rise * lowest.run - lowest.rise * run;
        let below = highest.rise * run - rise * highest.run;
        if above > d * lowest.run {
            if below < -d * highest.run {
                unlikely();
                return false;
            }
            *lowest = Bound {
                rise: rise - d,
                run,
            };
        }
        if below > d * highest.run {
            // Not if the lowest bound has just moved, because `above` is then positive.
            if above < -d * lowest.run {
                unlikely();
                return false;
            }
            *highest = Bound {
                rise: rise + d,
                run,
            };
        } else {
            unlikely();
        }
        true
    }

    /// Whether `rise / run` is outside the cone.
    #[inline(always)]
    pub(super) fn excludes<W>(&self, rise: W, run: i32) -> bool
    where
        W: Copy + From<i32> + Sub<Output = W> + Mul<Output = W> + BitOr<Output = W> + PartialOrd,
    {
        let Self { lowest, highest } = self;
        let above = rise * W::from(lowest.run) - W::from(lowest.rise) * W::from(run);
        let below = W::from(highest.rise) * W::from(run) - rise * W::from(highest.run);
        (above | below) < W::from(0)
    }
}
