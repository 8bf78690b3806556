//! The slopes that pass every sample of a window.

use core::ops::{BitOr, Mul, Sub};

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

    /// Keeps the slopes that also pass the sample `rise` counts and `run` ticks ago, unless that
    /// sample is more than `beyond` counts outside the cone; then says no, and the cone is of no
    /// more use.
    ///
    /// Products stay below 2^31 for `|rise| < 2^23`, a cone of such samples and `run <= 128`.
    #[inline(always)]
    pub(super) const fn narrow(&mut self, rise: i32, run: i32, d: i32, beyond: i32) -> bool {
        let Self { lowest, highest } = self;
        // How far the sample is above where one more count is outside, times the bound's run.
        // Without sign, one comparison finds that the bound stays, which is the common case.
        let above = rise * lowest.run - lowest.rise * run + beyond * lowest.run;
        let most = (d + beyond) * lowest.run;
        if above as u32 > most as u32 {
            if above < most {
                return false;
            }
            *lowest = Bound {
                rise: rise - d,
                run,
            };
        }
        let below = highest.rise * run - rise * highest.run + beyond * highest.run;
        let most = (d + beyond) * highest.run;
        if below as u32 > most as u32 {
            if below < most {
                return false;
            }
            *highest = Bound {
                rise: rise + d,
                run,
            };
        }
        true
    }

    /// Whether `rise / run` is in the cone, edges included.
    #[inline(always)]
    pub(super) fn contains<W>(&self, rise: W, run: i32) -> bool
    where
        W: Copy + From<i32> + Sub<Output = W> + Mul<Output = W> + BitOr<Output = W> + PartialOrd,
    {
        let run = W::from(run);
        let [lowest, highest] =
            [self.lowest, self.highest].map(|b| (W::from(b.rise), W::from(b.run)));
        let above = rise * lowest.1 - lowest.0 * run;
        let below = highest.0 * run - rise * highest.1;
        (above | below) >= W::from(0)
    }
}
