//! Counts of an encoder while its column is read.

use estimator_core::Count;
use terminal::failure::Failure;

use super::layout::Place;
use super::numbers::shown;
use super::options::{Column, ReadOptions};
use super::row::Row;
use super::units::Scale;

/// Distance from a whole count from which positions are reported as rounded.
const ROUNDED: f64 = 0.25;

/// Number of changes between 0 and 1 from which a column may be one line of an encoder. Fewer are those of a
/// shaft that is hardly turned.
const LINE: usize = 10;

/// Counts of an encoder.
#[derive(Default)]
pub(super) struct Encoder {
    pub(super) counts: Vec<u32>,
    /// The count of the latest row.
    pub(super) last: Option<u32>,
    /// The reading of the latest row: counts before they are unwrapped.
    pub(super) raw: i64,
    /// Largest distance of a position from a whole count.
    rounded: f64,
    /// Number of rows whose reading differs from the row before.
    changes: usize,
    /// Whether a reading was neither 0 nor 1.
    has_counts: bool,
}

impl Encoder {
    /// Adds the count of a row.
    pub(super) fn take(
        &mut self,
        row: &Row,
        at: Place,
        options: &ReadOptions,
        motor: usize,
    ) -> Result<(), Failure> {
        let column = at.column.name();
        let raw = match at.unit.scale {
            Scale::PerRev(per_rev) => {
                let position = row.number(column, at.place)?;
                let exact = position * f64::from(options.counts_per_rev[motor]) / per_rev;
                if exact.abs() > 9e15 {
                    let position = shown(position);
                    return Err(row.failure(
                        column,
                        &format!("{position} is too large; correct the field, or remove the row"),
                    ));
                }
                let whole = (exact + 0.5).floor();
                self.rounded = self.rounded.max((exact - whole).abs());
                whole as i64
            }
            _ => row.count(column, at.place)?,
        };
        self.changes += usize::from(self.last.is_some() && raw != self.raw);
        self.has_counts |= !(0..=1).contains(&raw);
        self.raw = raw;
        let count = match options.modulus[motor] {
            None => raw as u32,
            Some(modulus) => {
                let within = -i64::from(modulus) <= raw && raw < i64::from(modulus);
                let reading = raw.rem_euclid(i64::from(modulus)) as u32;
                let last = self.last.unwrap_or(reading);
                let next = Count(last).wrapped(reading, modulus);
                let refused = |why: &str| {
                    row.failure(column, &format!("{raw} with --modulus {modulus}: {why}"))
                };
                if !within {
                    return Err(refused("raw must be below modulus"));
                }
                next.map_err(|error| refused(error.message()))?.0
            }
        };
        self.last = Some(count);
        self.counts.push(count);
        Ok(())
    }

