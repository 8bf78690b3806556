//! The slopes that pass every sample of a window.

use super::runs::Run;
use crate::units::Count;

/// A bound on the slope, `rise / run`, with `|rise| < 2^23` and `run <= 128`; with `run = 0`
/// infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    pub(super) rise: i32,
    pub(super) run: i32,
}

/// The slopes of the lines through the newest sample that pass within d of all samples so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub(super) lowest: Bound,
    pub(super) highest: Bound,
    d: i32,
}

impl Cone {
    /// The cone of `ticks` samples that read the same as the newest.
    pub(super) const fn at_rest(ticks: i32, d: i32) -> Self {
        let rise = if ticks == 0 { 1 } else { d };
        Self {
            lowest: Bound {
                rise: -rise,
                run: ticks,
            },
            highest: Bound { rise, run: ticks },
            d,
        }
    }

    /// How far `rise / run` is above the lowest slope, times both runs: below 2^31.
    pub(super) const fn above_lowest(&self, rise: i32, run: i32) -> i32 {
        rise * self.lowest.run - self.lowest.rise * run
    }

    /// How far `rise / run` is below the highest slope, times both runs: below 2^31.
    pub(super) const fn below_highest(&self, rise: i32, run: i32) -> i32 {
        self.highest.rise * run - rise * self.highest.run
    }

    /// Keeps the slopes that also pass the sample `rise` counts and `run` ticks ago.
    pub(super) const fn narrow(&mut self, rise: i32, run: i32) {
        if self.above_lowest(rise, run) > self.d * self.lowest.run {
            self.raise(rise, run);
        }
        if self.below_highest(rise, run) > self.d * self.highest.run {
            self.lower(rise, run);
        }
    }

    /// As `narrow`, if the slope to that sample is in the cone; if not, says so, and the cone is
    /// of no more use.
    pub(super) const fn narrow_from_inside(&mut self, rise: i32, run: i32) -> bool {
        // Neither outside nor narrower takes one comparison, without sign.
        let above = self.above_lowest(rise, run);
        if above as u32 > (self.d * self.lowest.run) as u32 {
            if above < 0 {
                return false;
            }
            self.raise(rise, run);
        }
        let below = self.below_highest(rise, run);
        if below as u32 > (self.d * self.highest.run) as u32 {
            if below < 0 {
                return false;
            }
            self.lower(rise, run);
        }
        true
    }

    /// Narrows the cone by runs of one sample each, the first of them `age + 1` ticks ago, up to
    /// the first that is longer or outside; says how many these are.
    pub(super) fn follow(&mut self, runs: &[Run], newest: Count, age: i32) -> usize {
        // With the usual bound known, the loop has the registers that it needs.
        match self.d {
            1 => self.follow_by_one(runs, newest, age),
            _ => self.follow_by_d(runs, newest, age),
        }
    }

    #[inline(never)]
    fn follow_by_one(&mut self, runs: &[Run], newest: Count, age: i32) -> usize {
        let mut cone = Self { d: 1, ..*self };
        let followed = cone.followed(runs, newest, age);
        *self = cone;
        followed
    }

    #[inline(never)]
    fn follow_by_d(&mut self, runs: &[Run], newest: Count, age: i32) -> usize {
        let mut cone = *self;
        let followed = cone.followed(runs, newest, age);
        *self = cone;
        followed
    }

    #[inline(always)]
    fn followed(&mut self, runs: &[Run], newest: Count, age: i32) -> usize {
        let mut tick = age;
        for run in runs {
            tick += 1;
            let Some(z) = run.displacement_if_one(newest) else {
                return (tick - age - 1) as usize;
            };
            if !self.narrow_from_inside(z, tick) {
                return (tick - age - 1) as usize;
            }
        }
        runs.len()
    }

    /// How long the slope to samples `rise` counts away stays in the cone, if it leaves it before
    /// the sample `run` ticks ago.
    pub(super) fn leaves(&self, rise: i32, run: i32) -> Option<i32> {
        let edge = if rise >= 0 {
            if self.above_lowest(rise, run) >= 0 {
                return None;
            }
            self.lowest
        } else {
            if self.below_highest(rise, run) >= 0 {
                return None;
            }
            self.highest
        };
        // The slope of that edge is of the same sign and not zero.
        (rise * edge.run)
            .unsigned_abs()
            .checked_div(edge.rise.unsigned_abs())
            .map(|ticks| ticks as i32)
    }

    const fn raise(&mut self, rise: i32, run: i32) {
        self.lowest = Bound {
            rise: rise - self.d,
            run,
        };
    }

    const fn lower(&mut self, rise: i32, run: i32) {
        self.highest = Bound {
            rise: rise + self.d,
            run,
        };
    }

    /// Whether `rise / run` is in the cone, edges included. Products stay below 2^45.
    pub(super) fn contains(&self, rise: i64, run: i32) -> bool {
        let above =
            rise * i64::from(self.lowest.run) - i64::from(self.lowest.rise) * i64::from(run);
        let below =
            i64::from(self.highest.rise) * i64::from(run) - rise * i64::from(self.highest.run);
        (above | below) >= 0
    }
}
