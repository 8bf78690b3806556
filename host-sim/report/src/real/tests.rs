use experiments::real::run::Score;
use experiments::real::sources::Role;
use scoring::evaluation::Estimate;

use super::motion::Signals;
use super::*;

fn row(recording: &str, at: (u32, f64), estimator: &'static str, pct: f64) -> Row {
    Row {
        recording: recording.to_owned(),
        role: if recording == "a" {
            Role::Chooses
        } else {
            Role::Judges
        },
        counts_per_rev: at.0,
        rate_hz: at.1,
        phase: Some(0.5),
        estimator,
        score: Score {
            rms_pct: Some(pct),
            ..Score::default()
        },
    }
}

#[test]
fn curves_are_means_over_the_recordings_that_have_every_point() {
    let at = [(256, 1e3), (64, 1e3)];
    let rows = [
        row("a", at[0], "pll", 20.0),
        row("a", at[1], "pll", 40.0),
        row("b", at[0], "pll", 30.0),
        row("b", at[1], "pll", 60.0),
        row("only-fine", at[0], "pll", 90.0),
    ];
    let curves = curves(&rows, &["pll", "m-over-t"], &at, |(counts, _)| {
        counts.into()
    });
    assert_eq!(curves.recordings, 2);
    assert_eq!(curves.lines, [("pll", vec![(64.0, 50.0), (256.0, 25.0)])]);
}

#[test]
fn page_has_a_figure_for_every_varied_quantity() {
    let mut rows = Vec::new();
    for at in [(64, 500.0), (64, 1e3), (256, 500.0), (256, 1e3)] {
        rows.push(row("a", at, "pll", 20.0));
        rows.push(row("b", at, "m-over-t", 9000.0));
    }
    let printout = Printout {
        table: "a < b",
        ..Printout::default()
    };
    let page = |rows: &[Row]| real(rows, &["pll", "m-over-t"], (64, 1e3), &[], &printout).unwrap();
    let all = page(&rows);
    assert_eq!(crate::figures(&all).count(), 3);
    assert!(all.contains("a &lt; b") && all.contains("Error against rate at 64 counts/rev"));
    rows.retain(|row| row.rate_hz == 1e3);
    assert_eq!(crate::figures(&page(&rows)).count(), 2);
}

#[test]
fn ranking_begins_with_the_smallest_mean_and_draws_one_form_of_a_filter() {
    let at = (64, 1e3);
    let errors = [
        ("kalman-triple", 40.0),
        ("kalman-triple-table", 40.01),
        ("pll", 60.0),
        ("low-pass", 70.0),
        ("m-over-t", 10.0),
        ("kalman-motor", 300.0),
    ];
    let rows: Vec<_> = errors
        .iter()
        .map(|(name, pct)| row("a", at, name, *pct))
        .collect();
    let ranks = ranking::ranks(&rows, &errors.map(|(name, _)| name), at);
    assert_eq!((ranks[0].estimator, ranks[0].mean), ("m-over-t", 10.0));
    assert_eq!(ranks.last().unwrap().estimator, "kalman-motor");
    // Not one with more than the error of finite difference, and two of those that read counts.
    assert_eq!(ranking::drawn(&ranks), ["m-over-t", "kalman-triple", "pll"]);
}

#[test]
fn part_with_the_largest_errors_is_drawn() {
    // 5 s at 100 Hz with an error from 3.2 to 3.6 s, and a larger one at 1 s, where the truth is not known.
    let truth = vec![1.0; 500];
    let velocity = (0..500).map(|k| match k {
        100 => 1e3,
        320..360 => 3.0,
        _ => 1.0,
    });
    let estimate = Estimate {
        estimator: "pll",
        velocity: velocity.collect(),
        deviation: None,
        damping_ratio: None,
    };
    let known: Vec<_> = (0..500).map(|k| k != 100).collect();
    let hardest = |ticks: usize, known| {
        let signals = Signals {
            truth: &truth[..ticks],
            known,
            called: "truth",
            estimates: &[],
            rate_hz: 100.0,
        };
        motion::hardest(&signals, &[&estimate])
    };
    let first = hardest(500, Some(&known[..]));
    assert!((260..=320).contains(&first), "{first}");
    let first = hardest(500, None);
    assert!(first <= 100, "{first}");
    // A recording shorter than the part is drawn as a whole.
    assert_eq!(hardest(40, None), 0);
}
