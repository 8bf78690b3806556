//! `real --peers`: velocity algorithms of other projects.

use crate::{Folder, HOST_SIM, json};

/// Two recordings of 100 000 counts per revolution, of which the first one chooses constants.
const LIST: &str = "[[recording]]\nfile = 'chooses.csv'\nwhat = 'x'\nkind = 'fine'\n\
     counts_per_rev = 100000\nrole = 'chooses'\n\n[[recording]]\nfile = 'judges.csv'\nwhat = 'x'\n\
     kind = 'fine'\ncounts_per_rev = 100000\n";

/// 1 s at 2 kHz of the velocity `3 sin(2 π f t)` rad/s.
fn sine(frequency: f64) -> String {
    let mut text = String::from("time_s,fine_count,true_omega_rad_s\n");
    let w = std::f64::consts::TAU * frequency;
    for k in 0..=2000 {
        let t = f64::from(k) * 0.5e-3;
        let angle = 3.0 / w * (1.0 - (w * t).cos());
        let count = (angle / std::f64::consts::TAU * 1e5).floor();
        text += &format!("{t},{count},{}\n", 3.0 * (w * t).sin());
    }
    text
}

fn recordings(judged_hz: f64) -> Folder {
    let folder = Folder::new(HOST_SIM);
    folder.write("chooses.csv", sine(3.0));
    folder.write("judges.csv", sine(judged_hz));
    folder.write("recordings.toml", LIST);
    folder
}

#[test]
fn peers_are_rows_and_are_tuned_on_recordings_that_choose_alone() {
    let real = ["real", "--data", ".", "--peers", "--estimator", "pll"];
    let of = |text: String| -> Vec<String> {
        let lines = text.lines().filter(|line| line.contains("-tuned at "));
        lines.map(str::to_owned).collect()
    };
    let slow = recordings(3.0);
    let fast = recordings(30.0);
    let tuned = of(slow.good(&real));
    assert_eq!(tuned.len(), 7);
    assert!(
        tuned[0].starts_with("peer:moteus-tuned at 4096 counts/rev and 1000 Hz: pll_filter_hz ")
    );
    assert_eq!(tuned, of(fast.good(&real)));

    let rows = json(&fast.good(&[&real[..], &["--json", "-"]].concat()));
    let names: Vec<_> = rows
        .iter()
        .filter_map(|row| row["estimator"].as_str())
        .collect();
    // Two recordings, two phases: the estimator, nine peers, seven of them also tuned.
    assert_eq!(names.len(), 2 * 2 * (1 + 9 + 7));
    assert!(
        rows.iter()
            .all(|row| row["rms_pct"].as_f64().is_some_and(|pct| pct > 0.0))
    );
    let without = json(&fast.good(&[&real[..3], &real[4..], &["--json", "-"]].concat()));
    assert_eq!(rows[..4], without[..]);
}

#[test]
fn peers_are_only_default_where_no_recording_chooses() {
    let folder = recordings(3.0);
    folder.write("recordings.toml", LIST.replace("role = 'chooses'\n", ""));
    let text = folder.good(&["real", "--data", ".", "--peers", "--estimator", "pll"]);
    assert!(text.contains("peer:odrive "), "{text}");
    assert!(!text.contains("-tuned"), "{text}");
}
