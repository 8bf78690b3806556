//! Scores of a velocity estimate against the true velocity: error, delay, transients, and the force
//! that a hand would feel.

pub mod evaluation;
mod percentile;
pub mod score;
pub mod spectrum;

pub use percentile::percentile;
