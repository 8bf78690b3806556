//! Numerics that cannot break: short runs of the stress courses and of the fuzz bodies.

mod fuzz;
mod invariants;
mod lists;
mod stress;
mod traces;
