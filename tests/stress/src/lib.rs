//! Stress of the estimators: long, hostile courses, each tick computed in f32 by
//! `estimator-core` and in f64 by its generated twin.
//!
//! | module | what |
//! |---|---|
//! | [`course`] | what the encoders show: rest, top speed, ties, creep, jumps, wraps |
//! | [`pair`] | an estimator of the core beside its twin |
//! | [`contestants`] | all of them |
//! | [`trial`] | one estimator over one course, and what was found |
//! | [`sensitivity`] | parameters at the ends of their ranges |
//! | [`definition`] | FOAW by its O(n²) definition, in exact fractions |
//! | [`table`] | the findings as text, markdown and JSON |

pub mod contestants;
pub mod course;
pub mod definition;
pub mod pair;
pub mod sensitivity;
pub mod table;
pub mod trial;
