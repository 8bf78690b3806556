//! The tables of scenes in docs/, made from the catalogue.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package acceptance --test core scene_docs` writes them.

use std::fmt::Write as _;
use std::path::Path;

use firmware_app::config::{DEVICE, RATE};
use firmware_app::scene::BOUNDS;
use haptic_control::SceneKind;

/// The rows of scenes: number, name, what it is, torque and needs.
fn scenes() -> String {
    let mut table = "\
| number | scene | what it renders | torque | handle velocity | acceleration | continuous | transient |
|---|---|---|---|---|---|---|---|
"
    .to_owned();
    for kind in SceneKind::ALL {
        let facts = kind.facts();
        let needs = facts.needs;
        let yes = |needed| if needed { "yes" } else { "no" };
        let velocity = match (needs.velocity, needs.handle_estimator) {
            (true, _) => "yes",
            (false, true) => "for the slip",
            (false, false) => "no",
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "| {} | {} | {} | {} | {velocity} | {} | {} | {} |",
            facts.number,
            facts.name,
            facts.summary,
            facts.torque,
            yes(needs.acceleration),
            yes(needs.continuous),
            yes(needs.transient),
        );
    }
    table
}

/// The rows of parameters: scene, number, name, unit, bounds and usual value.
fn parameters() -> String {
    let mut table = "\
| scene | parameter | unit | from | to | usual |
|---|---|---|---|---|---|
"
    .to_owned();
    for kind in SceneKind::ALL {
        let usual = kind.usual(&DEVICE, RATE).expect("the default device");
        for (number, parameter) in (0..).zip(kind.facts().parameters) {
            let range = parameter.quantity.range(&BOUNDS);
            let value = usual.value(number, RATE).expect("the scene has it");
            let unit = match parameter.quantity.unit() {
                "" => "-",
                unit => unit,
            };
            let [least, most, value] = [*range.start(), *range.end(), value].map(short);
            let _ = writeln!(
                table,
                "| {} {kind} | {number} {} | {unit} | {least} | {most} | {value} |",
                kind.number(),
                parameter.name,
            );
        }
    }
    table
}

/// A number as it is written by hand: 0.04125, but -2.5e-6.
fn short(value: f32) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-4 => format!("{value:e}"),
        _ => value.to_string(),
    }
}

fn check(file: &str, name: &str, table: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(file);
    let text = std::fs::read_to_string(&path).expect(file);
    let begin = format!("<!-- {name}: written by the test scene_docs -->");
    let end = format!("<!-- end of {name} -->");
    let (before, rest) = text.split_once(&begin).expect("the table's beginning");
    let (written, after) = rest.split_once(&end).expect("the table's end");
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        let text = format!("{before}{begin}\n\n{table}\n{end}{after}");
        std::fs::write(&path, text).expect("docs can be written");
    } else {
        assert_eq!(
            written.trim(),
            table.trim(),
            "docs/{file} differs from the catalogue: UPDATE_GOLDEN=1 writes the table anew"
        );
    }
}

#[test]
fn every_scene_is_in_the_table_of_scenes() {
    check("theory/scenes.md", "list of scenes", &scenes());
}

#[test]
fn every_parameter_is_in_the_table_of_commands() {
    check("telemetry.md", "scene parameters", &parameters());
}
