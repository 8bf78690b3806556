//! Nothing but the features that members of the workspace turn on in crates that all of them use.
//!
//! Cargo compiles a crate once for each set of features, and takes the features of the packages that a
//! command names. Without this crate `cargo run`, `cargo test`, `cargo sim` and `cargo scope` each compiled
//! most of host-sim anew. It stands below all programs (`terminal` depends on it), so that each command
//! has all of these features; they add one small crate to a build.
//!
//! `tests/one_build.rs` names the crate and the features that are missing here.
