//! Tables of what the hand feels: causes, and the force without each of them.

use measured::Table;
use measured::digits::within_a_tenth;
use measured::tables::{
    FEEL_BOUNDS, FEEL_CAUSES, FEEL_CAUSES_TACTILE, FEEL_ESTIMATORS, FEEL_HANDLE,
    FEEL_HANDLE_SCENES, FEEL_SMALL_MOTOR, FEEL_WITHOUT, FEEL_WITHOUT_ESTIMATORS,
};
use serde_json::Value;

use crate::forces::FELT;
use crate::runs::{json, number, text, values};
use crate::{cell, check};

/// The rows of `feel` with these arguments.
fn feel(arguments: &[&str]) -> Vec<Value> {
    json(&[&["feel"], arguments].concat())
}

/// The only row that has this text in every field.
fn find<'a>(rows: &'a [Value], of: &[(&str, &str)]) -> &'a Value {
    let is = |row: &&Value| of.iter().all(|(field, value)| row[*field] == *value);
    let mut found = rows.iter().filter(is);
    let row = found.next().unwrap_or_else(|| panic!("{of:?}"));
    assert!(found.next().is_none(), "{of:?}");
    row
}

fn at(rows: &[Value], rate_hz: f64) -> Vec<Value> {
    let is = |row: &&Value| number(row, "rate_hz").to_bits() == rate_hz.to_bits();
    rows.iter().filter(is).cloned().collect()
}

/// A share in the file and on the page, in %. A share of less than 0.05 % is 0.
fn percent(share: f64) -> String {
    let text = format!("{:.1}", 100.0 * share);
    if text == "-0.0" {
        "0.0".to_owned()
    } else {
        text
    }
}

