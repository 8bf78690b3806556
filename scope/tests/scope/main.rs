//! Tests of the server and its page, with the flash image behind them. One binary: most of them wait
//! for times that are real, and run side by side.

mod bench;
mod browser;
mod common;
mod measured;
mod server;
