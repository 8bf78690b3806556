//! A texture, alone.
#![no_std]

use estimator_core::{Hertz, preset};
use haptic_control::Texture;
use scene_images::RATE;

scene_images::image!(Texture = preset!(Texture::new(0.006, Hertz(150.0), RATE)));
