//! What the hand feels.

use measured::tables::{
    FEEL_BOUNDS, FEEL_CAUSES, FEEL_HANDLE, FEEL_HANDLE_SCENES, FEEL_SMALL_MOTOR, FREE_AIR_1000HZ,
    FREE_AIR_11600HZ,
};
use measured::{Row, digits};

use crate::{between, number, of, range, rows, says, span, tenths, whole};

const PAGE: &str = "docs/feel.md";
const RATES: [&str; 2] = ["1000hz", "10000hz"];

/// Numbers in words, as far as a page needs them.
const NUMBERS: [&str; 11] = [
    "none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
];

fn is_bank(row: &Row) -> bool {
    row.text("handle") == Ok("imm")
}

fn controller(row: &Row) -> &str {
    row.text("controlled_by").expect("a name")
}

fn is_observer(row: &Row) -> bool {
    ["observer", "adaptive"]
        .iter()
        .any(|family| controller(row).starts_with(family))
}

#[test]
fn handle_with_a_bank_has_the_forces_of_the_statements() {
    let rows = rows(&FEEL_HANDLE);
    let shown = |column: &str| between(range(&rows, column, 2, is_bank));
    let [rms, most, below] = ["rms_mn_10000hz", "p99_mn_10000hz", "below_pct_10000hz"].map(shown);
    let [slow_rms, slow_most] = ["rms_mn_1000hz", "p99_mn_1000hz"].map(shown);
    let said = [
        format!(
            "With `imm` on the handle it has {rms} mN now, {most} mN at 99 %, and less than 10 mN in {below} % of the time."
        ),
        format!("At 1 kHz it has {slow_rms} mN, and {slow_most} mN at 99 %."),
    ];
    says(PAGE, &said);
}

/// Banks and filters have the same seeds in the same order.
#[test]
fn bank_on_the_handle_takes_off_what_the_statements_say() {
    let rows = rows(&FEEL_HANDLE);
    let (banks, filters): (Vec<_>, Vec<_>) = rows.iter().partition(|row| is_bank(row));
    let [slow, fast] = RATES.map(|rate| {
        let column = format!("rms_mn_{rate}");
        let off = banks.iter().zip(&filters).map(|(bank, filter)| {
            assert_eq!(bank.text("seed"), filter.text("seed"));
            let [bank, filter] = [bank, filter].map(|row| row.number(&column).unwrap());
            100.0 * (1.0 - bank / filter)
        });
        between(whole(span(off)))
    });
    let said = format!("takes {slow} % of its RMS off, {fast} % at 10 kHz (free air, five seeds,");
    says("README.md", &[said]);
    assert_eq!((banks.len(), filters.len()), (5, 5));
}

#[test]
fn scenes_with_a_bank_have_the_forces_of_the_statements() {
    let rows = rows(&FEEL_HANDLE_SCENES);
    let figures = |scenes: &[&str], rates: &[&str], is_one: &dyn Fn(&Row) -> bool| {
        let mut figures = Vec::new();
        for row in rows.iter().filter(|row| is_one(row)) {
            for scene in scenes {
                let columns = rates.iter().map(|rate| format!("{scene}_{rate}"));
                figures.extend(columns.map(|column| row.number(&column).unwrap()));
            }
        }
        figures
    };
    let is_filter = |row: &Row| !is_bank(row);
    let springs = figures(&["wall", "spring-damper"], &RATES, &is_bank);
    let filtered = figures(&["wall", "spring-damper"], &RATES, &is_filter);
    let viscous = figures(&["viscous"], &RATES, &is_bank);
    let slow = figures(&["viscous"], &RATES[..1], &is_bank);
    let below = springs.iter().filter(|force| **force < 5.0).count();
    assert_eq!(springs.len(), 20);
    let shown = |forces: &[f64]| between(tenths(span(forces.iter().copied())));
    let said = [
        format!(
            "With `imm` the viscous field has {} mN at 1 kHz, about half of the force",
            shown(&slow)
        ),
        format!("`wall` and `spring-damper` {} mN, where", shown(&springs)),
        format!("of these twenty figures {} are below it", NUMBERS[below]),
        format!("With the Kalman filter they have {} mN.", shown(&filtered)),
        format!(
            "`imm` on the handle has [{} mN](#what-was-taken-off) by seed",
            shown(&viscous)
        ),
    ];
    says(PAGE, &said);
    let filters = figures(&["viscous"], &RATES[..1], &is_filter);
    for (bank, filter) in slow.iter().zip(filters) {
        assert!((0.43..0.57).contains(&(bank / filter)), "{bank} {filter}");
    }
}

