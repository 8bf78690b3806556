//! A wall, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::{Radians, Wall};

scene_images::image!(Wall = preset!(Wall::new(Radians(0.1), 0.30, 0.001)));
