//! Tables of what the hand feels.

use super::DOCUMENTED;
use crate::{Column, Table};

/// The page of all of them.
const PAGE: &str = "docs/feel.md";

/// A table whose rows have a name, an RMS and the shares of the causes.
macro_rules! by_cause {
    ($row:literal) => {
        &[
            ($row, $row),
            ("rms_mn", "RMS, mN"),
            ("inertia", "inertia"),
            ("friction", "friction"),
            ("ripple", "ripple"),
            ("slip", "slip"),
            ("estimate", "estimate"),
            ("handle estimate", "handle estimate"),
            ("amplifier", "amplifier"),
            ("sampling", "sampling"),
            ("DAC", "DAC"),
            ("limits", "limits"),
        ]
    };
}

/// Parasitic force of every scene at 1 kHz, and its shares by cause, %.
pub const FEEL_CAUSES: Table = Table {
    name: "feel-causes",
    page: PAGE,
    columns: by_cause!("scene"),
    digits: None,
    command: DOCUMENTED,
};

/// Parasitic force of every scene at 1 kHz from 50 to 500 Hz, and its shares by cause, %.
pub const FEEL_CAUSES_TACTILE: Table = Table {
    name: "feel-causes-tactile",
    ..FEEL_CAUSES
};

/// Parasitic force in free air at 1 kHz from 50 to 500 Hz by estimator, and its shares by cause, %.
pub const FEEL_ESTIMATORS: Table = Table {
    name: "feel-estimators",
    columns: by_cause!("estimator"),
    ..FEEL_CAUSES
};

/// Parasitic force in free air without each cause, controlled by the adaptive observer.
pub const FEEL_WITHOUT: Table = Table {
    name: "feel-without",
    page: PAGE,
    columns: &[
        ("without", "without"),
        ("rms_mn_1000hz", "1 kHz: RMS, mN"),
        ("p99_mn_1000hz", "99 %, mN"),
        ("below_pct_1000hz", "below 10 mN, %"),
        ("rms_mn_10000hz", "10 kHz: RMS, mN"),
        ("p99_mn_10000hz", "99 %, mN"),
        ("below_pct_10000hz", "below 10 mN, %"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// Parasitic force in free air by estimator of the handle and by seed.
pub const FEEL_HANDLE: Table = Table {
    name: "feel-handle",
    columns: &[
        ("handle", "handle"),
        ("seed", "seed"),
        ("rms_mn_1000hz", "1 kHz: RMS, mN"),
        ("p99_mn_1000hz", "99 %, mN"),
        ("below_pct_1000hz", "below 10 mN, %"),
        ("tactile_mn_1000hz", "50-500 Hz, mN"),
        ("rms_mn_10000hz", "10 kHz: RMS, mN"),
        ("p99_mn_10000hz", "99 %, mN"),
        ("below_pct_10000hz", "below 10 mN, %"),
        ("tactile_mn_10000hz", "50-500 Hz, mN"),
    ],
    ..FEEL_WITHOUT
};

/// Parasitic force of three scenes by estimator of the handle and by seed, RMS, mN.
pub const FEEL_HANDLE_SCENES: Table = Table {
    name: "feel-handle-scenes",
    columns: &[
        ("handle", "handle"),
        ("seed", "seed"),
        ("viscous_1000hz", "1 kHz: viscous"),
        ("spring-damper_1000hz", "spring-damper"),
        ("wall_1000hz", "wall"),
        ("viscous_10000hz", "10 kHz: viscous"),
        ("spring-damper_10000hz", "spring-damper"),
        ("wall_10000hz", "wall"),
    ],
    ..FEEL_WITHOUT
};

const OF_ESTIMATORS: &[Column] = &[
    ("without", "without"),
    ("finite-difference_1000hz", "1 kHz: finite-difference"),
    ("foaw-best-fit_1000hz", "foaw-best-fit"),
    ("adaptive_1000hz", "adaptive"),
    ("finite-difference_10000hz", "10 kHz: finite-difference"),
    ("foaw-best-fit_10000hz", "foaw-best-fit"),
    ("adaptive_10000hz", "adaptive"),
];

/// Parasitic force in free air without each cause by estimator, RMS, mN.
pub const FEEL_WITHOUT_ESTIMATORS: Table = Table {
    name: "feel-without-estimators",
    columns: OF_ESTIMATORS,
    ..FEEL_WITHOUT
};

/// Parasitic force of every scene with a small motor beside its bounds, RMS, mN.
pub const FEEL_BOUNDS: Table = Table {
    name: "feel-bounds",
    columns: &[
        ("scene", "scene"),
        ("adaptive_1000hz", "1 kHz: adaptive"),
        ("true_velocities_1000hz", "true velocities"),
        ("inertia_1000hz", "all but inertia"),
        ("future_1000hz", "all but the future"),
        ("limits_1000hz", "all but DAC and limits"),
        ("adaptive_10000hz", "10 kHz: adaptive"),
        ("true_velocities_10000hz", "true velocities"),
        ("inertia_10000hz", "all but inertia"),
        ("future_10000hz", "all but the future"),
        ("limits_10000hz", "all but DAC and limits"),
    ],
    ..FEEL_WITHOUT
};

/// Parasitic force of the scenes that the small motor alone renders, without each cause.
pub const FEEL_SMALL_MOTOR: Table = Table {
    name: "feel-small-motor",
    columns: &[
        ("without", "without"),
        ("detents_rms_mn_1000hz", "detents, 1 kHz: RMS, mN"),
        ("detents_below_pct_1000hz", "below 10 mN, %"),
        ("texture_rms_mn_1000hz", "texture, 1 kHz: RMS, mN"),
        ("texture_below_pct_1000hz", "below 10 mN, %"),
        ("texture_rms_mn_10000hz", "texture, 10 kHz: RMS, mN"),
        ("texture_below_pct_10000hz", "below 10 mN, %"),
    ],
    ..FEEL_WITHOUT
};
