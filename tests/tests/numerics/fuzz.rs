//! Every fuzz body on bytes that proptest makes up.

use std::fs;
use std::path::PathBuf;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

use drivers::link::{Edge, LONGEST, Message, Rejected};
use drivers::{Command, encode};
use fuzz_bodies::{commands, control, designs, link, logs, samples, texts};
use haptic_control::Request;
use stress::designs::kinds;
use stress::tested::TestedEstimator;

/// So many cases. What fails is kept in `fuzz.regressions` beside this file, to be committed, and
/// tried first from then on.
fn cases(count: u32) -> ProptestConfig {
    let kept = FileFailurePersistence::WithSource("regressions");
    ProptestConfig {
        failure_persistence: Some(Box::new(kept)),
        ..ProptestConfig::with_cases(count)
    }
}

/// The [`kinds`] that learn their parameters, by number.
fn kinds_that_learn() -> Vec<u8> {
    let kinds = kinds();
    let learns = |kind: &u8| kinds[usize::from(*kind)].starts_with("adaptive");
    (0..kinds.len() as u8).filter(learns).collect()
}

fn any_bytes(most: usize) -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), 0..most)
}

/// Frames that are right, cut, or hit by a stray byte.
fn command_bytes() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        Just(encode(Command::Request(Request::Arm)).to_vec()),
        Just(encode(Command::Request(Request::Select(9))).to_vec()),
        any::<f32>().prop_map(|value| encode(Command::Torque(value)).to_vec()),
        (1usize..11)
            .prop_map(|most| { encode(Command::Request(Request::KeepAlive))[..most].to_vec() }),
        vec(prop_oneof![Just(0xA5u8), any::<u8>()], 0..30),
    ];
    vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

/// Messages that are right, cut, or hit by stray bytes, among which start bytes are frequent.
fn link_bytes() -> impl Strategy<Value = Vec<u8>> {
    let encoded = |message: Message| {
        let mut buffer = [0; LONGEST];
        message.encode(&mut buffer).expect("room").to_vec()
    };
    let edge = move |(seq, bound, age)| encoded(Edge { seq, bound, age }.into());
    let rejected = encoded(
        Rejected {
            garbage: 1,
            not_finite: 2,
            out_of_bounds: 3,
            unknown: 4,
            unverified: 5,
        }
        .into(),
    );
    let piece = prop_oneof![
        any::<(u32, u32, u32)>().prop_map(edge),
        (1..rejected.len()).prop_map(move |most| rejected[..most].to_vec()),
        vec(prop_oneof![Just(0x5Au8), 0..8u8, any::<u8>()], 0..30),
    ];
    vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

/// Text that looks like a recording.
fn csv_text() -> impl Strategy<Value = Vec<u8>> {
    let field = prop_oneof![
        Just("0".to_owned()),
        Just(String::new()),
        Just("nan".to_owned()),
        Just("1e400".to_owned()),
        any::<i64>().prop_map(|n| n.to_string()),
        any::<f64>().prop_map(|x| x.to_string()),
        (0u32..5000).prop_map(|n| format!("{}", f64::from(n) * 1e-3)),
        "[\"a,\r ]{0,3}",
    ];
    let header = proptest::sample::subsequence(
        vec![
            "t",
            "counts_large",
            "counts_small",
            "current",
            "edge_tick",
            "edge_bound",
            "x",
        ],
        0..=7,
    );
    (header, vec(vec(field, 0..8), 0..20)).prop_map(|(header, rows)| {
        let mut text = header.join(",");
        for row in rows {
            text.push('\n');
            text.push_str(&row.join(","));
        }
        text.into_bytes()
    })
}

/// The begin of a log of `tests/data/logs` with lines exchanged, bytes changed, and an end that is cut off.
fn log_text() -> impl Strategy<Value = Vec<u8>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/data/logs");
    let mut paths: Vec<_> = fs::read_dir(folder)
        .expect("the logs")
        .map(|entry| entry.expect("a log").path())
        .collect();
    paths.sort();
    let begin = |path: &PathBuf| {
        let mut bytes = fs::read(path).expect("a log");
        bytes.truncate(1500);
        bytes
    };
    let begins: Vec<_> = paths.iter().map(begin).collect();
    let changes = vec((any::<[usize; 2]>(), any::<u8>(), 0..4u8), 0..6);
    (proptest::sample::select(begins), changes).prop_map(|(mut bytes, changes)| {
        for ([at, other], byte, kind) in changes {
            let [at, other] = [at, other].map(|place| place % bytes.len().max(1));
            match kind {
                0 => bytes.truncate(at),
                1 => {
                    let mut lines: Vec<_> = bytes.split(|byte| *byte == b'\n').collect();
                    let count = lines.len();
                    lines.swap(at % count, other % count);
                    bytes = lines.join(&b'\n');
                }
                _ => bytes
                    .iter_mut()
                    .skip(at)
                    .take(1)
                    .for_each(|changed| *changed = byte),
            }
        }
        bytes
    })
}

