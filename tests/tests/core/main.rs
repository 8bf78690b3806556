//! Object code of `estimator-core` and `haptic-control` for the board, and what both have
//! to agree in.
//!
//! | module | checks |
//! |---|---|
//! | `codegen` | functions of `estimator-core` |
//! | `control_docs` | figures and names of `haptic-control` in docs/ |
//! | `devices` | the default device, the same in every crate |
//! | `scene_docs` | tables of scenes in docs/ |
//! | `scene_images` | what one scene of `haptic-control` costs on the board |
//!
//! The tests of what `estimator-core` computes are in its own package.

mod codegen;
mod control_docs;
mod devices;
mod image;
mod scene_docs;
mod scene_images;
