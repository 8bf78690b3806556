//! Detents, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::Detents;

scene_images::image!(Detents = preset!(Detents::new(0.006, 24)));
