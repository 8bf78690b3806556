//! Table of the boundaries for a terminal.

use std::fmt::Write as _;

use super::{Bound, Boundary, LoopSetup};
use crate::table::layout::{self, Column};

/// One table per rate and encoder with one line per estimator, in lines of `width` characters.
#[must_use]
pub fn table(cases: &[LoopSetup], boundaries: &[Boundary], width: usize) -> String {
    let mut text = String::from(
        "Z-width: stiffest wall (K) and strongest damping (B) that stay passive and free\n\
         of limit cycles. 'fails' is the fault just above the bound, and the hand that\n\
         finds it\n",
    );
    let all: Vec<_> = cases.iter().zip(boundaries).collect();
    let block = |a: &(&LoopSetup, _), b: &(&LoopSetup, _)| {
        a.0.rate_hz == b.0.rate_hz && a.0.lines == b.0.lines
    };
    for block in all.chunk_by(block) {
        let case = block[0].0;
        let _ = writeln!(
            text,
            "\n{} Hz, large encoder of {} lines",
            case.rate_hz, case.lines
        );
        let numbers = |head, unit, of: &dyn Fn(&Boundary) -> String| {
            Column::numbers(head, unit, block.iter().map(|(_, boundary)| of(boundary)))
        };
        let fails = |head, of: &dyn Fn(&Boundary) -> Bound| {
            let cells = block.iter().map(|(_, boundary)| beyond(of(boundary)));
            Column::text(head, "fails", cells)
        };
        let plain = |boundary: &Boundary| boundary.walls[0].1;
        let best = |boundary: &Boundary| boundary.stiffest().unwrap_or((0.0, plain(boundary)));
        let columns = [
            numbers("K at B = 0", "N.m/rad", &|of| shown(plain(of), 1.0)),
            fails("", &plain),
            numbers("best K", "N.m/rad", &|of| shown(best(of).1, 1.0)),
            numbers("at B", "mN.m.s/rad", &|of| three_digits(1e3 * best(of).0)),
            numbers("B at K = 0", "mN.m.s/rad", &|of| shown(of.viscous, 1e3)),
            fails("", &|of| of.viscous),
        ];
        let names = block.iter().map(|(case, _)| case.names()[0].to_owned());
        text += &layout::table(&Column::text("", "estimator", names), &columns, width);
    }
    text
}

fn beyond(bound: Bound) -> String {
    bound
        .beyond
        .map_or_else(|| "-".to_owned(), |finding| finding.to_string())
}

/// A bound times `unit`, with `>=` if it is a lower one.
fn shown(bound: Bound, unit: f64) -> String {
    let cap = if bound.beyond.is_none() { ">= " } else { "" };
    format!("{cap}{}", three_digits(unit * bound.value))
}

/// About three significant digits.
fn three_digits(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if value < 0.1 => format!("{value:.4}"),
        _ if value < 1.0 => format!("{value:.3}"),
        _ if value < 10.0 => format!("{value:.2}"),
        _ => format!("{value:.1}"),
    }
}
