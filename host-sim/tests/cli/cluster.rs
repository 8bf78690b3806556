//! The files in `cluster/`: their commands are run here, without an engine.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::HOST_SIM;

/// A run that takes milliseconds.
const SHORT: &str = "robust --scene hold --rate 1000 --seconds 0.05 --devices 3";

/// In place of `sbatch`: runs an array task by task, and a dependent job at once. A task that is in
/// the file `lost` fails.
const SBATCH: &str = r#"#!/usr/bin/env bash
set -eu
while [[ $1 == --* ]]; do
    case $1 in
        --array=*) array=${1#*=} ;;
        --output=*) output=${1#*=} ;;
        --dependency=*) [ "$1" = --dependency=afterany:17 ] ;;
    esac
    shift
done
if [ -z "${array:-}" ]; then
    bash "$@" > "$output" 2>&1 || true
    echo 18
    exit
fi
for range in ${array//,/ }; do
    for task in $(seq "${range%-*}" "${range#*-}"); do
        if ! grep -qx "$task" lost; then
            SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=1 bash "$@" > "${output//%a/$task}" 2>&1
        fi
    done
done
echo '17;cluster'
"#;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("bin")).unwrap();
        Self(folder)
    }

    /// Runs a program with `bin` first on the PATH.
    fn run(&self, program: &str, arguments: &[&str], variables: &[(&str, &str)]) -> Output {
        let old = std::env::var("PATH").unwrap();
        let path = format!("{}:{old}", self.0.path().join("bin").display());
        Command::new(program)
            .args(arguments)
            .env("PATH", path)
            .envs(variables.iter().copied())
            .current_dir(self.0.path())
            .output()
            .unwrap()
    }

    fn good(&self, program: &str, arguments: &[&str], variables: &[(&str, &str)]) {
        let output = self.run(program, arguments, variables);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{arguments:?}: {said}");
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.0.path().join(name))
            .unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Compares the merged outputs with those of a single run.
    fn merged_equals_whole(&self, merged: &str) {
        let whole: Vec<_> = SHORT.split(' ').chain(["--out", "whole"]).collect();
        self.good(HOST_SIM, &whole, &[]);
        for name in ["robust.csv", "robust.json", "index.html"] {
            // The page names the command with its folder.
            let text = |of: &str| {
                let text = self.text(&format!("{of}/{name}"));
                text.replace(&format!(" --out {of}"), "")
            };
            assert!(text("whole") == text(merged), "{name}");
        }
    }
}

fn cluster(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../cluster")
        .join(name)
}

#[test]
fn slurm_array_is_merged_and_a_lost_shard_is_run_again() {
    let folder = Folder::new();
    let sbatch = folder.0.path().join("bin/sbatch");
    fs::write(&sbatch, SBATCH).unwrap();
    fs::set_permissions(&sbatch, fs::Permissions::from_mode(0o755)).unwrap();
    let script = cluster("slurm.sh");
    let submit = |shards: &[(&str, &str)]| {
        let mut arguments = vec![script.to_str().unwrap(), "submit", "5", "run"];
        arguments.extend(SHORT.split(' '));
        folder.good(
            "bash",
            &arguments,
            &[&[("PROGRAM", HOST_SIM)], shards].concat(),
        );
    };
    fs::write(folder.0.path().join("lost"), "2\n4\n").unwrap();
    submit(&[]);
    let said = folder.text("run/merge.log");
    assert!(said.contains("shards 2,4 of 5 are missing"), "{said}");
    fs::write(folder.0.path().join("lost"), "").unwrap();
    let kept = fs::metadata(folder.0.path().join("run/parts/shard-1-of-5.jsonl")).unwrap();
    submit(&[("SHARDS", "2,4-4")]);
    let same = fs::metadata(folder.0.path().join("run/parts/shard-1-of-5.jsonl")).unwrap();
    assert_eq!(kept.modified().unwrap(), same.modified().unwrap());
    folder.merged_equals_whole("run/merged");
}

/// The shell command of the only container in a manifest.
fn command(manifest: &str) -> String {
    let (_, rest) = manifest.split_once("command: [sh, -c]\n").unwrap();
    let (_, script) = rest.split_once("args:\n            - |\n").unwrap();
    let lines = script.lines();
    let lines = lines.map_while(|line| line.strip_prefix("              "));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn commands_of_the_kubernetes_jobs_run_all_shards_and_merge_them() {
    let folder = Folder::new();
    std::os::unix::fs::symlink(HOST_SIM, folder.0.path().join("bin/host-sim")).unwrap();
    let [shards, merge] = ["kubernetes.yaml", "kubernetes-merge.yaml"]
        .map(|name| fs::read_to_string(cluster(name)).unwrap());
    let (_, n) = shards.split_once("\n  completions: ").unwrap();
    let n: usize = n.split_once('\n').unwrap().0.parse().unwrap();
    // The folder of the volume and the length of the run are others here.
    let long = "robust --devices 100000 ";
    let here = |command: String| {
        command
            .replace(long, &format!("{SHORT} "))
            .replace("/shards", "vol")
    };
    let (shard, merge) = (command(&shards), here(command(&merge)));
    assert!(shard.contains(long), "{shard}");
    for manifest in [
        &shards,
        &fs::read_to_string(cluster("kubernetes-merge.yaml")).unwrap(),
    ] {
        assert!(manifest.contains("mountPath: /shards }"), "{manifest}");
    }
    let run_all = || {
        for index in 0..n {
            let index = index.to_string();
            let variables = [("JOB_COMPLETION_INDEX", index.as_str())];
            folder.good("sh", &["-c", &here(shard.clone())], &variables);
        }
    };
    run_all();
    // A lost shard is run again, and the others are kept.
    let file = |k: usize| folder.0.path().join(format!("vol/shard-{k}-of-{n}.jsonl"));
    let written = || fs::metadata(file(1)).unwrap().modified().unwrap();
    let before = written();
    fs::remove_file(file(2)).unwrap();
    run_all();
    assert_eq!(written(), before);
    folder.good("sh", &["-c", &merge], &[]);
    folder.merged_equals_whole("vol/merged");
}
