//! A closed-loop run as a recording.

use super::Loop;
use recordings::recording::Recording;
use simulation::trace::Trace;

impl Loop {
    /// Runs for `ticks` and records every `every`-th tick as telemetry does: counts at the tick,
    /// currents from the tick on, and true values.
    ///
    /// # Errors
    /// As [`Loop::run`].
    pub fn record(&self, ticks: usize, every: usize) -> Result<Recording, String> {
        let rows = ticks.div_ceil(every);
        let mut recording = Recording {
            t: Vec::with_capacity(rows),
            trace: Trace {
                rate_hz: self.rate_hz / every as f64,
                ..Trace::default()
            },
            ..Recording::default()
        };
        let column = || Vec::with_capacity(rows);
        let (mut small, mut large_a, mut small_a, mut omega) =
            (Vec::with_capacity(rows), column(), column(), column());
        let mut k = 0;
        self.run(ticks, |moment| {
            if k % every == 0 {
                recording.t.push(k as f64 / self.rate_hz);
                recording.trace.counts_large.push(moment.sample.count.0);
                small.push(moment.sample.coupled.0);
                large_a.push(moment.commanded.0);
                small_a.push(moment.commanded.1);
                omega.push(moment.large.omega);
            }
            k += 1;
        })?;
        recording.trace.counts_small = Some(small);
        recording.trace.current = Some(large_a);
        recording.trace.true_omega = Some(omega);
        recording.current_small = Some(small_a);
        Ok(recording)
    }
}
