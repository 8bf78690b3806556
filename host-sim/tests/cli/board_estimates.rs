//! The board's own estimates in a recording, beside the rows that the reader takes.

use std::fmt::Write as _;

use crate::{Folder, HOST_SIM};

/// A recording of a board at 1 kHz and 5 rad/s. Of its 1900 rows after the start, 500 have an estimate that is three
/// standard deviations off. `more` is written behind each tenth row.
fn log(more: impl Fn(u32) -> String) -> String {
    let mut text = String::from(
        "# counts_per_rev = 4096\nt,counts_large,true_omega,velocity_large,sigma_large,state\n",
    );
    for k in 0..2000 {
        let velocity = if (500..1000).contains(&k) { 5.75 } else { 5.25 };
        let count = f64::from(5 * k) * 1e-3 / std::f64::consts::TAU * 4096.0;
        writeln!(
            text,
            "{},{},5,{velocity},0.25,2",
            f64::from(k) * 1e-3,
            count.floor()
        )
        .unwrap();
        if k % 10 == 9 {
            text += &more(k);
        }
    }
    text
}

#[test]
fn estimates_are_compared_with_the_truth_of_their_rows() {
    let folder = Folder::new(HOST_SIM);
    let repeated = |k: u32| format!("{},0,5,100,0.25,2\n", f64::from(k) * 1e-3);
    let of_others = |k: u32| format!("{},,,100,0.25,2\n", f64::from(k) * 1e-3 + 5e-4);
    for (text, said) in [
        (log(|_| String::new()), "2000 rows"),
        (
            log(repeated),
            "200 rows are left out that have the time of the row before",
        ),
        (log(of_others), "200 rows without a position are left out"),
        (
            log(|_| String::new()) + "2,6518,5,100,0.",
            "has no end and is left out",
        ),
    ] {
        folder.write("board.csv", &text);
        let (out, notes) = folder.good_on(&["replay", "board.csv", "--estimator", "pll"], b"");
        assert_eq!(out.lines().count(), 2001, "{notes}");
        let share = "the error of the board's velocity_large is within two sigma_large in 73.7 % of the samples";
        for line in [share, said] {
            assert!(notes.contains(line), "{line}: {notes}");
        }
    }
    // At other times are other rows.
    let resampled = [
        "replay",
        "board.csv",
        "--estimator",
        "pll",
        "--resample",
        "500",
    ];
    let (_, notes) = folder.good_on(&resampled, b"");
    assert!(!notes.contains("sigma_large"), "{notes}");
}

#[test]
fn figure_of_a_recording_that_is_cut_has_the_rows_above() {
    let folder = Folder::new(HOST_SIM);
    folder.write(
        "board.csv",
        &(log(|_| String::new()) + "2,6518,5,100,0.25,"),
    );
    let (_, notes) = folder.good_on(&["plot", "board.csv", "--out", "board.svg"], b"");
    assert!(notes.contains("has no end and is left out"), "{notes}");
    assert!(folder.text("board.svg").contains("estimate of the board"));
}
