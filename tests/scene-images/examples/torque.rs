//! A torque set-point, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::Torque;

scene_images::image!(Torque = preset!(Torque::new(0.01)));
