//! Designs whose parameters can be refused.

use estimator_catalogue::ROWS;

use crate::course::EDGE_CLOCK_HZ;
pub use crate::pairs::Refusable;
use crate::pairs::{Entry, Request, kalman_motor_table};

/// A design of the core that no row of the catalogue has.
const MOTOR_TABLE: &str = "kalman-motor-table";

/// The estimators whose design may be refused: the rows with a parameter or with an edge clock, and
/// the gain table of the motor model.
#[must_use]
pub fn kinds() -> Vec<&'static str> {
    let rows = ROWS
        .iter()
        .filter(|row| !row.parameters.is_empty() || row.needs.edge);
    rows.map(|row| row.name).chain([MOTOR_TABLE]).collect()
}

/// Values for the first parameter of `kind` within and beyond its range: fractions of the rate for a
/// frequency and for the edge clock of a row without parameters, window lengths, and 24 decades for
/// a noise.
#[must_use]
pub fn parameters(kind: &str, rate: f64) -> Vec<f64> {
    let first = Entry::named(kind).map(|entry| entry.row.parameters.first());
    let parts: &[f64] = match first {
        Some(Some(first)) if first.unit == "Hz" => &[1e-7, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.51],
        Some(None) => &[0.5, 1.0, 84.0, 1e4, 1e7],
        Some(Some(first)) if first.whole => return vec![0.0, 1.0, 2.0, 15.0, 64.0, 65.0],
        _ => return (-12..=12).map(|exponent| 10f64.powi(exponent)).collect(),
    };
    parts.iter().map(|part| part * rate).collect()
}

/// The design `kind` with `parameter` as its first parameter. The noise bound of a window in counts
/// equals its number of intervals, so that both limits of both are tested. The slow disturbance
/// torque, N·m, is ten times the white one, N·m/√Hz.
///
/// # Errors
/// The name of the design error, if core and twin agree in it.
///
/// # Panics
/// If only one of them refuses the design, or `kind` is not in [`kinds`].
pub fn design(kind: &str, rate: f64, counts_per_rev: u32, parameter: f64) -> Refusable {
    let value = |name: &str| match name {
        "load" => 10.0 * parameter,
        "load_time" => 0.1,
        "friction_share" => 0.7,
        "boundary_noise" => 0.0625,
        "literal" => 0.0,
        _ => parameter,
    };
    let entry = Entry::named(kind);
    let has_parameter = entry.is_none_or(|entry| !entry.row.parameters.is_empty());
    let request = Request {
        rate_hz: rate,
        counts_per_rev,
        clock_hz: if has_parameter {
            EDGE_CLOCK_HZ
        } else {
            parameter
        },
        capacity: entry.map_or(0, |entry| entry.capacities()[entry.capacities().len() - 1]),
        value: &value,
    };
    match entry {
        Some(entry) => (entry.design)(&request),
        None if kind == MOTOR_TABLE => kalman_motor_table(&request),
        None => panic!("no estimator {kind}"),
    }
}
