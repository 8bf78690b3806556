//! Every row of the catalogue of estimators is in every list that is made from it.

use std::collections::BTreeSet;

use bench_image::SUBJECTS;
use catalogue::estimators::Kind;
use estimator_catalogue::{Parameter, ROWS, Search};
use stress::contestants::at;
use stress::designs;

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
        let contestants = at(f64::from(rate_hz));
        let names = contestants.iter().map(|one| one.name.as_str());
        assert_eq!(of_rows(names), rows(), "stress::contestants");
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
        let designed = kinds.contains(&row.name);
        assert_eq!(designed, row.name != "finite-difference", "{}", row.name);
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
