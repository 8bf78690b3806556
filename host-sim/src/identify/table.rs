//! What was identified, for people and for programs.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::Identification;
use super::quantity::{DAMPING, Quantity};

/// The table: values with units and intervals, what was assumed, and the health lines.
#[must_use]
pub fn text(found: &Identification) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{:<32}{:>10}  {:<12}95 % interval",
        "", "value", "unit"
    );
    for quantity in &found.quantities {
        let (unit, scale) = quantity.unit;
        let _ = match &quantity.untold {
            None => writeln!(
                text,
                "{:<32}{:>10.4}  {:<12}{}",
                quantity.key,
                scale * quantity.estimate.value,
                unit,
                quantity.half_text(),
            ),
            Some(why) => writeln!(text, "{:<32}{:>10}  {:<12}{why}", quantity.key, "-", unit),
        };
    }
    let _ = writeln!(text);
    for quantity in found.quantities.iter().filter(|q| q.untold.is_none()) {
        let _ = writeln!(text, "health: {}", health(quantity));
    }
    let _ = writeln!(
        text,
        "\n{} of {} windows used; {:.1} % of the motor's torque unexplained, RMS",
        found.windows.0,
        found.windows.1,
        100.0 * found.unexplained
    );
    for assumed in &found.assumed {
        let _ = writeln!(text, "assumed: {assumed}");
    }
    text
}

/// How far a value is from the device file's, in terms of its interval.
fn health(quantity: &Quantity) -> String {
    let (part, inside) = quantity.health();
    let (unit, scale) = quantity.unit;
    let verdict = match (inside, quantity.key) {
        (true, _) => "inside its interval",
        _ if (part - 1.0).abs() < 0.01 => "outside its interval, but by less than 1 %",
        (false, DAMPING) => "outside its interval: coupler hot, or the file wrong",
        (false, _) => "outside its interval: the file is wrong, or what was assumed",
    };
    let file = scale * quantity.file;
    if quantity.file == 0.0 {
        return format!("{}: the file has none, {verdict}", quantity.key);
    }
    format!(
        "{}: {part:.3} of the file's {file:.4} {unit}, {:+.1} %, {verdict}",
        quantity.key,
        100.0 * (part - 1.0)
    )
}

/// One object a quantity, told or not, in SI units.
#[must_use]
pub fn json(found: &Identification) -> Value {
    let row = |quantity: &Quantity| {
        let (part, inside) = quantity.health();
        let told = quantity.untold.is_none();
        json!({
            "key": quantity.key,
            "value": told.then_some(quantity.estimate.value),
            "half_width_95": told.then_some(quantity.estimate.half),
            "untold": quantity.untold,
            "file": quantity.file,
            "of_file": told.then_some(part).filter(|part| part.is_finite()),
            "file_inside": told.then_some(inside),
        })
    };
    json!({
        "quantities": found.quantities.iter().map(row).collect::<Vec<_>>(),
        "assumed": found.assumed,
        "windows_used": found.windows.0,
        "windows": found.windows.1,
        "unexplained": found.unexplained,
    })
}
