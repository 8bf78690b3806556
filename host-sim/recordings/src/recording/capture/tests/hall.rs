//! Lines of Hall sensors.

use super::*;

/// Levels of three Hall sensors in a count: each is on over half a period, a third after the one before.
fn hall(count: i64) -> [u8; 3] {
    let degrees = 60 * count + 30;
    [0, 120, 240].map(|late| u8::from((degrees - late).rem_euclid(360) < 180))
}

#[test]
fn three_hall_lines_are_counted() {
    for (lines, sign) in [("U|V|W", 1), ("W|V|U", -1), ("V|W|U", 1)] {
        let mut text = String::from("t,U,V,W\n");
        for (t, _) in samples() {
            let [u, v, w] = hall(position(t).floor() as i64);
            writeln!(text, "{t:.9},{u},{v},{w}").unwrap();
        }
        let recording = decode(&text, "", lines, None).unwrap();
        check(&recording, sign, lines);
        let said = format!(
            "t from 't' (s), line U from column '{}', line V from",
            &lines[..1]
        );
        assert!(
            recording.notes[0].starts_with(&said),
            "{:?}",
            recording.notes
        );
    }
}

#[test]
fn lost_edges_of_hall_lines_are_the_shorter_way() {
    // 1000 counts up and back. On the way back 500 is missing, where the levels tell the direction, and 300 with 299,
    // where they do not.
    let down = (0..1000)
        .rev()
        .filter(|count| ![500, 300, 299].contains(count));
    let counts: Vec<i64> = (0..=1000).chain(down).collect();
    let mut text = String::from("t,U,V,W\n");
    for (k, count) in counts.iter().enumerate() {
        let [u, v, w] = hall(*count);
        let levels = match k {
            // For less than a tick, no level is on.
            700 => format!("{:.4},0,0,0\n{:.3}", 0.6995, 0.7),
            k => format!("{:.3}", 1e-3 * k as f64),
        };
        writeln!(text, "{levels},{u},{v},{w}").unwrap();
    }
    let recording = decode(&text, "", "U|V|W", None).unwrap();
    let found = recording
        .trace
        .counts_large
        .iter()
        .map(|count| i64::from(count.cast_signed()));
    assert_eq!(found.collect::<Vec<_>>(), counts);
    assert!(
        recording.notes[2].starts_with(
            "3 rows have several edges at once, or levels that do not occur, the first is line 702"
        ),
        "{:?}",
        recording.notes
    );
    let error = decode("t,U,V,W\n0,1,0,0\n1,1,1,1\n2,0,1,0\n", "", "U|V|W", None).unwrap_err();
    assert!(error.starts_with("c.csv: 100 % of the changes are of several edges at once or to levels that do not occur, the first in line 3"), "{error}");
}
