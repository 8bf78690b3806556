//! Tables of the parasitic force with an estimator in the closed loop.

use std::path::Path;

use measured::Table;
use measured::tables::{
    FREE_AIR_1000HZ, FREE_AIR_11600HZ, SCENE_FORCE, SCENE_ROUGHNESS, TEXTURE_INERTIA,
};
use serde_json::Value;

use crate::runs::{FREE_AIR, compare, number, text, values};
use crate::{cell, check};

/// Fields of a closed-loop row that a table shows, with the factor into its unit.
pub(crate) const FELT: [(&str, f64); 4] = [
    ("parasitic_mn_rms", 1.0),
    ("parasitic_mn_p99", 1.0),
    ("parasitic_mn_tactile", 1.0),
    ("below_threshold", 100.0),
];

/// The figures of [`FELT`] by controller, the reference encoder last.
pub(crate) fn felt(rows: &[Value]) -> Vec<(&str, [f64; 4])> {
    let of = |name| {
        let row = rows.iter().find(|row| text(row, "controlled_by") == name);
        let row = row.expect("a row");
        (
            name,
            FELT.map(|(field, factor)| factor * number(row, field)),
        )
    };
    let mut controllers: Vec<_> = values(rows, "controlled_by").into_iter().map(of).collect();
    // The reference encoder is scored beside every estimator.
    controllers.sort_by_key(|(name, _)| *name == "reference");
    controllers
}

#[test]
fn tables_of_free_air_have_every_controller() {
    for (table, rows) in [FREE_AIR_1000HZ, FREE_AIR_11600HZ].iter().zip(&*FREE_AIR) {
        let row = |(name, figures): &(&str, [f64; 4])| {
            let figures = figures.map(cell);
            [(*name).to_owned()].into_iter().chain(figures).collect()
        };
        let cells: Vec<_> = felt(rows).iter().map(row).collect();
        check(table, &[], &cells);
    }
}

/// A field of the closed-loop rows by scene, in the order of the program, and by controller.
fn check_scenes(table: &Table, rows: &[Value], field: &str) {
    let controllers = table.columns[1..].iter().map(|(name, _)| *name);
    let figure = |scene: &str, controller: &str| {
        let is = |row: &&Value| {
            text(row, "scenario") == scene && text(row, "controlled_by") == controller
        };
        cell(number(rows.iter().find(is).expect(scene), field))
    };
    let row = |scene: &str| {
        let figures = controllers.clone().map(|name| figure(scene, name));
        [scene.to_owned()].into_iter().chain(figures).collect()
    };
    let cells: Vec<_> = values(rows, "scenario").into_iter().map(row).collect();
    check(table, &[], &cells);
}

#[test]
fn tables_of_scenes_have_every_scene() {
    let rows = compare(&["--closed-loop", "--rate", "1000"]);
    check_scenes(&SCENE_FORCE, &rows, "parasitic_mn_rms");
    check_scenes(&SCENE_ROUGHNESS, &rows, "parasitic_mn_tactile");
}

/// Roughness in texture at 10 kHz on this device, mN.
fn texture_roughness(device: &[&str]) -> f64 {
    let base = ["--closed-loop", "--scene", "texture", "--rate", "10000"];
    let rows = compare(&[&base[..], &["--estimator", "adaptive"], device].concat());
    number(&rows[0], "parasitic_mn_tactile")
}

#[test]
fn inertia_of_the_handle_absorbs_the_texture() {
    let device = Path::new(env!("CARGO_TARGET_TMPDIR")).join("light-handle.toml");
    std::fs::write(&device, "[small]\ninertia_kg_m2 = 5e-7\n").expect("a device file");
    let light = ["--device", device.to_str().expect("a path in UTF-8")];
    let row = |name: &str, device| vec![name.to_owned(), cell(texture_roughness(device))];
    let rows = [row("default", &[]), row("a tenth", &light)];
    check(&TEXTURE_INERTIA, &[], &rows);
}
