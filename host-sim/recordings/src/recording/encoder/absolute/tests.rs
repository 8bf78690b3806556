//! Tests of counts that wrap.

use simulation::device::Device;

use super::*;
use crate::recording::Survey;

/// A shaft that turns by `step` counts a row, read by an encoder that wraps.
fn recording(step: i64, modulus: i64, least: i64) -> (Recording, Vec<u32>) {
    let mut text = String::from("t,counts_large,counts_small,edge_tick,edge_bound\n");
    let mut truth = Vec::new();
    for k in 0..3000_i64 {
        let at = 5 + step * k;
        let wrapped = (at - least).rem_euclid(modulus) + least;
        // The edge that a forward motion crossed last is the count itself.
        let tick = 84_000 * k;
        text += &format!("{},{wrapped},{k},{tick},{wrapped}\n", k as f64 * 1e-3);
        truth.push(at as u32);
    }
    (Recording::parse(text.as_bytes(), "r").unwrap(), truth)
}

fn encoder(counts: u32) -> ReadOptions {
    let mut device = Device::default();
    device.stages.large.counts_per_rev = counts;
    ReadOptions::of(&device)
}

#[test]
fn counts_of_an_absolute_encoder_are_unwrapped() {
    for (counts, step, least) in [
        (4096, 3, 0),
        (4096, -700, 0),
        (16_384, 11, -8192),
        (3600, 200, 0),
    ] {
        let (mut recording, truth) = recording(step, counts, least);
        let said = recording.unwrap_counts(&encoder(counts as u32));
        let start = recording.trace.counts_large[0].wrapping_sub(truth[0]);
        let truth: Vec<_> = truth
            .iter()
            .map(|count| count.wrapping_add(start))
            .collect();
        assert_eq!(recording.trace.counts_large, truth, "{counts} {step}");
        let edges = recording.trace.edges.unwrap();
        let bounds: Vec<_> = edges.iter().map(|edge| edge.unwrap().boundary).collect();
        assert_eq!(bounds, truth, "{counts} {step}");
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(
            said[0].contains(&format!("counts_large wraps at {counts}")),
            "{said:?}"
        );
    }
}

/// Rows of an encoder of 4096 counts, without the row at its wrap, and the counts of one without a wrap.
fn wrap_in_a_gap(missing: std::ops::Range<usize>) -> [Vec<u32>; 2] {
    let rows = (0..200).filter(|k| !missing.contains(k));
    let text: String = rows
        .clone()
        .map(|k| format!("{},{}\n", k as f64 * 1e-3, (4000 + 2 * k) % 4096))
        .collect();
    let text = format!("t,counts_large\n{text}");
    let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
    let said = recording.unwrap_counts(&encoder(4096));
    let is_said = said.iter().any(|note| note.contains("wraps at 4096"));
    assert_eq!(is_said, missing.len() < 20, "{said:?}");
    let truth = rows.map(|k| 4000 + 2 * k as u32).collect();
    [recording.trace.counts_large, truth]
}

#[test]
fn wrap_over_a_few_missing_rows_is_found() {
    for missing in [48..49, 40..58] {
        let [counts, truth] = wrap_in_a_gap(missing.clone());
        assert_eq!(counts, truth, "{missing:?}");
    }
    // Over more of them a shaft may have turned so far.
    let [counts, truth] = wrap_in_a_gap(40..70);
    assert_ne!(counts, truth);
}

#[test]
fn fast_shaft_does_not_wrap_in_a_gap() {
    // 300 counts from row to row, and 3300 over ten missing rows, within a revolution.
    let text: String = (0..12_u32)
        .filter(|k| *k == 0 || *k == 11)
        .chain(12..14)
        .map(|k| format!("{},{}\n", f64::from(k) * 1e-3, 300 * k))
        .collect();
    let text = format!("t,counts_large\n{text}");
    let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
    let before = recording.trace.counts_large.clone();
    let _ = recording.unwrap_counts(&encoder(4096));
    assert_eq!(recording.trace.counts_large, before);
}

