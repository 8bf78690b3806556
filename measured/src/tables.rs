//! The measured tables.

mod board;
mod closed_loop;
mod estimators;
mod evidence;
mod feel;
mod stress;

use crate::Table;

pub use board::*;
pub use closed_loop::*;
pub use estimators::*;
pub use evidence::*;
pub use feel::*;
pub use stress::*;

/// The command of the tables of the host simulation.
const DOCUMENTED: &str = "cargo test --release --package host-sim --test documented";

/// Every table with a page.
pub const ALL: &[Table] = &[
    PARETO,
    C_COST,
    CONTROL,
    BOUNDS,
    IMAGE_SIZES,
    SCENE_SIZES,
    SCENE_INSTRUCTIONS,
    FAULTS,
    SCENE_FAULT_TIME,
    SCENE_FAULT_FORCE,
    ESTIMATORS,
    REAL_MOTION,
    REAL_RESOLUTION,
    EVIDENCE_COST,
    EVIDENCE_MOTEUS,
    EVIDENCE_ODRIVE,
    EVIDENCE_VESC,
    EVIDENCE_SIMPLEFOC,
    EVIDENCE_OPENFFBOARD,
    EVIDENCE_DVRK,
    REFERENCE,
    PAPER,
    FINITE_DIFFERENCE,
    SCENARIOS_1000HZ,
    SCENARIOS_11600HZ,
    MOTOR_FRICTIONLESS,
    WRONG_CONSTANTS,
    FREE_AIR_1000HZ,
    FREE_AIR_11600HZ,
    SCENE_FORCE,
    SCENE_ROUGHNESS,
    TEXTURE_INERTIA,
    FEEL_CAUSES,
    FEEL_CAUSES_TACTILE,
    FEEL_ESTIMATORS,
    FEEL_HANDLE,
    FEEL_HANDLE_SCENES,
    FEEL_WITHOUT,
    FEEL_WITHOUT_ESTIMATORS,
    FEEL_SMALL_MOTOR,
    FEEL_BOUNDS,
    ROBUSTNESS,
    Z_WIDTH,
    Z_WIDTH_SEEDS,
    PARAMETER_BOUNDS,
    CONFIDENCE,
    VELOCITY_LOOP,
    STRESS,
    STRESS_SIGNALS,
    STRESS_PARAMETERS,
];

/// Files that no page shows: the hashes of all velocities.
pub const WITHOUT_PAGE: [&str; 1] = ["traces"];
