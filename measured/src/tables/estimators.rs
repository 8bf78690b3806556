//! Tables of the estimators in the host simulation.

use super::DOCUMENTED;
use crate::Table;

/// Every estimator: error on recordings of real devices, distance outside the haptic interval in the
/// simulation, and what the hand feels in free air at 1 kHz.
pub const ESTIMATORS: Table = Table {
    name: "estimators",
    page: "README.md",
    columns: &[
        ("estimator", "estimator"),
        ("reads", "reads"),
        ("real_rms_pct", "real motion, all"),
        ("real_judging_rms_pct", "judging"),
        ("tuned_1000hz_pct", "1 kHz, three"),
        ("all_1000hz_pct", "nine"),
        ("tuned_11600hz_pct", "11.6 kHz, three"),
        ("all_11600hz_pct", "nine"),
        ("below_threshold_pct", "below 10 mN, %"),
        ("roughness_mn", "roughness, mN"),
    ],
    digits: Some(2),
    command: DOCUMENTED,
};

/// RMS error on recordings of real devices at 1 kHz and 4096 counts/rev, % of finite difference; then
/// a column for each recording.
pub const REAL_MOTION: Table = Table {
    name: "real-motion",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("all", "all"),
        ("judging", "judging"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// Banks beside the other estimators on recordings of real devices at 1 kHz, by resolution: RMS errors,
/// % of finite difference, and where the largest ratio to the best of the others is.
pub const REAL_RESOLUTION: Table = Table {
    name: "real-resolution",
    page: "docs/real-motion.md",
    columns: &[
        ("counts_per_rev", "counts/rev"),
        ("imm", "imm"),
        ("imm_ratio", "largest ratio to another"),
        ("imm_on", "recording, the other"),
        ("imm_edge", "imm-edge"),
        ("imm_edge_ratio", "largest ratio to another"),
        ("imm_edge_on", "recording, the other"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// The reference of a recording, which is computed from the recording alone, beside its truth: RMS
/// errors at 1 kHz, % of finite difference.
pub const REFERENCE: Table = Table {
    name: "reference",
    page: "docs/your-log.md",
    columns: &[
        ("recording", "recording"),
        ("counts_per_rev", "counts/rev"),
        ("read", "from"),
        ("error_pct", "error of the reference"),
        ("sd_pct", "its standard deviation"),
        ("chosen_pct", "estimator that is best by the reference"),
        ("best_pct", "best estimator"),
        ("resolved", "resolved"),
    ],
    digits: Some(2),
    command: "cargo test --release --package experiments --test experiments reference",
};

/// The paper's experiment beside an independent simulation: distance outside the haptic interval.
pub const PAPER: Table = Table {
    name: "paper",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("pct_1000hz", "1 kHz"),
        ("independent_pct_1000hz", "independent"),
        ("pct_11600hz", "11.6 kHz"),
        ("independent_pct_11600hz", "independent"),
        ("pct_1000hz_frictionless", "1 kHz, no friction"),
        ("independent_pct_1000hz_frictionless", "independent"),
    ],
    digits: Some(2),
    command: DOCUMENTED,
};

/// Error of the finite difference beside an independent simulation.
pub const FINITE_DIFFERENCE: Table = Table {
    name: "finite-difference",
    page: "docs/benchmarks.md",
    columns: &[
        ("scenario", "scenario"),
        ("rms_rad_s", "finite difference"),
        ("independent_rms_rad_s", "independent"),
    ],
    digits: Some(2),
    command: DOCUMENTED,
};

/// Distance outside the haptic interval, % of finite difference; then a column for each scenario.
const SCENARIOS: Table = Table {
    name: "",
    page: "docs/benchmarks.md",
    columns: &[("estimator", "estimator"), ("all", "all")],
    digits: Some(2),
    command: DOCUMENTED,
};

/// Distance outside the haptic interval by scenario at 1 kHz, %.
pub const SCENARIOS_1000HZ: Table = Table {
    name: "scenarios-1000hz",
    ..SCENARIOS
};

/// Distance outside the haptic interval by scenario at 11.6 kHz, %.
pub const SCENARIOS_11600HZ: Table = Table {
    name: "scenarios-11600hz",
    ..SCENARIOS
};

/// Distance outside the haptic interval of the motor filter on a plant without friction.
pub const MOTOR_FRICTIONLESS: Table = Table {
    name: "motor-frictionless",
    page: "docs/benchmarks.md",
    columns: &[
        ("scenario", "scenario"),
        ("distance_pct", "`kalman-motor-steady`, %"),
    ],
    digits: Some(2),
    command: DOCUMENTED,
};

/// RMS error with right and with wrong constants, % of finite difference.
pub const WRONG_CONSTANTS: Table = Table {
    name: "wrong-constants",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("right_pct", "right, all"),
        ("worst_pct", "worst constants"),
        ("disc_right_pct", "disc, right"),
        ("disc_worst_pct", "disc, worst"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// The standard deviations that estimators give, against their errors.
pub const CONFIDENCE: Table = Table {
    name: "confidence",
    page: "docs/telemetry.md",
    columns: &[
        ("estimator", "estimator"),
        ("step_within_2_sigma_pct", "step: within 2 sigma, %"),
        ("step_sigma_over_error", "sigma over the error, RMS"),
        ("track_within_2_sigma_pct", "track: within 2 sigma, %"),
        ("track_sigma_over_error", "sigma over the error, RMS"),
    ],
    digits: Some(2),
    command: "cargo test --release --package experiments --test experiments confidence",
};

/// Instructions of an update in C and in Rust.
pub const C_COST: Table = Table {
    name: "c-cost",
    page: "docs/c.md",
    columns: &[
        ("estimator", "type"),
        ("rate_hz", "rate, Hz"),
        ("at_rest_c", "at rest, C"),
        ("at_rest_rust", "at rest, Rust"),
        ("texture_c", "texture, C"),
        ("texture_rust", "texture, Rust"),
        ("at_rest_source", "at rest, limpid.c"),
        ("texture_source", "texture, limpid.c"),
    ],
    digits: None,
    command: "cargo test --release --package c-interface --test interface board",
};
