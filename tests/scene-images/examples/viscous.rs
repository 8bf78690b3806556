//! A viscous field, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::Viscous;

scene_images::image!(Viscous = preset!(Viscous::new(0.001)));
