//! Figures with so many significant digits.

/// Smaller figures than this one are not written out on a page.
const SMALL: f64 = 0.01;

/// A figure with this many significant digits, at least those before the decimal point. Zero is "0".
#[must_use]
pub fn rounded(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    // The exponent of the rounded figure: 9.96 with two digits is 1.0e1.
    let exponential = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent = exponential
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok());
    let before = 1 + exponent.unwrap_or(0_i32);
    let after = i32::try_from(digits)
        .unwrap_or(i32::MAX)
        .saturating_sub(before);
    format!("{value:.*}", usize::try_from(after).unwrap_or(0))
}

/// What a page shows of a cell: a number with so many significant digits, "< 0.01" if it is positive
/// and smaller, a whole number and any other text as it is.
#[must_use]
pub fn shown(cell: &str, digits: usize) -> String {
    match cell.parse::<f64>() {
        Ok(_) if cell.parse::<i64>().is_ok() => cell.to_owned(),
        Ok(value) if 0.0 < value && value < SMALL => format!("< {SMALL}"),
        Ok(value) if value.is_finite() => rounded(value, digits),
        _ => cell.to_owned(),
    }
}

/// Whether two figures of a page with two digits are the same, give or take a tenth and half a
/// hundredth. Zero is the same as zero alone, and figures below 0.01 are the same as each other.
#[must_use]
pub fn within_a_tenth(then: f64, now: f64) -> bool {
    let (least, most) = (then.min(now), then.max(now));
    if least == 0.0 {
        most == 0.0
    } else if 0.0 < least && least < SMALL {
        most <= 1.1 * SMALL
    } else {
        (then - now).abs() <= 0.1 * now.abs() + 0.005
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones_after_rounding() {
        for (value, digits, text) in [
            (0.0, 2, "0"),
            (0.0612, 2, "0.061"),
            (0.0996, 2, "0.10"),
            (9.94, 2, "9.9"),
            (9.96, 2, "10"),
            (1234.5, 2, "1234"),
            (-0.25, 1, "-0.2"),
            (3.0, 3, "3.00"),
        ] {
            assert_eq!(rounded(value, digits), text);
        }
    }

    #[test]
    fn page_shows_small_figures_and_text() {
        let shown = |cell| shown(cell, 2);
        assert_eq!(shown("0.0099"), "< 0.01");
        assert_eq!(shown("0.01"), "0.010");
        assert_eq!(shown("never on"), "never on");
        assert_eq!(shown("0"), "0");
        assert_eq!(shown("7"), "7");
    }

    #[test]
    fn figures_are_the_same_within_a_tenth() {
        for (then, now, same) in [
            (0.0, 0.0, true),
            (0.0, 0.001, false),
            (0.001, 0.0, false),
            (0.001, 0.0109, true),
            (0.012, 0.0099, false),
            (91.0, 100.0, true),
            (89.0, 100.0, false),
            (111.0, 100.0, false),
        ] {
            assert_eq!(within_a_tenth(then, now), same, "{then} {now}");
        }
    }
}
