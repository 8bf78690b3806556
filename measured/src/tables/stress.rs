//! Tables of numerics under stress.

use crate::Table;

const COMMAND: &str = "nice cargo stress --resume target/stress.jsonl";

/// Every estimator over a long and hostile course, beside its f64 twin.
pub const STRESS: Table = Table {
    name: "stress",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("rate_hz", "rate, Hz"),
        ("ticks", "ticks"),
        ("wraps", "wraps of 2^32"),
        ("deviation_rad_s", "f32 against f64, rad/s"),
        ("start_deviation_rad_s", "soon after a start"),
        ("relative_deviation", "of the fastest velocity"),
        ("recovery_ticks", "at rest after, ticks"),
        ("settles_ticks", "by design"),
        ("windows_compared", "windows compared"),
        ("faults", "faults"),
    ],
    digits: None,
    command: COMMAND,
};

/// What f32 costs on signals of the simulated device.
pub const STRESS_SIGNALS: Table = Table {
    name: "stress-signals",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("rate_hz", "rate, Hz"),
        ("largest_rad_s", "largest, rad/s"),
        ("rms_rad_s", "RMS, rad/s"),
        ("rms_error_rad_s", "RMS error, rad/s"),
        ("added_error", "f32 adds"),
    ],
    digits: None,
    command: COMMAND,
};

/// Parameters at the ends of their ranges.
pub const STRESS_PARAMETERS: Table = Table {
    name: "stress-parameters",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("designs", "designs"),
        ("refused", "refused, by parameter"),
        (
            "relative_deviation",
            "f32 against f64, of the fastest velocity",
        ),
        ("broken", "broken"),
    ],
    digits: None,
    command: COMMAND,
};
