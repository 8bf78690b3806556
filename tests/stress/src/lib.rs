//! Stress test of the estimators: long courses of extreme motions, each tick computed in f32 by
//! `estimator-core` and in f64 by its generated twin.
//!
//! | module | content |
//! |---|---|
//! | [`course`] | counts, currents and edges: rest, top speed, ties, creep, jumps, wraps |
//! | [`pair`] | an estimator of the core beside its twin |
//! | [`tested`] | all pairs, with their bounds |
//! | [`trial`] | one estimator over one course |
//! | [`findings`] | results and bounds |
//! | [`parts`] | all estimators over long courses, in parts |
//! | [`experiment`] | a whole run as jobs that shards divide |
//! | [`designs`] | designs whose parameters can be refused |
//! | [`sensitivity`] | parameters at the limits of their ranges |
//! | [`signals`] | error by f32 on signals of a simulated device |
//! | [`definition`] | FOAW by its O(n²) definition, in exact fractions |
//! | [`table`] | the findings as text, and as cells of the measured tables |

pub mod course;
pub mod definition;
pub mod designs;
pub mod experiment;
pub mod findings;
pub mod pair;
mod pairs;
pub mod parts;
pub mod sensitivity;
mod settling;
pub mod signals;
pub mod table;
pub mod tested;
pub mod trial;
