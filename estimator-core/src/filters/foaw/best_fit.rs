//! The least-squares line through a window.

use core::ops::{Add, BitOr, Mul, Sub};

use super::cone::Cone;
use super::fit::{Straight, Window};
use crate::units::Count;

/// The longest accepted window. `W` holds the products with the sums without overflow.
#[inline(always)]
pub(super) fn longest<W>(older: &[Count], straight: Straight, d: i32) -> Window
where
    W: Copy + From<i32> + Into<i64> + PartialOrd,
    W: Add<Output = W> + Sub<Output = W> + Mul<Output = W> + BitOr<Output = W>,
{
    let mut cone = Cone::of(straight.rise(), straight.ticks(), d);
    // Number of samples tested, of which only the last may be rejected.
    let mut tick = straight.ticks();
    // Σ z_j, dividend and divisor of the slope, and the latest growth of the divisor.
    let mut sum = straight.step * triangle(tick);
    let mut run = tetrahedron(tick);
    let mut growth = triangle(tick);
    let mut rise = W::from(straight.step) * W::from(run);
    let accepted = loop {
        let Some(count) = older.get(tick as usize) else {
            break true;
        };
        tick += 1;
        let z = (straight.newest - *count).0;
        if !cone.narrow(z, tick, d) {
            break false;
        }
        let wider = rise - W::from(sum) + W::from(tick * z);
        sum += z;
        growth += tick;
        run += growth;
        if cone.excludes(wider, run) {
            break false;
        }
        rise = wider;
    };
    let intervals = tick as u8 - u8::from(!accepted);
    Window {
        intervals,
        slope: quotient(rise.into(), tetrahedron(i32::from(intervals))),
    }
}

/// `i (i + 1) / 2`.
#[inline(always)]
const fn triangle(i: i32) -> i32 {
    ((i * i + i) as u32 / 2) as i32
}

/// `i (i + 1) (i + 2) / 6`, the divisor of the slope of i intervals.
#[inline(always)]
const fn tetrahedron(i: i32) -> i32 {
    ((triangle(i) * (i + 2)) as u32 / 3) as i32
}

/// The longest step for which 32 bits hold the products of all windows of up to `n` intervals that begin
/// with it; -1 for none.
///
/// The first sample keeps every slope in the cone within d of the step. With m = |step| + d, every
/// accepted z_j is below `m (j + 1)`, and the sums and their products are below `m (n + 2)^4 / 3`.
pub(super) const fn longest_i32(n: u32, d: u16) -> i32 {
    let steepest = (3_u64 << 31) / (n + 2).pow(4) as u64;
    let step = steepest as i32 - d as i32;
    if step < 0 { -1 } else { step }
}

/// The quotient, rounded to the closest f32 or one of its neighbours; an exact quotient stays exact.
/// The divisor is below 2^20.
#[inline(always)]
fn quotient(dividend: i64, divisor: i32) -> f32 {
    let by = divisor as f32;
    if let Ok(dividend @ -0x0100_0000..=0x0100_0000) = i32::try_from(dividend) {
        return dividend as f32 / by;
    }
    // The conversion rounds the dividend. The rest beyond the whole counts is divided again; it fits
    // f32, because `|rest| <= 2 divisor`.
    let rounded = (dividend >> 16) as i32 as f32 * 65_536.0 / by;
    let whole = rounded as i32;
    let rest = dividend - i64::from(whole) * i64::from(divisor);
    whole as f32 + rest as i32 as f32 / by
}

#[cfg(test)]
mod tests {
    use super::longest_i32;

    /// `(|step| + d) (n + 2)^4 / 3` is to be below 2^31.
    #[test]
    fn windows_with_small_products_use_32_bits() {
        for (n, steepest) in [(128, 22), (64, 339), (32, 4820), (18, 40_265)] {
            for d in [0, 1, 5] {
                assert_eq!(longest_i32(n, d), steepest - i32::from(d), "{n} {d}");
            }
        }
        // The largest step and the largest bound, and a bound without a step.
        assert!(longest_i32(15, 1 << 14) >= 1 << 15 && longest_i32(18, 1 << 14) < 1 << 15);
        assert_eq!([longest_i32(128, 22), longest_i32(128, 23)], [0, -1]);
    }
}
