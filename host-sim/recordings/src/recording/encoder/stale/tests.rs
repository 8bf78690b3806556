use crate::recording::{ReadOptions, Recording};

/// Least that a hash of the row must be for a reading to arrive: about 1 % are lost.
const LOST: u32 = 10;

fn is_lost(k: u32) -> bool {
    k > 10 && k.wrapping_mul(2_654_435_761) % 1009 < LOST
}

/// 3 s of 1 kHz whose row k has the count of `motion` at the row that `latest` gives.
fn text(motion: impl Fn(f64) -> f64, latest: impl Fn(u32) -> u32) -> String {
    measured(motion, |k| 1e-3 * f64::from(latest(k)))
}

/// 3 s of 1 kHz whose row k has the count of `motion` at the time that `at` gives, s.
fn measured(motion: impl Fn(f64) -> f64, at: impl Fn(u32) -> f64) -> String {
    let row = |k: u32| {
        let count = motion(at(k)).floor();
        format!("{k}e-3,{count}\n")
    };
    let rows: String = (0..3000).map(row).collect();
    format!("t,counts_large\n{rows}")
}

fn read(text: &str, options: &ReadOptions) -> Recording {
    Recording::parse_as(text.as_bytes(), "r.csv", options).unwrap()
}

/// Options that leave stale readings out.
fn dropping() -> ReadOptions {
    ReadOptions {
        drop_stale: true,
        ..ReadOptions::default()
    }
}

fn note(text: &str) -> String {
    read(text, &ReadOptions::default()).notes.join("\n")
}

/// Up to 36 counts a row.
fn swing(t: f64) -> f64 {
    9000.0 * (4.0 * t).sin()
}

/// The last row whose reading arrived.
fn arrived(k: u32) -> u32 {
    (0..=k).rev().find(|k| !is_lost(*k)).unwrap_or(0)
}

#[test]
fn stale_readings_of_a_fast_shaft_are_named_with_their_number() {
    let said = note(&text(swing, arrived));
    // At the ends of the swing the shaft is slow, and nothing tells there.
    let speed = |k: u32| (swing(1e-3 * f64::from(k)) - swing(1e-3 * f64::from(k - 1))).abs();
    let clearly = (11..2990).filter(|k| is_lost(*k) && speed(*k) > 6.0);
    let possibly = (11..2990).filter(|k| is_lost(*k) && speed(*k) > 2.5);
    let [least, most] = [clearly.count(), possibly.clone().count()];
    let number: usize = said
        .split_once("stays in ")
        .and_then(|(_, rest)| rest.split(' ').next()?.parse().ok())
        .unwrap_or_else(|| panic!("{said}"));
    assert!(
        number <= most && 10 * number >= 8 * least,
        "{number}: {least} {most}"
    );
    assert!(said.contains("add --drop-stale"), "{said}");
    let first = (11..).find(|k| is_lost(*k)).unwrap();
    // The header is a line.
    let said_first = format!("the first in line {}:", first + 2);
    assert!(said.contains(&said_first), "{said_first}: {said}");
    let list = ReadOptions::default().of_list("the list");
    let said = read(&text(swing, arrived), &list).notes.join("\n");
    assert!(said.ends_with("; remove these rows"), "{said}");
}

#[test]
fn stale_readings_in_turn_are_named() {
    for lost in 1..=3 {
        let latest = |k: u32| {
            if k % 200 >= 100 && k % 200 < 100 + lost {
                k / 200 * 200 + 99
            } else {
                k
            }
        };
        let said = note(&text(|t| 20_000.0 * t, latest));
        assert!(
            said.contains(&format!("stays in {} rows", 15 * lost)),
            "{lost}: {said}"
        );
    }
}

#[test]
fn motions_without_stale_readings_are_not_named() {
    let noise = |t: f64, size: f64| size * ((t * 1e3 * 2.399).sin() + (t * 1e3 * 1.177).cos());
    let motions: [(&str, &dyn Fn(f64) -> f64); 8] = [
        ("swing", &swing),
        ("slow", &|t| 0.1 * swing(t)),
        ("noise", &|t| 12_000.0 * t + noise(t, 4.0)),
        ("noise of a slow shaft", &|t| 5000.0 * t + noise(t, 1.5)),
        ("half a count", &|t| 4500.0 * t),
        ("noise of a fast shaft", &|t| 40_000.0 * t + noise(t, 16.0)),
        ("stops and goes", &|t| {
            if t % 0.2 < 0.1 {
                (t / 0.2).floor() * 2000.0
            } else {
                (t / 0.2).floor() * 2000.0 + 20_000.0 * (t % 0.2 - 0.1)
            }
        }),
        ("stops at a wall", &|t| (40_000.0 * t).min(40_000.0)),
    ];
    for (name, motion) in motions {
        let said = note(&text(motion, |k| k));
        assert!(!said.contains("stays in"), "{name}: {said}");
    }
    // Rows that are late: the shaft did not move in the short time before.
    let row = |k: u32| {
        let t = 1e-3 * f64::from(k) - if k % 50 == 25 { 0.9e-3 } else { 0.0 };
        format!("{t:.5},{}\n", (1e4 * t).floor())
    };
    let late: String = (0..3000).map(row).collect();
    let said = note(&format!("t,counts_large\n{late}"));
    assert!(!said.contains("stays in"), "{said}");
}

