//! Velocities of every estimator, bit for bit, as hashes in measured/traces.csv.
//!
//! `UPDATE_GOLDEN=1 cargo test --release -p acceptance --test numerics traces` writes the file
//! anew.

use std::fmt::Write;
use std::path::Path;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate::simulate;
use simulation::trace::{Columns, Trace};
use stress::course::Course;
use stress::tested::{TestedEstimator, at};
use terminal::checksum::Sum;

const RATES_HZ: [f64; 2] = [1000.0, 10_000.0];

/// Simulated seconds of each scenario.
const SECONDS: f64 = 2.0;

/// Ticks of the stress course, and of each stretch of it.
const COURSE_TICKS: usize = 200_000;
const STRETCH_TICKS: usize = 1000;

/// Not a seed that presets are tuned on.
const SEED: u64 = 7;

const HEADER: &str = "estimator,rate_hz,trace,ticks,input_hash,velocity_hash";

/// A hash of 32-bit words, each little endian.
#[derive(Default)]
struct Hash(Sum);

impl Hash {
    fn take(&mut self, word: u32) {
        self.0.add(&word.to_le_bytes());
    }

    const fn value(&self) -> u64 {
        self.0.0
    }
}

/// A hash of everything that an estimator may read of the trace.
fn input_hash(trace: &Trace) -> u64 {
    let mut hash = Hash::default();
    for k in 0..trace.len() {
        hash.take(trace.counts_large[k]);
        if let Some(counts) = &trace.counts_small {
            hash.take(counts[k]);
        }
        if let Some(current) = &trace.current {
            hash.take((current[k] as f32).to_bits());
        }
        if let Some(Some(edge)) = trace.edges.as_ref().map(|edges| edges[k]) {
            hash.take(edge.boundary);
            hash.take((edge.age_s as f32).to_bits());
        }
    }
    hash.value()
}

/// A row for each estimator of the command line over each scenario.
fn scenarios(rate_hz: f64, rows: &mut String) {
    let device = Device::default();
    let parameters = Parameters::default();
    let columns = Columns {
        counts_small: true,
        edges: true,
    };
    for scenario in ScenarioName::ALL {
        let trace = simulate(&device, scenario, rate_hz, SEED, SECONDS, columns).unwrap();
        let input = input_hash(&trace);
        for kind in Kind::all() {
            let setup = Setup::of(&device, rate_hz);
            let values = parameters.values(kind, &setup, PlantKind::Friction);
            let mut hash = Hash::default();
            for velocity in kind.build(&setup, &values).unwrap().run(&trace) {
                hash.take(velocity.to_bits());
            }
            let (name, ticks, trace) = (kind.name, trace.len(), scenario.as_str());
            writeln!(
                rows,
                "{name},{rate_hz},{trace},{ticks},{input:016x},{:016x}",
                hash.value()
            )
            .unwrap();
        }
    }
}

/// The row of an estimator over the stress course.
fn course(tested: &TestedEstimator) -> String {
    let mut course = Course::new(SEED, tested.rate_hz);
    let mut pair = tested.pair();
    pair.start(&course.shown());
    let (mut input, mut velocities) = (Hash::default(), Hash::default());
    for tick in 0..COURSE_TICKS {
        if tick % STRETCH_TICKS == 0 {
            course.move_on();
        }
        let shown = course.step();
        for word in [shown.large, shown.small, shown.amps.to_bits()] {
            input.take(word);
        }
        let (boundary, age) = shown.edge.unwrap_or_default();
        input.take(boundary);
        input.take(age);
        velocities.take(pair.update(&shown).0.to_bits());
    }
    format!(
        "{},{},course,{COURSE_TICKS},{:016x},{:016x}\n",
        tested.name.replace(',', ""),
        tested.rate_hz,
        input.value(),
        velocities.value()
    )
}

/// Lines of `now` that `file` does not have in the same place, and the other way round.
fn moved(file: &str, now: &str) -> Vec<String> {
    let lines = |of: &str, from: &str, sign| -> Vec<String> {
        let of: Vec<_> = of.lines().collect();
        let missing = from.lines().filter(|line| !of.contains(line));
        missing.map(|line| format!("{sign} {line}")).collect()
    };
    let mut moved = lines(now, file, '-');
    moved.extend(lines(file, now, '+'));
    moved
}

#[test]
fn velocity_traces_are_unchanged() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../measured/traces.csv");
    let mut now = format!("{HEADER}\n");
    for rate_hz in RATES_HZ {
        scenarios(rate_hz, &mut now);
        for tested in at(rate_hz) {
            now += &course(&tested);
        }
    }
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        std::fs::write(&path, &now).unwrap();
        return;
    }
    let file = std::fs::read_to_string(&path).unwrap();
    let moved = moved(&file, &now);
    assert!(
        moved.is_empty(),
        "measured/traces.csv and this build differ; another input hash means that the plant or the \
         course changed, the same one that the estimator did:\n{}",
        moved.join("\n")
    );
    // The comparison sees a single bit of a single velocity.
    let broken = now.replacen("course,200000,", "course,200001,", 1);
    assert_eq!(self::moved(&file, &broken).len(), 2);
}
