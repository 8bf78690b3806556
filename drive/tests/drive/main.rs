//! The tool's binary against a board that a script plays over TCP, and against the emulated board.

mod answers;
mod bring_up;
mod calibrate;
mod commands;
mod documented;
mod emulated;
mod ends;
mod failures;
mod identity;
mod player;
mod recording;
mod scripted;
mod supply;
mod turns;
