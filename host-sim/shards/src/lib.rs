//! Experiments in shards: several processes, on one machine or on several, run a part of the jobs
//! each and write a file; the merged files give the rows of a single run.
//!
//! | module | content |
//! |---|---|
//! | [`part`] | part K of N, and its jobs |
//! | [`mod@file`] | the file of a part: heading, one row a line, checksum |
//! | [`merge`] | the files of all parts, checked, as the rows of a single run |
//! | [`exact`] | floats that are not finite, in JSON |

pub mod exact;
pub mod file;
pub mod merge;
pub mod part;

use serde::Serialize;
use serde::de::DeserializeOwned;
use terminal::failure::Failure;

pub use merge::Shards;
pub use part::Part;

/// The settings of an experiment whose jobs do not depend on each other. The rows depend on the
/// settings alone, not on the machine, the order or the number of the jobs in a call.
pub trait Experiment: Serialize + DeserializeOwned {
    /// Program and command, for example `host-sim robust`.
    const COMMAND: &'static str;
    /// Number of calls of `done` for each job.
    const STEPS_A_JOB: usize = 1;
    /// The unit that is run as a whole.
    type Job: Clone;
    /// Result of one job. Its JSON is read back to the same value.
    type Row: Serialize + DeserializeOwned;

    /// All jobs in the order of the rows.
    ///
    /// # Errors
    /// [`Failure::Input`] that names an invalid setting.
    fn jobs(&self) -> Result<Vec<Self::Job>, Failure>;

    /// Runs these jobs and returns one row for each, in their order.
    ///
    /// # Errors
    /// [`Failure::Input`] of a job that cannot be run.
    fn rows(&self, jobs: &[Self::Job], done: &(dyn Fn() + Sync))
    -> Result<Vec<Self::Row>, Failure>;
}
