//! Floats in JSON that are read back to the same value where they are not finite: `inf`, `-inf` and
//! `NaN` as text. For fields with `#[serde(with = "shards::exact")]`.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

/// A number, or a text if the value is not finite.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    match value.is_finite() {
        true => value.serialize(serializer),
        false => value.to_string().serialize(serializer),
    }
}

/// The value of a number or of a text.
///
/// An untagged enumeration does not read the numbers of `serde_json` if any package of the build has its
/// feature `arbitrary_precision`; [`Value`] does.
///
/// # Errors
/// Those of the deserializer; a text that is no number.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let wrong = || D::Error::custom("neither a number nor inf, -inf or NaN");
    match Value::deserialize(deserializer)? {
        Value::Number(number) => number.as_f64().ok_or_else(wrong),
        Value::String(text) => text.parse().map_err(|_| wrong()),
        _ => Err(wrong()),
    }
}

/// The same for two floats. For fields with `#[serde(with = "shards::exact::two")]`.
pub mod two {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Exact(#[serde(with = "super")] f64);

    /// Two numbers or texts.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<S: Serializer>(values: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
        values.map(Exact).serialize(serializer)
    }

    /// The values of two numbers or texts.
    ///
    /// # Errors
    /// Those of the deserializer; a text that is no number.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
        let values = <[Exact; 2]>::deserialize(deserializer)?;
        Ok(values.map(|Exact(value)| value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, Deserialize)]
    struct Row {
        #[serde(with = "super")]
        value: f64,
        #[serde(with = "super::two")]
        pair: [f64; 2],
    }

    #[test]
    fn every_float_is_read_back_with_its_bits() {
        for value in [
            0.0,
            -0.0,
            0.1,
            5e-324,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ] {
            let pair = [value, -value];
            let text = serde_json::to_string(&Row { value, pair }).unwrap();
            let row: Row = serde_json::from_str(&text).unwrap();
            let read = [row.value, row.pair[0], -row.pair[1]];
            let is_same =
                |read: &f64| read.to_bits() == value.to_bits() || read.is_nan() && value.is_nan();
            assert!(read.iter().all(is_same), "{text}");
        }
    }
}
