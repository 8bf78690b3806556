//! Complete tables of every estimator: README.md and docs/benchmarks.md hold every row that the
//! program prints, in its order.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package host-sim --test documented complete` writes
//! the tables. Without the variable the test fails where a figure moved by more than a tenth.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use catalogue::estimators::Kind;
use serde_json::Value;
use simulation::scenario::ScenarioName;

use crate::is_written_for;

/// The three scenarios of the paper's experiment, on which parameters are tuned with other seeds.
const TUNED_ON: [&str; 3] = ["step", "permanent", "track"];

/// The rows of `compare` with these arguments, as its JSON has them.
fn rows(arguments: &[&str]) -> Vec<Value> {
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(["compare", "--no-report", "--json", "-"])
        .args(arguments)
        .output()
        .expect("host-sim runs");
    assert!(output.status.success(), "{arguments:?}");
    serde_json::from_slice(&output.stdout).expect("standard output is JSON")
}

fn text<'a>(row: &'a Value, field: &str) -> &'a str {
    row[field].as_str().expect(field)
}

/// Mean distance of one estimator over these scenarios, % of finite difference's on them.
fn pooled(rows: &[Value], estimator: &str, scenarios: &[&str]) -> f64 {
    let distance = |name: &str| -> f64 {
        let is = |row: &&Value| {
            text(row, "estimator") == name && scenarios.contains(&text(row, "scenario"))
        };
        let distances: Vec<_> = rows.iter().filter(is).collect();
        assert_eq!(distances.len(), scenarios.len(), "{name}");
        let values = distances.iter().map(|row| row["distance_rad_s"].as_f64());
        values.sum::<Option<f64>>().expect("a distance")
    };
    100.0 * distance(estimator) / distance("finite-difference")
}

/// Figures below this one are not written out.
const SMALL: f64 = 0.01;

/// Two significant digits from 0.01 on, whole numbers from 10 on. "0" is exactly that.
fn cell(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if value < SMALL => format!("< {SMALL}"),
        _ if value >= 9.95 => format!("{value:.0}"),
        _ => {
            let digits = 1 - value.log10().floor() as i32;
            format!("{value:.*}", digits.max(0) as usize)
        }
    }
}

/// Whether `written` is what would be written for `value`, give or take a tenth.
fn agrees(written: &str, value: &str) -> bool {
    match (written.parse::<f64>(), value.parse::<f64>()) {
        (Ok(_), Ok(value)) => is_written_for(written, value),
        (Err(_), Err(_)) => written == value,
        // A figure may cross the mark by the tenth.
        (Ok(figure), Err(_)) | (Err(_), Ok(figure)) => 0.0 < figure && figure <= 1.1 * SMALL,
    }
}

static WRITING: Mutex<()> = Mutex::new(());

/// Writes the table called `name` in `file`, or compares it.
fn check(file: &str, name: &str, head: &[&str], rows: &[Vec<String>]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    let _guard = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let document = std::fs::read_to_string(&path).expect(file);
    let begin = format!("<!-- {name}: written by the test documented -->\n");
    let end = format!("<!-- end of {name} -->");
    let (before, rest) = document.split_once(&begin).expect("the table's beginning");
    let (table, after) = rest.split_once(&end).expect("the table's end");
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        let mut lines = format!("| {} |\n{}|\n", head.join(" | "), "|---".repeat(head.len()));
        for row in rows {
            lines += &format!("| {} |\n", row.join(" | "));
        }
        let document = format!("{before}{begin}\n{lines}\n{end}{after}");
        std::fs::write(&path, document).expect("the document can be written");
        return;
    }
    let cells = |line: &str| -> Vec<String> {
        let cells = line.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let written: Vec<_> = table.trim().lines().map(cells).collect();
    assert_eq!(written[0], head, "{file}, {name}");
    assert_eq!(written.len(), rows.len() + 2, "rows of {file}, {name}");
    let mut moved = Vec::new();
    for (written, now) in written[2..].iter().zip(rows) {
        assert_eq!(written.len(), now.len(), "{file}, {name}: {written:?}");
        for (column, head) in head.iter().enumerate() {
            let (then, now) = (&written[column], &now[column]);
            if !agrees(then, now) {
                moved.push(format!("{}, {head}: {then} became {now}", written[0]));
            }
        }
    }
    assert!(moved.is_empty(), "{file}, {name}: {moved:#?}");
}

