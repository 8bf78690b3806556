//! Commands in shards: merged files give the bytes of a single run, and shards that are no run are
//! refused by name.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use crate::HOST_SIM;
use crate::common::{Folder, files};

/// Standard output and files of `arguments`, which write to `here`; the outputs are removed.
fn outputs(folder: &Folder, arguments: &str) -> (String, BTreeMap<PathBuf, Vec<u8>>) {
    let out = folder.good(arguments);
    let here = folder.path().join("here");
    let files = files(&here);
    fs::remove_dir_all(here).unwrap();
    (out, files)
}

/// Runs `command` whole and in `n` shards, which are merged in an order that is not that of the parts.
fn merged_equals_whole(
    folder: &Folder,
    command: &str,
    options: &str,
    file: &str,
    counts: &[usize],
) {
    let whole = outputs(folder, &format!("{command} {options}"));
    assert!(
        whole.1.contains_key(&folder.path().join(file)),
        "{:?}",
        whole.1.keys()
    );
    for &n in counts {
        let mut names = Vec::new();
        for k in 1..=n {
            let printed = folder.good(&format!("{command} --shard {k}/{n} --out parts"));
            assert_eq!(printed, format!("parts/shard-{k}-of-{n}.jsonl\n"));
            names.push(printed.trim().to_owned());
        }
        names.rotate_left(n / 2);
        names.swap(0, n - 1);
        let merged = outputs(folder, &format!("merge {} {options}", names.join(" ")));
        assert_eq!(merged.0, whole.0, "{n} shards");
        assert_eq!(
            merged.1.keys().collect::<Vec<_>>(),
            whole.1.keys().collect::<Vec<_>>()
        );
        for (name, bytes) in &whole.1 {
            assert!(merged.1[name] == *bytes, "{n} shards: {}", name.display());
        }
    }
}

const ROBUST: &str = "robust --scene hold --scene wall --rate 1000 --seconds 0.2 --devices 20";

#[test]
fn merged_shards_of_robust_equal_a_single_run() {
    let outputs = "--out here/page --json here/rows.json";
    let folder = Folder::new(HOST_SIM);
    let file = "here/page/robust.csv";
    merged_equals_whole(&folder, ROBUST, outputs, file, &[1, 3, 120]);
}

#[test]
fn merged_shards_of_sensitivity_equal_a_single_run() {
    let command = "sensitivity --scenario step --scenario wall --rate 1000 --rate 2000 --seed 3 --seed 4 \
                   --seconds 0.5 --estimator adaptive --estimator pll --set pll.bandwidth_hz=33.3";
    let outputs = "--json here/rows.json --out here/page";
    let file = "here/page/figures/01.svg";
    let folder = Folder::new(HOST_SIM);
    merged_equals_whole(&folder, command, outputs, file, &[3, 9]);
}

#[test]
fn merged_shards_of_zwidth_equal_a_single_run() {
    let command =
        "zwidth --estimator pll --estimator kalman-motor --rate 1000 --lines 256 --lines 1024";
    let file = "here/page/zwidth.csv";
    let folder = Folder::new(HOST_SIM);
    merged_equals_whole(&folder, command, "--out here/page", file, &[3, 5]);
}

/// Two groups with traces of their own, one of which has time stamps of edges; parameters at the limits
/// of their ranges have notes.
#[test]
fn merged_shards_of_tune_equal_a_single_run() {
    let command = "tune --estimator pll --estimator low-pass --estimator kalman-motor-steady --estimator \
                   adaptive-edge --rate 1000 --rate 2000 --seconds 0.5 --seeds 1 --scenario texture";
    let folder = Folder::new(HOST_SIM);
    let file = "here/p.toml";
    merged_equals_whole(&folder, command, "--out here/p.toml", file, &[2, 5, 17]);
}

const SIMULATE: &str = "simulate --scenario track --rate 1000 --seconds 6 --out log.csv";

