//! Numbers in messages.

use device_files::to_digits;

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

/// Digits of a time between two others that a message shows: those that a time since 1970 has behind its seconds.
const SPAN_DIGITS: usize = 7;

/// A time between two others, s, without the digits in which their rounding shows.
pub(super) fn shown_span(s: f64) -> String {
    shown(to_digits(s, SPAN_DIGITS))
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
        assert_eq!(shown_span(1_740_830_406.3 - 1_740_830_400.300_3), "5.9997");
        assert_eq!(shown_span(7.3 - 1.3011), "5.9989");
    }
}
