//! What README.md and docs/choosing.md say about the estimators beyond their table.

use measured::tables::{
    ESTIMATORS, FREE_AIR_11600HZ, PARETO, REAL_MOTION, SCENARIOS_1000HZ, SCENARIOS_11600HZ,
};
use measured::{Row, digits};

use crate::{name, number, range, rows, words};

/// The observers that read the position of the handle.
const OBSERVERS: [&str; 6] = [
    "observer",
    "observer-edge",
    "adaptive",
    "adaptive-edge",
    "observer-soft",
    "adaptive-soft",
];

/// The banks that read the position of the handle.
const BANKS_WITH_HANDLE: [&str; 2] = ["imm-adaptive", "imm-adaptive-edge"];

/// Names of the rows with the least number in a column, with three digits.
fn best<'a>(rows: &'a [Row], column: &str, is_one: impl Fn(&Row) -> bool) -> Vec<&'a str> {
    let found = || rows.iter().filter(|row| is_one(row));
    let [least, _] = range(rows, column, 3, &is_one);
    let is_least =
        |row: &&Row| number(row, column).map(|it| digits::rounded(it, 3)) == Some(least.clone());
    found().filter(is_least).map(name).collect()
}

fn reads(row: &Row, signals: &str) -> bool {
    row.text("reads") == Ok(signals)
}

fn is_bank(row: &Row) -> bool {
    name(row).starts_with("imm")
}

#[test]
fn errors_on_real_devices_are_those_of_the_statements() {
    let rows = rows(&ESTIMATORS);
    let real = "real_rms_pct";
    let of = |wanted: &'static str| range(&rows, real, 2, move |row| name(row) == wanted);
    assert_eq!([of("imm-edge"), of("imm")], [["6.1"; 2], ["8.6"; 2]]);
    let others = range(&rows, real, 2, |row| reads(row, "edges") && !is_bank(row));
    assert_eq!(others, ["9.7", "13"]);
    // Finite difference is what the others are compared with.
    let filters =
        |row: &Row| reads(row, "counts") && !is_bank(row) && name(row) != "finite-difference";
    assert_eq!(range(&rows, real, 3, filters), ["40.7", "177"]);
    let learns = |row: &Row| is_bank(row) || name(row).starts_with("adaptive");
    let models =
        |row: &Row| row.text("reads").is_ok_and(|it| it.contains("current")) && !learns(row);
    assert_eq!(range(&rows, real, 2, models), ["183", "3107"]);
    assert_eq!(of("adaptive-held"), ["25"; 2]);
}

/// The recordings with a motor torque are those on which an estimator with the current runs.
#[test]
fn errors_on_recordings_with_a_torque_are_those_of_the_statements() {
    let rows = rows(&REAL_MOTION);
    let row = |wanted: &str| rows.iter().find(|row| name(row) == wanted).expect("a row");
    let recordings = rows[0].names().skip(REAL_MOTION.columns.len());
    let with_torque: Vec<_> = recordings
        .filter(|column| number(row("imm-motor"), column).is_some())
        .collect();
    assert_eq!(with_torque.len(), 5);
    for (wanted, said) in [
        ("imm", "13.3"),
        ("imm-motor", "12.7"),
        ("imm-edge", "9.0"),
        ("imm-motor-edge", "8.7"),
    ] {
        let errors = with_torque
            .iter()
            .filter_map(|column| number(row(wanted), column));
        let mean = errors.sum::<f64>() / 5.0;
        assert_eq!(format!("{mean:.1}"), said, "{wanted}");
    }
}

#[test]
fn filters_of_counts_compare_as_the_statements_say() {
    let rows = rows(&ESTIMATORS);
    let counts = |row: &Row| reads(row, "counts");
    for column in ["all_1000hz_pct", "all_11600hz_pct"] {
        let [_, banks] = range(&rows, column, 4, |row| counts(row) && is_bank(row));
        let [others, _] = range(&rows, column, 4, |row| counts(row) && !is_bank(row));
        let [banks, others] = [banks, others].map(|text| text.parse::<f64>().expect("a number"));
        assert!(banks < others, "{column}: {banks} {others}");
    }
    let others = |row: &Row| counts(row) && !is_bank(row) && name(row) != "super-twisting-explicit";
    let pooled = "all_1000hz_pct";
    assert_eq!(range(&rows, pooled, 2, others), ["94", "168"]);
    let explicit = |row: &Row| name(row) == "super-twisting-explicit";
    assert_eq!(range(&rows, pooled, 2, explicit), ["412"; 2]);
    let triple = [
        "kalman-triple",
        "kalman-triple-table",
        "kalman-triple-steady",
    ];
    assert_eq!(best(&rows, "tuned_1000hz_pct", counts), triple);
    assert_eq!(
        best(&rows, "tuned_11600hz_pct", counts),
        ["alpha-beta-gamma"]
    );
}