/// One recording has no true velocity and not all columns: there are notes on recordings, and an
/// estimator is left out.
#[test]
fn merged_shards_of_tune_on_recordings_equal_a_single_run() {
    let folder = Folder::new(HOST_SIM);
    folder.good(SIMULATE);
    let counts = folder.text("log.csv");
    let counts = counts.lines().filter(|line| !line.starts_with('#'));
    let counts: String = counts
        .map(|line| line.split(',').take(2).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    assert!(counts.starts_with("t,counts_large\n"), "{counts}");
    fs::write(folder.path().join("counts.csv"), counts).unwrap();
    let command = "tune log.csv counts.csv --estimator pll --estimator kalman-motor --estimator low-pass \
                   --estimator foaw-best-fit";
    let file = "here/p.toml";
    merged_equals_whole(&folder, command, "--out here/p.toml", file, &[1, 2, 5]);
    folder.good(&format!("{command} --out p.toml"));
    let text = folder.text("p.toml");
    for said in [
        "# host-sim tune log.csv counts.csv --estimator pll",
        "# Tuned on every second second of log.csv, counts.csv.",
        "# counts.csv: no column true_omega",
        "# kalman-motor: left out, it needs other columns",
        "pll]",
        "low-pass]",
        "foaw-best-fit]",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
}

#[test]
fn shards_of_another_recording_are_refused() {
    let folder = Folder::new(HOST_SIM);
    folder.good(SIMULATE);
    let tune = "tune log.csv --estimator pll --estimator low-pass";
    folder.good(&format!("{tune} --shard 1/2 --out parts"));
    // The name, the columns and the number of rows are as before.
    let text = folder.text("log.csv");
    let (head, last) = text.trim_end().rsplit_once('\n').unwrap();
    let (t, fields) = last.split_once(',').unwrap();
    let (count, others) = fields.split_once(',').unwrap();
    let count: i64 = count.parse().unwrap();
    let changed = format!("{head}\n{t},{},{others}\n", count + 1);
    fs::write(folder.path().join("log.csv"), changed).unwrap();
    folder.good(&format!("{tune} --shard 2/2 --out parts"));
    let both = "parts/shard-1-of-2.jsonl parts/shard-2-of-2.jsonl";
    let line = folder.refused(&format!("merge {both} --out merged.toml"));
    let said = "parts/shard-2-of-2.jsonl: settings differ from those of parts/shard-1-of-2.jsonl: logs = \
                [{\"name\":\"log.csv\",\"sum\":\"";
    assert!(line.contains(said), "{line}");

    let line = folder.refused("merge parts/shard-1-of-2.jsonl --out merged.toml");
    let again = format!("shard 2/2 is missing; run host-sim {tune} --shard 2/2 --out parts");
    assert!(line.contains(&again), "{line}");
    folder.good(&format!("{tune} --shard 1/2 --out parts"));
    let line = folder.refused(&format!("merge {both} --json rows.json"));
    assert!(line.contains("--json: tune has no rows"), "{line}");

    let motion = "tune --rate 1000 --seconds 0.5 --seeds 1 --scenario texture --estimator pll";
    folder.good(&format!("{motion} --shard 1/2 --out motion"));
    let names = "motion/shard-1-of-2.jsonl parts/shard-2-of-2.jsonl";
    let line = folder.refused(&format!("merge {names} --out merged.toml"));
    let said = "shard of host-sim tune on recordings, but motion/shard-1-of-2.jsonl is one of host-sim tune";
    assert!(line.contains(said), "{line}");
    let line = folder.refused("tune none.csv --shard 1/2 --out parts");
    assert!(line.contains("none.csv: cannot read"), "{line}");
}

/// Without an option for outputs the merged run writes where the command does.
#[test]
fn default_folder_is_that_of_the_command() {
    let folder = Folder::new(HOST_SIM);
    let command = "sensitivity --scenario step --seconds 0.5 --estimator pll";
    let printed = folder.good(&format!("{command} --shard 1/1"));
    assert_eq!(printed, "target/sensitivity/shard-1-of-1.jsonl\n");
    folder.good("merge target/sensitivity/shard-1-of-1.jsonl");
    let page = folder.text("target/sensitivity/index.html");
    assert!(page.contains(&format!("host-sim {command}<")), "{page}");
    let json = folder.good("merge target/sensitivity/shard-1-of-1.jsonl --json -");
    assert_eq!(json, folder.text("target/sensitivity/sensitivity.json"));
}

#[test]
fn shards_that_are_no_run_are_refused_by_name() {
    let folder = Folder::new(HOST_SIM);
    let tiny = "robust --scene off --rate 1000 --seconds 0.05 --devices 3";
    for k in 1..=4 {
        folder.good(&format!("{tiny} --out . --shard {k}/4"));
    }
    folder.good(&format!("{tiny} --out . --shard 1/2"));
    folder.good(&format!("{tiny} --seed 2 --shard 2/4 --out seed"));
    folder
        .good("sensitivity --scenario step --seconds 0.5 --estimator pll --shard 2/4 --out other");
    let merge = |names: &str, said: &str| {
        let names = names.split(' ').map(|name| match name.len() {
            1 => format!("shard-{name}-of-4.jsonl"),
            _ => name.to_owned(),
        });
        let names: Vec<_> = names.collect();
        let line = folder.refused(&format!("merge {} --out merged", names.join(" ")));
        assert!(line.contains(said), "{line}");
    };
    let again = "run host-sim robust --scene off --rate 1000 --seconds 0.05 --devices 3 --shard 2/4 --out .";
    merge(
        "1 3 4",
        &format!("shard 2/4 is missing; {again} and add its shard-2-of-4.jsonl"),
    );
    merge(
        "1",
        &format!("shards 2-4 of 4 are missing; {again}, likewise the others"),
    );
    merge("3", "shards 1-2,4 of 4 are missing");
    merge(
        "1 ./shard-1-of-4.jsonl",
        "./shard-1-of-4.jsonl: shard 1/4 is already given by shard-1-of-4.jsonl",
    );
    merge(
        "1 shard-1-of-2.jsonl",
        "shard-1-of-2.jsonl: shard 1/2, but shard-1-of-4.jsonl is shard 1/4",
    );
    merge("1 nowhere.jsonl", "nowhere.jsonl: cannot read");
    merge(
        "1 seed/shard-2-of-4.jsonl",
        "seed/shard-2-of-4.jsonl: settings differ from those of shard-1-of-4.jsonl: seed = 2, not 1",
    );
    merge(
        "1 other/shard-2-of-4.jsonl",
        "other/shard-2-of-4.jsonl: shard of host-sim sensitivity, but shard-1-of-4.jsonl is one of host-sim \
         robust",
    );

    // A file that was cut anywhere, or in which anything was changed.
    let text = folder.text("shard-2-of-4.jsonl");
    let lines: Vec<_> = text.split_inclusive('\n').collect();
    assert_eq!(lines.len(), 2 + 8, "{text}");
    let with = |name: &str, text: &str, said: &str| {
        fs::write(folder.path().join(name), text).unwrap();
        merge(&format!("1 3 4 {name}"), &format!("{name}: {said}"));
        fs::remove_file(folder.path().join(name)).unwrap();
    };
    let changed = "changed after it was written: the checksum is ";
    with(
        "empty.jsonl",
        "",
        "is empty; run the command with its --shard again",
    );
    with("heading.jsonl", &text[..100], "line 1: not a shard");
    with(
        "lines.jsonl",
        &lines[..5].concat(),
        "its end is missing; run host-sim robust",
    );
    with("row.jsonl", &text[..text.len() / 2], "its end is missing");
    with("last.jsonl", &text[..text.len() - 1], "its end is missing");
    with(
        "hole.jsonl",
        &[&lines[..3], &lines[4..]].concat().concat(),
        changed,
    );
    with(
        "twice.jsonl",
        &[&lines[..4], &lines[3..]].concat().concat(),
        changed,
    );
    with(
        "digit.jsonl",
        &text.replacen("\"felt_nm\":", "\"felt_nm\":1", 1),
        changed,
    );
    with(
        "seed.jsonl",
        &text.replacen("\"seed\":1", "\"seed\":2", 1),
        changed,
    );
}

#[test]
fn command_of_a_missing_shard_is_quoted_for_a_shell() {
    let folder = Folder::new(HOST_SIM);
    let run = "robust --scene off --rate 1000 --seconds 0.05 --devices 0 --shard 1/2 --out";
    let out = "it's a folder";
    folder.good(&run.split(' ').chain([out]).collect::<Vec<_>>());
    let line = folder.refused(&["merge", "it's a folder/shard-1-of-2.jsonl"]);
    let said = r"--shard 2/2 --out 'it'\''s a folder' and add its shard-2-of-2.jsonl";
    assert!(line.contains(said), "{line}");
}
