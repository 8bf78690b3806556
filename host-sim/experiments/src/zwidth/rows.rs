//! Boundaries as JSON and CSV: one object, or line, a bound.

use serde::Serialize;

use super::{Bound, Boundary, Case};

/// One bound of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Estimator of the large motor.
    pub estimator: &'static str,
    /// Estimator of the handle.
    pub handle_estimator: &'static str,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Lines of the large encoder.
    pub lines: u32,
    /// Seed.
    pub seed: u64,
    /// What was bounded: `stiffness`, at that damping, or `damping`, without a wall.
    pub bound: &'static str,
    /// Stiffness, N.m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping, N.m.s/rad.
    pub damping_nms_per_rad: f64,
    /// Whether nothing failed up to the largest value that is tried: the bound is a lower one.
    pub at_cap: bool,
    /// What fails beyond: `limit cycle`, `energy`, `stopped`.
    pub fault: Option<&'static str>,
    /// Who finds that: `hand`, `light grip`, `throw`.
    pub touch: Option<&'static str>,
}

/// The rows of all cases, in their order, each from the wall without damping to the damping
/// without a wall.
#[must_use]
pub fn rows(cases: &[Case], boundaries: &[Boundary], seed: u64) -> Vec<Row> {
    let mut rows = Vec::new();
    for (case, boundary) in cases.iter().zip(boundaries) {
        let row = |what, found: Bound, stiffness, damping| Row {
            estimator: case.large.name,
            handle_estimator: case.handle.name,
            rate_hz: case.rate_hz,
            lines: case.lines,
            seed,
            bound: what,
            stiffness_nm_per_rad: stiffness,
            damping_nms_per_rad: damping,
            at_cap: found.beyond.is_none(),
            fault: found.beyond.map(|finding| finding.fault.as_str()),
            touch: found.beyond.map(|finding| finding.touch.as_str()),
        };
        for &(damping, wall) in &boundary.walls {
            rows.push(row("stiffness", wall, wall.value, damping));
        }
        let viscous = boundary.viscous;
        rows.push(row("damping", viscous, 0.0, viscous.value));
    }
    rows
}
