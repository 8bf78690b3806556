//! Numbers in messages.

use super::steps::to_digits;

/// Digits of a number that a message shows: the time since 1970 in microseconds has 16.
const DIGITS: usize = 15;

/// `x` without digits of rounding, and without more zeros than a line has space for.
#[must_use]
pub fn shown(x: f64) -> String {
    let x = to_digits(x, DIGITS);
    match x == 0.0 || (1e-6..1e15).contains(&x.abs()) {
        true => x.to_string(),
        false => format!("{x:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_has_no_digits_of_rounding() {
        for (x, text) in [
            (0.199_999_999_999_999_98, "0.2"),
            (-0.0005, "-0.0005"),
            (1_740_830_400.001, "1740830400.001"),
            (1e300, "1e300"),
            (0.0, "0"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(shown(x), text);
        }
    }
}
