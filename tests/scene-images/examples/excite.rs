//! The excitation, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::{DualStage, Excite};
use scene_images::RATE;

scene_images::image!(Excite = preset!(Excite::new(&DualStage::DEFAULT, RATE)));
