//! Intervals between samples that differ from the control period.

/// Range of an interval, control periods.
const PERIODS: [f32; 2] = [1.0 / 1024.0, 1_048_576.0];

/// Argument up to which a series of the exponential function is short.
pub(crate) const SHORT: f32 = 0.25;

/// Halvings that bring every argument of [`lost`] and every interval of a bank to [`SHORT`] or below.
pub(crate) const HALVINGS: usize = 24;

/// `period` within the range of [`VaryingPeriod`](crate::VaryingPeriod); NaN is the shortest.
#[inline(always)]
pub(crate) fn limited_period(period: f32) -> f32 {
    if !(period >= PERIODS[0]) {
        PERIODS[0]
    } else if period > PERIODS[1] {
        PERIODS[1]
    } else {
        period
    }
}

/// The smaller of two numbers, the second if one is NaN. `f32::min` is a call of a mathematical library on
/// processors without an FPU.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `1 - exp(-x)` for x from 0 to 4e6: the part of a quantity that a decay removes.
///
/// The argument is halved until the series is short; then `1 - exp(-2y) = m (2 - m)` with
/// `m = 1 - exp(-y)`.
pub(crate) fn lost(x: f32) -> f32 {
    let mut y = x;
    let mut halvings = 0;
    while y > SHORT && halvings < HALVINGS {
        y *= 0.5;
        halvings += 1;
    }
    // y - y²/2! + y³/3! - .. to 6e-10 relative.
    let mut m =
        y * (1.0 - y / 2.0 * (1.0 - y / 3.0 * (1.0 - y / 4.0 * (1.0 - y / 5.0 * (1.0 - y / 6.0)))));
    for _ in 0..halvings {
        m *= 2.0 - m;
    }
    m
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{HALVINGS, PERIODS, SHORT, limited_period, lost};

    #[test]
    fn lost_part_is_that_of_the_exponential_function() {
        let mut x = 1e-4f32;
        while x < 4e6 {
            let exact = -(-f64::from(x)).exp_m1();
            let off = f64::from(lost(x)) / exact - 1.0;
            assert!(off.abs() < 5e-7, "{x}: {off}");
            x *= 1.003;
        }
        assert_eq!(lost(0.0), 0.0);
    }

    #[test]
    fn halvings_suffice_for_the_longest_interval() {
        // A pole at half the rate: π per period. A bank has at most 1 per period.
        let longest = std::f32::consts::PI * PERIODS[1];
        assert!(longest / 2f32.powi(HALVINGS as i32) < SHORT);
    }

    #[test]
    fn intervals_out_of_range_are_limited() {
        for (period, limited) in [
            (0.0, PERIODS[0]),
            (-3.0, PERIODS[0]),
            (f32::NAN, PERIODS[0]),
            (1e-3, 1e-3),
            (1.0, 1.0),
            (7e5, 7e5),
            (f32::INFINITY, PERIODS[1]),
        ] {
            assert_eq!(limited_period(period), limited.max(PERIODS[0]), "{period}");
        }
    }
}
