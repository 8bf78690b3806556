//! The host simulation: the dual-stage device in f64, its encoders, the scenarios that drive
//! it, and the scores and reports that say what a hand would feel.
//!
//! Estimators come from `estimator-core` and see only what a controller board would see: counts,
//! the applied current, edge time stamps. Truth goes to the scores alone.

pub mod belief;
pub mod cli;
pub mod closed_loop;
pub mod compare;
pub mod contest;
pub mod cost;
pub mod device;
pub mod encoder;
pub mod estimators;
pub mod failure;
pub mod felt;
pub mod health;
pub mod identify;
pub mod limit;
pub mod output;
pub mod parameters;
pub mod plant;
pub mod record;
pub mod recording;
pub mod replay;
pub mod report;
pub mod robust;
pub mod rows;
pub mod scenario;
pub mod score;
pub mod sensitivity;
pub mod simulate;
pub mod spectrum;
pub mod table;
pub mod telemetry;
pub mod trace;
pub mod tune;
pub mod version;
pub mod wording;
pub mod zwidth;
