//! Programs in C and C++ on this machine: every estimator has the bits of Rust on the traces of
//! `cargo pareto`, with parameters from `host-sim export --c` and with parameters that the library designs.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use c_interface::{CASES, Case, Compiler, VALUES, compiled, designs, folder, missing, parameters};
use estimator_core::Sample;
use limpid_dist::{COMPUTER, build};
use pareto::traces::{self, RATES_HZ};

const C99: Compiler = Compiler {
    program: "gcc",
    arguments: &["-std=c99", "-O2"],
};

const CPP17: Compiler = Compiler {
    program: "g++",
    arguments: &["-x", "c++", "-std=c++17", "-O2"],
};

/// Warnings, which a program of a user may have as errors.
const WARNINGS: [&str; 7] = [
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wdouble-promotion",
];

/// Address and undefined-behaviour sanitizers.
const SANITIZED: Compiler = Compiler {
    program: "gcc",
    arguments: &[
        "-std=c99",
        "-g",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ],
};

fn cases(rate_hz: u32) -> Vec<&'static Case> {
    let all = CASES.iter().copied().flatten();
    all.filter(|case| case.rate_hz == rate_hz).collect()
}

/// The traces of a rate.
fn samples(rate_hz: u32) -> Vec<Vec<Sample>> {
    let traces = traces::all().expect("the traces").into_iter();
    let counted = traces.filter(|trace| trace.rate_hz == rate_hz);
    let mut samples: Vec<_> = counted.map(|trace| trace.samples).collect();
    samples.push(traces::hostile(rate_hz));
    samples
}

/// Compiles the program for the cases of a rate.
fn program(compiler: &Compiler, name: &str, rate_hz: u32) -> PathBuf {
    let library = build(&COMPUTER).expect("the library");
    // `-x none`: the library is no source of the language before.
    let library = ["-x", "none", library.to_str().expect("a path in UTF-8")];
    program_of(compiler, name, rate_hz, &[&WARNINGS[..], &library].concat())
}

/// Compiles the program for the cases of a rate with these arguments for the functions.
pub(crate) fn program_of(
    compiler: &Compiler,
    name: &str,
    rate_hz: u32,
    functions: &[&str],
) -> PathBuf {
    let folder = folder(&format!("{name}-{rate_hz}"));
    let cases = cases(rate_hz);
    for (file, text) in [
        ("parameters.h", parameters(&cases)),
        ("designs.h", designs(&cases)),
    ] {
        std::fs::write(folder.join(file), text).expect("target is writable");
    }
    let program = folder.join("replay");
    let more = [functions, &["-lpthread", "-ldl", "-lm"]].concat();
    compiled(compiler, "replay.c", &folder, &more, &program);
    program
}

fn job(case: &Case, samples: &[Sample]) -> Vec<u8> {
    let name = case.c.to_string();
    let mut bytes = (name.len() as u32).to_ne_bytes().to_vec();
    bytes.extend(name.as_bytes());
    bytes.extend((samples.len() as u32).to_ne_bytes());
    for sample in samples {
        let edge = sample.edge.unwrap_or_default();
        let words = [
            sample.count.0,
            sample.coupled.0,
            sample.current.get().to_bits(),
            u32::from(sample.edge.is_some()),
            edge.boundary.0,
            edge.age.0,
        ];
        bytes.extend(words.iter().flat_map(|word| word.to_ne_bytes()));
    }
    bytes
}

/// Runs a command on jobs. The answers are as long as the jobs say.
fn answers(command: &mut Command, input: Vec<u8>) -> Vec<u32> {
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut to = child.stdin.take().expect("piped");
    let writer = std::thread::spawn(move || to.write_all(&input));
    let output = child.wait_with_output().expect("the program ends");
    writer
        .join()
        .expect("no panic")
        .expect("the program reads all jobs");
    assert!(output.status.success(), "{command:?}: {}", output.status);
    let (words, []) = output.stdout.as_chunks() else {
        panic!("{command:?}: half a word");
    };
    words.iter().map(|word| u32::from_ne_bytes(*word)).collect()
}

/// Compares what a program computes, twice if it also designs parameters.
pub(crate) fn compare(program: &Path, rate_hz: u32, designs: bool) {
    let mut compared = 0;
    let samples = samples(rate_hz);
    for case in cases(rate_hz) {
        for samples in &samples {
            let expected: Vec<u32> = (case.run)(samples)
                .iter()
                .map(|value| value.to_bits())
                .collect();
            let answers = answers(&mut Command::new(program), job(case, samples));
            let (exported, rest) = answers.split_at(expected.len());
            let (designed, over) = rest.split_at(if designs { expected.len() } else { 0 });
            let name = case.c;
            assert!(
                exported == expected,
                "{name} at {rate_hz} Hz: bits with exported parameters"
            );
            assert!(
                !designs || designed == expected,
                "{name} at {rate_hz} Hz: bits with designed parameters"
            );
            if case.c.row.varying_period {
                let velocities = expected.iter().step_by(VALUES);
                assert!(
                    over.iter().eq(velocities),
                    "{name} at {rate_hz} Hz: bits over a period of 1"
                );
            } else {
                assert!(over.is_empty());
            }
            compared += expected.len();
        }
    }
    assert!(compared > 1_000_000, "only {compared} values");
}

#[test]
fn a_program_in_c99_has_the_bits_of_rust() {
    if missing(C99.program) {
        return;
    }
    for rate_hz in RATES_HZ {
        compare(&program(&C99, "c99", rate_hz), rate_hz, true);
    }
}

#[test]
fn a_program_in_cpp17_has_the_bits_of_rust() {
    if missing(CPP17.program) {
        return;
    }
    for rate_hz in RATES_HZ {
        compare(&program(&CPP17, "cpp17", rate_hz), rate_hz, true);
    }
}

/// The jobs of all cases of a rate over a trace of extremes, with their expected first run.
fn all_jobs(rate_hz: u32, length: usize) -> Vec<u8> {
    let hostile = traces::hostile(rate_hz);
    let cases = cases(rate_hz);
    cases
        .iter()
        .flat_map(|case| job(case, &hostile[..length]))
        .collect()
}

#[test]
fn sanitizers_find_nothing() {
    if missing(SANITIZED.program) {
        return;
    }
    for rate_hz in RATES_HZ {
        let program = program(&SANITIZED, "sanitized", rate_hz);
        let answers = answers(&mut Command::new(program), all_jobs(rate_hz, 4096));
        assert!(answers.len() > 100_000);
    }
}

#[test]
fn valgrind_finds_nothing() {
    if missing(C99.program) || missing("valgrind") {
        return;
    }
    for rate_hz in RATES_HZ {
        let program = program(&C99, "valgrind", rate_hz);
        let mut command = Command::new("valgrind");
        command
            .args(["--quiet", "--error-exitcode=9", "--leak-check=full"])
            .arg(program);
        assert!(answers(&mut command, all_jobs(rate_hz, 500)).len() > 10_000);
    }
}

/// The library lists exactly the types that have cases.
#[test]
fn every_type_of_the_header_has_a_case() {
    let mut types: Vec<_> = CASES
        .iter()
        .copied()
        .flatten()
        .map(|case| case.c.to_string())
        .collect();
    types.sort();
    types.dedup();
    let mut listed: Vec<_> = limpid::source::NAMES
        .iter()
        .map(|name| (*name).to_owned())
        .collect();
    listed.sort();
    assert_eq!(types, listed);
}
