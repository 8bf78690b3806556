//! Bad counts, counters that are set again, and motion within a count: what is printed of them.

use crate::{Folder, HOST_SIM};

/// The numbers before the units of the line on the motion: revolutions, and rad/s.
fn motion(text: &str) -> [f64; 2] {
    let words: Vec<_> = text.split_whitespace().collect();
    let said = words.join(" ");
    let (_, line) = said.split_once("the shaft turns within ").unwrap();
    let (turns, rest) = line.split_once(" rev, at up to ").unwrap();
    let (speed, _) = rest.split_once(" rad/s").unwrap();
    [turns, speed].map(|number| number.parse().unwrap())
}

/// A swing of 30 degrees and 5 rad/s at 100 Hz, whose first position is another one.
#[test]
fn header_has_the_motion_without_a_jump() {
    let folder = Folder::new(HOST_SIM);
    let row = |k: u32| {
        let t = 0.01 * f64::from(k);
        let angle = if k == 0 {
            170.0
        } else {
            30.0 * (5.0 * t).sin()
        };
        format!("{t:.2},{angle:.3}\n")
    };
    let rows: String = (0..1000).map(row).collect();
    folder.write("log.csv", format!("t,angle_deg\n{rows}"));
    let speed = 5.0 * 30.0_f64.to_radians();
    let ways: [&[&str]; 2] = [
        &["recommend", "log.csv"],
        &["replay", "log.csv", "--estimator", "pll", "--out", "v.csv"],
    ];
    for arguments in ways {
        let [within, up_to] = motion(&folder.good(arguments));
        // A count of 4096 at both ends.
        assert!((within - 60.0 / 360.0).abs() < 2.0 / 4096.0, "{within}");
        // A count in 10 ms is 0.15 rad/s.
        assert!((up_to - speed).abs() < 0.16, "{up_to} {speed}");
    }
}

/// A shaft of 9 counts a row at 100 Hz, 1.38 rad/s, whose counter is set to 0 after different times.
#[test]
fn counter_that_is_set_to_zero_is_named_and_is_no_motion() {
    let folder = Folder::new(HOST_SIM);
    let (mut set, mut next) = (0, 0);
    let row = |k: i64| {
        if k == next {
            (set, next) = (k, k + 20 + 7 * k % 60);
        }
        format!("{:.2},{}\n", 0.01 * k as f64, 9 * (k - set))
    };
    let rows: String = (0..2000).map(row).collect();
    folder.write("log.csv", format!("t,counts_large\n{rows}"));
    let (text, said) = folder.good_on(&["recommend", "log.csv"], b"");
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let [_, up_to] = motion(&text);
    assert!((up_to - 1.38).abs() < 0.01, "{up_to}");
    assert!(
        said.contains("returns to nearly 0 from different counts in"),
        "{said}"
    );
    assert!(!said.contains("--modulus"), "{said}");
}

/// A swing of 0.02 degrees: a count of 4096 is 0.088 degrees.
#[test]
fn motion_within_a_count_is_refused_with_the_counts_per_revolution() {
    let folder = Folder::new(HOST_SIM);
    let row = |k: u32| {
        let t = 1e-3 * f64::from(k);
        format!("{t:.3},{:.6}\n", 0.02 * (20.0 * t).sin())
    };
    let rows: String = (0..1000).map(row).collect();
    folder.write("log.csv", format!("t,angle_deg\n{rows}"));
    let line = folder.refused(&["recommend", "log.csv"]);
    let said = "most of them by less than a count with 4096 counts/rev, as is assumed where no number is given";
    assert!(
        line.contains(said) && line.contains("--counts-per-rev"),
        "{line}"
    );
    let _ = folder.good(&["recommend", "log.csv", "--counts-per-rev", "1048576"]);
}
