//! Boundaries as JSON and CSV: one object or line per bound.

use serde::Serialize;

use super::{Bound, Boundary, LoopSetup};

/// One bound of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ZwidthRow {
    /// Estimator of the large motor, or [`EXACT`](super::EXACT).
    pub estimator: &'static str,
    /// Estimator of the handle, or [`EXACT`](super::EXACT).
    pub handle_estimator: &'static str,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Lines of the large encoder.
    pub lines: u32,
    /// Seed.
    pub seed: u64,
    /// The bounded quantity: `stiffness` at the given damping, or `damping` without a wall.
    pub bound: &'static str,
    /// Stiffness, N.m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping, N.m.s/rad.
    pub damping_nms_per_rad: f64,
    /// Whether the largest value of the search passes; the bound is then a lower one.
    pub at_cap: bool,
    /// Failure beyond the bound: `limit cycle`, `energy`, `stopped`.
    pub fault: Option<&'static str>,
    /// Contact that causes it: `hand`, `light grip`, `throw`.
    pub touch: Option<&'static str>,
}

/// The rows of all cases, in their order: the walls in order of damping, then the damping without a
/// wall.
#[must_use]
pub fn rows(cases: &[LoopSetup], boundaries: &[Boundary], seed: u64) -> Vec<ZwidthRow> {
    let mut rows = Vec::new();
    for (case, boundary) in cases.iter().zip(boundaries) {
        let [estimator, handle_estimator] = case.names();
        let row = |what, found: Bound, stiffness, damping| ZwidthRow {
            estimator,
            handle_estimator,
            rate_hz: case.rate_hz,
            lines: case.lines,
            seed,
            bound: what,
            stiffness_nm_per_rad: stiffness,
            damping_nms_per_rad: damping,
            at_cap: found.beyond.is_none(),
            fault: found.beyond.map(|finding| finding.violation.as_str()),
            touch: found.beyond.map(|finding| finding.contact.as_str()),
        };
        for &(damping, wall) in &boundary.walls {
            rows.push(row("stiffness", wall, wall.value, damping));
        }
        let viscous = boundary.viscous;
        rows.push(row("damping", viscous, 0.0, viscous.value));
    }
    rows
}
