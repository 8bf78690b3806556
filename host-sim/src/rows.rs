//! Scores as JSON and CSV.

use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;

/// Columns of the CSV: the JSON's fields but the parameters.
pub const COLUMNS: &[&str] = &[
    "scenario",
    "rate_hz",
    "plant",
    "seed",
    "estimator",
    "rms_rad_s",
    "max_rad_s",
    "distance_rad_s",
    "distance_transient_rad_s",
    "distance_pct",
    "distance_transient_pct",
    "rms_pct",
    "outside",
    "delay_ms",
    "noise_rad_s",
    "chatter_rad_s",
    "force_mn",
    "within_2_sigma",
    "non_finite",
];

/// An array of objects, one a line; what is not defined is `null`.
///
/// # Errors
/// [`Failure::Input`]; none is known to happen.
pub fn json<T: Serialize>(rows: &[T]) -> Result<Vec<u8>, Failure> {
    let mut text = b"[".to_vec();
    for (i, row) in rows.iter().enumerate() {
        text.extend_from_slice(if i == 0 { b"\n" } else { b",\n" });
        serde_json::to_writer(&mut text, row).map_err(|e| Failure::Input(e.to_string()))?;
    }
    text.extend_from_slice(b"\n]\n");
    Ok(text)
}

/// These fields of the same objects, or of an object among their fields, as CSV; what is not defined
/// is empty.
///
/// # Errors
/// [`Failure::Input`]; none is known to happen.
pub fn csv<T: Serialize>(rows: &[T], columns: &[&str]) -> Result<Vec<u8>, Failure> {
    let failed = |error: csv::Error| Failure::Input(error.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns).map_err(failed)?;
    for row in rows {
        let object = serde_json::to_value(row).map_err(|e| Failure::Input(e.to_string()))?;
        let cells = columns.iter().map(|&column| match field(&object, column) {
            Value::Null => String::new(),
            Value::String(text) => text.clone(),
            number => number.to_string(),
        });
        writer.write_record(cells).map_err(failed)?;
    }
    writer
        .into_inner()
        .map_err(|e| Failure::Input(e.to_string()))
}

fn field<'a>(object: &'a Value, column: &str) -> &'a Value {
    let inner = || {
        object
            .as_object()?
            .values()
            .find_map(|value| value.get(column))
    };
    object.get(column).or_else(inner).unwrap_or(&Value::Null)
}
