//! Numerics under stress.

use measured::tables::{STRESS, STRESS_SIGNALS};
use measured::{Row, digits};

use crate::{name, rows, says};

const PAGE: &str = "docs/benchmarks.md";

/// The row with the largest number of those for which `is_one` holds, and the number.
fn largest(
    rows: &[Row],
    figure: impl Fn(&Row) -> f64,
    is_one: impl Fn(&str) -> bool,
) -> (&Row, f64) {
    let found = rows.iter().filter(|row| is_one(name(row)));
    let found = found.map(|row| (row, figure(row)));
    found.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a row")
}

fn rate(row: &Row) -> String {
    format!("{} kHz", row.number("rate_hz").unwrap() / 1e3)
}

fn is_bank(name: &str) -> bool {
    name.starts_with("imm")
}

fn is_observer(name: &str) -> bool {
    name.starts_with("observer") || name.starts_with("adaptive")
}

fn is_switching(name: &str) -> bool {
    name.starts_with("super-twisting") || name == "tracking-differentiator"
}

#[test]
fn signals_of_a_device_differ_as_the_statements_say() {
    let rows = rows(&STRESS_SIGNALS);
    let rms = |row: &Row| row.number("rms_rad_s").unwrap();
    let (observer, moved) = largest(&rows, rms, is_observer);
    let exponential = format!("{moved:.1e}");
    let (bank, of_bank) = largest(&rows, rms, is_bank);
    let (switching, of_switching) = largest(&rows, rms, is_switching);
    let said = [
        format!(
            "up to {exponential} rad/s RMS (`{}` at {})",
            name(observer),
            rate(observer)
        ),
        format!(
            "up to {} rad/s RMS (`{}` at {})",
            digits::rounded(of_bank, 2),
            name(bank),
            rate(bank)
        ),
        format!(
            "a switching law by up to {} (`{}` at {})",
            digits::rounded(of_switching, 2),
            name(switching),
            rate(switching)
        ),
    ];
    says(PAGE, &said);
    let decides = |name: &str| is_bank(name) || is_observer(name) || is_switching(name);
    let (row, most) = largest(&rows, rms, |name| !decides(name));
    assert!(most < 2e-6, "{}: {most}", name(row));
    let added = |row: &Row| row.number("added_error").unwrap().abs();
    let (bank, of_bank) = largest(&rows, added, is_bank);
    let (other, of_other) = largest(&rows, added, |name| !is_bank(name));
    assert!(
        of_other < of_bank && of_bank < 5e-3,
        "{} {}",
        name(bank),
        name(other)
    );
}

#[test]
fn stress_course_ends_as_the_statements_say() {
    let rows = rows(&STRESS);
    let seconds =
        |row: &Row| row.number("recovery_ticks").unwrap() / row.number("rate_hz").unwrap();
    let (row, longest) = largest(&rows, seconds, |name| name.starts_with("adaptive"));
    let said = format!(
        "longest time in the table, {} s (`{}` at {})",
        digits::rounded(longest, 2),
        name(row),
        rate(row)
    );
    says(PAGE, &[said]);
    assert!((2.6..3.0).contains(&(6.0 / longest)), "{longest}");
    let relative = |row: &Row| row.number("relative_deviation").unwrap();
    let (_, most) = largest(&rows, relative, is_bank);
    says(
        "docs/theory/imm.md",
        &[format!(
            "by up to {most} times the fastest velocity in 1e8 ticks"
        )],
    );
    let faults = rows.iter().map(|row| row.number("faults").unwrap());
    assert!(faults.sum::<f64>() == 0.0);
}
