//! The tool's binary against a board that a script plays over TCP.

mod commands;
mod failures;
mod identity;
mod recording;
mod scripted;