#[test]
fn counts_of_a_16_bit_counter_are_unwrapped() {
    let (mut recording, truth) = recording(100, 65_536, 0);
    let said = recording.unwrap_counts(&encoder(4096));
    assert_eq!(recording.trace.counts_large, truth);
    assert!(said[0].contains("wraps at 65536"), "{said:?}");
}

#[test]
fn encoder_that_differs_from_the_device_is_reported_and_not_unwrapped() {
    let (mut recording, _) = recording(11, 16_384, 0);
    let before = recording.trace.counts_large.clone();
    let said = recording.unwrap_counts(&encoder(4096));
    let words = "counts, with 4096 counts per revolution: if the encoder is absolute, give its counts \
                 with --counts-per-rev, or as large.counts_per_rev in the file of --device, or \
                 --modulus counts_large=16384 if";
    assert!(said[0].contains(words), "{said:?}");
    assert!(
        said[0].starts_with("counts_large jumps by -16373 "),
        "{said:?}"
    );
    assert_eq!(recording.trace.counts_large, before);
}

#[test]
fn encoder_of_fewer_counts_than_the_device_is_reported() {
    for (modulus, step) in [(1024, 4), (64, 1), (1 << 24, 40_000)] {
        let (mut recording, _) = recording(step, modulus, 0);
        let said = recording.unwrap_counts(&encoder(4096));
        let option = format!("or --modulus counts_large={modulus} if");
        assert!(said[0].starts_with("counts_large jumps by -"), "{said:?}");
        assert!(said[0].contains(&option), "{said:?}");
    }
}

/// The remedy for an encoder of the right counts that is fast is none of other counts.
#[test]
fn fast_absolute_encoder_is_told_of_its_modulus() {
    let (mut recording, _) = recording(1232, 4096, 0);
    let said = recording.unwrap_counts(&encoder(4096));
    let words = "it turns by more than a quarter of a revolution from row to row; give --modulus counts_large=4096";
    assert!(said[0].ends_with(words), "{said:?}");
}

/// The modulus is not that of the device, but near it: the step over the wrap would be a jump.
#[test]
fn wrap_at_another_modulus_is_reported_and_not_unwrapped() {
    for (modulus, step) in [
        (4000, 7),
        (3600, -3),
        (4096 - 30, 2),
        (50_000, 40),
        (65_000, 40),
    ] {
        let (mut recording, _) = recording(step, modulus, 0);
        let before = recording.trace.counts_large.clone();
        let said = recording.unwrap_counts(&encoder(4096));
        assert_eq!(recording.trace.counts_large, before, "{modulus}");
        assert!(said[0].starts_with("counts_large jumps by "), "{said:?}");
        let power = u64::try_from(modulus).unwrap().next_power_of_two();
        let is_near = modulus > 4000 && modulus < 4096 || modulus == 65_000;
        let option = match is_near {
            true => format!("--modulus counts_large={power} if"),
            false => "--modulus counts_large=N, N about ".to_owned(),
        };
        assert!(said[0].contains(&option), "{said:?}");
    }
}

#[test]
fn incremental_counts_are_not_changed() {
    // Over the wrap of 32 bits, and with a gap in which the shaft turns nearly a revolution.
    let text = "t,counts_large\n0,-2\n0.001,-1\n0.002,1\n0.003,2\n0.1,4000\n0.101,4001\n";
    let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
    let before = recording.trace.counts_large.clone();
    assert_eq!(
        recording.unwrap_counts(&encoder(4096)),
        Vec::<String>::new()
    );
    assert_eq!(recording.trace.counts_large, before);
    // Over 2^31, where a signed count wraps.
    let row = |k: i64| format!("{},{}\n", k as f64 * 1e-3, (1_i64 << 31) - 90 + 3 * k);
    let text = format!("t,counts_large\n{}", (0..60).map(row).collect::<String>());
    let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
    assert_eq!(
        recording.unwrap_counts(&encoder(4096)),
        Vec::<String>::new()
    );
}

