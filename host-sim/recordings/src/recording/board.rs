//! Columns of a recording with the board's own estimates, for figures.

use std::collections::BTreeMap;
use std::io::Read;

use super::Recording;
use super::layout::Layout;
use super::options::ReadOptions;
use super::text::fields::is_without_value;
use super::text::row::Row;
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
    /// Reads the columns of the recording `input`, which is called `name` in messages. A text without the columns
    /// that the board's recordings have is from another source: nothing of it is read.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn parse(input: impl Read, name: &str) -> Result<Self, Failure> {
        let options = ReadOptions::default();
        Recording::parse_with_board(input, name, &options).map(|recording| recording.board)
    }

    /// The column called `name`, a field of telemetry frames. A value that was not finite is NaN.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.get(name).map(Vec::as_slice)
    }

    /// Adds the rows of `other`, which has the same columns.
    pub(super) fn append(&mut self, mut other: Self) {
        if self.columns.is_empty() {
            self.columns = other.columns;
        } else {
            for (name, values) in &mut self.columns {
                if let Some(added) = other.columns.get_mut(name) {
                    values.append(added);
                }
            }
        }
        self.learned = other.learned.or(self.learned);
    }

    /// Removes the first `rows` rows and returns them, with what was learned.
    pub(super) fn split_front(&mut self, rows: usize) -> Self {
        let front = |values: &mut Vec<f64>| values.drain(..rows.min(values.len())).collect();
        let columns = self.columns.iter_mut();
        Self {
            columns: columns
                .map(|(name, values)| (*name, front(values)))
                .collect(),
            learned: self.learned,
        }
    }
}

/// The board's columns of a layout, and their rows so far.
pub(super) struct Board {
    /// Index in a row, and name, of each column.
    places: Vec<(usize, &'static str)>,
    learned: Option<[usize; 3]>,
    rows: BoardColumns,
}

impl Board {
    /// The columns of `layout`; `None` if it is none of a board.
    pub(super) fn of(layout: &Layout) -> Option<Self> {
        let place = |column: &str| layout.names.iter().position(|name| name == column);
        place("counts_large").or(place(LEARNED[0]))?;
        let known = |(place, name): (usize, &String)| {
            let known = COLUMNS.iter().find(|(column, _)| column == name);
            known.map(|(column, _)| (place, *column))
        };
        let places: Vec<_> = layout.names.iter().enumerate().filter_map(known).collect();
        let empty = places.iter().map(|(_, column)| (*column, Vec::new()));
        let learned = match LEARNED.map(place) {
            [Some(damping), Some(friction), Some(torque)] => Some([damping, friction, torque]),
            _ => None,
        };
        Some(Self {
            rows: BoardColumns {
                columns: empty.collect(),
                learned: None,
            },
            places,
            learned,
        })
    }

    /// As [`Board::of`], for a recording in parts whose rows are kept: with standard deviations or learned
    /// parameters of the board. Rows that are `resampled` are not those of the board.
    pub(super) fn in_parts(layout: &Layout, resampled: Option<f64>) -> Option<Self> {
        let is_estimate = |name: &String| name == "sigma_large" || name == LEARNED[0];
        let is_kept = resampled.is_none() && layout.names.iter().any(is_estimate);
        is_kept.then(|| Self::of(layout)).flatten()
    }

    /// The indices in a row of what is read.
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> {
        let learned = self.learned.into_iter().flatten();
        self.places.iter().map(|(place, _)| *place).chain(learned)
    }

    /// Adds a row.
    pub(super) fn take(&mut self, row: &Row) -> Result<(), Failure> {
        for &(place, column) in &self.places {
            let is_unknown = !WHOLE.contains(&column) && is_without_value(row.text(column, place)?);
            let number = match is_unknown {
                true => f64::NAN,
                false => row.number(column, place)?,
            };
            if let Some(values) = self.rows.columns.get_mut(column) {
                values.push(number);
            }
        }
        if let Some([damping, friction, torque_constant]) = self.learned
            && !row.text(LEARNED[0], damping)?.is_empty()
        {
            self.rows.learned = Some(LearnedLine {
                damping: row.number(LEARNED[0], damping)?,
                friction: row.number(LEARNED[1], friction)?,
                torque_constant: row.number(LEARNED[2], torque_constant)?,
            });
        }
        Ok(())
    }

    /// Removes the first `rows` rows and returns them.
    pub(super) fn drain(&mut self, rows: usize) -> BoardColumns {
        self.rows.split_front(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn present_columns_are_read_and_an_invalid_field_is_reported() {
        let text = "t,torque,counts_large,state\n0,0.5,1,2\n0.001,-0.25,1,3\n";
        let board = BoardColumns::parse(text.as_bytes(), "r.csv").unwrap();
        assert_eq!(board.column("torque"), Some(&[0.5, -0.25][..]));
        assert_eq!(board.column("state"), Some(&[2.0, 3.0][..]));
        assert_eq!(board.column("current_small"), None);
        assert_eq!(board.learned, None);
        let text = "t,counts_large,learned_torque_constant,learned_damping,learned_friction\n\
                    0,0,,,\n0.001,1,3,1,2\n0.002,2,,,\n";
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
        let text = "t,torque,counts_large,state\n0,0.5,1,2\n0.001,-0.25,1,3\n";
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
