//! `robust` as somebody types it.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder of its own for each test, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("limpid-{test}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn run(&self, arguments: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .args(arguments.split_whitespace())
            .current_dir(&self.0)
            .output()
            .unwrap()
    }

    /// Standard output of a run that ended with `status`.
    fn ends(&self, status: i32, arguments: &str) -> (String, String) {
        let output = self.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{arguments}: {errors}");
        (String::from_utf8(output.stdout).unwrap(), errors)
    }

    /// The one line of a run that was refused, which must leave every file as it was.
    fn refused(&self, arguments: &str) -> String {
        let before = self.files();
        let (out, errors) = self.ends(2, arguments);
        assert!(out.is_empty(), "{arguments}: {out}");
        assert_eq!(errors.lines().count(), 1, "{arguments}: {errors}");
        assert_eq!(self.files(), before, "{arguments}");
        errors
    }

    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const SHORT: &str = "robust --scene hold --scene wall --rate 1000 --seconds 0.2 --devices 20";

#[test]
fn single_device_is_repeated_with_only() {
    let folder = Folder::new("robust-only");
    let (all, _) = folder.ends(0, &format!("{SHORT} --json -"));
    assert!(
        folder.files().is_empty(),
        "no report unless it is asked for"
    );
    let all: Vec<serde_json::Value> = serde_json::from_str(&all).unwrap();
    for device in ["17", "agile-stiff"] {
        let (one, _) = folder.ends(0, &format!("{SHORT} --only {device} --json -"));
        let one: Vec<serde_json::Value> = serde_json::from_str(&one).unwrap();
        let same: Vec<_> = all
            .iter()
            .filter(|row| row["device"] == device)
            .cloned()
            .collect();
        assert_eq!(one, same);
    }
}

#[test]
fn violation_has_exit_status_1_and_the_command_that_repeats_it() {
    let folder = Folder::new("robust-violated");
    // A handle so heavy that a hand that moves it feels more than the limit.
    fs::write(
        folder.0.join("heavy.toml"),
        "[hand]\nstiffness_nm_per_rad = 200\ndamping_nms_per_rad = 1\n\
         [small]\ninertia_kg_m2 = 1e-2\n",
    )
    .unwrap();
    let run = "robust --scene off --rate 1000 --seconds 0.5 --devices 0 --device heavy.toml";
    let (out, said) = folder.ends(1, &format!("{run} --out .",));
    assert!(out.contains("violated"), "{out}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(
        said.contains("scene off, device nominal, seed 1: torque"),
        "{said}"
    );
    assert!(said.contains("--only nominal"), "{said}");
    assert!(folder.0.join("robust.csv").exists());
    folder.ends(1, &format!("{run} --only nominal"));
    // The file of a shard is complete, and the merged run has the verdict.
    folder.ends(0, &format!("{run} --shard 1/1 --out ."));
    folder.ends(1, "merge shard-1-of-1.jsonl --out merged");
}

#[test]
fn invalid_arguments_are_refused_with_a_remedy() {
    let folder = Folder::new("robust-words");
    for (arguments, said) in [
        (
            "robust --scene step",
            "no scene 'step'; there are off, free-air",
        ),
        ("robust --estimator best", "no estimator 'best'"),
        (
            "robust --estimator kalman-motor",
            "reads more than its own encoder",
        ),
        ("robust --rate 5", "rate 5 Hz"),
        ("robust --seconds 0", "duration 0 s"),
        ("robust --devices many", "--devices"),
        ("robust --shard 4/3", "must be K/N with K from 1 to N"),
        ("robust --shard 1/3 --only 4", "--only"),
        ("robust --only corner", "no device 'corner'"),
        ("robust --device none.toml", "none.toml: cannot read"),
        ("robust --set pll.cutoff=3", "pll has no parameter 'cutoff'"),
        ("merge", "SHARD"),
        ("merge none.jsonl", "none.jsonl: cannot read"),
    ] {
        let line = folder.refused(arguments);
        assert!(line.contains(said), "{arguments}: {line}");
    }
}
