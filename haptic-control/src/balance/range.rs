//! Ranges of a quantity that is not known exactly.

/// The values from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) low: f32,
    pub(super) high: f32,
}

impl Range {
    /// The products with `x`.
    pub(super) fn times(self, x: f32) -> Self {
        if x < 0.0 {
            Self {
                low: self.high * x,
                high: self.low * x,
            }
        } else {
            Self {
                low: self.low * x,
                high: self.high * x,
            }
        }
    }

    /// The differences from a value `x`, whose error is `error`.
    pub(super) fn below(self, x: f32, error: f32) -> Self {
        Self {
            low: x - self.high - error,
            high: x - self.low + error,
        }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            high: self.high + other.high,
        }
    }

    pub(super) fn negative(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }

    pub(super) fn meets(self, other: Self) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// Widened by `by` on both sides, but within `most`.
    pub(super) fn widened(self, by: f32, most: Self) -> Self {
        Self {
            low: larger(self.low - by, most.low),
            high: -larger(-self.high - by, -most.high),
        }
    }

    /// The common part.
    pub(super) fn narrowed(self, low: f32, high: f32) -> Self {
        Self {
            low: larger(self.low, low),
            high: -larger(-self.high, -high),
        }
    }
}

pub(super) fn larger(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}
