//! Properties that must hold for any input bytes.
//!
//! Each function here is the body of one fuzz target (`tests/fuzz/targets`) and of one bounded
//! run in the tests. A panic is a finding. No loop is longer than its bytes.
//!
//! | body | bytes become | what must hold |
//! |---|---|---|
//! | [`samples`] | counts, currents, edges, restarts | every output finite, every covariance sound |
//! | [`designs`] | rates, encoders, noises | refused by name, or finite ever after |
//! | [`commands`] | the command channel | every byte is in a frame, counted, or still held |
//! | [`link`] | the bytes from a board | every byte is in a frame, counted, or still held; a valid frame is found |
//! | [`control`] | a whole control task's inputs | currents within limits, safe once stopped |
//! | [`logs`] | the rows of a log | every velocity, error and constant finite, every message one line |
//! | [`texts`] | recordings, devices, presets | read whole, or refused in one line |

mod bytes;
pub mod commands;
pub mod control;
pub mod designs;
pub mod link;
pub mod logs;
pub mod samples;
pub mod texts;
