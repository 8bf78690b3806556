//! Tables of the closed loop.

use super::DOCUMENTED;
use crate::Table;

/// Parasitic force of a hand that moves through free air.
const FREE_AIR: Table = Table {
    name: "",
    page: "docs/benchmarks.md",
    columns: &[
        ("controlled_by", "controlled by"),
        ("rms_mn", "RMS, mN"),
        ("p99_mn", "99 %, mN"),
        ("roughness_mn", "50 to 500 Hz, mN"),
        ("below_threshold_pct", "below 10 mN, %"),
    ],
    digits: Some(2),
    command: DOCUMENTED,
};

/// Parasitic force in free air at 1 kHz.
pub const FREE_AIR_1000HZ: Table = Table {
    name: "free-air-1000hz",
    ..FREE_AIR
};

/// Parasitic force in free air at 11.6 kHz.
pub const FREE_AIR_11600HZ: Table = Table {
    name: "free-air-11600hz",
    ..FREE_AIR
};

/// Parasitic force of every scene at 1 kHz, RMS, mN.
pub const SCENE_FORCE: Table = Table {
    name: "scene-force",
    page: "docs/benchmarks.md",
    columns: &[
        ("scene", "scene"),
        ("finite-difference", "finite-difference"),
        ("low-pass", "low-pass"),
        ("foaw-end-fit", "foaw-end-fit"),
        ("kalman-triple-steady", "kalman-triple-steady"),
        ("observer", "observer"),
        ("adaptive", "adaptive"),
    ],
    digits: Some(2),
    command: DOCUMENTED,
};

/// Parasitic force of every scene at 1 kHz from 50 to 500 Hz, RMS, mN.
pub const SCENE_ROUGHNESS: Table = Table {
    name: "scene-roughness",
    ..SCENE_FORCE
};

/// Force that misses in the scene texture at 10 kHz, by the inertia of the handle.
pub const TEXTURE_INERTIA: Table = Table {
    name: "texture-inertia",
    page: "docs/benchmarks.md",
    columns: &[
        ("inertia", "inertia of the handle"),
        ("missing_mn", "50 to 500 Hz, mN"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// The closed loop on devices that differ from the assumed one.
pub const ROBUSTNESS: Table = Table {
    name: "robustness",
    page: "docs/benchmarks.md",
    columns: &[
        ("scene", "scene"),
        ("stable", "stable"),
        ("stopped", "stopped"),
        ("violated", "violated"),
        ("handle_median", "handle, rad/s"),
        ("handle_95", "95 %"),
        ("handle_most", "most"),
        ("felt_median", "felt, mN.m"),
        ("felt_95", "95 %"),
        ("felt_most", "most"),
        ("oscillation_median", "oscillation, mN.m"),
        ("oscillation_95", "95 %"),
        ("oscillation_most", "most"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// The Z-width with 1024 lines.
pub const Z_WIDTH: Table = Table {
    name: "z-width",
    page: "docs/theory/z-width.md",
    columns: &[
        ("estimator", "estimator"),
        ("undamped_nm_per_rad_1000hz", "1 kHz: K at B = 0"),
        ("best_nm_per_rad_1000hz", "best K"),
        ("best_mnms_per_rad_1000hz", "its B"),
        ("damping_mnms_per_rad_1000hz", "B at K = 0"),
        ("undamped_nm_per_rad_11600hz", "11.6 kHz: K at B = 0"),
        ("best_nm_per_rad_11600hz", "best K"),
        ("best_mnms_per_rad_11600hz", "its B"),
        ("damping_mnms_per_rad_11600hz", "B at K = 0"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// The stiffest wall at 1 kHz with 1024 lines by seed.
pub const Z_WIDTH_SEEDS: Table = Table {
    name: "z-width-seeds",
    columns: &[
        ("estimator", "estimator"),
        ("best_nm_per_rad_seed_1", "best K, seed 1"),
        ("best_nm_per_rad_seed_2", "2"),
        ("best_nm_per_rad_seed_3", "3"),
        ("best_nm_per_rad_seed_4", "4"),
        ("best_nm_per_rad_seed_5", "5"),
        ("best_nm_per_rad_seed_6", "6"),
        ("mean_nm_per_rad", "mean"),
        ("least_nm_per_rad", "least"),
    ],
    ..Z_WIDTH
};

/// The Z-width with the estimators of the firmware at 10 kHz.
pub const PARAMETER_BOUNDS: Table = Table {
    name: "parameter-bounds",
    page: "docs/telemetry.md",
    columns: &[
        ("estimator", "large motor by"),
        (
            "stiffness_nm_per_rad_seed_1",
            "stiffness without damping, N·m/rad",
        ),
        (
            "damping_mnms_per_rad_seed_1",
            "damping without stiffness, mN·m·s/rad",
        ),
        ("stiffness_nm_per_rad_seed_2", "seed 2, stiffness"),
        ("damping_mnms_per_rad_seed_2", "seed 2, damping"),
    ],
    digits: Some(3),
    command: DOCUMENTED,
};

/// Margins of the velocity loop.
pub const VELOCITY_LOOP: Table = Table {
    name: "velocity-loop",
    page: "docs/theory/velocity-loop.md",
    columns: &[
        ("rate_khz", "rate, kHz"),
        ("modulus", "modulus"),
        ("gain", "gain"),
        ("phase_deg", "phase, degrees"),
        ("delay_ms", "delay, ms"),
        ("crossover_hz", "crossover, Hz"),
    ],
    digits: Some(3),
    command: "cargo test --release --package acceptance --test core margins",
};
