//! Velocity algorithms of other projects, as comparators for recordings of real devices and for the
//! instructions of an update.
//!
//! Each one is written anew from a description of the algorithm: difference equation, constants, limits.
//! No code of a project is here, and no comparator is an estimator of this project. The pages
//! `docs/evidence` name the lines of each project that were described.
//!
//! | comparator | project | velocity |
//! |---|---|---|
//! | [`Moteus`] | moteus | integral of a critically damped tracking loop |
//! | [`ODrive`] | ODrive | tracking loop whose phase detector counts whole counts, with a dead band |
//! | [`VescPll`] | VESC | tracking loop with two separate poles, limited by [`VescFast`] |
//! | [`VescFast`] | VESC | low-pass over the finite difference |
//! | [`SimpleFocSensor`] | SimpleFOC | counts over the time since the count changed, then a low-pass |
//! | [`SimpleFocEncoder`] | SimpleFOC | counts over the time between edges, then a low-pass |
//! | [`OpenFfBoard`] | OpenFFBoard | biquad low-pass over the finite difference |
//! | [`Dvrk`] | dVRK | four counts over the time of four edges, with the acceleration of five |
//!
//! All of them compute with integers and f32 `+ - * /`. Positions are relative to the newest count, so
//! that f32 suffices for any number of revolutions.
#![no_std]

mod dvrk;
mod moteus;
mod odrive;
mod openffboard;
mod simplefoc;
mod vesc;

pub use dvrk::{Dvrk, DvrkState};
pub use moteus::{Moteus, MoteusState};
pub use odrive::{ODrive, ODriveState};
pub use openffboard::{OpenFfBoard, OpenFfBoardState};
pub use simplefoc::{
    SimpleFocEncoder, SimpleFocEncoderState, SimpleFocSensor, SimpleFocSensorState,
};
pub use vesc::{VescFast, VescFastState, VescPll, VescPllState};

/// `x` within `-most` and `most`.
#[inline(always)]
fn limited(x: f32, most: f32) -> f32 {
    if x > most {
        most
    } else if x < -most {
        -most
    } else {
        x
    }
}
