//! Every row of the catalogues is in every list that is made from them. The lists that are not
//! here: every row has functions of the code probe (`codegen`), colours that differ (`report`), a
//! page, and scenarios and scores a row of documentation (`host-sim`, test `documented`).

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use bench_image::SUBJECTS;
use catalogue::estimators::Kind;
use estimator_catalogue::{Parameter, ROWS, Search};
use fuzz_bodies::samples;
use haptic_control::SceneKind;
use measured::tables;
use simulation::scenario::ScenarioName;
use stress::designs;
use stress::tested::at;

/// Names of all rows.
fn rows() -> BTreeSet<&'static str> {
    ROWS.iter().map(|row| row.name).collect()
}

/// The estimator's name before its parameters.
fn plain(name: &str) -> &str {
    name.split([' ', ',']).next().unwrap_or(name)
}

/// Names of a list that are names of rows.
fn of_rows<'a>(list: impl Iterator<Item = &'a str>) -> BTreeSet<&'a str> {
    list.map(plain)
        .filter(|name| rows().contains(name))
        .collect()
}

#[test]
fn every_row_is_on_the_command_line_stressed_and_measured() {
    assert_eq!(rows().len(), ROWS.len(), "two rows of one name");
    assert_eq!(
        Kind::all()
            .iter()
            .map(|kind| kind.name)
            .collect::<BTreeSet<_>>(),
        rows()
    );
    for rate_hz in [1000, 10_000] {
        let tested_estimators = at(f64::from(rate_hz));
        let names = tested_estimators.iter().map(|one| one.name.as_str());
        assert_eq!(of_rows(names), rows(), "stress::tested");
        let at_rate = |subject: &&bench_image::Subject| [0, rate_hz].contains(&subject.rate_hz);
        let names = SUBJECTS.iter().filter(at_rate).map(|subject| subject.name);
        assert_eq!(
            of_rows(names),
            rows(),
            "bench_image::SUBJECTS at {rate_hz} Hz"
        );
    }
    let kinds = designs::kinds();
    for row in ROWS {
        // The rate alone fixes these.
        let fixed = ["finite-difference", "imm", "imm-pair", "imm-motor"].contains(&row.name);
        assert_eq!(kinds.contains(&row.name), !fixed, "{}", row.name);
    }
}

/// Names in the first column of a measured table.
fn measured_names(table: &measured::Table) -> Vec<String> {
    let (first, _) = table.columns[0];
    let rows = table.read().unwrap_or_else(|error| panic!("{error}"));
    let name = |row: &measured::Row| row.text(first).expect("the first column").to_owned();
    rows.iter().map(name).collect()
}

#[test]
fn every_row_is_in_the_fuzz_target_of_samples() {
    let tested_estimators = samples::tested_estimators();
    let names = tested_estimators.iter().map(|one| one.name.as_str());
    assert_eq!(of_rows(names), rows());
}

#[test]
fn every_row_is_in_the_measured_tables() {
    for table in [
        tables::PARETO,
        tables::BOUNDS,
        tables::ESTIMATORS,
        tables::SCENARIOS_1000HZ,
        tables::SCENARIOS_11600HZ,
        tables::WRONG_CONSTANTS,
    ] {
        let names = measured_names(&table);
        let found = of_rows(names.iter().map(String::as_str));
        let mut expected = rows();
        if table.name == tables::BOUNDS.name {
            expected.retain(|name| pareto::bound::is_derivable(name));
        }
        assert_eq!(found, expected, "measured/{}.csv", table.name);
    }
}

#[test]
fn every_scene_is_in_the_measured_tables() {
    for table in [tables::SCENE_SIZES, tables::SCENE_INSTRUCTIONS] {
        let names = measured_names(&table);
        for scene in SceneKind::ALL {
            let is_there = names.iter().any(|name| name == scene.name());
            assert!(is_there, "measured/{}.csv lacks {scene}", table.name);
        }
    }
}

#[test]
fn every_row_has_a_trace_of_every_scenario() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../measured/traces.csv");
    let traces = fs::read_to_string(path).expect("measured/traces.csv");
    for row in ROWS {
        for rate_hz in [1000, 10_000] {
            for scenario in ScenarioName::ALL {
                let begin = format!("{},{rate_hz},{scenario},", row.name);
                let is_there = traces.lines().any(|line| line.starts_with(&begin));
                assert!(is_there, "measured/traces.csv has no row {begin}..");
            }
        }
    }
}

#[test]
fn search_range_of_every_parameter_is_within_its_range() {
    let inside =
        |parameter: &Parameter, value: f64| (parameter.lowest..=parameter.highest).contains(&value);
    for row in ROWS {
        for parameter in row.parameters {
            let ends = match parameter.search {
                Search::Log(low, high) => [low, high],
                Search::Each(low, high) => [low, high].map(f64::from),
                Search::Fixed(value) => [value; 2],
            };
            let name = format!("{}.{}", row.name, parameter.name);
            assert!(
                ends.iter().all(|end| inside(parameter, *end)),
                "{name}: {ends:?}"
            );
            assert!(
                !parameter.name.is_empty() && !parameter.meaning.is_empty(),
                "{name}"
            );
        }
    }
}