/// A sensor of 12 bits whose bus sometimes gives 0xFFFF, and a counter of 16 bits around zero.
#[test]
fn failed_readings_are_no_wraps_of_a_16_bit_counter() {
    let read = |count: &dyn Fn(i64) -> i64| {
        let rows = (0..3000).map(|k| format!("{}e-3,{}\n", k, count(k)));
        let text = format!("t,counts_large\n{}", rows.collect::<String>());
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let before = recording.trace.counts_large.clone();
        let said = recording.unwrap_counts(&encoder(4096));
        (before == recording.trace.counts_large, said)
    };
    let (is_same, said) = read(&|k| match k % 1300 {
        700 => 65_535,
        _ => (11 * k).rem_euclid(4096),
    });
    let failed = "counts_large is 65535 in 2 rows and from 0 to 4095 in all others, as where readings of an absolute \
                  encoder failed: remove these rows; the counts are not unwrapped";
    assert_eq!((is_same, &said[..]), (true, &[failed.to_owned()][..]));
    let around_zero = |k: i64| ((k % 100) - 1).rem_euclid(65_536);
    let (_, said) = read(&around_zero);
    assert!(said[0].contains("wraps at 65536"), "{said:?}");
}

/// A bad reading one revolution away is no wrap where the counts span more than a revolution.
#[test]
fn counts_of_more_than_a_revolution_do_not_wrap_at_it() {
    let count = |k: i64| if k < 1200 { 5 * k } else { 5 * k - 4095 };
    let row = |k: i64| format!("{},{}\n", k as f64 * 1e-3, count(k));
    let text = format!("t,counts_large\n{}", (0..1300).map(row).collect::<String>());
    let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
    let before = recording.trace.counts_large.clone();
    let said = recording.unwrap_counts(&encoder(4096));
    assert_eq!(recording.trace.counts_large, before);
    assert!(
        said[0].starts_with("counts_large jumps by -4090 "),
        "{said:?}"
    );
}

/// A counter that is set to zero at any count has no modulus; bad readings of an encoder that wraps are fewer.
#[test]
fn jumps_of_different_sizes_are_no_wraps() {
    let said = |count: &mut dyn FnMut(i64) -> i64| {
        let rows = (0..3000).map(|k| format!("{k}e-3,{}\n", count(k)));
        let text = format!("t,counts_large\n{}", rows.collect::<String>());
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        recording.unwrap_counts(&encoder(4096)).join("\n")
    };
    for step in [3, -40] {
        // It is set after 30 to 79 rows.
        let (mut at, mut next) = (0, 0);
        let set = said(&mut |k| {
            if k >= next {
                (at, next) = (k, k + 30 + 7 * k % 50);
            }
            step * (k - at)
        });
        let unequal = "counts; its jumps have different sizes, as of a counter that is set to zero or of bad counts";
        assert!(set.contains(unequal) && !set.contains("--modulus"), "{set}");
    }
    let wraps = said(&mut |k| match k {
        500 | 1700 => 400,
        _ => (7 * k) % 1000,
    });
    assert!(
        wraps.contains("or --modulus counts_large=N, N about 1000,"),
        "{wraps}"
    );
}

/// A wrap passes three quarters of the modulus at least: a smaller jump is no reason to name one.
#[test]
fn modulus_is_named_where_the_jump_is_that_of_a_wrap() {
    let option = |jump| modulus_option("counts_large", jump, 4500);
    assert_eq!(option(-3374), "");
    assert!(option(-3375).contains("--modulus counts_large=N, N about 4500,"));
}

/// Each encoder has a modulus of its own: the handle passes more than a quarter of the motor's from row to row.
#[test]
fn survey_finds_the_wraps_of_both_encoders() {
    let row = |k: u32| {
        format!(
            "{},{},{}\n",
            f64::from(k) * 1e-3,
            3 * k % 4096,
            2001 * k % 20_000
        )
    };
    let rows: String = (0..3000).map(row).collect();
    let text = format!("t,counts_large,counts_small\n{rows}");
    let survey = Survey::new(text.as_bytes(), "r", &ReadOptions::default(), None).unwrap();
    let said = ["counts_large wraps at 4096", "counts_small wraps at 20000"]
        .map(|wraps| format!("{wraps} and is unwrapped: a revolution of an absolute encoder"));
    assert_eq!(survey.notes, said);
}
