//! What holds for any estimator, tried on every row of the catalogue: an estimator gets these tests
//! with its row. What holds for some estimators only, such as exact ramps, is tested in
//! `estimator-core`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use estimator_catalogue::ROWS;
use stress::course::{Course, Draws, Shown};
use stress::tested::{TestedEstimator, at};

const RATES_HZ: [f64; 2] = [1000.0, 10_000.0];

/// Stretches of motion in a course, and ticks of each.
const STRETCHES: usize = 40;
const STRETCH_TICKS: usize = 150;

/// A course over every kind of stretch.
fn course(seed: u64, rate_hz: f64) -> Vec<Shown> {
    let mut course = Course::new(seed, rate_hz);
    let mut shown = vec![course.shown()];
    for _ in 0..STRETCHES {
        course.move_on();
        shown.extend((0..STRETCH_TICKS).map(|_| course.step()));
    }
    shown
}

/// Velocities of the core at every sample but the first, as bits. Adding zero turns the negative
/// zero into the positive one.
fn velocities(tested: &TestedEstimator, course: &[Shown]) -> Vec<f32> {
    let mut pair = tested.pair();
    pair.start(&course[0]);
    let update = |shown| pair.update(shown).0 + 0.0;
    course[1..].iter().map(update).collect()
}

/// Calls `test` with every estimator and the courses of a few seeds.
fn each(test: impl Fn(&TestedEstimator, &[Shown])) {
    for rate_hz in RATES_HZ {
        let tested_estimators = at(rate_hz);
        for seed in 1..=3 {
            let course = course(seed, rate_hz);
            for tested in &tested_estimators {
                test(tested, &course);
            }
        }
    }
}

#[track_caller]
fn assert_identical(tested: &TestedEstimator, one: &[f32], other: &[f32]) {
    assert_eq!(one.len(), other.len());
    let differ = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
    if let Some(tick) = one.iter().zip(other).position(differ) {
        let (name, rate_hz) = (&tested.name, tested.rate_hz);
        panic!(
            "{name} at {rate_hz} Hz: {} against {} at tick {tick}",
            one[tick], other[tick]
        );
    }
}

#[test]
fn shift_of_the_counters_by_whole_lines_changes_nothing() {
    each(|tested, course| {
        let shift = 0x7654_3210u32;
        let there = |shown: &Shown| Shown {
            large: shown.large.wrapping_add(shift),
            small: shown.small.wrapping_add(shift),
            amps: shown.amps,
            edge: shown.edge.map(|(e, age)| (e.wrapping_add(shift), age)),
        };
        let shifted: Vec<_> = course.iter().map(there).collect();
        let here = velocities(tested, course);
        assert_identical(tested, &here, &velocities(tested, &shifted));
    });
}

#[test]
fn mirrored_motion_gives_mirrored_velocity() {
    each(|tested, course| {
        // Boundary e lies between counts e - 1 and e: turned round, it is 1 - e.
        let turned = |shown: &Shown| Shown {
            large: shown.large.wrapping_neg(),
            small: shown.small.wrapping_neg(),
            amps: -shown.amps,
            edge: (shown.edge).map(|(e, age)| (1u32.wrapping_sub(e), age)),
        };
        let mirrored: Vec<_> = course.iter().map(turned).collect();
        let forth = velocities(tested, course);
        let forth: Vec<_> = forth.iter().map(|v| 0.0 - v).collect();
        assert_identical(tested, &forth, &velocities(tested, &mirrored));
    });
}

#[test]
fn restart_is_a_fresh_start() {
    each(|tested, course| {
        let mut used = tested.pair();
        used.start(&course[0]);
        for shown in &course[1..] {
            used.update(shown);
        }
        used.start(&course[0]);
        let again: Vec<_> = (course[1..].iter().map(|shown| used.update(shown).0 + 0.0)).collect();
        assert_identical(tested, &velocities(tested, course), &again);
    });
}

