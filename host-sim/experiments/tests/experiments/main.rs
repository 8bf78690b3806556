//! Tests of experiments as their callers see them. One binary: what they share is compiled and linked
//! once, and the slow ones run side by side.

mod another_device;
mod attribution;
mod beyond;
mod bounds;
mod closed_loop;
mod confidence;
mod encoder_faults;
mod identify;
mod identify_encoders;
mod loops;
mod reference;
mod scaled_presets;
