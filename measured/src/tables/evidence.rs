//! Tables of the pages for the maintainers of other projects: `docs/evidence`.

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