    /// Notes on positions that are far from whole counts, and on a column that may hold no counts.
    /// `motor` is the index of the encoder.
    pub(super) fn notes(
        &self,
        motor: usize,
        options: &ReadOptions,
    ) -> impl Iterator<Item = String> {
        let column = Column::COUNTS[motor].name();
        let rounded = (self.rounded > ROUNDED).then(|| {
            format!(
                "{column}: positions are up to {:.2} counts from a whole count with {} counts/rev and are rounded to \
                 the nearest; if the encoder has more counts, give them {}",
                self.rounded,
                options.counts_per_rev[motor],
                options.counts_given[motor]
            )
        });
        let line = (!self.has_counts && self.changes >= LINE).then(|| {
            format!(
                "{column} is 0 or 1 in all rows, and changes {} times: if it is one line of a quadrature encoder, \
                 count the edges of both lines with host-sim decode",
                self.changes
            )
        });
        rounded.into_iter().chain(line)
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{ReadOptions, Recording};

    /// Rows of time, motor and handle, with columns and modulus as on the command line. The default
    /// device has 4096 counts per revolution on the motor and 20000 on the handle.
    fn read(rows: &[(&str, &str)], columns: &str, modulus: &[&str]) -> Result<Recording, String> {
        let mut options = ReadOptions::default();
        if !columns.is_empty() {
            options.add_columns(columns).unwrap();
        }
        for text in modulus {
            options.set_modulus(text).unwrap();
        }
        let mut text = "t,counts_large,counts_small\n".to_owned();
        for (k, (large, small)) in rows.iter().enumerate() {
            text += &format!("{},{large},{small}\n", k as f64 / 1000.0);
        }
        let read = Recording::parse_as(text.as_bytes(), "r.csv", &options);
        read.map_err(|error| error.to_string())
    }

    fn counts(of: &[u32]) -> Vec<i32> {
        of.iter().map(|&count| count as i32).collect()
    }

    /// A whole turn of 4096 counts is 360 degrees; halves are rounded up.
    #[test]
    fn angles_are_counts_to_the_nearest() {
        let degrees = "counts_large=counts_large:deg,counts_small=counts_small:rev";
        let rows = [("0", "0"), ("90", "0.5"), ("-90", "-2"), ("45.0219", "1")];
        let recording = read(&rows, degrees, &[]).unwrap();
        // 45.0219 degrees are 512.2492 counts.
        let large = counts(&recording.trace.counts_large);
        assert_eq!(large, [0, 1024, -1024, 512]);
        let small = counts(recording.trace.counts_small.as_ref().unwrap());
        assert_eq!(small, [0, 10_000, -40_000, 20_000]);
        let rounded = |recording: &Recording| {
            let said = recording.notes.iter();
            said.filter(|note| note.contains("are rounded to the nearest"))
                .count()
        };
        assert_eq!(rounded(&recording), 0, "{:?}", recording.notes);
        // A quarter of a turn and half a count.
        let halves = [("90.0439453125", "0"), ("-90.0439453125", "0")];
        let recording = read(&halves, degrees, &[]).unwrap();
        assert_eq!(counts(&recording.trace.counts_large), [1025, -1024]);
        // 45.0221 degrees are 512.2514 counts: more than a quarter off.
        let rows = [("0", "0"), ("45.0221", "0.5")];
        assert_eq!(rounded(&read(&rows, degrees, &[]).unwrap()), 1);
        // 45.03 degrees are 512.3413 counts.
        let rows = [("0", "0"), ("45.03", "0.5")];
        let recording = read(&rows, degrees, &[]).unwrap();
        assert_eq!(rounded(&recording), 1);
        let note =
            "counts_large: positions are up to 0.34 counts from a whole count with 4096 counts/rev";
        assert!(
            recording.notes.iter().any(|n| n.starts_with(note)),
            "{:?}",
            recording.notes
        );
    }

    #[test]
    fn angles_beyond_any_count_are_refused() {
        let turns = "counts_large=counts_large:rev";
        // 9e15 counts are 2.1973e12 turns.
        assert!(read(&[("0", "0"), ("2.197e12", "0")], turns, &[]).is_ok());
        let error = read(&[("0", "0"), ("-2.198e12", "0")], turns, &[]).unwrap_err();
        for part in ["r.csv: line 3: column counts_large: ", "is too large"] {
            assert!(error.contains(part), "{error}");
        }
    }

    /// Both encoders wrap at their own modulus, in both directions, and a counter may count from its
    /// modulus down to 0 below zero.
    #[test]
    fn readings_are_unwrapped_at_the_modulus() {
        let both = ["1000", "counts_small=360"];
        let rows = [("990", "5"), ("998", "1"), ("6", "357"), ("-990", "-1")];
        let recording = read(&rows, "", &both).unwrap();
        let large = counts(&recording.trace.counts_large);
        assert_eq!(large, [990, 998, 1006, 1010]);
        let small = counts(recording.trace.counts_small.as_ref().unwrap());
        assert_eq!(small, [5, 1, -3, -1]);
        assert!(read(&[("-1000", "0"), ("999", "0")], "", &both).is_ok());
        for reading in ["1000", "-1001"] {
            let error = read(&[("0", "0"), (reading, "0")], "", &both).unwrap_err();
            for part in [
                "r.csv: line 3: column counts_large: ",
                reading,
                "with --modulus 1000: raw must be below modulus",
            ] {
                assert!(error.contains(part), "{error}");
            }
        }
    }

    #[test]
    fn column_that_may_be_a_line_of_an_encoder_is_reported() {
        let row = |k: usize, large: [&'static str; 2], small: [&'static str; 2]| {
            (large[k % 2], small[k % 2])
        };
        let notes = |rows: usize, large, small| {
            let rows: Vec<_> = (0..rows).map(|k| row(k, large, small)).collect();
            read(&rows, "", &[]).unwrap().notes
        };
        let line = |column, changes| {
            format!(
                "{column} is 0 or 1 in all rows, and changes {changes} times: if it is one line of a \
                 quadrature encoder, count the edges of both lines with host-sim decode"
            )
        };
        assert_eq!(
            notes(11, ["0", "1"], ["5", "6"]),
            [line("counts_large", 10)]
        );
        assert_eq!(
            notes(12, ["0", "-1"], ["1", "0"]),
            [line("counts_small", 11)]
        );
        // Few changes are those of a shaft at rest, and 2 is a count.
        assert!(notes(10, ["0", "1"], ["0", "2"]).is_empty());
        assert!(notes(20, ["1", "2"], ["7", "7"]).is_empty());
    }

    /// Milliseconds, milliamperes and degrees a second.
    #[test]
    fn numbers_are_converted_to_the_units_of_a_recording() {
        let mut options = ReadOptions::default();
        options
            .add_columns("t=t:ms,current=i:mA,true_omega=w:deg/s,counts_large=n")
            .unwrap();
        let text = "t,n,i,w\n0,0,1500,180\n1,1,-250,-90\n";
        let recording = Recording::parse_as(text.as_bytes(), "r.csv", &options).unwrap();
        let near = |ours: &[f64], exact: [f64; 2]| {
            assert!(
                (ours.iter().zip(exact)).all(|(a, b)| (a - b).abs() < 1e-12),
                "{ours:?} {exact:?}"
            );
        };
        near(&recording.t, [0.0, 1e-3]);
        near(recording.trace.current.as_ref().unwrap(), [1.5, -0.25]);
        let pi = std::f64::consts::PI;
        near(
            recording.trace.true_omega.as_ref().unwrap(),
            [pi, -pi / 2.0],
        );
    }
}
