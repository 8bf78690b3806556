//! What the compiler makes of `estimator-core` and `haptic-control` for the board.
//!
//! | module | checks |
//! |---|---|
//! | `codegen` | functions of `estimator-core` |
//! | `scene_images` | what one scene of `haptic-control` costs on the board |
//!
//! The tests of what `estimator-core` computes are in its own package.

mod codegen;
mod image;
mod scene_images;
