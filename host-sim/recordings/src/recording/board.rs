//! Columns of a recording with the board's own estimates, for figures.

use std::collections::BTreeMap;
use std::io::Read;

use super::options::ReadOptions;
use super::records::Records;
use super::text::fields::is_without_value;
use crate::telemetry::{COLUMNS, LearnedLine};
use terminal::failure::Failure;

/// Columns that `record` writes and `replay` ignores; each may be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardColumns {
    columns: BTreeMap<&'static str, Vec<f64>>,
    /// `learned_damping`, `learned_friction`, `learned_torque_constant` of the last row that has them.
    pub learned: Option<LearnedLine>,
}

/// Columns with a number in each row.
const WHOLE: [&str; 4] = ["counts_large", "counts_small", "state", "cause"];

/// Columns of [`BoardColumns::learned`], empty in most rows.
const LEARNED: [&str; 3] = [
    "learned_damping",
    "learned_friction",
    "learned_torque_constant",
];

impl BoardColumns {
    /// Whether the CSV text that begins with `text` has the board's columns of standard deviations or
    /// learned parameters.
    #[must_use]
    pub fn are_in(text: &[u8]) -> bool {
        let header = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let mut names = header.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
        names.any(|name| name == b"sigma_large" || name == LEARNED[0].as_bytes())
    }

    /// Reads CSV text called `name` in messages. A text without the columns that the board's
    /// recordings have is from another source: nothing of it is read.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn parse(input: impl Read, name: &str) -> Result<Self, Failure> {
        BoardReader::open(input, name)?.next(usize::MAX)
    }

    /// The column called `name`, a field of telemetry frames. A value that was not finite is NaN.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.get(name).map(Vec::as_slice)
    }
}

/// A log with the board's columns, read in parts.
pub struct BoardReader<'a> {
    records: Records<'a>,
    /// Index in a row, and name, of each column.
    places: Vec<(usize, &'static str)>,
    learned: [Option<usize>; 3],
}

impl<'a> BoardReader<'a> {
    /// Reads the header of CSV text called `name` in messages.
    ///
    /// # Errors
    /// As [`BoardColumns::parse`].
    pub fn open(input: impl Read + 'a, name: &'a str) -> Result<Self, Failure> {
        let records = Records::open(input, name, &ReadOptions::default())?;
        let names = &records.layout.names;
        let place = |column: &str| names.iter().position(|name| name == column);
        let mut learned = LEARNED.map(place);
        let mut places = Vec::new();
        if place("counts_large").or(learned[0]).is_none() {
            learned = [None; 3];
        } else {
            for (place, name) in names.iter().enumerate() {
                let known = COLUMNS.iter().find(|(column, _)| column == name);
                places.extend(known.map(|(column, _)| (place, *column)));
            }
        }
        Ok(Self {
            records,
            places,
            learned,
        })
    }

    /// The next rows, at most `rows`.
    ///
    /// # Errors
    /// As [`BoardColumns::parse`].
    pub fn next(&mut self, rows: usize) -> Result<BoardColumns, Failure> {
        let mut board = BoardColumns::default();
        if self.places.is_empty() && self.learned[0].is_none() {
            return Ok(board);
        }
        for (_, column) in &self.places {
            board.columns.insert(column, Vec::new());
        }
        for _ in 0..rows {
            let Some(row) = self.records.next()? else {
                break;
            };
            for &(place, column) in &self.places {
                let is_unknown =
                    !WHOLE.contains(&column) && is_without_value(row.text(column, place)?);
                let number = match is_unknown {
                    true => f64::NAN,
                    false => row.number(column, place)?,
                };
                if let Some(values) = board.columns.get_mut(column) {
                    values.push(number);
                }
            }
            if let [Some(damping), Some(friction), Some(torque_constant)] = self.learned
                && !row.text(LEARNED[0], damping)?.is_empty()
            {
                board.learned = Some(LearnedLine {
                    damping: row.number(LEARNED[0], damping)?,
                    friction: row.number(LEARNED[1], friction)?,
                    torque_constant: row.number(LEARNED[2], torque_constant)?,
                });
            }
        }
        Ok(board)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn present_columns_are_read_and_an_invalid_field_is_reported() {
        let text = "t,torque,counts_large,state\n0,0.5,1,2\n1,-0.25,1,3\n";
        let board = BoardColumns::parse(text.as_bytes(), "r.csv").unwrap();
        assert_eq!(board.column("torque"), Some(&[0.5, -0.25][..]));
        assert_eq!(board.column("state"), Some(&[2.0, 3.0][..]));
        assert_eq!(board.column("current_small"), None);
        assert_eq!(board.learned, None);
        let text = "learned_torque_constant,learned_damping,learned_friction\n,,\n3,1,2\n,,\n";
        let learned = LearnedLine {
            damping: 1.0,
            friction: 2.0,
            torque_constant: 3.0,
        };
        let board = BoardColumns::parse(text.as_bytes(), "r.csv").unwrap();
        assert_eq!(board.learned, Some(learned));
        let torn = text.replace("3,1,2", "3,1,");
        let error = BoardColumns::parse(torn.as_bytes(), "r.csv").unwrap_err();
        let said = "r.csv: line 3: column learned_friction: '' is not a number; remove the row, or \
                    fill the field";
        assert_eq!(error.to_string(), said);
        let text = "t,torque,counts_large,state\n0,0.5,1,2\n1,-0.25,1,3\n";
        // A recording from before such fields were empty.
        for none in ["", "NaN"] {
            let unknown = text.replace("-0.25", none);
            let board = BoardColumns::parse(unknown.as_bytes(), "r.csv").unwrap();
            let torque = board.column("torque").unwrap();
            assert!(torque[0] == 0.5 && torque[1].is_nan(), "{torque:?}");
        }
        let stateless = text.replace(",3\n", ",\n");
        let error = BoardColumns::parse(stateless.as_bytes(), "r.csv").unwrap_err();
        assert!(error.to_string().contains("column state: ''"), "{error}");
        let bad = text.replace("-0.25", "x");
        let error = BoardColumns::parse(bad.as_bytes(), "r.csv").unwrap_err();
        let said = "r.csv: line 3: column torque: 'x' is not a number; correct the field, or remove the row";
        assert_eq!(error.to_string(), said);
    }
}
