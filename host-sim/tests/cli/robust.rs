//! `robust` as somebody types it.

use std::fs;

use crate::HOST_SIM;
use crate::common::{Folder, files};

const SHORT: &str = "robust --scene hold --scene wall --rate 1000 --seconds 0.2 --devices 20";

#[test]
fn single_device_is_repeated_with_only() {
    let folder = Folder::new(HOST_SIM);
    let (all, _) = folder.ends(0, &format!("{SHORT} --json -"));
    assert!(
        files(folder.path()).is_empty(),
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
    let folder = Folder::new(HOST_SIM);
    // A handle so heavy that a hand that moves it feels more than the limit.
    fs::write(
        folder.path().join("heavy.toml"),
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
    assert!(folder.path().join("robust.csv").exists());
    assert!(
        out.contains("corners and 0 drawn devices per scene"),
        "{out}"
    );
    let (out, _) = folder.ends(1, &format!("{run} --only nominal"));
    assert!(out.contains("1 device per scene"), "{out}");
    // The file of a shard is complete, and the merged run has the verdict.
    folder.ends(0, &format!("{run} --shard 1/1 --out ."));
    folder.ends(1, "merge shard-1-of-1.jsonl --out merged");
}

#[test]
fn corner_beyond_a_limit_is_limited_and_named() {
    let folder = Folder::new(HOST_SIM);
    let run = "robust --devices 2 --scene wall --rate 1000 --seconds 0.1 --device d.toml";
    for (device, name, said) in [
        (
            "disc.phase_counts = 0.12",
            "disc",
            "disc_random 0.0199805 in place of 0.02, because of disc: phase_counts",
        ),
        (
            "small.inertia_kg_m2 = 1.67e-6",
            "agile-stiff",
            "in place of 0.7, because of small.inertia_kg_m2 = ",
        ),
        (
            "hand.damping_nms_per_rad = 0.009",
            "agile-stiff",
            "in place of 0.7, because of hand.damping_nms_per_rad = 0.036: too large",
        ),
    ] {
        folder.write("d.toml", device);
        let output = folder.run(&format!("{run} --json -"));
        // Some of these devices violate a limit.
        assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
        let [rows, notes] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        assert_eq!(crate::json(&rows).len(), 29 + 2, "{device}");
        let first = format!("the first is scene wall, device {name}, with ");
        let is_note = |line: &&str| line.starts_with("note: ");
        assert_eq!(notes.lines().filter(is_note).count(), 1, "{notes}");
        assert!(notes.contains(&first) && notes.contains(said), "{notes}");
    }
    // The page of a merged run says it too.
    let run = format!("{run} --scene off --shard 1/1 --out .");
    folder.good(&run.replace("--scene wall ", ""));
    let (_, notes) = folder.ends(0, "merge shard-1-of-1.jsonl --out merged");
    assert!(notes.contains("limited to what a device can be"), "{notes}");
    let page = folder.text("merged/index.html");
    assert!(page.contains("limited to what a device can be"));
}

#[test]
fn invalid_arguments_are_refused_with_a_remedy() {
    let folder = Folder::new(HOST_SIM);
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
        ("robust --rate 5", "--rate 5: a closed loop needs a control"),
        ("robust --seconds 0", "duration 0 s"),
        ("robust --devices many", "--devices"),
        ("robust --shard 4/3", "must be K/N with K from 1 to N"),
        ("robust --shard 1/3 --only 4", "--only"),
        ("robust --only corner", "no device 'corner'"),
        (
            "robust --scene wall --only 9999999999",
            "--only 9999999999: the devices that --devices 1000 draws are 0 to 999; choose",
        ),
        (
            "robust --devices 0 --only 0",
            "--only 0: no device is drawn with --devices 0; choose",
        ),
        ("robust --device none.toml", "none.toml: cannot read"),
        ("robust --set pll.cutoff=3", "pll has no parameter 'cutoff'"),
        ("merge", "SHARD"),
        ("merge none.jsonl", "none.jsonl: cannot read"),
    ] {
        let line = folder.refused(arguments);
        assert!(line.contains(said), "{arguments}: {line}");
    }
}

#[test]
fn page_names_the_command_that_repeats_the_run_and_the_device() {
    let folder = Folder::new(HOST_SIM);
    folder.write("mine.toml", "[hand]\nstiffness_nm_per_rad = 0.4\n");
    let run = "robust --scene off --rate 1000 --seconds 0.2 --devices 1 --device mine.toml \
               --estimator pll --set pll.bandwidth_hz=200";
    folder.good(&format!("{run} --out page"));
    let words: Vec<_> = run.split_whitespace().collect();
    let command = format!("host-sim {} --out page", words.join(" "));
    let page = folder.text("page/index.html");
    assert!(page.contains(&command), "{page}");
    assert!(page.replace(&command, "").contains("mine.toml"), "{page}");
    // The page of a merged run is the page of the run.
    folder.good(&format!("{run} --shard 1/1 --out parts"));
    folder.good("merge parts/shard-1-of-1.jsonl --out merged");
    let merged = folder.text("merged/index.html");
    assert_eq!(merged.replace("--out merged", "--out page"), page);
}