/// What an estimator reads, in words.
fn signals(kind: &Kind) -> String {
    let needs = kind.needs;
    let mut words = vec![if needs.edge { "edges" } else { "counts" }];
    if needs.current {
        words.push("current");
    }
    if needs.coupled {
        words.push("handle");
    }
    words.join(", ")
}

/// Fields of a closed-loop row that a table shows, with the factor into its unit.
const FELT: [(&str, f64); 4] = [
    ("parasitic_mn_rms", 1.0),
    ("parasitic_mn_p99", 1.0),
    ("parasitic_mn_tactile", 1.0),
    ("below_threshold", 100.0),
];

/// The figures of [`FELT`] by controller, the reference encoder last.
fn felt(rate: &str) -> Vec<(String, [f64; 4])> {
    let rows = rows(&["--closed-loop", "--scene", "free-air", "--rate", rate]);
    let mut controllers: Vec<(String, [f64; 4])> = Vec::new();
    for row in &rows {
        let name = text(row, "controlled_by");
        if controllers.iter().all(|(seen, _)| seen != name) {
            let figures = FELT.map(|(field, factor)| factor * row[field].as_f64().expect(field));
            controllers.push((name.to_owned(), figures));
        }
    }
    // The reference encoder is scored beside every estimator; its row stands last.
    controllers.sort_by_key(|(name, _)| name == "reference");
    controllers
}

#[test]
fn tables_of_estimators_are_complete() {
    let rates = ["1000", "11600"];
    let scored: Vec<_> = rates.iter().map(|rate| rows(&["--rate", rate])).collect();
    let scenarios: Vec<&str> = {
        let mut seen = Vec::new();
        for row in &scored[0] {
            if !seen.contains(&text(row, "scenario")) {
                seen.push(text(row, "scenario"));
            }
        }
        seen
    };
    let in_name = |name: &str| name.parse::<ScenarioName>().is_ok();
    assert!(scenarios.len() >= 9 && scenarios.iter().all(|name| in_name(name)));
    let loops = rates.map(felt);
    let at_1_khz: BTreeMap<_, _> = loops[0].iter().cloned().collect();

    let overview: Vec<Vec<String>> = Kind::all()
        .iter()
        .map(|kind| {
            let mut row = vec![kind.name.to_owned(), signals(kind)];
            for rows in &scored {
                row.push(cell(pooled(rows, kind.name, &TUNED_ON)));
                row.push(cell(pooled(rows, kind.name, &scenarios)));
            }
            let figures = at_1_khz.get(kind.name);
            row.extend([3, 2].map(|i| figures.map_or("-".to_owned(), |f| cell(f[i]))));
            row
        })
        .collect();
    let head = [
        "estimator",
        "reads",
        "1 kHz, three",
        "nine",
        "11.6 kHz, three",
        "nine",
        "below 10 mN, %",
        "roughness, mN",
    ];
    check("README.md", "estimators", &head, &overview);

    for (rate, rows) in rates.iter().zip(&scored) {
        let table: Vec<Vec<String>> = Kind::all()
            .iter()
            .map(|kind| {
                let each = scenarios
                    .iter()
                    .map(|name| pooled(rows, kind.name, &[name]));
                let all = pooled(rows, kind.name, &scenarios);
                let figures = each.chain([all]).map(cell);
                [kind.name.to_owned()].into_iter().chain(figures).collect()
            })
            .collect();
        let head: Vec<_> = ["estimator"]
            .into_iter()
            .chain(scenarios.iter().copied())
            .chain(["all nine"])
            .collect();
        let name = format!("scenarios at {rate} Hz");
        check("docs/benchmarks.md", &name, &head, &table);
    }

    for (rate, controllers) in rates.iter().zip(&loops) {
        let line = |(name, figures): &(String, [f64; 4])| -> Vec<String> {
            let figures = figures.map(cell);
            [name.clone()].into_iter().chain(figures).collect()
        };
        let table: Vec<_> = controllers.iter().map(line).collect();
        let head = [
            "controlled by",
            "RMS, mN",
            "99 %, mN",
            "50 to 500 Hz, mN",
            "below 10 mN, %",
        ];
        let name = format!("free air at {rate} Hz");
        check("docs/benchmarks.md", &name, &head, &table);
    }
}

