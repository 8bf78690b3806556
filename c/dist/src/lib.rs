//! What users of C and C++ take: the header `limpid.h`, a static library per target, the same as one file of C
//! for processors without a target, and a library folder for Arduino.

mod arduino;
pub mod cli;
mod header;
mod libraries;
mod translation;

pub use arduino::{arduino, milliseconds};
pub use header::header;
pub use libraries::{BOARDS, Build, COMPUTER, build, libraries, source};
