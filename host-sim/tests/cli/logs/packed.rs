//! Logs that are compressed, or no text.

use super::LOGS;
use crate::{Folder, HOST_SIM};

/// Runs a command of the shell in `folder`.
fn shell(folder: &Folder, script: &str) {
    let mut shell = std::process::Command::new("sh");
    let status = shell
        .args(["-c", script])
        .current_dir(folder.path())
        .status();
    assert!(status.unwrap().success(), "{script}");
}

#[test]
fn compressed_log_is_read_as_its_text() {
    let folder = Folder::new(HOST_SIM);
    shell(
        &folder,
        &format!("gzip -c '{LOGS}/own.csv' > own.csv.gz; head -c 900 own.csv.gz > cut.gz"),
    );
    let run = |log: &str| folder.good(&["replay", log, "--estimator", "pll"]);
    assert_eq!(run("own.csv.gz"), run(&format!("{LOGS}/own.csv")));
    folder.good(&["plot", "own.csv.gz", "--out", "p.svg"]);
    let line = folder.refused(&["replay", "cut.gz"]);
    assert!(
        line.contains("cut.gz: cannot read: not a complete gzip file: "),
        "{line}"
    );
    // A comment in the text has the counts per revolution.
    shell(
        &folder,
        &format!("(echo '# counts_per_rev = 512'; cat '{LOGS}/own.csv') | gzip > stated.gz"),
    );
    let output = folder.run(&["replay", "stated.gz", "--estimator", "pll"]);
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(
        notes.contains("stated.gz: 512 counts/rev, as the file states"),
        "{notes}"
    );
}

#[test]
fn quote_without_an_end_is_reported_by_its_line() {
    let folder = Folder::new(HOST_SIM);
    let rows: String = (1..100)
        .map(|k| format!("{},{k},n\n", f64::from(k) * 1e-3))
        .collect();
    folder.write("r.csv", format!("t,counts_large,note\n0,1,\"abc\n{rows}"));
    let line = folder.refused(&["replay", "r.csv"]);
    assert!(
        line.contains("r.csv: line 2: a quote (\") begins a field"),
        "{line}"
    );
}

/// Read whole, it would need more memory than there is: the limit makes this a failure of the program alone.
#[test]
fn stream_without_an_end_that_is_no_text_is_refused() {
    let folder = Folder::new(HOST_SIM);
    let script =
        format!("ulimit -v 4000000; '{HOST_SIM}' replay /dev/zero --out - 2> said; test $? = 2");
    shell(&folder, &script);
    let said = std::fs::read_to_string(folder.path().join("said")).unwrap();
    assert_eq!(
        said,
        "error: /dev/zero: line 1: the file is not text; write it as CSV\n"
    );
}
