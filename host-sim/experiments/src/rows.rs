//! Scores as JSON and CSV.

use serde::Serialize;
use serde_json::{Map, Value};

use terminal::failure::Failure;

/// The field whose keys differ between rows; it is a single cell of the CSV.
const PARAMETERS: &str = "parameters";

/// JSON array with one object per line; an undefined value is `null`.
///
/// # Errors
/// [`Failure::Input`] if a row cannot be serialised.
pub fn json<T: Serialize>(rows: &[T]) -> Result<Vec<u8>, Failure> {
    let mut text = b"[".to_vec();
    for (i, row) in rows.iter().enumerate() {
        text.extend_from_slice(if i == 0 { b"\n" } else { b",\n" });
        serde_json::to_writer(&mut text, row).map_err(|e| Failure::Input(e.to_string()))?;
    }
    text.extend_from_slice(b"\n]\n");
    Ok(text)
}

/// CSV with the fields of the same objects, in their order. An undefined value is an empty cell. The
/// fields of a nested object are columns, except the parameters, which are one cell `a=1;b=2`.
///
/// # Errors
/// [`Failure::Input`] if a row cannot be serialised.
pub fn csv<T: Serialize>(rows: &[T]) -> Result<Vec<u8>, Failure> {
    let failed = |error: csv::Error| Failure::Input(error.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.iter().enumerate() {
        let row = serde_json::to_value(row).map_err(|e| Failure::Input(e.to_string()))?;
        let mut cells = Vec::new();
        flatten(row.as_object().unwrap_or(&Map::new()), &mut cells);
        if i == 0 {
            let names = cells.iter().map(|(name, _)| name);
            writer.write_record(names).map_err(failed)?;
        }
        let texts = cells.iter().map(|(_, cell)| cell);
        writer.write_record(texts).map_err(failed)?;
    }
    writer
        .into_inner()
        .map_err(|e| Failure::Input(e.to_string()))
}

fn flatten(object: &Map<String, Value>, cells: &mut Vec<(String, String)>) {
    for (name, value) in object {
        match value {
            Value::Object(parameters) if name == PARAMETERS => {
                let each = parameters
                    .iter()
                    .map(|(name, value)| format!("{name}={}", cell(value)));
                cells.push((name.clone(), each.collect::<Vec<_>>().join(";")));
            }
            Value::Object(fields) => flatten(fields, cells),
            value => cells.push((name.clone(), cell(value))),
        }
    }
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        number => number.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Row {
        name: &'static str,
        after: Option<f64>,
        before: f64,
        parameters: std::collections::BTreeMap<&'static str, f64>,
        varied: Inner,
    }

    #[derive(Serialize)]
    struct Inner {
        z: f64,
        a: bool,
    }

    #[test]
    fn columns_are_the_fields_in_their_order() {
        let row = |name, after| Row {
            name,
            after,
            before: 0.5,
            parameters: [("n", 2.0), ("d", 1.0)].into(),
            varied: Inner { z: 1.5, a: true },
        };
        let text = csv(&[row("a,b", None), row("c", Some(-1.0))]).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "name,after,before,parameters,z,a\n\"a,b\",,0.5,d=1.0;n=2.0,1.5,true\nc,-1.0,0.5,d=1.0;\
             n=2.0,1.5,true\n"
        );
    }
}