/// The motor model has no friction: on a plant without friction it is exact while the handle is
/// clamped or still, and worse than finite difference when the handle moves.
#[test]
fn motor_model_without_friction() {
    let rows = rows(&["--rate", "1000", "--frictionless"]);
    for (scenario, written) in [
        ("step", "0"),
        ("permanent", "0"),
        ("track", "0"),
        ("creep", "0"),
        ("hold", "0"),
        ("free-air", "164"),
        ("wall", "19"),
        ("texture", "5.3"),
    ] {
        let now = pooled(&rows, "kalman-motor-steady", &[scenario]);
        assert!(is_written_for(written, now), "{scenario}: {now}");
    }
}

/// A field of a closed-loop row by scene and controller, scenes in the order of the program.
fn by_scene(rows: &[Value], field: &str, controllers: &[&str]) -> Vec<Vec<String>> {
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows {
        if !scenes.contains(&text(row, "scenario")) {
            scenes.push(text(row, "scenario"));
        }
    }
    let figure = |scene: &str, controller: &str| {
        let found = rows
            .iter()
            .find(|row| text(row, "scenario") == scene && text(row, "controlled_by") == controller);
        cell(found.expect(scene)[field].as_f64().expect(field))
    };
    let line = |scene: &&str| -> Vec<String> {
        let figures = controllers.iter().map(|name| figure(scene, name));
        [(*scene).to_owned()].into_iter().chain(figures).collect()
    };
    scenes.iter().map(line).collect()
}

#[test]
fn tables_of_scenes_are_complete() {
    let controllers = [
        "finite-difference",
        "low-pass",
        "foaw-end-fit",
        "kalman-triple-steady",
        "observer",
        "adaptive",
    ];
    let rows = rows(&["--closed-loop", "--rate", "1000"]);
    let head: Vec<_> = ["scene"].into_iter().chain(controllers).collect();
    for (name, field) in [
        ("scenes in the loop", "parasitic_mn_rms"),
        ("roughness of scenes", "parasitic_mn_tactile"),
    ] {
        let table = by_scene(&rows, field, &controllers);
        check("docs/benchmarks.md", name, &head, &table);
    }
}

/// Roughness in texture at 10 kHz on this device, mN.
fn texture_roughness(device: &[&str]) -> f64 {
    let base = ["--closed-loop", "--scene", "texture", "--rate", "10000"];
    let rows = rows(&[&base[..], &["--estimator", "adaptive"], device].concat());
    rows[0]["parasitic_mn_tactile"].as_f64().expect("a figure")
}

#[test]
fn inertia_of_the_handle_takes_the_texture() {
    let device = Path::new(env!("CARGO_TARGET_TMPDIR")).join("light-handle.toml");
    std::fs::write(&device, "[small]\ninertia_kg_m2 = 5e-7\n").expect("a device file");
    let light = ["--device", device.to_str().expect("a path in UTF-8")];
    assert!(is_written_for("108", texture_roughness(&[])));
    assert!(is_written_for("46", texture_roughness(&light)));
}
