//! The flash image, unmodified, on the virtual board in closed loop with the plant.

/// What `scene.rs` of the firmware needs to know of its board.
mod board {
    pub(crate) const RATE_HZ: u32 = 10_000;
}
/// The very file that decides what the image holds.
#[path = "../../../firmware/src/scene.rs"]
mod scene;

mod control;
mod faults;
mod image;
mod mirror;
mod recording;
