//! The device file with the identified values.

use device_files::six_digits;
use toml_edit::{DocumentMut, Item, Table, Value};

use super::quantity::{Known, Quantity};
use simulation::device::Device;

/// `text` with the identified values replaced or added; everything else is unchanged. A comment
/// beside each value has its interval and its source. `known` is written if it was `given` on the
/// command line, because the other values depend on it. So are the counts per revolution, unless they are
/// those of `text`.
///
/// # Errors
/// One line if `text` or the result is not a device file.
pub fn updated(
    text: &str,
    quantities: &[Quantity],
    known: Known,
    given: bool,
    counts_per_rev: u32,
    source: &str,
) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    if Device::from_toml_str(text)?.stages.large.counts_per_rev != counts_per_rev {
        let (key, counts) = ("large.counts_per_rev", i64::from(counts_per_rev));
        put(&mut document, key, counts.into(), &format!("of {source}"))?;
    }
    if given {
        let (key, value) = known.entry();
        put(&mut document, key, rounded(value), "given as known")?;
    }
    for quantity in quantities.iter().filter(|q| q.rejected.is_none()) {
        // The estimate of a small friction can be negative.
        let value = quantity.estimate.value.max(0.0);
        let comment = format!(
            "identified from {source} within {} (95 %), with {known} as exact",
            quantity.half_text(),
        );
        put(&mut document, quantity.key, rounded(value), &comment)?;
    }
    let text = document.to_string();
    Device::from_toml_str(&text).map_err(|error| {
        // The file with this line is not written.
        let error = match error.split_once(", ") {
            Some((line, error)) if line.starts_with("line ") => error,
            _ => &error,
        };
        format!("the identified values are no device: {error}")
    })?;
    Ok(text)
}

/// A value with six digits.
fn rounded(value: f64) -> Value {
    Value::from(six_digits(value))
}

/// Sets `section.name`. Its section can be a table, an inline table, or missing.
fn put(
    document: &mut DocumentMut,
    key: &str,
    mut value: Value,
    comment: &str,
) -> Result<(), String> {
    let (section, name) = key.split_once('.').unwrap_or(("", key));
    let section = document
        .entry(section)
        .or_insert_with(|| Item::Table(Table::new()));
    match section {
        Item::Value(Value::InlineTable(table)) => {
            // An inline table has no place for a comment.
            table.insert(name, value);
        }
        Item::Table(table) => {
            value.decor_mut().set_suffix(format!(" # {comment}"));
            let before = table.get(name).and_then(Item::as_value).map(Value::decor);
            if let Some(prefix) = before.and_then(|decor| decor.prefix()) {
                value.decor_mut().set_prefix(prefix.clone());
            }
            match table.get_mut(name) {
                Some(item) => *item = Item::Value(value),
                None => {
                    table.insert(name, Item::Value(value));
                }
            }
        }
        _ => return Err(format!("{key}: {section} must be a table: [{section}]")),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::fit::Estimate;
    use super::super::quantity::{DAMPING, FRICTION, INERTIA};
    use super::*;

    fn quantity(key: &'static str, value: f64) -> Quantity {
        Quantity {
            key,
            estimate: Estimate {
                value,
                half: 0.01 * value,
                by_counts: false,
            },
            file: value,
            unit: super::super::quantity::MILLI_NM,
            rejected: None,
            vague: false,
        }
    }

    #[test]
    fn only_identified_values_are_replaced() {
        let text = "# mine\n[large]\ncounts_per_rev = 2000 # coarse\ninertia_kg_m2 = 1e-5 # old\n\n[hand]\nstiffness_nm_per_rad = 0.4\n";
        let quantities = [quantity(INERTIA, 1.234567e-5), quantity(DAMPING, 0.9e-3)];
        let known = Known::TorqueConstant(0.05);
        let new = updated(text, &quantities, known, true, 2000, "a.csv").unwrap();
        assert!(
            new.starts_with("# mine\n[large]\ncounts_per_rev = 2000 # coarse\ninertia_kg_m2 = ")
        );
        assert!(
            new.contains("[hand]\nstiffness_nm_per_rad = 0.4\n"),
            "{new}"
        );
        assert!(
            !new.contains("old") && new.contains("within +-1.0 % (95 %)"),
            "{new}"
        );
        let device = Device::from_toml_str(&new).unwrap();
        let mut expected = Device::from_toml_str(text).unwrap();
        expected.stages.large.inertia = 1.23457e-5;
        expected.stages.large.torque_constant = 0.05;
        expected.stages.damping = 0.9e-3;
        assert_eq!(device, expected);
        // Once more changes nothing but the same values.
        assert_eq!(
            updated(&new, &quantities, known, true, 2000, "a.csv").unwrap(),
            new
        );
    }

    #[test]
    fn an_inline_section_and_an_untold_value_are_left_in_their_form() {
        let text = "large = { inertia_kg_m2 = 1e-5 }\n";
        let mut rejected = quantity(DAMPING, 1.0);
        rejected.rejected = Some("vague".to_owned());
        let quantities = [quantity(INERTIA, 2e-5), rejected];
        let known = Known::TorqueConstant(0.05);
        let new = updated(text, &quantities, known, false, 4096, "a.csv").unwrap();
        assert_eq!(new, "large = { inertia_kg_m2 = 0.00002 }\n");
    }

    #[test]
    fn other_counts_are_written_as_a_whole_number() {
        let known = Known::TorqueConstant(0.05);
        let quantities = [quantity(INERTIA, 2e-5)];
        let new = updated("", &quantities, known, false, 1000, "a.csv").unwrap();
        assert!(new.contains("counts_per_rev = 1000 # of a.csv\n"), "{new}");
        let read = Device::from_toml_str(&new).unwrap();
        assert_eq!(read.stages.large.counts_per_rev, 1000);
        let default = Device::default().stages.large.counts_per_rev;
        let new = updated("", &quantities, known, false, default, "a.csv").unwrap();
        assert!(!new.contains("counts_per_rev"), "{new}");
    }

    #[test]
    fn friction_below_zero_is_written_as_none() {
        let quantities = [quantity(FRICTION, -1e-5)];
        let known = Known::TorqueConstant(0.05);
        let new = updated("", &quantities, known, false, 4096, "a.csv").unwrap();
        let device = Device::from_toml_str(&new).unwrap();
        assert_eq!(device.stages.large.coulomb_friction, 0.0, "{new}");
    }
}
