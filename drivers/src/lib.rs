//! Drivers of the controller board, over the traits of embedded-hal 1.0 where they exist.
#![no_std]

mod adc_scale;
mod amplifier;
mod command;
mod dac_code;
mod divider;
pub mod link;
mod pwm;
mod settings;
mod store;
mod telemetry;

pub use adc_scale::AdcScale;
pub use amplifier::{Amplifier, Amplifiers, CurrentOutput, Enables};
pub use command::{Command, Parser, encode};
pub use dac_code::{DacCode, DacScale, FULL_SCALES, REACHES};
pub use divider::Divider;
pub use pwm::PwmCurrent;
pub use settings::{SETTINGS_BYTES, Saved, Setting, SettingFacts, Settings, SettingsError};
pub use store::{SaveError, Store};
pub use telemetry::NO_ESTIMATOR;
