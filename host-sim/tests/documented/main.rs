//! The figures in README.md and docs are what the program prints.

mod estimators;
mod in_the_loop;
mod pages;
mod theory;

use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind};
use experiments::compare::{Case, Outcome, Settings, compare};
use experiments::sensitivity::{self, sensitivity};
use experiments::table::pooled_pct;
use scoring::evaluation::Row;
use scoring::score::Wanted;
use simulation::device::{Device, Disc};
use simulation::scenario::ScenarioName;

const BENCHMARKS: &str = include_str!("../../../docs/benchmarks.md");

/// The cells of the rows of the table whose heading row contains `heading`.
fn table<'a>(text: &'a str, heading: &str) -> Vec<Vec<&'a str>> {
    let rows: Vec<_> = text
        .lines()
        .skip_while(|line| !(line.starts_with('|') && line.contains(heading)))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    assert!(!rows.is_empty(), "no table headed {heading}");
    rows
}

/// Whether a figure with so many digits, or one moved by a tenth, would be written for `value`.
fn is_written_for(cell: &str, value: f64) -> bool {
    let written: f64 = cell
        .parse()
        .unwrap_or_else(|_| panic!("'{cell}' is no number"));
    (written - value).abs() <= 0.1 * value.abs() + 0.005 && (written == 0.0) == (value < 0.005)
}

fn run(scenarios: &[ScenarioName], rate_hz: f64, plant: PlantKind) -> Vec<Outcome> {
    let case = |&scenario: &ScenarioName| Case {
        scenario,
        rate_hz,
        plant,
        seed: 1,
        seconds: scenario.default_seconds(),
        keep: false,
    };
    let settings = Settings {
        device: Device::default(),
        estimators: Kind::all().iter().collect(),
        parameters: Parameters::default(),
        wanted: Wanted::ALL,
    };
    let cases: Vec<_> = scenarios.iter().map(case).collect();
    compare(&cases, &settings, || ()).unwrap()
}

fn of<'a>(outcomes: &'a [Outcome], estimator: &'a str) -> impl Iterator<Item = &'a Row> {
    let rows = outcomes.iter().flat_map(|outcome| &outcome.rows);
    rows.filter(move |row| row.estimator == estimator)
}

#[test]
fn distances_of_the_papers_experiment() {
    use ScenarioName::{Permanent, Step, Track};
    let experiment = |rate, plant| run(&[Step, Permanent, Track], rate, plant);
    let columns = [
        experiment(1e3, PlantKind::Friction),
        experiment(11.6e3, PlantKind::Friction),
        experiment(1e3, PlantKind::Frictionless),
    ];
    let check = |name: &str, cells: &[(usize, &str)]| {
        for &(column, cell) in cells {
            let value = pooled_pct(of(&columns[column], name).map(|row| &row.score)).unwrap();
            assert!(
                is_written_for(cell, value),
                "{name}: {cell} is written, {value} is so"
            );
        }
    };
    for row in table(BENCHMARKS, "| independent | 11.6 kHz |") {
        check(row[0], &[(0, row[1]), (1, row[3]), (2, row[5])]);
    }
}

#[test]
fn wrong_beliefs() {
    let on = |disc| {
        let settings = Settings {
            device: Device {
                disc,
                ..Device::default()
            },
            estimators: Kind::all().iter().collect(),
            parameters: Parameters::default(),
            wanted: Wanted::NONE,
        };
        use ScenarioName::{Creep, FreeAir, Hold, Permanent, Step, Texture, Track, Wall};
        let scenarios = [Step, Permanent, Track, FreeAir, Wall, Texture, Creep, Hold];
        let of = |scenario: ScenarioName| {
            [1, 2, 3].map(|seed| Case {
                scenario,
                rate_hz: 1e3,
                plant: PlantKind::Friction,
                seed,
                seconds: scenario.default_seconds(),
                keep: false,
            })
        };
        let cases: Vec<_> = scenarios.into_iter().flat_map(of).collect();
        let rows = sensitivity(&cases, &settings, || ()).unwrap();
        sensitivity::table::table(&rows, usize::MAX)
    };
    let errors = Disc {
        phase_counts: 0.06,
        line_counts: 0.25,
        random_counts: 0.02,
    };
    let tables = [on(Disc::default()), on(errors)];
    for row in table(BENCHMARKS, "| worst constants |") {
        let printed = tables.iter().flat_map(|text| {
            let is = |line: &&str| line.split_whitespace().next() == Some(row[0]);
            let line = text.lines().find(is).expect(row[0]);
            let cells: Vec<f64> = line
                .split_whitespace()
                .skip(1)
                .map(|cell| cell.parse().unwrap())
                .collect();
            // Right constants, over all scenarios; the worst ones, before the two shares outside.
            [cells[0], cells[cells.len() - 3]]
        });
        for (cell, value) in row[1..].iter().zip(printed) {
            assert!(
                is_written_for(cell, value),
                "{}: {cell} is written, {value} is so",
                row[0]
            );
        }
    }
}

#[test]
fn errors_of_finite_difference() {
    for row in table(BENCHMARKS, "| finite difference |") {
        let outcomes = run(&[row[0].parse().unwrap()], 1e3, PlantKind::Friction);
        let rms = of(&outcomes, "finite-difference")
            .next()
            .unwrap()
            .score
            .rms_rad_s
            .unwrap();
        assert!(
            is_written_for(row[1], rms),
            "{}: {} is written, {rms} is so",
            row[0],
            row[1]
        );
    }
}
