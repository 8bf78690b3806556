//! Which source the program and its pages were built from.

use std::process::Command;

use crate::{Folder, HOST_SIM, SHORT};

/// The commit of this folder, or `None` outside of a repository.
fn head() -> Option<String> {
    let output = Command::new("git")
        .args(["rev-parse", "HEAD"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

#[test]
fn version_and_pages_name_the_commit_and_the_command() {
    let folder = Folder::new(HOST_SIM);
    let version = folder.good(&["--version"]);
    let version = version.trim().strip_prefix("host-sim ").unwrap();
    let (number, source) = version.split_once(" (commit ").unwrap();
    assert_eq!(number, env!("CARGO_PKG_VERSION"));
    let commit = source.split([',', ')']).next().unwrap();
    match head() {
        Some(head) => {
            assert!(head.starts_with(commit), "{version}, {head}");
            assert!(source.contains(", source of 20"), "{version}");
        }
        None => assert_eq!(commit, "unknown"),
    }
    let compare = [&SHORT[..7], &["--out", "compare"]].concat();
    let robust = [
        "robust",
        "--scene",
        "off",
        "--devices",
        "1",
        "--seconds",
        "0.2",
        "--out",
        "robust",
    ];
    for (arguments, command) in [
        (&compare[..], format!("host-sim {}", compare.join(" "))),
        (&robust, "host-sim robust --scene off".to_owned()),
    ] {
        folder.good(arguments);
        let page = folder.text(&format!("{}/index.html", arguments[arguments.len() - 1]));
        assert!(page.contains(version), "{arguments:?}");
        assert!(page.contains(&format!("<code>{command}")), "{command}");
    }
}
