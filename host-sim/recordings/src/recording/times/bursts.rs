//! Rows whose times come in bursts: a computer has stamped the rows of a packet as they arrived.

use device_files::to_digits;
use terminal::failure::Failure;

use super::mean_rate;
use super::steps::{Steps, differs};
use crate::recording::numbers::shown;

/// Least length of a pause between two bursts, in mean steps. Rows that come at random have a quarter of their time
/// in longer steps, which differ.
const PAUSE: f64 = 1.5;

/// Least part of the time that the pauses take.
const PAUSED: f64 = 0.75;

/// Least part of the steps that are pauses. A log of a few parts has fewer.
const PAUSES: f64 = 0.01;

/// Largest relative difference of a pause from the mean one, and least part of them that is within it.
const ALIKE: f64 = 0.3;
const MOST_ALIKE: f64 = 0.9;

/// Least part of the pauses that come behind a far shorter step. In a log of two rates the long steps are together.
const BEHIND_SHORT: f64 = 0.75;

impl Steps {
    /// Checks that the rows do not come in bursts, of which no rate follows. `repeated` is the number of rows that have the
    /// time of the row before, and no step.
    ///
    /// # Errors
    /// [`Failure::Input`] with the mean rate.
    pub(crate) fn check_bursts(&self, repeated: usize, name: &str) -> Result<(), Failure> {
        let sum = |steps: &mut dyn Iterator<Item = (f64, u64)>| {
            let add = |(time, number), (length, more)| (time + length * more as f64, number + more);
            steps.fold((0.0, 0), add)
        };
        let (duration, number) = sum(&mut self.lengths());
        let steps = number + repeated as u64;
        let mean = duration / steps as f64;
        let is_pause = |(length, _): &(f64, u64)| *length > PAUSE * mean;
        let (paused, pauses) = sum(&mut self.lengths().filter(is_pause));
        let pause = paused / pauses as f64;
        let is_alike = |(length, _): &(f64, u64)| differs(*length, pause) < ALIKE;
        let (_, alike) = sum(&mut self.lengths().filter(is_pause).filter(is_alike));
        let are_bursts = paused > PAUSED * duration
            && pauses as f64 > PAUSES * steps as f64
            && self.rises as f64 > BEHIND_SHORT * pauses as f64
            && alike as f64 > MOST_ALIKE * pauses as f64;
        match mean_rate(steps, duration).filter(|_| are_bursts) {
            None => Ok(()),
            Some(hz) => Err(Failure::Input(format!(
                "{name}: column t: the rows come in bursts, about {:.0} rows each {} ms, as a computer receives \
                 packets: if they were measured at an even rate, give their mean rate with --row-rate {hz}; if t is \
                 exact, add --resample {hz}",
                steps as f64 / pauses as f64,
                shown(to_digits(1e3 * duration / pauses as f64, 3))
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::Recording;
    use simulation::trace::Trace;

    /// Rows of 1 kHz that arrive `each` at a time, 40 us apart.
    fn bursts(each: u32, rows: u32) -> Vec<f64> {
        let time = |k: u32| f64::from(k / each * each) * 1e-3 + f64::from(k % each) * 4e-5;
        (0..rows).map(time).collect()
    }

    fn refused(t: &[f64], repeated: usize) -> Option<String> {
        let trace = Trace {
            counts_large: vec![0; t.len()],
            ..Trace::default()
        };
        let mut rows = Recording::of_columns(t.to_vec(), trace, "r.csv").unwrap();
        rows.repeated_rows = repeated;
        let error = rows.check_times("r.csv").err()?.to_string();
        error.contains("bursts").then_some(error)
    }

    #[test]
    fn rows_in_bursts_are_refused_with_the_mean_rate() {
        for each in [2, 4, 16, 64] {
            let error = refused(&bursts(each, 64_001), 0).unwrap();
            let said = format!(
                "r.csv: column t: the rows come in bursts, about {each} rows each {each} ms"
            );
            assert!(error.starts_with(&said), "{error}");
            assert!(error.contains("with --row-rate 1000; if"), "{error}");
        }
        // Rows that have no step count for the rate.
        let mut t = bursts(16, 8001);
        let all = t.len();
        let mut k = 0;
        t.retain(|_| {
            k += 1;
            k % 16 != 5
        });
        let error = refused(&t, all - t.len()).unwrap();
        assert!(error.contains("with --row-rate 1000; if"), "{error}");
    }

    #[test]
    fn other_uneven_rows_are_no_bursts() {
        let even: Vec<_> = (0..5000).map(|k| f64::from(k) * 1e-3).collect();
        assert_eq!(refused(&even, 0), None);
        // Pauses between the parts of a log, and rows of two rates.
        let parts: Vec<_> = (0..5000)
            .map(|k| f64::from(k) * 1e-3 + f64::from(k / 500) * 20.0)
            .collect();
        assert_eq!(refused(&parts, 0), None);
        let two: Vec<_> = (0..5000)
            .map(|k| f64::from(k) * 1e-3 + f64::from(k.max(2500) - 2500) * 5e-3)
            .collect();
        assert_eq!(refused(&two, 0), None);
        // Rows at the changes of a count alone: a swing, whose ends take long.
        let mut last = 0.0;
        let swing = (0..50_000).map(|k| f64::from(k) * 1e-4);
        let changes: Vec<_> = swing
            .filter(|t| {
                let count = (300.0 * (3.0 * t).sin()).floor();
                std::mem::replace(&mut last, count) != count
            })
            .collect();
        assert_eq!(refused(&changes, 0), None);
        // Groups of rows with pauses of different lengths, as of a log that events begin.
        let groups: Vec<_> = (0..4800)
            .map(|k| {
                let group = k / 16;
                f64::from(group / 2) * 48e-3
                    + f64::from(group % 2) * 8e-3
                    + f64::from(k % 16) * 4e-5
            })
            .collect();
        assert_eq!(refused(&groups, 0), None);
        // Rows at random.
        let (mut noise, mut t) = (1_u32, 0.0);
        let random: Vec<_> = (0..5000)
            .map(|_| {
                noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                t -= 1e-3 * (f64::from(noise) / f64::from(u32::MAX)).max(1e-9).ln();
                t
            })
            .collect();
        assert_eq!(refused(&random, 0), None);
    }
}
