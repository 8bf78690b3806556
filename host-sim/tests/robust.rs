//! `robust` and `merge` as somebody types them.

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

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const SHORT: &str = "robust --scene hold --scene wall --rate 1000 --seconds 0.2 --devices 20";

#[test]
fn merged_shards_equal_a_single_run() {
    let folder = Folder::new("robust-merge");
    let (whole, _) = folder.ends(0, &format!("{SHORT} --out whole --json whole.json"));
    for k in 1..=3 {
        folder.ends(0, &format!("{SHORT} --out parts --shard {k}/3"));
    }
    let shards = "parts/shard-3-of-3.jsonl parts/shard-1-of-3.jsonl parts/shard-2-of-3.jsonl";
    let (merged, _) = folder.ends(
        0,
        &format!("merge {shards} --out merged --json merged.json"),
    );
    assert_eq!(whole.replace("whole", "merged"), merged);
    assert!(
        whole.contains("29 corners and 20 drawn devices per scene"),
        "{whole}"
    );
    assert_eq!(folder.read("whole.json"), folder.read("merged.json"));
    for name in ["robust.csv", "robust.json", "summary.svg", "index.html"] {
        let of = |folder_name: &str| folder.read(&format!("{folder_name}/{name}"));
        assert_eq!(of("whole"), of("merged"), "{name}");
    }
    let rows: Vec<serde_json::Value> = serde_json::from_slice(&folder.read("whole.json")).unwrap();
    assert_eq!(rows.len(), 2 * (29 + 20));
    assert_eq!(
        (&rows[0]["scene"], &rows[0]["device"]),
        (&"hold".into(), &"nominal".into())
    );
    let svg = String::from_utf8(folder.read("whole/summary.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
}

#[test]
fn shards_of_different_runs_are_refused_by_name() {
    let folder = Folder::new("robust-refused");
    let tiny = "robust --scene off --rate 1000 --seconds 0.05 --devices 3 --out .";
    for k in 1..=3 {
        folder.ends(0, &format!("{tiny} --shard {k}/3"));
    }
    folder.ends(0, &format!("{tiny} --shard 1/2"));
    let merge = |names: &str| folder.refused(&format!("merge {names} --out merged"));
    let said = merge("shard-1-of-3.jsonl shard-3-of-3.jsonl");
    assert!(
        said.contains("shard 2/3 is missing") && said.contains("shard-2-of-3.jsonl"),
        "{said}"
    );
    let said = merge("shard-1-of-3.jsonl ./shard-1-of-3.jsonl");
    assert!(
        said.contains("./shard-1-of-3.jsonl: shard 1/3 is already given by shard-1-of-3.jsonl"),
        "{said}"
    );
    let said = merge("shard-1-of-3.jsonl shard-1-of-2.jsonl");
    assert!(
        said.contains("shard-1-of-2.jsonl: shard 1/2, but"),
        "{said}"
    );
    let said = merge("shard-1-of-3.jsonl nowhere.jsonl");
    assert!(said.contains("nowhere.jsonl: cannot read"), "{said}");

    let text = String::from_utf8(folder.read("shard-2-of-3.jsonl")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let with = |name: &str, lines: &[&str]| {
        fs::write(folder.0.join(name), lines.join("\n")).unwrap();
        let said = merge(&format!("shard-1-of-3.jsonl shard-3-of-3.jsonl {name}"));
        assert!(said.contains(&format!("{name}: ")), "{said}");
        said
    };
    // Shard 2 of 3 ends with the last of the 29 corners and 3 devices.
    let said = with("short.jsonl", &lines[..lines.len() - 1]);
    assert!(said.contains("device 2 is missing"), "{said}");
    let said = with("hole.jsonl", &[&lines[..3], &lines[4..]].concat());
    assert!(
        said.contains("line 4: scene off, device large-constant-high is missing"),
        "{said}"
    );
    let said = with(
        "twice.jsonl",
        &[&lines[..], &lines[lines.len() - 1..]].concat(),
    );
    assert!(said.contains("device 2 is there twice"), "{said}");
    let cut = &lines[lines.len() - 1][..40];
    let said = with("cut.jsonl", &[&lines[..lines.len() - 1], &[cut]].concat());
    assert!(said.contains("line 12: EOF"), "{said}");
    let other = text.replacen("\"seed\":1", "\"seed\":2", 1);
    let said = with("other.jsonl", &other.lines().collect::<Vec<_>>());
    assert!(
        said.contains("settings differ from those of shard-1-of-3.jsonl"),
        "{said}"
    );
    let said = with("empty.jsonl", &[]);
    assert!(said.contains("not a shard"), "{said}");
}

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
    folder.ends(1, &format!("{run} --shard 1/1 --out ."));
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
