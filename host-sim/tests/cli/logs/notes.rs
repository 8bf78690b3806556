//! What is reported about a log that is read.

use super::replay;
use crate::{Folder, HOST_SIM};

#[test]
fn columns_and_units_that_were_converted_are_reported() {
    let folder = Folder::new(HOST_SIM);
    for (log, options, said) in [
        (
            "moteus-tview.csv",
            "",
            "read as a log of moteus: t from 'timestamp' (s), counts_large from 'position' (rev with 4096 \
             counts/rev), current from 'q_A' (A)",
        ),
        (
            "vesc-tool.csv",
            "",
            "read as a log of VESC Tool: t from 'ms_today' (ms)",
        ),
        (
            "vesc-tool.csv",
            "",
            "counts_large wraps at 4096 and is unwrapped",
        ),
        (
            "absolute-4096.csv",
            "",
            "counts_large wraps at 4096 and is unwrapped",
        ),
        (
            "plotjuggler.csv",
            "",
            "current from '/joint_states/handle/effort' (N.m with 0.",
        ),
        (
            "plotjuggler.csv",
            "",
            "10 rows without a position are left out",
        ),
        (
            "missing-rows.csv",
            "",
            "3 rows are missing in 2 gaps of at most 2, the first before line 102 at 0.102 s",
        ),
    ] {
        let (_, notes) = replay(&folder, log, options);
        let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(notes.contains(said), "{log}: {notes}");
    }
    // Nothing is said about a log that needs no conversion.
    let (_, notes) = replay(&folder, "own.csv", "");
    assert!(!notes.contains("from '"), "{notes}");
}

#[test]
fn positions_off_whole_counts_are_reported() {
    let folder = Folder::new(HOST_SIM);
    folder.write("coarse.toml", "large.counts_per_rev = 1000\n");
    let device = "--column counts_large=angle:deg --device coarse.toml";
    let (_, notes) = replay(&folder, "absolute-deg.csv", device);
    let notes = notes.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "counts from a whole count with 1000 counts/rev and are rounded to the nearest";
    assert!(notes.contains(said), "{notes}");
}