/// The default device's file with lines lost, moved, and values exchanged.
fn toml_text() -> impl Strategy<Value = Vec<u8>> {
    let whole = toml::to_string(&simulation::device::Device::default()).expect("serialises");
    let lines: Vec<String> = whole.lines().map(str::to_owned).collect();
    let count = lines.len();
    let value = prop_oneof![
        any::<f64>().prop_map(|x| format!("{x:?}")),
        (-20.0..20.0f64).prop_map(|x| format!("{:e}", 10f64.powf(x))),
        any::<i64>().prop_map(|n| n.to_string()),
        "[ -~]{0,6}",
    ];
    let change = (0..count, 0..count, 0..6u8, value);
    vec(change, 0..4).prop_map(move |changes| {
        let mut lines = lines.clone();
        for (at, other, kind, value) in changes {
            match kind {
                0 => lines[at].clear(),
                1 => lines.swap(at, other),
                _ => {
                    if let Some(equals) = lines[at].find('=') {
                        lines[at].replace_range(equals.., &format!("= {value}"));
                    }
                }
            }
        }
        lines.join("\n").into_bytes()
    })
}

thread_local! {
    static TESTED: Vec<TestedEstimator> = samples::tested_estimators();
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn estimators_stay_finite_for_any_samples(data in any_bytes(4000)) {
        TESTED.with(|all| samples::run(all, &data));
    }

    #[test]
    fn designs_from_any_bits_are_valid_or_refused(data in any_bytes(400)) {
        designs::run(&data);
    }

    #[test]
    fn designs_from_any_parameters_are_valid_or_refused(
        kind: u8,
        rate in -1.0..6.0f64,
        counts in 0.0..9.6f64,
        parameter in -20.0..20.0f64,
    ) {
        designs::try_one(kind, 10f64.powf(rate), 10f64.powf(counts) as u32, 10f64.powf(parameter));
    }

    /// Ticks of up to eight time constants of the motor, the longest that a design may have.
    #[test]
    fn slow_adaptive_designs_are_stable_or_refused(
        kind in proptest::sample::select(kinds_that_learn()),
        rate in 8.0..40.0f64,
        counts in 0.0..5.0f64,
        parameter in -8.0..0.0f64,
    ) {
        designs::try_one(kind, rate, 10f64.powf(counts) as u32, 10f64.powf(parameter));
    }

    #[test]
    fn any_rows_of_a_log_give_finite_results(data in any_bytes(200)) {
        logs::run(&data);
    }

    #[test]
    fn outputs_are_within_the_limits_for_any_inputs(data in any_bytes(8000)) {
        control::run(&data);
    }
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn command_bytes_are_all_accounted_for(data in prop_oneof![any_bytes(200), command_bytes()]) {
        commands::run(&data);
    }

    #[test]
    fn link_bytes_are_all_accounted_for(data in prop_oneof![any_bytes(600), link_bytes()]) {
        link::run(&data);
    }

    #[test]
    fn any_file_is_read_or_refused_with_one_line(data in prop_oneof![any_bytes(300), csv_text(), log_text(), toml_text()]) {
        texts::run(&data);
    }
}
