//! Run time against error.

pub mod board;
pub mod image;
mod thumb;