#[test]
fn distances_of_the_observers_are_those_of_the_statements() {
    let tables = [&SCENARIOS_1000HZ, &SCENARIOS_11600HZ].map(rows);
    let [slow, fast] = &tables;
    let scenarios: Vec<_> = slow[0]
        .names()
        .skip(SCENARIOS_1000HZ.columns.len())
        .collect();
    assert_eq!(scenarios.len(), 9);
    let most = |rows: &[Row], names: &[&str], scenario: &str| {
        let [_, most] = range(rows, scenario, 2, |row| names.contains(&name(row)));
        most
    };
    for scenario in scenarios {
        let is_noise = scenario == "stochastic";
        let others = most(slow, &OBSERVERS[1..], scenario);
        assert_eq!(others, if is_noise { "0.14" } else { "0" }, "{scenario}");
        let all = most(fast, &OBSERVERS, scenario);
        assert_eq!(all, if is_noise { "0.090" } else { "0" }, "{scenario}");
        let bank = most(slow, &BANKS_WITH_HANDLE, scenario);
        match scenario {
            "step" => assert_eq!(bank, "0.055"),
            "stochastic" => assert_eq!(bank, "0.49"),
            _ => assert!(
                bank.parse::<f64>().expect("a number") < 0.055,
                "{scenario}: {bank}"
            ),
        }
    }
    assert_eq!(most(slow, &OBSERVERS[..1], "stochastic"), "0.69");
    let permanent = |names: &[&str]| -> f64 {
        let text = most(slow, names, "permanent");
        text.parse().expect("a number")
    };
    assert!(permanent(&["observer"]) > permanent(&["kalman-triple", "alpha-beta-gamma"]));
}

#[test]
fn share_of_time_at_11600_hz_is_that_of_the_statements() {
    let rows = rows(&FREE_AIR_11600HZ);
    let share = |is_one: &dyn Fn(&str) -> bool| {
        let by = |row: &Row| row.text("controlled_by").expect("a name").to_owned();
        range(&rows, "below_threshold_pct", 2, |row| is_one(&by(row)))
    };
    let difference = |name: &str| name == "finite-difference";
    let motor = |name: &str| name.starts_with("kalman-motor");
    assert_eq!(share(&difference), ["14"; 2]);
    assert_eq!(share(&motor), ["85", "86"]);
    assert_eq!(share(&|name| !difference(name) && !motor(name)), ["96"; 2]);
}

/// An edit of a statement is one of its test, too.
#[test]
fn pages_have_the_statements() {
    let readme = words("README.md");
    for said in [
        "leave 6.1 % of the error of the finite difference with edge time stamps (`imm-edge`) and 8.6 % without",
        "read only edge time stamps leave 9.7 to 13 %. The other filters that read only counts leave 41 to 177 %",
        "`imm` leaves 13.3 % and `imm-motor` 12.7 %, `imm-edge` 9.0 % and `imm-motor-edge` 8.7 %",
        "has 1.8 to 31 times the error of the finite difference, unless it learns or is a bank: `adaptive-held` leaves 25 %",
        "the pool is at 94 to 168 % (412 with `super-twisting-explicit`)",
        "at most 0.09 % in the ninth, stochastic. At 1 kHz this holds for all but `observer`, with at most 0.14 %; \
         `observer` has up to 0.69 %",
        "have up to 0.49 % in stochastic and 0.055 % in step at 1 kHz",
        "14 % of the time below 10 mN, the others 96 %, the two `kalman-motor` 85 to 86 %",
    ] {
        assert!(readme.contains(said), "{said}");
    }
    let choosing = words("docs/choosing.md");
    assert!(choosing.contains("0.14 %; `observer` has up to 0.69 %"));
    let pareto = rows(&PARETO);
    let mean = |wanted: &str| {
        let row = pareto.iter().find(|row| name(row) == wanted);
        row.expect("a row").text("mean_3").expect("instructions")
    };
    let [imm, motor] = ["imm", "imm-motor"].map(mean);
    let held = mean("adaptive-held");
    let slow = rows(&SCENARIOS_1000HZ);
    let distance = |wanted: &'static str, scenario: &str| {
        let [least, _] = range(&slow, scenario, 3, move |row| name(row) == wanted);
        least
    };
    for said in [
        format!("`imm` takes {imm} instructions in the mean"),
        format!("for {motor} instructions."),
        format!("It takes {held} instructions in the mean, `imm-motor` {motor}."),
        format!("`imm` {} %, in stochastic", distance("imm", "texture")),
        format!("`imm-edge` has {} and", distance("imm-edge", "texture")),
    ] {
        assert!(choosing.contains(&said), "{said}");
    }
}
