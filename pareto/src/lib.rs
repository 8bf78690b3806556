//! Run time against error: every estimator and its peers over the same traces on the emulated
//! board, instructions counted, cycles estimated, sizes read from the image.

pub mod board;
pub mod bound;
pub mod cli;
pub mod control;
pub mod image;
pub mod measure;
mod peer_tuning;
pub mod plot;
pub mod table;
pub mod traces;
