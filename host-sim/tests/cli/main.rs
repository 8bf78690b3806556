//! The command line as somebody types it.

mod closed_loop;
mod cluster;
mod coarsen;
#[path = "../common/mod.rs"]
mod common;
mod compare;
mod escaping;
mod export;
mod files;
mod identify;
mod identify_logs;
mod logs;
mod output;
mod real;
mod real_peers;
mod recommend;
mod record;
mod recordings;
mod refusals;
mod replay;
mod replay_reference;
mod robust;
mod shards;
mod tables;
mod tune;
mod tune_logs;
mod uneven;
mod version;
mod words;
mod zwidth;

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of its own for each test, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("limpid-{test}-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
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
fn help_names_every_command() {
    let folder = Folder::new("help");
    let help = folder.good(&["--help"]);
    for command in [
        "compare",
        "replay",
        "record",
        "plot",
        "identify",
        "simulate",
        "coarsen",
        "real",
        "recommend",
        "tune",
        "sensitivity",
        "limit",
        "zwidth",
        "robust",
        "merge",
        "estimators",
        "scenarios",
        "device",
    ] {
        assert!(help.contains(&format!("\n  {command} ")), "{help}");
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
}
