//! A program in C for the board, linked by the Arm toolchain with the library for Cortex-M4F or compiled with limpid.c,
//! on the emulated board: bits and instructions of every estimator beside those of the bench image in Rust.

use std::path::Path;

use bench_image::{SUBJECTS, Subject};
use c_interface::{CASES, CORTEX_M4F, Case, VALUES, compiled, folder, missing, parameters};
use estimator_catalogue::{Parameter, Row};
use limpid_dist::{BOARDS, build, source};
use measured::tables::C_COST;
use pareto::board::{Job, Ran, on_board, on_board_in_c};
use pareto::image::{Image, Level};
use pareto::traces::{self, BenchTrace, RATES_HZ};

/// Most instructions that an update in C has beyond that in Rust, in the mean over a trace.
///
/// The parameters of the bench image are constants of its code, those of C are memory. The searches of FOAW and
/// the sums of the other windows have more values than there are registers where their length is a parameter.
/// An observer reads more parameters than there are registers, and checks the current, which in Rust the
/// sample's type has done. A bank with such an observer is a function apart, for which the sample is copied.
fn allowed(row: &Row, in_rust: f64) -> f64 {
    let more = match row.name {
        "foaw-best-fit" => 23.0,
        "foaw-end-fit" => 22.0,
        "imm-motor-edge" => 15.0,
        "imm-adaptive-edge" => 21.0,
        _ if row.settling.is_window() => 13.0,
        _ if row.parameters.iter().any(Parameter::is_torque) || row.needs.edge => 13.0,
        _ => 6.0,
    };
    in_rust + more
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

/// The image of these cases with `functions`, a library or a source.
fn image(rate_hz: u32, cases: &[&Case], functions: &Path) -> Image {
    let folder = folder(&format!("board-{rate_hz}"));
    std::fs::write(folder.join("parameters.h"), parameters(cases)).expect("target is writable");
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/");
    let program = folder.join("image.elf");
    let script = format!("-T{here}c/image.ld");
    let memory = format!("-L{here}../..");
    let more = [
        "-ffreestanding",
        "-nostdlib",
        "-Wl,--gc-sections",
        "-Wl,-z,noexecstack",
        functions.to_str().expect("a path in UTF-8"),
        &script,
        &memory,
        "-lgcc",
        // Where compilers of boards fuse a product and a sum unless they are told not to.
        "-std=gnu99",
    ];
    compiled(&CORTEX_M4F, "image.c", &folder, &more, &program);
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

fn bits(value: &f32) -> u32 {
    value.to_bits()
}

fn mean(ran: &Ran) -> f64 {
    let counted = &ran.instructions[SKIPPED..];
    counted.iter().copied().map(f64::from).sum::<f64>() / counted.len() as f64
}

#[test]
fn updates_in_c_have_the_bits_and_nearly_the_instructions_of_rust() {
    if missing(CORTEX_M4F.program) {
        return;
    }
    let m4f = BOARDS.iter().find(|one| one.folder == "cortex-m4f");
    let library = build(m4f.expect("a library")).expect("the library");
    let translated = folder("source").join("limpid.c");
    std::fs::write(&translated, source().expect("limpid.c")).expect("target is writable");
    let bench = Image::build(Level::Speed).expect("the bench image");
    let all = traces::all().expect("the traces");
    let (mut rows, mut above) = (Vec::new(), Vec::new());
    for rate_hz in RATES_HZ {
        let cases = cases(rate_hz);
        let traces = ["still", "texture"].map(|name| {
            let same = |trace: &&BenchTrace| (trace.name, trace.rate_hz) == (name, rate_hz);
            &all.iter().find(same).expect("a trace").samples[..]
        });
        let jobs = |subject: &dyn Fn(usize) -> usize| -> Vec<Job<'_>> {
            (0..cases.len())
                .flat_map(|k| traces.map(|samples| (subject(k), samples)))
                .map(|(subject, samples)| Job {
                    subject,
                    samples,
                    follow: 0,
                })
                .collect()
        };
        let names: Vec<_> = cases.iter().map(|case| case.c.to_string()).collect();
        let [in_c, of_source] = [&library, &translated].map(|functions| {
            let image = image(rate_hz, &cases, functions);
            on_board_in_c(&image, &names, &jobs(&|k| k)).expect("the image runs")
        });
        let in_rust = on_board(&bench, &jobs(&|k| subject(cases[k]))).expect("the image runs");
        for (k, case) in cases.iter().enumerate() {
            let mut row = vec![case.c.to_string(), rate_hz.to_string()];
            let mut last = Vec::new();
            for (samples, k) in traces.iter().zip(traces.len() * k..) {
                let expected = (case.run)(samples);
                let expected: Vec<_> = expected.iter().step_by(VALUES).map(bits).collect();
                let name = format!("{} at {rate_hz} Hz", case.c);
                for (ran, with) in [(&in_c[k], "the library"), (&of_source[k], "limpid.c")] {
                    let same = ran.velocities.iter().map(bits).eq(expected.iter().copied());
                    assert!(same, "{name}: bits on the board with {with}");
                }
                let (c, rust) = (mean(&in_c[k]), mean(&in_rust[k]));
                row.extend([c, rust].map(|count| format!("{count:.0}")));
                last.push(format!("{:.0}", mean(&of_source[k])));
                if c > allowed(case.c.row, rust) {
                    above.push(format!("{name}: {c:.1} in C, {rust:.1} in Rust"));
                }
            }
            rows.push([row, last].concat());
        }
    }
    // A compiler moves an instruction or two.
    let same = |_: &str, then: f64, now: f64| (then - now).abs() <= (0.02 * then).max(3.0);
    let checked = C_COST.check(&[], &rows, same);
    checked.unwrap_or_else(|error| panic!("{error}"));
    assert!(above.is_empty(), "{}", above.join("\n"));
}
