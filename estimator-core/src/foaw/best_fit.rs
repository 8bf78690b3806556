//! The least-squares line.

use core::ops::{Add, BitOr, Mul, Sub};

use super::cone::Cone;
use super::fit::Window;
use crate::units::Count;

/// `W` holds the products.
#[inline(always)]
pub(super) fn longest<W>(
    older: &[Count],
    newest: Count,
    straight: usize,
    step: i32,
    d: i32,
) -> Window
where
    W: Copy
        + From<i32>
        + Into<i64>
        + Add<Output = W>
        + Sub<Output = W>
        + Mul<Output = W>
        + BitOr<Output = W>
        + PartialOrd,
{
    let mut age = straight;
    // Slopes and displacements are less those of the first window from here on, which makes them
    // small.
    let mut cone = Cone::of(0, age as i32, d);
    let mut line = newest.0.wrapping_sub((step * age as i32) as u32);
    let mut sum = 0;
    let mut rise = W::from(0);
    let mut triangle = (age * (age + 1) / 2) as i32;
    let mut run = triangle * (age as i32 + 2) / 3;
    while let Some(count) = older.get(age) {
        let tick = age as i32 + 1;
        line = line.wrapping_sub(step as u32);
        let z = line.wrapping_sub(count.0) as i32;
        if !cone.narrow(z, tick, d, d) {
            break;
        }
        let wider = rise - W::from(sum) + W::from(tick * z);
        triangle += tick;
        if !cone.contains(wider, run + triangle) {
            break;
        }
        run += triangle;
        sum += z;
        rise = wider;
        age += 1;
    }
    let rise = rise.into() + i64::from(step) * i64::from(run);
    Window {
        intervals: age as i32,
        slope: quotient(rise, run),
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
