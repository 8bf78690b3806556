//! A hold, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::Hold;

scene_images::image!(Hold = preset!(Hold::new(0.30, 0.001)));
