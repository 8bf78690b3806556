//! Command line of the host simulation.
fn main() {}
