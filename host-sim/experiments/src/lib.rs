//! The experiments that the commands run: comparison of estimators, closed loop, robustness,
//! what the hand feels, stiffness limits, wrong parameters, tuning, identification, replay of recordings, and recordings of
//! real devices with a known velocity.

pub mod closed_loop;
pub mod compare;
pub mod designed;
pub mod distinct;
pub mod feel;
pub mod identify;
pub mod limit;
mod parallel;
pub mod rates;
pub mod real;
pub mod recommend;
pub mod reference;
pub mod replay;
pub mod robust;
pub mod rows;
pub mod sensitivity;
pub mod simulated;
pub mod table;
pub mod transparency;
pub mod tune;
pub mod uneven;
pub mod zwidth;
