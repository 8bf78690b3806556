//! The firmware without its hardware, against its documentation in docs/telemetry.md and
//! docs/board.md. Tests hold for every combination of features unless they say otherwise.

mod ammeter;
mod bench;
mod commands;
mod control;
mod index;
mod large;
mod port;
mod rest;
mod scenes;
mod settings;
mod supply;
mod telemetry;
