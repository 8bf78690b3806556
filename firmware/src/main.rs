//! The firmware of the controller board: an RTIC application.
#![no_std]
#![no_main]

mod boards;
mod link;
mod log;
mod tasks;
