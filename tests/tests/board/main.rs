//! The flash image, unmodified, on the virtual board in closed loop with the plant.

/// What the firmware's control needs to know of its board.
mod board {
    pub(crate) const RATE_HZ: u32 = 10_000;
}

/// What the firmware's control says of a tick.
mod telemetry {
    use estimator_core::Sample;
    use haptic_control::Action;

    #[derive(Clone, Copy)]
    pub(crate) struct Record {
        pub(crate) tick: u32,
        pub(crate) sample: Sample,
        pub(crate) action: Action,
        pub(crate) state: u8,
        pub(crate) cause: u8,
        #[allow(dead_code, reason = "the firmware's")]
        pub(crate) overruns: u32,
        pub(crate) estimation: crate::scene::Estimation,
        #[allow(dead_code, reason = "the firmware's")]
        pub(crate) learned: crate::scene::Learned,
    }
}

/// The very files that the image's control task is made of.
#[path = "../../../firmware/src"]
#[allow(
    dead_code,
    unexpected_cfgs,
    unused_imports,
    reason = "features are the firmware's"
)]
mod firmware {
    pub(crate) mod control;
    pub(crate) mod scene;
}
// The names that these files know each other by.
use firmware::scene;

mod choice;
mod cost;
mod edges;
mod faults;
mod golden;
mod healthy;
mod identify;
mod image;
mod learned;
mod mirror;
mod record;
mod recording;
mod reference;
mod scores;
mod size;
