//! A spring with a damper, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::{Radians, SpringDamper};

scene_images::image!(SpringDamper = preset!(SpringDamper::new(Radians(0.1), 0.30, 0.001)));
