//! Boundaries as a table for a terminal.

use std::fmt::Write as _;

use super::{Bound, Boundary, Case};

/// One block a rate and encoder, one line an estimator.
#[must_use]
pub fn table(cases: &[Case], boundaries: &[Boundary]) -> String {
    let mut text = String::from(
        "Z-width: stiffest wall and strongest damping that stay passive and free of limit cycles\n\
         K in N.m/rad, B in mN.m.s/rad; 'beyond' says who finds what just above the bound\n",
    );
    let all: Vec<_> = cases.iter().zip(boundaries).collect();
    let block =
        |a: &(&Case, _), b: &(&Case, _)| a.0.rate_hz == b.0.rate_hz && a.0.lines == b.0.lines;
    for block in all.chunk_by(block) {
        let case = block[0].0;
        let _ = writeln!(
            text,
            "\n{} Hz, large encoder of {} lines",
            case.rate_hz, case.lines
        );
        let _ = writeln!(
            text,
            "  {:<22}{:>9}  {:<24}{:>9}{:>9}{:>11}  beyond",
            "estimator", "K, B = 0", "beyond", "best K", "at B", "B, K = 0",
        );
        for (case, boundary) in block {
            let plain = boundary.walls[0].1;
            let (damping, best) = boundary.stiffest().unwrap_or((0.0, plain));
            let _ = writeln!(
                text,
                "  {:<22}{:>9}  {:<24}{:>9}{:>9}{:>11}  {}",
                case.large.name,
                shown(plain, 1.0),
                beyond(plain),
                shown(best, 1.0),
                digits(1e3 * damping),
                shown(boundary.viscous, 1e3),
                beyond(boundary.viscous),
            );
        }
    }
    text
}

fn beyond(bound: Bound) -> String {
    bound
        .beyond
        .map_or_else(|| "-".to_owned(), |finding| finding.to_string())
}

/// A bound times `unit`, with a sign where it is a lower one.
fn shown(bound: Bound, unit: f64) -> String {
    let cap = if bound.beyond.is_none() { ">= " } else { "" };
    format!("{cap}{}", digits(unit * bound.value))
}

/// About three digits.
fn digits(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if value < 0.1 => format!("{value:.4}"),
        _ if value < 1.0 => format!("{value:.3}"),
        _ if value < 10.0 => format!("{value:.2}"),
        _ => format!("{value:.1}"),
    }
}
