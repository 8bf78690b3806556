//! Tables of the pages for the maintainers of other projects: `docs/evidence`.

use super::DOCUMENTED;
use crate::Table;

/// Run time of an update of the velocity algorithms of other projects, written anew.
pub const EVIDENCE_COST: Table = Table {
    name: "evidence-cost",
    page: "docs/evidence.md",
    columns: &[
        ("estimator", "comparator"),
        ("mean_3", "mean, `3`"),
        ("most_3", "most, `3`"),
        ("at_rest_3", "at rest, `3`"),
        ("mean_s", "mean, `s`"),
        ("cycles_3", "cycles, `3`"),
        ("code_3", "code, `3`"),
        ("state", "state"),
    ],
    digits: None,
    command: "cargo pareto",
};

/// A project beside estimators of this project on the recordings that judge: means, then a column for
/// the RMS error on each recording, % of finite difference.
const EVIDENCE: Table = Table {
    name: "",
    page: "",
    columns: &[
        ("estimator", "estimator"),
        ("counts_per_rev", "counts/rev"),
        ("rate_khz", "kHz"),
        ("parameters", "parameters"),
        ("rms_pct", "RMS, %"),
        ("rms_rad_s", "RMS, rad/s"),
        ("p99_pct", "99th, %"),
        ("p99_rad_s", "99th, rad/s"),
        ("delay_ms", "delay, ms"),
        ("moving_at_rest_pct", "moves, %"),
        ("instructions", "instructions"),
        ("state", "state, bytes"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

const fn evidence(name: &'static str, page: &'static str) -> Table {
    Table {
        name,
        page,
        ..EVIDENCE
    }
}

/// moteus.
pub const EVIDENCE_MOTEUS: Table = evidence("evidence-moteus", "docs/evidence/moteus.md");

/// ODrive.
pub const EVIDENCE_ODRIVE: Table = evidence("evidence-odrive", "docs/evidence/odrive.md");

/// VESC.
pub const EVIDENCE_VESC: Table = evidence("evidence-vesc", "docs/evidence/vesc.md");

/// SimpleFOC.
pub const EVIDENCE_SIMPLEFOC: Table = evidence("evidence-simplefoc", "docs/evidence/simplefoc.md");

/// OpenFFBoard.
pub const EVIDENCE_OPENFFBOARD: Table =
    evidence("evidence-openffboard", "docs/evidence/openffboard.md");

/// dVRK.
pub const EVIDENCE_DVRK: Table = evidence("evidence-dvrk", "docs/evidence/dvrk.md");
