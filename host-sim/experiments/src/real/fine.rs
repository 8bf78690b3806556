//! Recordings of a fine encoder.

use recordings::log::Log;
use recordings::recording::{ReadOptions, Recording};
use terminal::failure::Failure;

/// Position of a shaft as a fine encoder saw it. Times need not be even.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fine {
    /// Time of each row from the first one, s, rising: a time since 1970 has too few digits for edges.
    pub t: Vec<f64>,
    /// Counts of the fine encoder, without the steps of a counter of 32 bits.
    pub counts: Vec<i64>,
    /// Current of the motor from a row to the next one, A, if it is known.
    pub current: Option<Vec<f64>>,
    /// True velocity at each row, rad/s, if it is known.
    pub omega: Option<Vec<f64>>,
    /// Notes of the reader, one line each.
    pub notes: Vec<String>,
    /// Notes on counts that wrap at fewer than 32 bits, one line each.
    pub unwrapped: Vec<String>,
}

impl Fine {
    /// Reads the first `seconds` of `log`, whose encoder is the large motor's of `options`.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn read(log: &Log, options: &ReadOptions, seconds: f64) -> Result<Self, Failure> {
        let mut recording = Recording::parse_first(log.reader()?, log.name(), options, seconds)?;
        recording.check_times(log.name())?;
        let unwrapped = recording.unwrap_counts(options);
        Ok(Self {
            unwrapped,
            ..Self::from(recording)
        })
    }

    /// Mean rate of the rows, Hz.
    #[must_use]
    pub(crate) fn mean_rate_hz(&self) -> f64 {
        let last = self.t.len() - 1;
        last as f64 / (self.t[last] - self.t[0])
    }
}

impl From<Recording> for Fine {
    fn from(recording: Recording) -> Self {
        let Recording {
            mut t,
            trace,
            notes,
            ..
        } = recording;
        let start = t.first().copied().unwrap_or_default();
        t.iter_mut().for_each(|t| *t -= start);
        let mut position: Option<i64> = None;
        let counts = trace.counts_large.iter().map(|&count| {
            // A counter of 32 bits wraps.
            let at = position.map_or(i64::from(count as i32), |last| {
                last + i64::from(count.wrapping_sub(last as u32) as i32)
            });
            position = Some(at);
            at
        });
        Self {
            counts: counts.collect(),
            t,
            current: trace.current,
            omega: trace.true_omega,
            notes,
            unwrapped: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, seconds: f64) -> Fine {
        let options = ReadOptions::default();
        let recording = Recording::parse_first(text.as_bytes(), "f.csv", &options, seconds);
        recording.expect("a recording").into()
    }

    #[test]
    fn times_are_those_from_the_first_row() {
        let text =
            "t,fine_count\n1700000000,1\n1700000000.0625,2\n1700000000.125,3\n1700000000.1875,4\n";
        let fine = parse(text, 0.125);
        assert_eq!(fine.t, [0.0, 0.0625, 0.125]);
        assert_eq!(fine.counts, [1, 2, 3]);
        assert_eq!((fine.current, fine.omega), (None, None));
    }

    #[test]
    fn counter_of_32_bits_goes_on_where_it_wraps() {
        let text =
            "t,counts_large\n0,-6\n0.05,2\n0.1,4294967295\n0.15,2147483640\n0.2,-2147483640\n";
        let counts = parse(text, 9.0).counts;
        assert_eq!(counts, [-6, 2, -1, (1 << 31) - 8, (1 << 31) + 8]);
    }
}
