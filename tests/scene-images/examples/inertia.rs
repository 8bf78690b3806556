//! A virtual inertia, alone.
#![no_std]

use estimator_core::preset;
use haptic_control::{DualStage, Inertia};

scene_images::image!(
    Inertia = preset!(Inertia::new(-2e-6, DualStage::DEFAULT.small.inertia as f32))
);
