//! Free air, alone.
#![no_std]

use haptic_control::FreeAir;

scene_images::image!(FreeAir = FreeAir);
