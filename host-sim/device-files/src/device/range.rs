//! Allowed range of one value of a device, and the message about a value outside of it.

use crate::decimal;

/// Allowed range of one value.
pub(super) enum Range {
    /// From the first to the last value, which are far outside of what a device of this kind has: the
    /// simulation and the designs work with every value between.
    Within(f64, f64),
    /// As [`Range::Within`]. A larger value is probably in the unit of the given name, which is ten to the
    /// given power in SI units.
    Usually(f64, f64, &'static str, i32),
    /// A share: from 0 to below 1.
    Share,
}

impl Range {
    /// Checks the value of a key.
    ///
    /// # Errors
    /// One line with the key, the value and what would be right.
    pub(super) fn check(&self, key: &str, value: f64, unit: &str) -> Result<(), String> {
        if !value.is_finite() {
            return Err(format!("{key} = {value}: must be a finite number"));
        }
        let rule = match *self {
            Self::Share if (0.0..1.0).contains(&value) => return Ok(()),
            Self::Share => "at least 0 and below 1".to_owned(),
            Self::Within(least, most) | Self::Usually(least, most, ..) => {
                if (least..=most).contains(&value) {
                    return Ok(());
                }
                if value > most {
                    format!("at most {} {unit}{}", decimal(most), self.hint(value))
                } else if least == 0.0 {
                    format!("0 {unit} or more")
                } else if value <= 0.0 {
                    format!("above 0 {unit}")
                } else {
                    format!("at least {} {unit}", decimal(least))
                }
            }
        };
        Err(format!("{key} = {}: must be {rule}", decimal(value)))
    }

    /// Hint for a value that is too large: the value in SI units, if the given one is in the usual unit.
    fn hint(&self, value: f64) -> String {
        let Self::Usually(_, most, usual, power) = *self else {
            return String::new();
        };
        if value * 10.0_f64.powi(power) > most {
            return String::new();
        }
        let value = decimal(value);
        format!("; did you mean {value}e{power}, which is {value} {usual}?")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_a_range_are_inside() {
        for range in [Range::Within(2.0, 8.0), Range::Usually(2.0, 8.0, "mm", -3)] {
            for (value, rule) in [
                (2.0, None),
                (8.0, None),
                (1.9, Some("at least 2 m")),
                (8.1, Some("at most 8 m")),
            ] {
                let checked = range.check("key", value, "m").err();
                let is_right = match rule {
                    None => checked.is_none(),
                    Some(rule) => {
                        checked.is_some_and(|error| error.contains(&format!("must be {rule}")))
                    }
                };
                assert!(is_right, "{value}");
            }
        }
        assert!(Range::Share.check("key", 0.0, "").is_ok());
        assert!(Range::Share.check("key", 1.0, "").is_err());
    }

    /// 8000 mm are the largest length, and more has no unit that would be right.
    #[test]
    fn unit_that_would_be_right_is_named() {
        let range = Range::Usually(2.0, 8.0, "mm", -3);
        let hint = |value: f64| {
            range
                .check("key", value, "m")
                .unwrap_err()
                .contains("did you mean")
        };
        assert!(hint(9.0) && hint(8000.0));
        assert!(!hint(8001.0));
    }
}
