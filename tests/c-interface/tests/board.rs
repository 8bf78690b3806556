//! A program in C for the board, linked by the Arm toolchain with the library for Cortex-M4F, on the
//! emulated board: bits and instructions of every estimator beside those of the bench image in Rust.

use bench_image::{SUBJECTS, Subject};
use c_interface::{CASES, Case, Compiler, VALUES, compiled, folder, missing, parameters};
use estimator_catalogue::{Parameter, Row};
use estimator_core::Sample;
use limpid_dist::{BOARDS, build};
use pareto::board::{Job, Ran, on_board, on_board_in_c};
use pareto::image::{Image, Level};
use pareto::traces::{self, RATES_HZ};

const ARM: Compiler = Compiler {
    program: "arm-none-eabi-gcc",
    arguments: &[
        "-std=c99",
        "-O2",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-mcpu=cortex-m4",
        "-mthumb",
        "-mfloat-abi=hard",
        "-mfpu=fpv4-sp-d16",
        "-ffreestanding",
        "-nostdlib",
        "-Wl,--gc-sections",
        "-Wl,-z,noexecstack",
    ],
};

/// Most instructions that an update in C has beyond that in Rust, in the mean over a trace.
///
/// The parameters of the bench image are constants of its code, those of C are memory. The compiler
/// unrolls a loop whose length it knows, so a window costs a share more in C. An observer reads more
/// parameters than there are registers, checks the current, which in Rust the sample's type has done, and
/// an edge becomes an `Option` in memory.
fn allowed(row: &Row, in_rust: f64) -> f64 {
    if row.settling.is_window() {
        in_rust * 1.42
    } else if row.parameters.iter().any(Parameter::is_torque) || row.needs.edge {
        in_rust + 16.0
    } else {
        in_rust + 6.0
    }
}

/// Updates at the start of a trace that are not compared, as in the tables of `cargo pareto`.
const SKIPPED: usize = 200;

fn cases(rate_hz: u32) -> Vec<&'static Case> {
    let mut cases: Vec<&Case> = Vec::new();
    for case in CASES.iter().copied().flatten() {
        let known = cases
            .iter()
            .any(|one| one.c.to_string() == case.c.to_string());
        if case.rate_hz == rate_hz && !known {
            cases.push(case);
        }
    }
    cases
}

fn image(rate_hz: u32, cases: &[&Case]) -> Image {
    let folder = folder(&format!("board-{rate_hz}"));
    std::fs::write(folder.join("parameters.h"), parameters(cases)).expect("target is writable");
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/");
    let program = folder.join("image.elf");
    let m4f = BOARDS.iter().find(|one| one.folder == "cortex-m4f");
    let library = build(m4f.expect("a library")).expect("the library");
    let script = format!("-T{here}c/image.ld");
    let memory = format!("-L{here}../..");
    let more = [library.to_str().expect("a path in UTF-8"), &script, &memory];
    compiled(&ARM, "image.c", &folder, &more, &program);
    Image::read(Level::Speed, &program).expect("an image")
}

/// The subject of the bench image for a case.
fn subject(case: &Case) -> usize {
    let window = if case.c.row.settling.is_window() {
        case.c.capacity
    } else {
        0
    };
    let same = |subject: &Subject| {
        (subject.name, subject.window) == (case.c.row.name, window)
            && [0, case.rate_hz].contains(&subject.rate_hz)
    };
    SUBJECTS
        .iter()
        .position(same)
        .expect("the bench image has it")
}

fn mean(ran: &Ran) -> f64 {
    let counted = &ran.instructions[SKIPPED..];
    counted.iter().copied().map(f64::from).sum::<f64>() / counted.len() as f64
}

#[test]
fn updates_in_c_have_the_bits_and_nearly_the_instructions_of_rust() {
    if missing(ARM.program) {
        return;
    }
    let bench = Image::build(Level::Speed).expect("the bench image");
    let all = traces::all().expect("the traces");
    let mut above = Vec::new();
    for rate_hz in RATES_HZ {
        let cases = cases(rate_hz);
        let image = image(rate_hz, &cases);
        let traces: Vec<&[Sample]> = all
            .iter()
            .filter(|trace| trace.rate_hz == rate_hz && ["still", "texture"].contains(&trace.name))
            .map(|trace| &trace.samples[..])
            .collect();
        assert_eq!(traces.len(), 2);
        let jobs = |subject: &dyn Fn(usize) -> usize| -> Vec<Job<'_>> {
            (0..cases.len())
                .flat_map(|k| traces.iter().map(move |samples| (k, *samples)))
                .map(|(k, samples)| Job {
                    subject: subject(k),
                    samples,
                    follow: 0,
                })
                .collect()
        };
        let names: Vec<_> = cases.iter().map(|case| case.c.to_string()).collect();
        let in_c = on_board_in_c(&image, &names, &jobs(&|k| k)).expect("the image runs");
        let in_rust = on_board(&bench, &jobs(&|k| subject(cases[k]))).expect("the image runs");
        for (k, (in_c, in_rust)) in in_c.iter().zip(&in_rust).enumerate() {
            let case = cases[k / traces.len()];
            let samples = traces[k % traces.len()];
            let expected = (case.run)(samples);
            let velocities = expected.iter().step_by(VALUES).map(|value| value.to_bits());
            let name = format!("{} at {rate_hz} Hz", case.c);
            assert!(
                in_c.velocities
                    .iter()
                    .map(|value| value.to_bits())
                    .eq(velocities),
                "{name}: bits on the board"
            );
            let (c, rust) = (mean(in_c), mean(in_rust));
            println!("{name}: {c:.1} instructions in C, {rust:.1} in Rust");
            if c > allowed(case.c.row, rust) {
                above.push(format!("{name}: {c:.1} in C, {rust:.1} in Rust"));
            }
        }
    }
    assert!(above.is_empty(), "{}", above.join("\n"));
}
