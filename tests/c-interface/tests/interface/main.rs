//! Tests of the interface for C. One binary: builds of libraries, compilers and the emulator run side by
//! side.

mod board;
mod examples;
mod header;
mod host;
mod libraries;
mod refused;
mod source;
