//! Off, alone.
#![no_std]

use haptic_control::Off;

scene_images::image!(Off = Off);
