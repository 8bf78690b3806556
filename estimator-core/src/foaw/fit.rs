//! The two ways to draw a line through a window.

use super::cone::Cone;
use super::runs::{Run, Runs};
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
    /// The longest accepted window of at most `n` intervals, with noise bound `d`.
    #[doc(hidden)]
    fn longest<const N: usize>(runs: &RunsOf<N>, n: i32, d: i32) -> Window;
}

/// Hides the ring's type from the trait's signature.
#[derive(Clone, Copy, Debug)]
pub struct RunsOf<'a, const N: usize>(pub(super) &'a Runs<N>);

/// A window and its slope.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub(super) intervals: i32,
    pub(super) slope: f32,
}

impl Sealed for EndFit {
    /// Along a run of equal counts the slope `z / i` only comes closer to zero, and so do the
    /// bounds that its samples set: it is enough to look at the ends of runs.
    #[inline]
    fn longest<const N: usize>(runs: &RunsOf<N>, n: i32, d: i32) -> Window {
        let newest = runs.0.newest;
        let older = runs.0.older();
        let mut age = runs.0.length - 1;
        let mut cone = Cone::at_rest(age, d);
        let mut taken = 0;
        // Every run has a sample at least, so not more than these are in the window.
        let mut most = N.min((n - age) as usize);
        while let Some(ahead @ [run, ..]) = older.get(taken..most) {
            // A call is worth it for some samples that all differ.
            if run.is_one_sample() && ahead.get(3).is_some_and(|run| run.is_one_sample()) {
                let inside = cone.follow(ahead, newest, age);
                age += inside as i32;
                taken += inside;
                if ahead.get(inside).is_some_and(|next| next.is_one_sample()) {
                    break;
                }
                continue;
            }
            let z = run.displacement_to(newest);
            let length = run.length();
            if length == 0 || !cone.narrow_from_inside(z, age + 1) {
                break;
            }
            taken += 1;
            age += 1;
            if length == 1 {
                continue;
            }
            let last = n.min(age + length - 1);
            if let Some(left_at) = cone.leaves(z, last) {
                age = left_at;
                break;
            }
            cone.narrow(z, last);
            age = last;
            most = N.min(taken + (n - age) as usize);
        }
        let last = taken.checked_sub(1).and_then(|last| older.get(last));
        let rise = last.map_or(0, |run| run.displacement_to(newest));
        Window {
            intervals: age,
            slope: rise as f32 / age as f32,
        }
    }
}

impl Sealed for BestFit {
    #[inline]
    fn longest<const N: usize>(runs: &RunsOf<N>, n: i32, d: i32) -> Window {
        longest_best_fit(runs.0.older(), runs.0.newest, runs.0.length - 1, n, d)
    }
}

/// Not inlined: one copy for all window lengths.
#[inline(never)]
fn longest_best_fit(older: &[Run], newest: Count, at_rest: i32, n: i32, d: i32) -> Window {
    let mut age = at_rest;
    let mut cone = Cone::at_rest(age, d);
    let mut sums = Sums::at_rest(age);
    let mut runs = older.iter();
    let (mut z, mut left) = (0, 0);
    while age < n {
        if left == 0 {
            let Some(run) = runs.next() else { break };
            z = run.displacement_to(newest);
            left = run.length();
            if left == 0 {
                break;
            }
        }
        left -= 1;
        let tick = age + 1;
        cone.narrow(z, tick);
        sums.include(z, tick);
        // The first window's own line is always in its cone.
        if !cone.contains(sums.rise, sums.run) {
            sums.exclude(z, tick);
            break;
        }
        age = tick;
    }
    Window {
        intervals: age,
        slope: quotient(sums.rise, sums.run),
    }
}

/// What the least-squares slope of a window of i intervals is made of.
struct Sums {
    /// `S0 = Σ z_j`, below 2^29.
    sum: i32,
    /// `2 S1 - i S0`, below 2^36.
    rise: i64,
    /// `i (i + 1) / 2`.
    triangle: i32,
    /// `i (i + 1) (i + 2) / 6`.
    run: i32,
}

impl Sums {
    const fn at_rest(ticks: i32) -> Self {
        let triangle = ticks * (ticks + 1) / 2;
        Self {
            sum: 0,
            rise: 0,
            triangle,
            run: triangle * (ticks + 2) / 3,
        }
    }

    fn include(&mut self, z: i32, tick: i32) {
        self.rise += i64::from(tick) * i64::from(z) - i64::from(self.sum);
        self.sum += z;
        self.triangle += tick;
        self.run += self.triangle;
    }

    /// Undoes the last `include`.
    fn exclude(&mut self, z: i32, tick: i32) {
        self.run -= self.triangle;
        self.triangle -= tick;
        self.sum -= z;
        self.rise -= i64::from(tick) * i64::from(z) - i64::from(self.sum);
    }
}

/// The closest f32, or one as good as that: an exact quotient stays exact. The divisor is below
/// 2^20.
fn quotient(dividend: i64, divisor: i32) -> f32 {
    let by = divisor as f32;
    if dividend.unsigned_abs() <= 1 << 24 {
        return dividend as i32 as f32 / by;
    }
    // The dividend was rounded, too. Divide again what is beyond the whole counts: that fits
    // f32, as `|rest| <= 2 divisor`.
    let rounded = (dividend >> 16) as i32 as f32 * 65_536.0 / by;
    let whole = rounded as i32;
    let rest = dividend - i64::from(whole) * i64::from(divisor);
    whole as f32 + rest as i32 as f32 / by
}
