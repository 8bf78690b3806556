//! The tables of scenes in docs/, made from the catalogue.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package acceptance --test core scene` writes them.

use firmware_app::config::{DEVICE, RATE};
use firmware_app::scene::BOUNDS;
use haptic_control::SceneKind;
use measured::block::{Block, markdown};

/// The table of scenes: number, name, what it is, torque and needs.
fn scenes() -> String {
    let row = |kind: SceneKind| {
        let facts = kind.facts();
        let needs = facts.needs;
        let yes = |needed| if needed { "yes" } else { "no" };
        let velocity = match (needs.velocity, needs.handle_estimator) {
            (true, _) => "yes",
            (false, true) => "for the slip",
            (false, false) => "no",
        };
        let number = facts.number.to_string();
        let words = [&*number, facts.name, facts.summary, facts.torque, velocity];
        let needs = [
            needs.acceleration,
            needs.continuous,
            needs.transient,
            needs.free,
        ]
        .map(yes);
        words.into_iter().chain(needs).map(str::to_owned).collect()
    };
    let head = [
        "number",
        "scene",
        "what it renders",
        "torque",
        "handle velocity",
        "acceleration",
        "continuous",
        "transient",
        "free",
    ];
    let rows: Vec<_> = SceneKind::ALL.into_iter().map(row).collect();
    markdown(&head, &rows)
}

/// The table of parameters: scene, number, name, unit, bounds and usual value.
fn parameters() -> String {
    let mut rows = Vec::new();
    for kind in SceneKind::ALL {
        let usual = kind.usual(&DEVICE, RATE).expect("the default device");
        for (number, parameter) in (0..).zip(kind.facts().parameters) {
            let range = parameter.quantity.range(&BOUNDS);
            let value = usual.value(number, RATE).expect("the scene has it");
            let unit = match parameter.quantity.unit() {
                "" => "-",
                unit => unit,
            };
            let names = [
                format!("{} {kind}", kind.number()),
                format!("{number} {}", parameter.name),
                unit.to_owned(),
            ];
            let values = [*range.start(), *range.end(), value].map(short);
            rows.push([names, values].concat());
        }
    }
    markdown(
        &["scene", "parameter", "unit", "from", "to", "usual"],
        &rows,
    )
}

/// A number as it is written by hand: 0.04125, but -2.5e-6.
fn short(value: f32) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-4 => format!("{value:e}"),
        _ => value.to_string(),
    }
}

fn check(page: &'static str, name: &'static str, table: &str) {
    let block = Block {
        kind: "catalogue",
        name,
        page,
    };
    let checked = block.check(table);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn every_scene_is_in_the_table_of_scenes() {
    check("docs/theory/scenes.md", "scenes", &scenes());
}

#[test]
fn every_parameter_is_in_the_table_of_commands() {
    check("docs/telemetry.md", "scene parameters", &parameters());
}
