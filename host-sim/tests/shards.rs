//! Commands in shards: merged files give the bytes of a single run, and shards that are no run are
//! refused by name.

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use common::{Folder, files};

const HOST_SIM: &str = env!("CARGO_BIN_EXE_host-sim");

/// Standard output and files of `arguments`, which write to `here`; the outputs are removed.
fn outputs(folder: &Folder, arguments: &str) -> (String, BTreeMap<PathBuf, Vec<u8>>) {
    let out = folder.good(arguments);
    let here = folder.path.join("here");
    let files = files(&here);
    fs::remove_dir_all(here).unwrap();
    (out, files)
}

/// Runs `command` whole and in `n` shards, which are merged in an order that is not that of the parts.
fn merged_equals_whole(test: &str, command: &str, options: &str, file: &str, counts: &[usize]) {
    let folder = Folder::new(test, HOST_SIM);
    let whole = outputs(&folder, &format!("{command} {options}"));
    assert!(
        whole.1.contains_key(&folder.path.join(file)),
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
        let merged = outputs(&folder, &format!("merge {} {options}", names.join(" ")));
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
    merged_equals_whole(
        "robust",
        ROBUST,
        outputs,
        "here/page/robust.csv",
        &[1, 3, 120],
    );
}

#[test]
fn merged_shards_of_sensitivity_equal_a_single_run() {
    let command = "sensitivity --scenario step --scenario wall --rate 1000 --rate 2000 --seed 3 --seed 4 \
                   --seconds 0.5 --estimator adaptive --estimator pll --set pll.bandwidth_hz=33.3";
    let outputs = "--json here/rows.json --out here/page";
    let file = "here/page/figures/01.svg";
    merged_equals_whole("sensitivity", command, outputs, file, &[3, 9]);
}

#[test]
fn merged_shards_of_zwidth_equal_a_single_run() {
    let command =
        "zwidth --estimator pll --estimator kalman-motor --rate 1000 --lines 256 --lines 1024";
    let file = "here/page/zwidth.csv";
    merged_equals_whole("zwidth", command, "--out here/page", file, &[3, 5]);
}

/// Two groups with traces of their own, one of which has time stamps of edges; parameters at the limits
/// of their ranges have notes.
#[test]
fn merged_shards_of_tune_equal_a_single_run() {
    let command = "tune --estimator pll --estimator low-pass --estimator kalman-motor-steady --estimator \
                   adaptive-edge --rate 1000 --rate 2000 --seconds 0.5 --seeds 1 --scenario texture";
    merged_equals_whole(
        "tune",
        command,
        "--out here/p.toml",
        "here/p.toml",
        &[2, 5, 17],
    );
}

/// Without an option for outputs the merged run writes where the command does.
#[test]
fn default_folder_is_that_of_the_command() {
    let folder = Folder::new("default", HOST_SIM);
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
    let folder = Folder::new("refused", HOST_SIM);
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
        fs::write(folder.path.join(name), text).unwrap();
        merge(&format!("1 3 4 {name}"), &format!("{name}: {said}"));
        fs::remove_file(folder.path.join(name)).unwrap();
    };
    let changed = "changed after it was written: the checksum is ";
    with("empty.jsonl", "", "line 1: not a shard");
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