#[test]
fn bounds_are_those_of_the_statements() {
    let rows = rows(&FEEL_BOUNDS);
    let shown = |scenes: &[&str], columns: &[&str]| {
        let figures = scenes.iter().flat_map(|scene| {
            let rows = &rows;
            columns.iter().map(move |column| of(rows, scene, column))
        });
        between(tenths(span(figures)))
    };
    let bound = "future_1000hz";
    let three = ["wall", "spring-damper", "viscous"];
    let true_velocities = RATES.map(|rate| format!("true_velocities_{rate}"));
    let true_velocities = true_velocities.each_ref().map(String::as_str);
    let [slow, fast] = tenths(true_velocities.map(|column| of(&rows, "viscous", column)));
    let ticks = span(rows.iter().filter_map(|row| number(row, bound)));
    let said = [
        format!(
            "what the hand changes within a tick, {} mN at 1 kHz",
            between(tenths(ticks))
        ),
        format!(
            "The bound of wall, spring-damper and viscous field is {} mN at 1 kHz.",
            shown(&three, &[bound])
        ),
        format!(
            "whole inertia of the handle it is {} mN.",
            shown(&three, &["inertia_1000hz"])
        ),
        format!("which leave {} mN.", shown(&three[..2], &true_velocities)),
        format!("the true velocities leave {slow} mN at 1 kHz, {fast} mN at 10 kHz"),
    ];
    says(PAGE, &said);
}

#[test]
fn scenes_of_the_small_motor_are_as_the_statements_say() {
    let small = rows(&FEEL_SMALL_MOTOR);
    let below = ["detents", "texture"].map(|scene| {
        let column = format!("{scene}_below_pct_1000hz");
        of(&small, "nothing", &column)
    });
    let [detents, texture] = whole(below);
    says(
        PAGE,
        &[format!(
            "is below the threshold in {detents} and {texture} % of the time"
        )],
    );
    let causes = rows(&FEEL_CAUSES);
    for scene in ["detents", "off"] {
        let slip = of(&causes, scene, "slip");
        assert!(
            (60.0..72.0).contains(&slip),
            "two thirds of {scene} are {slip} %"
        );
    }
}

#[test]
fn estimators_in_the_loop_compare_as_the_statements_say() {
    let [slow, fast] = [FREE_AIR_1000HZ, FREE_AIR_11600HZ].map(|table| rows(&table));
    let differs = |row: &Row| {
        let name = controller(row);
        name == "super-twisting-explicit" || name.starts_with("kalman-motor")
    };
    let others = |row: &Row| !differs(row) && controller(row) != "reference";
    let [usual, more] = [
        range(&slow, "rms_mn", 2, others),
        range(&slow, "rms_mn", 2, differs),
    ];
    let difference = of(&slow, "finite-difference", "roughness_mn");
    let observers = slow.iter().filter(|row| is_observer(row));
    let roughness = observers.map(|row| 100.0 * row.number("roughness_mn").unwrap() / difference);
    let roughness = between(whole(span(roughness)));
    let said = [
        format!(
            "force: {} mN in free air, and {} mN with `super-twisting-explicit` and the two `kalman-motor`",
            between(usual),
            between(more)
        ),
        format!("the observers have {roughness} % of that of the finite difference"),
    ];
    says("README.md", &said);
    says("docs/choosing.md", &said[1..]);
    // "Better than a low-pass filter by less than a tenth at 1 kHz, and not better at 11.6 kHz."
    for (rows, least, most) in [(&slow, 0.9, 1.0), (&fast, 1.0, 1.05)] {
        let filter = of(rows, "low-pass", "rms_mn");
        for row in rows.iter().filter(|row| is_observer(row)) {
            let ratio = row.number("rms_mn").unwrap() / filter;
            let name = controller(row);
            assert!(
                least < ratio && ratio < most,
                "{name}: {}",
                digits::rounded(ratio, 3)
            );
        }
    }
}