/// Writes a table of shares, or fails where an RMS moved by more than a tenth or a share by more than a
/// point and a tenth of itself.
fn check_shares(table: &Table, rows: &[Vec<String>]) {
    let close = |column: &str, then: f64, now: f64| match column {
        "rms_mn" => within_a_tenth(then, now),
        _ => (then - now).abs() <= 1.0 + 0.1 * then.abs(),
    };
    let checked = table.check(&[], rows, close);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

/// One row of a table of shares: a name, the RMS of `whole`, the shares in the order of the table.
fn shares(
    table: &Table,
    name: &str,
    rows: &[Value],
    of: (&str, &str),
    [whole, share]: [&str; 2],
) -> Vec<String> {
    let force = number(find(rows, &[of, ("without", "nothing")]), whole);
    let causes = table.columns[2..].iter().map(|(cause, _)| *cause);
    let shares: Vec<f64> = causes
        .map(|cause| number(find(rows, &[of, ("cause", cause)]), share))
        .collect();
    let sum: f64 = shares.iter().sum();
    assert!((sum - 1.0).abs() < 1e-6, "{name}: {sum}");
    let shares = shares.into_iter().map(percent);
    [name.to_owned(), format!("{force:.2}")]
        .into_iter()
        .chain(shares)
        .collect()
}

const WHOLE: [&str; 2] = ["parasitic_mn_rms", "share"];
const TACTILE: [&str; 2] = ["parasitic_mn_tactile", "tactile_share"];

#[test]
fn tables_of_causes_have_every_scene_and_estimator() {
    let rows = feel(&["--causes-only", "--estimator", "adaptive"]);
    for (table, fields) in [(FEEL_CAUSES, WHOLE), (FEEL_CAUSES_TACTILE, TACTILE)] {
        let row = |scene| shares(&table, scene, &rows, ("scenario", scene), fields);
        let cells: Vec<_> = values(&rows, "scenario").into_iter().map(row).collect();
        check_shares(&table, &cells);
    }
    let rows = feel(&["--causes-only", "--scene", "free-air"]);
    let row = |name| {
        let of = ("controlled_by", name);
        shares(&FEEL_ESTIMATORS, name, &rows, of, TACTILE)
    };
    let cells: Vec<_> = values(&rows, "controlled_by")
        .into_iter()
        .map(row)
        .collect();
    check_shares(&FEEL_ESTIMATORS, &cells);
}

/// Names of what is switched off, "nothing" first.
fn switched_off(rows: &[Value]) -> Vec<&str> {
    let rows = rows.iter().filter(|row| row["without"].is_string());
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        let name = text(row, "without");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

const RMS: (&str, f64) = FELT[0];
const P99: (&str, f64) = FELT[1];
const BELOW: (&str, f64) = FELT[3];

const RATES_HZ: [f64; 2] = [1e3, 1e4];

#[test]
fn tables_without_each_cause_have_every_cause() {
    let names = ["finite-difference", "foaw-best-fit", "adaptive"];
    let estimators = names.map(|name| ["--estimator", name]).concat();
    let base = ["--scene", "free-air", "--rate", "1000", "--rate", "10000"];
    let rows = feel(&[&base[..], &estimators].concat());
    let figures = |without: &str, names: &[&str], fields: &[(&str, f64)]| {
        let mut cells = vec![without.to_owned()];
        for rows in RATES_HZ.map(|rate_hz| at(&rows, rate_hz)) {
            for name in names {
                let row = find(&rows, &[("controlled_by", name), ("without", without)]);
                let figure = |(field, factor): &(&str, f64)| cell(factor * number(row, field));
                cells.extend(fields.iter().map(figure));
            }
        }
        cells
    };
    let of_adaptive: Vec<_> = (switched_off(&rows).into_iter())
        .map(|without| figures(without, &["adaptive"], &[RMS, P99, BELOW]))
        .collect();
    check(&FEEL_WITHOUT, &[], &of_adaptive);
    let of_all: Vec<_> = (switched_off(&rows).into_iter())
        .map(|without| figures(without, &names, &[RMS]))
        .collect();
    check(&FEEL_WITHOUT_ESTIMATORS, &[], &of_all);
}

/// Seeds 1 and 7001 chose the constants of the compensation; these did not.
const JUDGING: [&str; 5] = ["2", "3", "4", "5", "6"];

/// A row for each estimator of the handle and each judging seed, with these cells of the scenes at a rate.
fn by_handle_and_seed<const N: usize>(
    scenes: &[&str],
    cells: impl Fn(&[Value]) -> [String; N],
) -> Vec<Vec<String>> {
    let mut run = vec!["--causes-only", "--estimator", "adaptive"];
    run.extend(["--rate", "1000", "--rate", "10000"]);
    run.extend(scenes.iter().flat_map(|scene| ["--scene", scene]));
    let mut table = Vec::new();
    for handle in ["kalman-triple-steady", "imm"] {
        for seed in JUDGING {
            let rows = feel(&[&run[..], &["--handle-estimator", handle, "--seed", seed]].concat());
            let mut row = vec![handle.to_owned(), seed.to_owned()];
            row.extend(
                RATES_HZ
                    .into_iter()
                    .flat_map(|rate_hz| cells(&at(&rows, rate_hz))),
            );
            table.push(row);
        }
    }
    table
}

#[test]
fn table_of_the_handles_estimators_has_every_judging_seed() {
    let cells = by_handle_and_seed(&["free-air"], |rows| {
        let nothing = find(rows, &[("without", "nothing")]);
        let figures = [RMS, P99, BELOW, (TACTILE[0], 1.0)];
        figures.map(|(field, factor)| cell(factor * number(nothing, field)))
    });
    check(&FEEL_HANDLE, &[], &cells);
}

#[test]
fn table_of_the_handles_estimators_has_three_scenes() {
    let scenes = ["viscous", "spring-damper", "wall"];
    let cells = by_handle_and_seed(&scenes, |rows| {
        scenes.map(|scene| {
            let row = find(rows, &[("scenario", scene), ("without", "nothing")]);
            cell(number(row, RMS.0))
        })
    });
    check(&FEEL_HANDLE_SCENES, &[], &cells);
}

#[test]
fn table_of_the_small_motors_scenes_has_every_cause() {
    let scenes = ["--scene", "detents", "--scene", "texture"];
    let rows = feel(&[&scenes[..], &["--rate", "1000", "--rate", "10000"]].concat());
    let [slow, fast] = RATES_HZ.map(|rate_hz| at(&rows, rate_hz));
    let row = |without: &str| {
        let figures = [(&slow, "detents"), (&slow, "texture"), (&fast, "texture")];
        let cells = figures.map(|(rows, scene)| {
            let row = find(rows, &[("scenario", scene), ("without", without)]);
            [RMS, BELOW].map(|(field, factor)| cell(factor * number(row, field)))
        });
        [&[without.to_owned()], &cells.concat()[..]].concat()
    };
    let cells: Vec<_> = switched_off(&rows).into_iter().map(row).collect();
    check(&FEEL_SMALL_MOTOR, &[], &cells);
}

/// Every scene but `off`, which commands no current.
#[test]
fn table_of_the_bounds_has_every_scene_with_a_small_motor() {
    let rates = ["--rate", "1000", "--rate", "10000"];
    let rows = feel(&[&["--bounds", "--estimator", "adaptive"], &rates[..]].concat());
    let scenes = values(&rows, "scenario");
    let scenes = scenes.into_iter().filter(|scene| *scene != "off");
    let row = |scene: &str| {
        let mut cells = vec![scene.to_owned()];
        for rows in RATES_HZ.map(|rate_hz| at(&rows, rate_hz)) {
            cells.extend(switched_off(&rows).into_iter().map(|without| {
                let row = find(&rows, &[("scenario", scene), ("without", without)]);
                row[RMS.0].as_f64().map_or_else(|| "-".to_owned(), cell)
            }));
        }
        cells
    };
    let cells: Vec<_> = scenes.map(row).collect();
    check(&FEEL_BOUNDS, &[], &cells);
}
