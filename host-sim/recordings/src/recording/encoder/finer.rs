//! Positions that change by less than a count of the encoder that is stated or assumed.

use device_files::to_digits;

use super::Encoder;
use super::stepped::power_of_ten;
use crate::recording::ReadOptions;
use crate::recording::numbers::shown;

/// Largest share of the changes of the positions at which the count changes too.
const SHARE: f64 = 0.5;

/// Positions that change in more rows than their counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Finer {
    /// Number of rows in which the position changes.
    pub changes: usize,
    /// What the counts per revolution are, and how others are given.
    pub remedy: String,
}

impl Encoder {
    /// What is said of an angle of the encoder with the index `motor` that changes in many more rows than its count.
    pub(in crate::recording) fn finer(&self, motor: usize, options: &ReadOptions) -> Option<Finer> {
        let (counts_per_unit, _) = self.unit.filter(|_| !self.is_counts)?;
        let changes = self.grid.changes();
        if self.changes as f64 > SHARE * changes as f64 {
            return None;
        }
        let per_rev = options.counts_per_rev[motor];
        let given = &options.counts_given[motor];
        let assumed = match per_rev == ReadOptions::default().counts_per_rev[motor] {
            true => ", as is assumed where no number is given",
            false => "",
        };
        // A decimal digit of the log is no step of an encoder.
        let step = self.grid.step();
        let step = step.filter(|step| power_of_ten(step / counts_per_unit).is_none());
        let step = step.filter(|step| *step > self.float_step);
        let counts = match step {
            Some(step) => self.by_counts(step, per_rev, given),
            None => {
                let finest = f64::from(per_rev) / self.grid.least()?;
                let finest = shown(to_digits(finest, 3));
                format!(
                    "give the counts of the encoder {given}; the smallest change is 1/{finest} revolution"
                )
            }
        };
        let remedy = format!(
            "the positions change at {changes} rows, most of them by less than a count with {per_rev} counts/rev{assumed}; \
             {counts}"
        );
        Some(Finer { changes, remedy })
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{Finer, read_log};

    /// What is said of a swing of 1 kHz and `amplitude`, in `unit`, whose positions are multiples of `step`.
    fn finer(unit: &str, amplitude: f64, step: f64) -> Option<Finer> {
        let row = |k: u32| {
            let t = 1e-3 * f64::from(k);
            let position = (amplitude * (20.0 * t).sin() / step).floor() * step;
            format!("{t:.3},{position:.9}\n")
        };
        let text = format!("t,counts_large\n{}", (0..1000).map(row).collect::<String>());
        let recording = read_log(&text, &format!("counts_large=counts_large:{unit}"));
        recording.unwrap().finer
    }

    #[test]
    fn motion_within_a_count_is_told_with_the_counts_of_the_log() {
        // A count of 4096 is 0.088 degrees.
        let said = finer("deg", 0.03, 360.0 / 1_048_576.0).unwrap().remedy;
        let begin = "most of them by less than a count with 4096 counts/rev, as is assumed where no number is given; they \
                     are multiples of 1/1048576 revolution: if these are the encoder's counts, give 1048576 counts/rev \
                     with --counts-per-rev";
        assert!(said.contains(begin), "{said}");
        // The last digit of the log is no step of an encoder.
        let said = finer("rad", 3e-4, 1e-7).unwrap().remedy;
        let end = "; give the counts of the encoder with --counts-per-rev, or as large.counts_per_rev in the file of \
                   --device; the smallest change is 1/62800000 revolution";
        assert!(said.ends_with(end), "{said}");
    }

    #[test]
    fn motion_over_counts_and_counts_themselves_are_not_told() {
        assert_eq!(finer("deg", 300.0, 360.0 / 4096.0), None);
        assert_eq!(finer("deg", 0.0, 1.0), None);
        assert_eq!(finer("counts", 1.0, 1.0), None);
        assert_eq!(finer("rev", 3.0, 1.0 / 90.0), None);
    }
}