/// 4 s with a Gaussian noise on the counts of a swing.
#[test]
fn noise_of_counts_is_no_stale_reading() {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for trial in 0..60 {
        let deviation = [0.3, 1.0, 2.0, 4.0, 8.0][trial % 5];
        let speed = [4.0, 5.0, 6.0, 8.0, 12.0, 20.0][trial % 6];
        let frequency = 1.0 + 7.0 * uniform();
        let mut row = |k: u32| {
            let t = 1e-3 * f64::from(k);
            let noise = deviation * (0..12).map(|_| uniform()).sum::<f64>() - 6.0 * deviation;
            let position = 1e3 * speed / frequency * (frequency * t).sin() + noise;
            format!("{t:.3},{}\n", position.floor())
        };
        let rows: String = (0..4000).map(&mut row).collect();
        let said = note(&format!("t,counts_large\n{rows}"));
        assert!(!said.contains("stays in"), "{deviation} {speed}: {said}");
    }
}

#[test]
fn readings_of_another_clock_are_named_with_their_rate() {
    for hz in [600, 700, 850] {
        let said = note(&measured(swing, |k| {
            (f64::from(k * hz) / 1000.0).floor() / f64::from(hz)
        }));
        let number: f64 = said
            .split_once("it is read about ")
            .and_then(|(_, rest)| rest.split(' ').next()?.parse().ok())
            .unwrap_or_else(|| panic!("{hz}: {said}"));
        assert!((number / f64::from(hz) - 1.0).abs() < 0.05, "{hz}: {said}");
    }
}

#[test]
fn rows_of_stale_readings_are_left_out_and_others_stay() {
    let drop = dropping();
    let text = text(swing, arrived);
    let recording = read(&text, &drop);
    let whole = read(&text, &ReadOptions::default());
    let left_out = whole.t.len() - recording.t.len();
    let said = format!("{left_out} rows are left out where counts_large stays");
    assert!(
        recording.notes[0].starts_with(&said),
        "{:?}",
        recording.notes
    );
    // Every row that is left out is one whose reading was lost, and all of a fast shaft are.
    let times: Vec<u32> = recording
        .t
        .iter()
        .map(|t| (t * 1e3).round() as u32)
        .collect();
    let speed = |k: u32| (swing(1e-3 * f64::from(k)) - swing(1e-3 * f64::from(k - 1))).abs();
    for k in 1..3000 {
        let is_left_out = times.binary_search(&k).is_err();
        assert!(!is_left_out || is_lost(k), "{k}");
        assert!(
            is_left_out || !is_lost(k) || speed(k) < 5.0,
            "{k}: {}",
            speed(k)
        );
    }
}

#[test]
fn slow_shaft_keeps_its_rows_where_its_encoder_wraps() {
    let wraps = |t: f64| (300.0 * t).floor().rem_euclid(64.0);
    assert_eq!(read(&text(wraps, |k| k), &dropping()).t.len(), 3000);
}

#[test]
fn shaft_that_stops_keeps_its_rows_from_the_fourth_on() {
    let mut drop = dropping();
    let wall = |t: f64| (40_000.0 * t).min(40_000.0);
    let recording = read(&text(wall, |k| k), &drop);
    assert_eq!(recording.t.len(), 3000 - 3);
    drop.set_row_rate(1000.0).unwrap();
    let rows: String = (0..3000)
        .map(|k| format!("{}\n", wall(1e-3 * f64::from(k)).floor()))
        .collect();
    let recording = read(&format!("counts_large\n{rows}"), &drop);
    // Rows without a time keep theirs.
    assert_eq!(recording.t.len(), 3000 - 3);
    assert_eq!(recording.t.last().map(|t| (t * 1e3).round()), Some(2999.0));
}
