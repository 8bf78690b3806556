//! Commands a board over its link, and shows and records its telemetry.
//!
//! The messages are those of `drivers::link`; the commands those of `drivers::Command`. A board that
//! speaks another protocol can be identified and disarmed, and gets no other command.

mod board;
mod bring_up;
mod calibrate;
mod channels;
mod check;
pub mod cli;
mod clock;
mod currents;
mod follow;
pub mod guided;
mod identity;
mod interrupt;
pub mod named;
mod pace;
pub mod patience;
pub mod port;
mod questions;
mod record;
pub mod refusal;
mod response;
mod sent;
mod session;
pub mod settings;
pub mod starts;
mod strokes;
mod supply;
mod timed;
mod turns;
mod watch;
