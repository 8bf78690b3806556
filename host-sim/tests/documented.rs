//! The figures in README.md and docs/benchmarks.md are what the program prints.

use host_sim::closed_loop::SceneName;
use host_sim::compare::{Case, Outcome, Settings, compare};
use host_sim::contest::Row;
use host_sim::device::{Device, Disc};
use host_sim::estimators::Kind;
use host_sim::parameters::{Parameters, PlantKind};
use host_sim::robust::{self, summary};
use host_sim::scenario::ScenarioName;
use host_sim::score::Wanted;
use host_sim::sensitivity::{self, sensitivity};
use host_sim::table::pooled_pct;
use host_sim::zwidth;

const README: &str = include_str!("../../README.md");
const THEORY: &str = include_str!("../../docs/theory.md");
const BENCHMARKS: &str = include_str!("../../docs/benchmarks.md");

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
        experiment(11.6e3, PlantKind::Frictionless),
    ];
    let check = |name: &str, cells: &[(usize, &str)]| {
        for &(column, cell) in cells {
            let value = pooled_pct(of(&columns[column], name)).unwrap();
            assert!(
                is_written_for(cell, value),
                "{name}: {cell} is written, {value} is so"
            );
        }
    };
    for row in table(README, "| knows |") {
        let cells: Vec<_> = row[2..].iter().copied().enumerate().collect();
        // "kalman-triple, -table, -steady" stands for all three.
        let mut names = row[0].split(", ");
        let name = names.next().unwrap();
        check(name, &cells);
        for suffix in names {
            check(&format!("{name}{suffix}"), &cells);
        }
    }
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
        sensitivity::table::table(&rows)
    };
    let errors = Disc {
        phase_counts: 0.06,
        line_counts: 0.25,
        random_counts: 0.02,
    };
    let tables = [on(Disc::default()), on(errors)];
    for row in table(BENCHMARKS, "| worst belief |") {
        let printed = tables.iter().flat_map(|text| {
            let is = |line: &&str| line.split_whitespace().next() == Some(row[0]);
            let line = text.lines().find(is).expect(row[0]);
            let cells: Vec<f64> = line
                .split_whitespace()
                .skip(1)
                .map(|cell| cell.parse().unwrap())
                .collect();
            // Right, over all scenarios; the worst belief, before the two shares outside.
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

/// The corners and the first drawn devices of the documented run, which it contains.
#[test]
fn robustness_of_the_loop() {
    let rows = table(BENCHMARKS, "| stable | stopped | violated |");
    assert_eq!(rows.len(), SceneName::ALL.len());
    let part = |rate_hz, devices| {
        let device = Device::default();
        let kind = Kind::named("kalman-triple-steady").unwrap();
        let settings = robust::Settings {
            version: String::new(),
            scenes: rows.iter().map(|row| row[0].to_owned()).collect(),
            rate_hz,
            estimator: kind.name.to_owned(),
            values: robust::Settings::values(kind, &device, rate_hz, &Parameters::default()),
            devices,
            seed: 1,
            seconds: 2.0,
            device,
        };
        let jobs = settings.jobs().unwrap();
        let rows = robust::Experiment::new(&settings)
            .unwrap()
            .rows(&jobs, || ());
        summary::summaries(&rows.unwrap()).unwrap()
    };
    for scene in part(1e3, 0) {
        assert_eq!(scene.counts[2], 0, "{}, 1 kHz", scene.scene);
    }
    for (row, scene) in rows.iter().zip(part(10e3, 20)) {
        assert_eq!(row[0], scene.scene);
        let counts: Vec<usize> = row[1..4].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(counts.iter().sum::<usize>(), 1027);
        for (part, whole) in scene.counts.iter().zip(&counts) {
            assert!(part <= whole, "{}: {:?}, {counts:?}", row[0], scene.counts);
        }
        for (cell, spread, unit) in [
            (row[4], scene.handle_rad_s, 1.0),
            (row[5], scene.felt_nm, 1e3),
            (row[6], scene.oscillation_nm.unwrap(), 1e3),
        ] {
            let written: Vec<f64> = cell.split(' ').map(|cell| cell.parse().unwrap()).collect();
            assert!(
                unit * spread.largest <= 1.01 * written[2],
                "{}: {cell}, {spread:?}",
                row[0]
            );
            // A median of 47 against that of 1027, which holds them.
            assert!(
                (unit * spread.median / written[0] - 1.0).abs() < 0.35,
                "{}: {cell}, {spread:?}",
                row[0]
            );
        }
    }
}

/// Two rows of the chart at 1 kHz; the search's own step is 3 %.
#[test]
fn z_width_of_two_estimators() {
    let names = ["foaw-end-fit", "kalman-triple"];
    let cases = names.map(|name| zwidth::Case {
        large: Kind::named(name).unwrap(),
        handle: Kind::named(name).unwrap(),
        rate_hz: 1e3,
        lines: 1024,
    });
    let settings = zwidth::Settings {
        device: Device::default(),
        parameters: Parameters::default(),
        seed: 1,
    };
    let found = zwidth::boundaries(&cases, &settings, || ()).unwrap();
    let rows = table(THEORY, "| estimator | 1 kHz | | | | 11.6 kHz |");
    for (name, boundary) in names.iter().zip(&found) {
        let row = rows.iter().find(|row| row[0] == *name).unwrap();
        let (damping, best) = boundary.stiffest().unwrap();
        let plain = boundary.walls[0].1.value;
        let values = [
            plain,
            best.value,
            1e3 * damping,
            1e3 * boundary.viscous.value,
        ];
        for (cell, value) in row[1..5].iter().zip(values) {
            assert!(
                is_written_for(cell, value),
                "{name}: {cell} is written, {value} is so"
            );
        }
    }
}
