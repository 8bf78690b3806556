//! The firmware without its hardware: what the control task computes, the scenes, the commands and
//! the telemetry frames. The crate has no I/O, so the host runs the same code in tests.
#![no_std]

pub mod ammeter;
pub mod commands;
pub mod config;
pub mod control;
pub mod index;
pub mod large;
pub mod port;
pub mod reports;
pub mod rest;
pub mod scene;
pub mod schedule;
pub mod supply;
pub mod telemetry;
