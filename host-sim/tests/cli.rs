//! The command line as somebody types it.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data");

/// A folder of its own for each test, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("limpid-{test}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), text).unwrap();
    }

    fn files(&self) -> BTreeSet<String> {
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let files = fs::read_dir(&self.0).unwrap().map(name);
        files.map(|name| name.into_string().unwrap()).collect()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .args(arguments)
            .current_dir(&self.0)
            .output()
            .unwrap()
    }

    /// Standard output of a run that ended well.
    fn good(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// The one line of a run that was refused, which must leave every file as it was.
    fn refused(&self, arguments: &[&str]) -> String {
        let before = self.files();
        let output = self.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{arguments:?}: {errors}");
        assert!(errors.starts_with("error: "), "{errors}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert_eq!(self.files(), before, "{arguments:?}");
        errors
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn json(text: &str) -> Vec<serde_json::Value> {
    serde_json::from_str(text).unwrap()
}

const SHORT: [&str; 9] = [
    "compare",
    "--scenario",
    "step",
    "--rate",
    "1000",
    "--seconds",
    "1",
    "--json",
    "-",
];

#[test]
fn json_on_standard_output_is_the_contract() {
    let folder = Folder::new("json");
    let rows = json(&folder.good(&SHORT));
    let names: Vec<_> = rows
        .iter()
        .map(|row| row["estimator"].as_str().unwrap())
        .collect();
    for name in [
        "finite-difference",
        "low-pass",
        "foaw-end-fit",
        "foaw-best-fit",
        "kalman-triple",
        "kalman-motor",
        "pll",
    ] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    for row in &rows {
        assert_eq!(row["scenario"], "step");
        assert_eq!(row["rate_hz"], 1000.0);
        assert_eq!(row["plant"], "friction");
        assert_eq!(row["seed"], 1);
        for field in [
            "rms_rad_s",
            "max_rad_s",
            "distance_rad_s",
            "distance_transient_rad_s",
            "distance_pct",
            "distance_transient_pct",
            "rms_pct",
            "outside",
            "delay_ms",
            "noise_rad_s",
            "chatter_rad_s",
            "force_mn",
        ] {
            let value = row[field].as_f64();
            assert!(
                value.is_some_and(f64::is_finite),
                "{field} of {}",
                row["estimator"]
            );
        }
    }
    let difference = &rows[0];
    assert_eq!(difference["estimator"], "finite-difference");
    assert_eq!(difference["rms_pct"], 100.0);
    assert!(
        folder.files().is_empty(),
        "no report unless it is asked for"
    );
}

#[test]
fn the_same_command_gives_the_same_bytes_and_another_seed_others() {
    let folder = Folder::new("same");
    let report = |out| {
        let mut arguments = SHORT[..7].to_vec();
        arguments.extend(["--out", out]);
        folder.good(&arguments);
        let read = |name| fs::read(folder.0.join(out).join(name)).unwrap();
        // The page shows its own command, which names the folder.
        let page = String::from_utf8(read("index.html"))
            .unwrap()
            .replace(out, "");
        (page, read("scores.csv"), read("scores.json"))
    };
    assert!(report("folder-one") == report("folder-two"));
    let one = folder.good(&SHORT);
    assert_eq!(one, folder.good(&SHORT));
    let mut other = SHORT.to_vec();
    other.extend(["--seed", "2"]);
    assert_ne!(one, folder.good(&other));
}

#[test]
fn the_plant_without_friction_is_another_plant() {
    let folder = Folder::new("frictionless");
    let mut arguments = SHORT.to_vec();
    arguments.push("--frictionless");
    let rows = json(&folder.good(&arguments));
    assert!(rows.iter().all(|row| row["plant"] == "frictionless"));
    assert_ne!(
        rows[0]["rms_rad_s"],
        json(&folder.good(&SHORT))[0]["rms_rad_s"]
    );
}

#[test]
fn what_is_not_wanted_is_not_computed() {
    let folder = Folder::new("wanted");
    let mut arguments = SHORT.to_vec();
    arguments.extend(["--estimator", "pll", "--score", "rms_rad_s"]);
    let rows = json(&folder.good(&arguments));
    assert_eq!(rows.len(), 1);
    assert!(rows[0]["rms_pct"].is_f64() && rows[0]["delay_ms"].is_null());
}

#[test]
fn a_set_parameter_counts() {
    let folder = Folder::new("set");
    let rms = |set| {
        let mut arguments = SHORT.to_vec();
        arguments.extend(["--estimator", "foaw-end-fit", "--set", set]);
        json(&folder.good(&arguments))[0]["rms_pct"]
            .as_f64()
            .unwrap()
    };
    // One interval is the finite difference.
    assert_eq!(rms("foaw-end-fit.n=1"), 100.0);
    assert_ne!(rms("foaw-end-fit.n=15"), 100.0);
}

#[test]
fn a_recording_of_a_real_motor_replays() {
    let folder = Folder::new("replay");
    let recording = format!("{DATA}/back-and-forth.csv");
    let device = format!("{DATA}/hall-90.toml");
    let arguments = [
        "replay",
        &recording,
        "--device",
        &device,
        "--out",
        "v.csv",
        "--json",
        "v.json",
        // 90 counts a revolution want a longer window than the presets' 4096.
        "--set",
        "foaw-best-fit.n=64",
    ];
    let output = folder.run(&arguments);
    assert_eq!(output.status.code(), Some(0));
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(
        notes.contains("kalman-motor left out: no column current"),
        "{notes}"
    );

    let mut reader = csv::Reader::from_path(folder.0.join("v.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    assert_eq!(&header[0], "t");
    let foaw = header
        .iter()
        .position(|name| name == "foaw-best-fit")
        .unwrap();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 1501);
    // Once a window is full, the estimate is near the recording's own reference.
    let mut recorded = csv::Reader::from_path(&recording).unwrap();
    let recorded: Vec<_> = recorded.records().map(Result::unwrap).collect();
    for k in [100, 700, 1500] {
        let estimate: f64 = rows[k][foaw].parse().unwrap();
        let reference: f64 = recorded[k][4].parse().unwrap();
        assert!(
            (estimate - reference).abs() < 3.0,
            "row {k}: {estimate}, {reference}"
        );
    }

    let scores = json(&fs::read_to_string(folder.0.join("v.json")).unwrap());
    let rms = |name: &str| {
        let row = scores.iter().find(|row| row["estimator"] == name).unwrap();
        assert_eq!(row["scenario"], "back-and-forth.csv");
        row["rms_rad_s"].as_f64().unwrap()
    };
    // One count a tick is 69.8 rad/s here; at about a quarter of a count a tick, quantisation
    // alone costs finite difference sqrt(f (1 - f)) of it.
    assert!((15.0..35.0).contains(&rms("finite-difference")));
    assert!(rms("foaw-best-fit") < 0.1 * rms("finite-difference"));
}

#[test]
fn bad_recordings_are_refused_by_file_line_and_column() {
    let folder = Folder::new("bad");
    for (name, text, said) in [
        ("empty.csv", &b""[..], "empty.csv: line 1: no column t"),
        (
            "missing.csv",
            b"t,count\n0,0\n",
            "missing.csv: line 1: no column counts_large",
        ),
        (
            "text.csv",
            b"t,counts_large\n0,0\n1e-3,x\n",
            "text.csv: line 3: column counts_large",
        ),
        (
            "nan.csv",
            b"t,counts_large\n0,0\nnan,1\n",
            "nan.csv: line 3: column t",
        ),
        (
            "back.csv",
            b"t,counts_large\n0,0\n2,1\n1,2\n",
            "back.csv: line 4: column t",
        ),
        (
            "binary.csv",
            b"\x7fELF\x00\xff\xfe\n\x00\x01\x02",
            "binary.csv: line 1: no column t",
        ),
        (
            "bits.csv",
            b"t,counts_large\n\xff\xfe,0\n",
            "bits.csv: line 2: column t: not text",
        ),
        (
            "one.csv",
            b"t,counts_large\n0,0\n",
            "one.csv: needs two rows",
        ),
    ] {
        folder.write(name, text);
        let line = folder.refused(&["replay", name, "--out", "o.csv", "--json", "o.json"]);
        assert!(line.contains(said), "{line}");
    }
    let line = folder.refused(&["replay", "none.csv", "--out", "o.csv"]);
    assert!(line.contains("none.csv: cannot read"), "{line}");
    folder.write("plain.csv", "t,counts_large\n0,0\n1e-3,1\n2e-3,1\n");
    let line = folder.refused(&["replay", "plain.csv", "--json", "o.json"]);
    assert!(line.contains("no column true_omega"), "{line}");
    let line = folder.refused(&[
        "replay",
        "plain.csv",
        "--estimator",
        "kalman-motor",
        "--out",
        "o.csv",
    ]);
    let said = "plain.csv: line 1: no column current, which kalman-motor needs";
    assert!(line.contains(said), "{line}");
}

#[test]
fn a_hundred_megabytes_are_read_to_the_line_that_is_wrong() {
    let folder = Folder::new("large");
    let mut text = b"t,counts_large\n".to_vec();
    let mut row = 0_u32;
    while text.len() < 100_000_000 {
        writeln!(text, "{}.{:03},{row:012}", row / 1000, row % 1000).unwrap();
        row += 1;
    }
    text.extend_from_slice(b"1e9,end\n");
    folder.write("large.csv", &text);
    let line = folder.refused(&["replay", "large.csv", "--out", "o.csv"]);
    assert!(
        line.contains(&format!(
            "large.csv: line {}: column counts_large: 'end'",
            row + 2
        )),
        "{line}"
    );
    // And as one line without an end.
    folder.write("large.csv", vec![b'7'; 100_000_000]);
    let line = folder.refused(&["replay", "large.csv", "--out", "o.csv"]);
    assert!(line.contains("large.csv: line 1: no column t"), "{line}");
    assert!(line.len() < 300, "{} bytes", line.len());
}

#[test]
fn bad_words_are_refused_with_what_to_do() {
    let folder = Folder::new("words");
    folder.write("device.toml", "[large]\ninertia = 1\n");
    folder.write("negative.toml", "[large]\ninertia_kg_m2 = -1\n");
    folder.write("file", "");
    for (arguments, said) in [
        (&["compare", "--scenario", "stp"][..], "step"),
        (&["compare", "--estimator", "kalman"], "kalman-triple"),
        (&["compare", "--rate", "0"], "rate"),
        (&["compare", "--rate", "nan"], "rate"),
        (&["compare", "--rate", "fast"], "--rate"),
        (&["compare", "--seconds", "-1"], "duration -1 s"),
        (&["compare", "--seconds", "0.1"], "scores begin after 0.1 s"),
        (&["compare", "--score", "beauty"], "rms_rad_s"),
        (&["compare", "--set", "foaw-end-fit.n=129"], "from 1 to 128"),
        (
            &[
                "compare",
                "--set",
                "low-pass.cutoff_hz=600",
                "--rate",
                "1000",
            ],
            "1/2 of the control rate",
        ),
        (
            &["compare", "--device", "none.toml"],
            "none.toml: cannot read",
        ),
        (&["compare", "--device", "device.toml"], "inertia"),
        (
            &["compare", "--device", "negative.toml"],
            "large.inertia_kg_m2",
        ),
        (
            &["compare", "--presets", "device.toml"],
            "device.toml: line 1",
        ),
        (
            &[
                "compare",
                "--seconds",
                "0.2",
                "--rate",
                "1000",
                "--scenario",
                "step",
                "--out",
                "file/x",
            ],
            "file/x",
        ),
        (&["compare", "--bogus"], "host-sim --help"),
        (&["replay"], "TRACE.csv"),
        (
            &["tune", "--estimator", "finite-difference"],
            "nothing to tune",
        ),
        (&["tune", "--seeds", "0"], "--seeds"),
        (&["dance"], "host-sim --help"),
    ] {
        let line = folder.refused(arguments);
        assert!(line.contains(said), "{arguments:?}: {line}");
    }
}

#[test]
fn tuned_parameters_are_written_and_taken() {
    let folder = Folder::new("tune");
    let tune = [
        "tune",
        "--estimator",
        "pll",
        "--estimator",
        "foaw-end-fit",
        "--rate",
        "1000",
        "--seconds",
        "1",
        "--seeds",
        "1",
        "--scenario",
        "step",
        "--out",
        "tuned.toml",
    ];
    folder.good(&tune);
    let text = fs::read_to_string(folder.0.join("tuned.toml")).unwrap();
    assert!(text.contains("[preset.estimators.pll]"), "{text}");
    let rms = |more: &[&str]| {
        let mut arguments = SHORT.to_vec();
        arguments.extend(["--estimator", "pll"]);
        arguments.extend(more);
        json(&folder.good(&arguments))[0]["distance_rad_s"]
            .as_f64()
            .unwrap()
    };
    // Tuned on another seed, still much better than any bandwidth far off.
    let tuned = rms(&["--presets", "tuned.toml"]);
    assert!(tuned < 0.7 * rms(&["--set", "pll.bandwidth_hz=10"]));
    assert_ne!(tuned, rms(&["--set", "pll.bandwidth_hz=100"]));
}

#[test]
fn help_names_every_command() {
    let folder = Folder::new("help");
    let help = folder.good(&["--help"]);
    for command in [
        "compare",
        "replay",
        "tune",
        "estimators",
        "scenarios",
        "device",
    ] {
        assert!(help.contains(command), "{help}");
    }
    assert!(
        folder
            .good(&["estimators"])
            .contains("--set foaw-best-fit.n=")
    );
    assert!(folder.good(&["scenarios"]).contains("texture"));
    // A device that is printed is a device that is read.
    let device = folder.good(&["device"]);
    folder.write("d.toml", &device);
    assert_eq!(folder.good(&["device", "--device", "d.toml"]), device);
    assert!(Path::new(DATA).join("README.md").exists());
}
