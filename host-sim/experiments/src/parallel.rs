//! Jobs that run in parallel, with results and errors in their order.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

/// The results of all jobs, in their order. A job after one that failed may not run.
///
/// # Errors
/// That of the first job, in order, that failed. It does not depend on the number of threads.
pub(crate) fn in_order<'j, J: Sync, R: Send, E: Send>(
    jobs: &'j [J],
    run: impl Fn(&'j J) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let failed = AtomicUsize::new(usize::MAX);
    let ran: Vec<Option<Result<R, E>>> = (jobs.par_iter().enumerate())
        .map(|(i, job)| {
            if failed.load(Ordering::Relaxed) < i {
                return None;
            }
            let result = run(job);
            if result.is_err() {
                failed.fetch_min(i, Ordering::Relaxed);
            }
            Some(result)
        })
        .collect();
    // The job that another one was left out for comes before it.
    ran.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::in_order;

    #[test]
    fn error_is_that_of_the_first_job_that_fails() {
        let jobs: Vec<u64> = (0..64).collect();
        // Of two threads the one with the later jobs is the first to fail.
        let run = |&job: &u64| {
            std::thread::sleep(Duration::from_micros(if job < 32 { 500 } else { 0 }));
            if job >= 20 { Err(job) } else { Ok(job) }
        };
        let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build();
        let failed = threads.unwrap().install(|| in_order(&jobs, run));
        assert_eq!(failed, Err(20));
    }

    #[test]
    fn results_have_the_order_of_the_jobs() {
        let jobs: Vec<u64> = (0..100).collect();
        let run = |&job: &u64| Ok::<_, ()>(job);
        assert_eq!(in_order(&jobs, run), Ok(jobs.clone()));
    }
}
