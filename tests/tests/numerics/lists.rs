//! Lists of estimators that are written by hand, against the estimators of `host-sim`.

use bench_image::SUBJECTS;
use catalogue::estimators::Kind;
use stress::contestants::at;
use stress::designs;

/// Estimators that a list leaves out, with the reason.
type Exempt = &'static [(&'static str, &'static str)];

const HELD: &str = "the observer without its slip: a part of the update of the observer itself";
const BLIND: &str = "not measured yet: an observer without current and slip";

const NOT_STRESSED: Exempt = &[
    ("observer-held", HELD),
    ("observer-edge-held", HELD),
    ("observer-edge-blind", BLIND),
];
const NOT_DESIGNED: Exempt = &[("finite-difference", "it has no parameter")];
const NOT_MEASURED: Exempt = NOT_STRESSED;

/// Each estimator is in the list or exempt, and none both.
fn complete(list: &str, names: &[&str], exempt: Exempt) {
    for kind in Kind::all() {
        let is_exempt = exempt.iter().any(|(name, _)| *name == kind.name);
        let is_listed = names.contains(&kind.name);
        assert!(is_listed != is_exempt, "{} in {list}: {names:?}", kind.name);
    }
    for (name, _) in exempt {
        assert!(Kind::named(name).is_ok(), "{list} leaves out {name}");
    }
}

/// The estimator's name before its parameters.
fn plain(name: &str) -> &str {
    name.split([' ', ',']).next().unwrap_or(name)
}

#[test]
fn every_estimator_is_stressed_designed_and_measured_or_exempt() {
    for rate_hz in [1000.0, 10_000.0] {
        let contestants = at(rate_hz);
        let names: Vec<_> = contestants.iter().map(|one| plain(&one.name)).collect();
        complete("stress::contestants", &names, NOT_STRESSED);
    }
    complete("stress::designs", &designs::KINDS, NOT_DESIGNED);
    for rate_hz in [1000, 10_000] {
        let at_rate = |subject: &&bench_image::Subject| [0, rate_hz].contains(&subject.rate_hz);
        let names: Vec<_> = SUBJECTS
            .iter()
            .filter(at_rate)
            .map(|subject| plain(subject.name))
            .collect();
        complete("bench_image::SUBJECTS", &names, NOT_MEASURED);
    }
}
