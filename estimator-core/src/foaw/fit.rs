//! The two ways to draw a line through a window.

use super::cone::Slope;

/// How a line is fitted to a window: [`EndFit`] or [`BestFit`].
pub trait Fit: Sealed {}

/// The line through both ends of the window, `z_i / i`. The paper's step 3 describes this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndFit {
    displacement: i32,
}

/// The least-squares line of the window (eq. 6):
/// `(2 S1 - i S0) / (i (i + 1) (i + 2) / 6)`, with `S0 = Σ z_j`, `S1 = Σ j z_j`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BestFit {
    sum: i32,
    moment: i64,
}

impl Fit for EndFit {}
impl Fit for BestFit {}

/// The arithmetic of a fit, kept inside the crate.
pub trait Sealed: Copy {
    /// The window of one interval.
    fn new(displacement: i32) -> Self;
    /// Takes the sample `interval` ticks ago in.
    fn include(&mut self, displacement: i32, interval: i32);
    /// The slope of the window of `interval` intervals.
    fn slope(&self, interval: i32) -> Slope;
}

impl Sealed for EndFit {
    fn new(displacement: i32) -> Self {
        Self { displacement }
    }

    fn include(&mut self, displacement: i32, _: i32) {
        self.displacement = displacement;
    }

    fn slope(&self, interval: i32) -> Slope {
        Slope {
            rise: i64::from(self.displacement),
            run: interval,
        }
    }
}

impl Sealed for BestFit {
    fn new(displacement: i32) -> Self {
        Self {
            sum: displacement,
            moment: i64::from(displacement),
        }
    }

    fn include(&mut self, displacement: i32, interval: i32) {
        // |z_j| < 2^22 and j <= 128: the sum stays below 2^29, the moment below 2^36.
        self.sum += displacement;
        self.moment += i64::from(displacement) * i64::from(interval);
    }

    fn slope(&self, interval: i32) -> Slope {
        Slope {
            rise: 2 * self.moment - i64::from(interval) * i64::from(self.sum),
            run: interval * (interval + 1) * (interval + 2) / 6,
        }
    }
}
