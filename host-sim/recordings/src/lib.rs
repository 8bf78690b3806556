//! Recorded motion: the decoder of the board's telemetry, the CSV file of a recording, and the
//! checks of the data that a recording holds.

pub mod arguments;
pub mod health;
pub mod log;
pub mod record;
pub mod recording;
pub mod telemetry;
