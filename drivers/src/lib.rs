//! Drivers of the controller board, over the traits of embedded-hal 1.0 where they exist.
#![no_std]

mod amplifier;
mod command;
mod dac_code;
mod pwm;
mod telemetry;

pub use amplifier::{Amplifier, CurrentOutput};
pub use command::{Command, Parser, encode};
pub use dac_code::DacCode;
pub use pwm::PwmCurrent;
