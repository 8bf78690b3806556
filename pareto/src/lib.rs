//! Run time against error: every estimator and its peers over the same traces on the emulated
//! board, instructions counted, cycles estimated, sizes read from the image.

pub mod board;
pub mod bound;
mod cycles;
mod flow;
pub mod image;
pub mod measure;
pub mod plot;
pub mod table;
mod thumb;
pub mod traces;
