//! Result of the identification as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::Identification;
use super::fit::Estimate;
use super::quantity::{DAMPING, Quantity, Unit};
use super::ratio::Ratio;
use terminal::wording::wrapped;

/// The result as text: values with units and intervals, health lines, assumptions.
#[must_use]
pub fn text(found: &Identification) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{:<32}{:>10}  {:<11}{:<12}95 %",
        "", "value", "unit", "in SI units"
    );
    let mut rejected = String::new();
    for quantity in &found.quantities {
        let Unit { name, per_si, .. } = quantity.unit;
        let key = quantity.key;
        if let Some(why) = &quantity.rejected {
            let _ = writeln!(
                rejected,
                "{}",
                wrapped(&format!("not identified: {key}: {why}"), 4)
            );
        }
        if !quantity.is_told() {
            let _ = writeln!(text, "{key:<32}{:>10}  {name:<11}", "-");
            continue;
        }
        let Estimate { value, .. } = quantity.estimate;
        let _ = writeln!(
            text,
            "{key:<32}{:>10.4}  {name:<11}{:<12}{}",
            per_si * value,
            format!("{value:.4e}"),
            quantity.half_text(),
        );
    }
    let _ = write!(
        text,
        "The keys are those of the device file, whose values are in SI units.\n\n{rejected}"
    );
    let _ = writeln!(
        text,
        "Counts and current alone determine, without a known constant:"
    );
    for ratio in &found.ratios {
        let Estimate { value, half, .. } = ratio.estimate;
        let _ = writeln!(
            text,
            "{:<42}{value:>10.4e}  {:<10}+-{half:.1e}",
            ratio.name, ratio.unit
        );
    }
    if found.quantities.iter().any(|q| q.rejected.is_none()) {
        text.push('\n');
    }
    for quantity in found.quantities.iter().filter(|q| q.rejected.is_none()) {
        let _ = writeln!(
            text,
            "{}",
            wrapped(
                &format!("health: {}", health(quantity, found.is_default)),
                4
            )
        );
    }
    let _ = writeln!(
        text,
        "\n{} of {} windows used; {:.1} % of the motor's torque unexplained, RMS",
        found.windows.0,
        found.windows.1,
        100.0 * found.unexplained
    );
    for assumed in &found.assumed {
        let _ = writeln!(text, "{}", wrapped(&format!("assumed: {assumed}"), 4));
    }
    text
}

/// Comparison of a value with that of the device file, or of the default device, relative to its interval.
fn health(quantity: &Quantity, is_default: bool) -> String {
    let (part, inside) = quantity.health();
    let Unit { name, per_si, .. } = quantity.unit;
    let verdict = match (inside, quantity.key) {
        (true, _) => "inside its interval",
        _ if (part - 1.0).abs() < 0.01 => "outside its interval, but by less than 1 %",
        _ if is_default => "outside its interval: the device differs, or an assumption is wrong",
        (false, DAMPING) => "outside its interval: the coupler is hot, or the file is wrong",
        (false, _) => "outside its interval: the file or an assumption is wrong",
    };
    let of = match is_default {
        true => "the default device",
        false => "the file",
    };
    let file = per_si * quantity.file;
    if quantity.file == 0.0 {
        return format!("{}: {of} has none, {verdict}", quantity.key);
    }
    format!(
        "{}: {part:.3} of {of}'s {file:.4} {name}, {:+.1} %, {verdict}",
        quantity.key,
        100.0 * (part - 1.0)
    )
}

/// The result as JSON: one object per quantity, in the SI unit that it names. `untold` is the reason
/// of a rejection; `estimate` is the value whether it is rejected or not.
#[must_use]
pub fn json(found: &Identification) -> Value {
    let row = |quantity: &Quantity| {
        let (part, inside) = quantity.health();
        let identified = quantity.rejected.is_none();
        json!({
            "key": quantity.key,
            "unit": quantity.unit.si,
            "value": identified.then_some(quantity.estimate.value),
            "half_width_95": identified.then_some(quantity.estimate.half),
            "untold": quantity.rejected,
            "estimate": quantity.estimate.value,
            "estimate_half_width_95": quantity.estimate.half,
            "file": quantity.file,
            "of_file": identified.then_some(part).filter(|part| part.is_finite()),
            "file_inside": identified.then_some(inside),
        })
    };
    let ratio = |ratio: &Ratio| {
        json!({
            "name": ratio.name,
            "unit": ratio.unit,
            "value": ratio.estimate.value,
            "half_width_95": ratio.estimate.half,
        })
    };
    json!({
        "quantities": found.quantities.iter().map(row).collect::<Vec<_>>(),
        "ratios": found.ratios.iter().map(ratio).collect::<Vec<_>>(),
        "assumed": found.assumed,
        "windows_used": found.windows.0,
        "windows": found.windows.1,
        "unexplained": found.unexplained,
    })
}