#[test]
fn signals_not_needed_are_not_read() {
    each(|tested, course| {
        let needs = tested.pair().needs();
        let mut draws = Draws::new(9);
        let other = |shown: &Shown| {
            let mut other = *shown;
            if !needs.coupled {
                other.small = draws.bits() as u32;
            }
            if !needs.current {
                other.amps = draws.unit() as f32;
            }
            if !needs.edge {
                other.edge = Some((draws.bits() as u32, draws.bits() as u32));
            }
            other
        };
        let dressed: Vec<_> = course.iter().map(other).collect();
        let bare = velocities(tested, course);
        assert_identical(tested, &bare, &velocities(tested, &dressed));
    });
}

#[test]
fn rest_from_the_start_is_zero_velocity() {
    for rate_hz in RATES_HZ {
        for tested in at(rate_hz) {
            for count in [0, 1, 0x7FFF_FFFF, 0x8000_0000, u32::MAX, 1_000_000_000] {
                let rest = Shown {
                    large: count,
                    small: count ^ 0x55,
                    amps: 0.0,
                    edge: None,
                };
                let outputs = velocities(&tested, &[rest; 300]);
                let (name, moves) = (&tested.name, outputs.iter().any(|v| *v != 0.0));
                assert!(!moves, "{name} at {rate_hz} Hz moves at count {count}");
            }
        }
    }
}

#[test]
fn signals_of_a_row_are_those_of_its_type() {
    for rate_hz in RATES_HZ {
        for tested in at(rate_hz) {
            let row = ROWS.iter().find(|row| {
                let rest = tested.name.strip_prefix(row.name);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', ',']))
            });
            if let Some(row) = row {
                assert_eq!(row.needs, tested.pair().needs(), "{}", row.name);
            }
        }
    }
}

/// Every source file of the core.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("readable");
    let paths = entries.map(|entry| entry.expect("readable").path());
    paths
        .flat_map(|path| match path.is_dir() {
            true => sources(&path),
            false => vec![path],
        })
        .collect()
}

/// A type without the modules it is in, and without the length of its tables.
fn bare(name: &str) -> String {
    let words = name.split_inclusive(['<', '>', ',', ' ']);
    let last = words.map(|word| word.rsplit("::").next().unwrap_or(word));
    last.collect::<String>().replace("1024", "N")
}

/// Implements the trait and passes the work on to two estimators: `estimator-core` tests it.
const COMBINES_TWO: &str = "Handover";

/// A type that implements `VelocityEstimator`, and an alias of such a type, is a tested estimator.
#[test]
fn every_estimator_of_the_core_is_tried() {
    let tried: BTreeSet<String> = at(1000.0)
        .iter()
        .map(|tested| bare(tested.pair().kind()))
        .collect();
    let mut missing = Vec::new();
    let mut aliases = BTreeMap::new();
    let mut found = 0;
    let core = Path::new(env!("CARGO_MANIFEST_DIR")).join("../estimator-core/src");
    for path in sources(&core) {
        // An alias may go over two lines.
        let text = fs::read_to_string(&path).expect("readable");
        let text = text.replace(" =\n    ", " = ");
        for line in text.lines() {
            let implementor = line
                .strip_prefix("impl")
                .and_then(|line| line.split_once("VelocityEstimator for "))
                .map(|(_, name)| name.trim_end_matches(" {"));
            if let Some(name) = implementor {
                found += 1;
                let base = name.split('<').next().unwrap_or(name);
                let tries = |kind: &String| kind.split('<').next() == Some(base);
                if base != COMBINES_TWO && !tried.iter().any(tries) {
                    missing.push(name.to_owned());
                }
            }
            let alias = line
                .strip_prefix("pub type ")
                .and_then(|line| line.split_once(" = "));
            if let Some((name, of)) = alias {
                aliases.insert(name.to_owned(), of.trim_end_matches(';').to_owned());
            }
        }
    }
    found += aliases.len();
    // An alias may be a part of another one.
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    for of in aliases.values() {
        let parts = of.split_inclusive(|c| !is_name(c)).map(|part| {
            let name = part.trim_end_matches(|c| !is_name(c));
            match aliases.get(name) {
                Some(of) => part.replacen(name, of, 1),
                None => part.to_owned(),
            }
        });
        let whole: String = parts.collect();
        if !tried.contains(&whole) {
            missing.push(whole);
        }
    }
    assert!(found >= 20, "{found} implementations and names");
    assert!(missing.is_empty(), "{missing:?} of {tried:#?}");
}
