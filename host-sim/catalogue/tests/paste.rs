//! The lines of Rust for a user's program compile and give the velocities of the catalogue.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use simulation::trace::{EdgeStamp, Trace};

const CORE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../estimator-core");
const LOCK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.lock");

const ROWS: usize = 200;
const RATE_HZ: f64 = 2e3;

/// A device and a rate of which no value is that of the default.
fn setup() -> Setup {
    let mut setup = Setup::default();
    setup.rate.0 = RATE_HZ;
    let stages = &mut setup.stages;
    stages.large.counts_per_rev = 1000;
    stages.large.inertia *= 1.3;
    stages.large.torque_constant *= 0.8;
    stages.large.coulomb_friction *= 0.7;
    stages.small.counts_per_rev = 2000;
    stages.damping *= 1.2;
    stages.amplifier_bandwidth.0 *= 0.5;
    setup
}

/// A trace with all signals: a shaft that goes forward, turns and stops.
fn trace() -> Trace {
    let position = |k: usize| (40.0 * (k.min(150) as f64 * 0.03).sin()).floor() as i32 as u32;
    let counts: Vec<u32> = (0..ROWS).map(position).collect();
    let edge = |k: usize| {
        (k > 0 && counts[k] != counts[k - 1]).then(|| EdgeStamp {
            age_s: 21_000.0 / 84e6,
            boundary: counts[k].max(counts[k - 1]),
        })
    };
    let mut last = None;
    let edges = (0..ROWS).map(|k| {
        last = edge(k).or(last.map(|stamp: EdgeStamp| EdgeStamp {
            age_s: stamp.age_s + 1.0 / RATE_HZ,
            ..stamp
        }));
        last
    });
    Trace {
        rate_hz: RATE_HZ,
        counts_small: Some(counts.iter().map(|count| count / 2).collect()),
        current: Some((0..ROWS).map(|k| 0.25 * (k % 3) as f64).collect()),
        edges: Some(edges.collect()),
        counts_large: counts,
        ..Trace::default()
    }
}

/// The crate: a module per estimator, and a program that prints the bits of every velocity.
fn program(trace: &Trace, setup: &Setup) -> String {
    let mut text = String::from("use estimator_core::{ClockTicks, Count, Edge};\n\n");
    for kind in Kind::all() {
        let values = Parameters::default().values(kind, setup, PlantKind::Friction);
        let (id, rust) = (kind.id, kind.rust(setup, &values));
        let _ = writeln!(text, "mod {id} {{\n{rust}}}\n");
    }
    let edges = trace.edges.as_ref().unwrap().iter().map(|edge| match edge {
        None => "None".to_owned(),
        Some(edge) => {
            let age = (edge.age_s * 84e6).round();
            format!(
                "Some(Edge {{ boundary: Count({}), age: ClockTicks({age}) }})",
                edge.boundary
            )
        }
    });
    let edges: Vec<_> = edges.collect();
    let (counts, coupled) = (&trace.counts_large, trace.counts_small.as_ref().unwrap());
    let current = trace.current.as_ref().unwrap();
    let _ = writeln!(
        text,
        "const COUNT: [u32; {ROWS}] = {counts:?};\nconst COUPLED: [u32; {ROWS}] = {coupled:?};\n\
         const AMPS: [f32; {ROWS}] = {current:?};\nconst EDGE: [Option<Edge>; {ROWS}] = [{}];\n\nfn main() {{",
        edges.join(", ")
    );
    for kind in Kind::all() {
        let mut inputs = vec!["COUNT[k]"];
        if kind.needs.coupled {
            inputs.push("COUPLED[k]");
        }
        if kind.needs.current {
            inputs.push("if k == 0 { 0.0 } else { AMPS[k - 1] }");
        }
        if kind.needs.edge {
            inputs.push("EDGE[k]");
        }
        let (id, inputs) = (kind.id, inputs.join(", "));
        let _ = writeln!(
            text,
            "    let k = 0;\n    let mut velocity = {id}::Velocity::start({inputs});\n    let mut bits = Vec::new();\n    \
             for k in 1..{ROWS} {{ bits.push(velocity.update({inputs}).to_bits().to_string()); }}\n    \
             println!(\"{{}}\", bits.join(\" \"));"
        );
    }
    text + "}\n"
}

#[test]
fn pasted_lines_compile_and_give_the_same_velocities() {
    let (trace, setup) = (trace(), setup());
    // Below the build's own folder, so that nothing is left elsewhere.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pasted");
    fs::create_dir_all(folder.join("src")).unwrap();
    let manifest = format!(
        "[package]\nname = \"pasted\"\nedition = \"2024\"\n[dependencies]\n\
         estimator-core = {{ path = {CORE:?} }}\n[workspace]\n[lints.rust]\nunused = \"deny\"\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    fs::copy(LOCK, folder.join("Cargo.lock")).unwrap();
    fs::write(folder.join("src/main.rs"), program(&trace, &setup)).unwrap();
    let run = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--offline"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{errors}");
    let printed = String::from_utf8(run.stdout).unwrap();
    assert_eq!(printed.lines().count(), Kind::all().len());
    for (kind, line) in Kind::all().iter().zip(printed.lines()) {
        let values = Parameters::default().values(kind, &setup, PlantKind::Friction);
        let estimator = kind.build(&setup, &values).unwrap();
        let velocities = estimator.run(&trace);
        let bits: Vec<_> = velocities[1..]
            .iter()
            .map(|v| v.to_bits().to_string())
            .collect();
        assert_eq!(line, bits.join(" "), "{}", kind.name);
        assert!(velocities.iter().any(|v| *v != 0.0), "{}", kind.name);
    }
}
