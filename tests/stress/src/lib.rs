//! Stress of the estimators: long, hostile courses, each tick computed in f32 by
//! `estimator-core` and in f64 by its generated twin.
//!
//! | module | what |
//! |---|---|
//! | [`course`] | what the encoders show: rest, top speed, ties, creep, jumps, wraps |
//! | [`pair`] | an estimator of the core beside its twin |
//! | [`contestants`] | all of them |
//! | [`trial`] | one estimator over one course |
//! | [`findings`] | what was found, and what it is held against |
//! | [`parts`] | all estimators over long courses, in parts |
//! | [`designs`] | estimators by parameters that may be refused |
//! | [`sensitivity`] | parameters at the ends of their ranges |
//! | [`signals`] | what f32 costs on signals that a device can give |
//! | [`definition`] | FOAW by its O(n²) definition, in exact fractions |
//! | [`table`] | the findings as text, and as cells of the measured tables |

pub mod contestants;
pub mod course;
pub mod definition;
pub mod designs;
pub mod findings;
pub mod pair;
mod pairs;
pub mod parts;
pub mod sensitivity;
mod settling;
pub mod signals;
pub mod table;
pub mod trial;
