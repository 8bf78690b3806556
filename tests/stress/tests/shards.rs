//! `cargo stress` in shards: the merged files give the bytes of a single run.

#[path = "../../../host-sim/tests/common/mod.rs"]
mod common;

use common::Folder;

const STRESS: &str = env!("CARGO_BIN_EXE_stress");

const SHORT: &str = "--ticks 3000 --estimator kalman-triple-s --rate 1000 --rate 2000 --seed 5";

#[test]
fn merged_shards_equal_a_single_run() {
    let folder = Folder::new(STRESS);
    let whole = folder.good(&format!("{SHORT} --json whole.json"));
    assert!(
        whole.contains("kalman-triple-steady") && whole.contains("2000"),
        "{whole}"
    );
    // The course at one rate has been run before, and some shards of 60 are empty.
    folder.good(&format!("{SHORT} --resume kept.jsonl --shard 2/3"));
    // Of a run to standard output, this is all.
    let json = folder.good(&format!("{SHORT} --json -"));
    assert_eq!(json, folder.text("whole.json"));
    let kept = folder.text("kept.jsonl");
    assert!(!kept.is_empty());
    for (n, more) in [(3, "--resume kept.jsonl"), (60, "")] {
        for k in 1..=n {
            let printed = folder.good(&format!("{SHORT} {more} --shard {k}/{n}"));
            assert_eq!(printed, format!("target/stress/shard-{k}-of-{n}.jsonl\n"));
        }
        let names: Vec<_> = (1..=n)
            .rev()
            .map(|k| format!("target/stress/shard-{k}-of-{n}.jsonl"))
            .collect();
        let merged = folder.good(&format!("--merge {} --json merged.json", names.join(" ")));
        assert_eq!(merged, whole);
        assert_eq!(folder.text("merged.json"), folder.text("whole.json"));
    }
    let lines = |text: &str| text.lines().count();
    assert_eq!(lines(&folder.text("kept.jsonl")), 2, "each course once");
    assert_eq!(lines(&kept), 1, "{kept}");
}

#[test]
fn tables_have_the_named_estimators_alone() {
    let folder = Folder::new(STRESS);
    for (name, tables) in [("foaw-end-fit n 15", 3), ("finite-difference", 2)] {
        let arguments = ["--ticks", "1000", "--rate", "1000", "--estimator", name];
        let text = folder.good(&arguments);
        let kind = name.split(' ').next().unwrap();
        let blocks: Vec<_> = text.split("\n\n").collect();
        assert_eq!(blocks.len(), tables, "{text}");
        for other in ["pll", "kalman", "observer"] {
            assert!(!text.contains(other), "{text}");
        }
        assert!(blocks.iter().all(|block| block.contains(kind)), "{text}");
    }
}

#[test]
fn lost_shards_are_named_with_the_command_that_runs_them() {
    let folder = Folder::new(STRESS);
    folder.good(&format!("{SHORT} --shard 2/3 --out parts"));
    let errors = folder.refused("--merge parts/shard-2-of-3.jsonl");
    let again = "run cargo stress --ticks 3000 --rate 1000 --rate 2000 --estimator kalman-triple-s --seed 5 \
                 --shard 1/3 --out parts";
    assert!(
        errors.contains("shards 1,3 of 3 are missing") && errors.contains(again),
        "{errors}"
    );
    for wrong in [
        "--merge parts/shard-2-of-3.jsonl --seed 2",
        "--shard 1/3 --json x.json",
        "--out parts",
    ] {
        assert_eq!(folder.run(wrong).status.code(), Some(2), "{wrong}");
    }
}
