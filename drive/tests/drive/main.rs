//! The tool's binary against a board that a script plays over TCP.

mod calibrate;
mod commands;
mod ends;
mod failures;
mod identity;
mod player;
mod recording;
mod scripted;
mod supply;
mod turns;
