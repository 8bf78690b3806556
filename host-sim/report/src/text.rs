//! Numbers and names as text.

use catalogue::parameters::PlantKind;
use scoring::score::TACTILE_BAND_HZ;

/// Three significant digits, without exponent from 0.001 on; infinity as its sign.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    let text = match size {
        _ if value.is_nan() => return "not a number".into(),
        _ if size.is_infinite() => "\u{221e}".into(),
        0.0 => return "0".into(),
        _ if size < 0.000_999_5 => format!("{size:.0e}"),
        _ if size < 0.999_5 => format!("{size:.3}"),
        _ if size < 9.995 => format!("{size:.2}"),
        _ if size < 99.95 => format!("{size:.1}"),
        _ => format!("{size:.0}"),
    };
    // U+2212, as wide as a digit.
    if value < 0.0 {
        format!("\u{2212}{text}")
    } else {
        text
    }
}

/// A sample rate with its unit.
pub(super) fn rate(hz: f64) -> String {
    if hz >= 1000.0 {
        let khz = (hz / 10.0).round() / 100.0;
        format!("{khz} kHz")
    } else {
        format!("{hz} Hz")
    }
}

/// A share, 0 to 1, in whole %, with a decimal near either end.
pub(super) fn share(part: f64) -> String {
    let percent = 100.0 * part;
    let near_an_end = percent.min(100.0 - percent) < 9.5;
    if near_an_end && percent > 0.0 && percent < 100.0 {
        format!("{percent:.1}\u{a0}%")
    } else {
        format!("{percent:.0}\u{a0}%")
    }
}

/// The frequencies at which a fingertip feels roughness.
pub(super) fn tactile_band() -> String {
    let [low, high] = TACTILE_BAND_HZ;
    format!("{low} to {high} Hz")
}

/// Name of the plant in a sentence.
pub(super) fn plant(friction: bool) -> &'static str {
    let kind = match friction {
        true => PlantKind::Friction,
        false => PlantKind::Frictionless,
    };
    kind.phrase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_round_across_their_limits() {
        for (value, expected) in [
            (0.0, "0"),
            (0.000_32, "3e-4"),
            (0.3646, "0.365"),
            (0.999_6, "1.00"),
            (1.534, "1.53"),
            (9.996, "10.0"),
            (-42.07, "\u{2212}42.1"),
            (99.96, "100"),
            (168.3, "168"),
            (f64::INFINITY, "\u{221e}"),
        ] {
            assert_eq!(number(value), expected);
        }
    }

    #[test]
    fn rates_are_in_khz_and_shares_keep_a_decimal_near_the_ends() {
        assert_eq!(rate(11_600.0), "11.6 kHz");
        assert_eq!(rate(1000.0), "1 kHz");
        assert_eq!(rate(1250.0), "1.25 kHz");
        assert_eq!(rate(500.0), "500 Hz");
        assert_eq!(share(0.5), "50\u{a0}%");
        assert_eq!(share(0.9968), "99.7\u{a0}%");
        assert_eq!(share(0.032), "3.2\u{a0}%");
        assert_eq!(share(0.0), "0\u{a0}%");
        assert_eq!(share(1.0), "100\u{a0}%");
    }
}
