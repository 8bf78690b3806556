//! The command line as somebody types it.

mod board_estimates;
mod closed_loop;
mod cluster;
mod coarsen;
#[path = "../common/mod.rs"]
mod common;
mod compare;
mod decode;
mod escaping;
mod export;
mod feel;
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
mod sensitivity;
mod shards;
mod tables;
mod tune;
mod tune_logs;
mod uneven;
mod version;
mod words;
mod zwidth;

use common::{DATA, Folder};

const HOST_SIM: &str = env!("CARGO_BIN_EXE_host-sim");

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
    let folder = Folder::new(HOST_SIM);
    let help = folder.good(&["--help"]);
    for command in [
        "compare",
        "replay",
        "record",
        "plot",
        "identify",
        "simulate",
        "coarsen",
        "decode",
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
