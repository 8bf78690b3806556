//! The slopes that pass every sample of a window.

/// A slope as an exact fraction: counts over ticks, or both times the same factor.
#[derive(Clone, Copy, Debug)]
pub struct Slope {
    pub(super) rise: i64,
    /// Positive, below 2^20.
    pub(super) run: i32,
}

impl Slope {
    /// The closest f32, or one as good as that: an exact slope stays exact.
    pub(super) fn to_f32(self) -> f32 {
        let run = self.run as f32;
        let quotient = self.rise as f32 / run;
        if self.rise.unsigned_abs() <= 1 << 24 {
            return quotient;
        }
        // The dividend was rounded, too. Divide again what is beyond the whole counts: that fits
        // f32, as `|rest| <= 2 run`.
        let whole = quotient as i32;
        let rest = self.rise - i64::from(whole) * i64::from(self.run);
        whole as f32 + rest as i32 as f32 / run
    }
}

/// A bound on the slope, `rise / run`, with `|rise| < 2^23` and `run <= 128`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    rise: i32,
    run: i32,
}

impl Bound {
    /// Both products stay below 2^30.
    fn is_above(self, other: Self) -> bool {
        self.rise * other.run > other.rise * self.run
    }
}

/// The slopes of the lines through the newest sample that pass within d of all samples so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    lowest: Bound,
    highest: Bound,
}

impl Cone {
    /// The cone of the previous sample, `displacement` counts and one tick ago.
    pub(super) fn new(displacement: i32, d: i32) -> Self {
        Self {
            lowest: Bound {
                rise: displacement - d,
                run: 1,
            },
            highest: Bound {
                rise: displacement + d,
                run: 1,
            },
        }
    }

    /// Keeps the slopes that also pass the sample `run` ticks ago.
    pub(super) fn narrow(&mut self, displacement: i32, run: i32, d: i32) {
        let low = Bound {
            rise: displacement - d,
            run,
        };
        let high = Bound {
            rise: displacement + d,
            run,
        };
        if low.is_above(self.lowest) {
            self.lowest = low;
        }
        if self.highest.is_above(high) {
            self.highest = high;
        }
    }

    /// Whether `slope` is in the cone, edges included. Products stay below 2^45.
    pub(super) fn contains(&self, slope: Slope) -> bool {
        slope.rise * i64::from(self.lowest.run)
            >= i64::from(self.lowest.rise) * i64::from(slope.run)
            && slope.rise * i64::from(self.highest.run)
                <= i64::from(self.highest.rise) * i64::from(slope.run)
    }
}
