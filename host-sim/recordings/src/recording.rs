//! Recordings of a motor, read from the logs that users have.
//!
//! A log is read in this order: `records` find the rows in any form of a log, with `text` for rows of fields;
//! `layout` finds the columns and their units by names, or by the `options` of the user; `columns` collect the
//! rows, with `times` for their times and `encoder` for their counts. `survey` and `parts` read a log that is
//! larger than the memory in two passes.

mod board;
mod capture;
mod columns;
mod encoder;
mod layout;
mod memory;
mod numbers;
mod options;
mod parts;
mod records;
mod rows;
mod survey;
mod text;
mod times;
mod write;

use std::io::Read;
use std::path::Path;

pub use board::BoardColumns;
pub use capture::Capture;
pub use columns::currents::implausible_current;
pub use encoder::absolute::{after, boundary};
pub use encoder::finer::Finer;
pub(crate) use encoder::stale;
pub use layout::formats::{KnownLog, known_logs};
pub use numbers::shown;
pub(crate) use options::MEASURED;
pub use options::ReadOptions;
pub use options::stated::{counts_per_rev_line, stated_counts_per_rev};
pub(crate) use options::units::Quantity;
pub use parts::Parts;
pub(crate) use records::kinds::check as check_kind;
pub use survey::Survey;
pub use times::clock::LONGEST_GAP;
pub use times::steps::SLOWEST_HZ;

use crate::log::Log;
use board::Board;
use columns::Columns;
use columns::currents::largest;
use layout::{Layout, hint};
use records::Records;

use simulation::trace::Trace;
use terminal::failure::Failure;

/// A recording: its time column, and the other columns as a trace.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Column `t`, s.
    pub t: Vec<f64>,
    /// The columns as a trace; its rate follows from the steps of `t` near their median. Its current is the
    /// measured one where the next row has it, otherwise the command.
    pub trace: Trace,
    /// The small motor's current from this tick to the next, A, as that of the trace.
    pub current_small: Option<Vec<f64>>,
    /// The board's own estimates in these rows, where they were read too.
    pub board: BoardColumns,
    /// What the positions tell if the counts change in few of the rows in which they do.
    pub finer: Option<Finer>,
    /// Number of steps of `t` that differ from the period by more than a tenth of it.
    pub uneven_steps: usize,
    /// Number of rows that are left out because they have the time of the row before.
    pub repeated_rows: usize,
    /// Notes of the reader, one line each: what it converted, and the rows that are missing.
    pub notes: Vec<String>,
}

impl Recording {
    /// Reads a CSV file with the columns of this project, or a known log, for the default device.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let log = Log::open(path)?;
        Self::parse(log.reader()?, log.name())
    }

    /// Reads text called `name` in messages, as [`Recording::read`].
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn parse(input: impl Read, name: &str) -> Result<Self, Failure> {
        Self::parse_as(input, name, &ReadOptions::default())
    }

    /// Reads text called `name` in messages, with the columns and units of `options`.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn parse_as(input: impl Read, name: &str, options: &ReadOptions) -> Result<Self, Failure> {
        Self::parse_rows(input, name, options, f64::INFINITY, |_| None)
    }

    /// As [`Recording::parse_as`], with the board's columns if the recording is one of a board.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn parse_with_board(
        input: impl Read,
        name: &str,
        options: &ReadOptions,
    ) -> Result<Self, Failure> {
        Self::parse_rows(input, name, options, f64::INFINITY, Board::of)
    }

    /// As [`Recording::parse_as`], up to the first row that is `seconds` after the first one, s.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn parse_first(
        input: impl Read,
        name: &str,
        options: &ReadOptions,
        seconds: f64,
    ) -> Result<Self, Failure> {
        Self::parse_rows(input, name, options, seconds, |_| None)
    }

    fn parse_rows(
        input: impl Read,
        name: &str,
        options: &ReadOptions,
        seconds: f64,
        board: impl FnOnce(&Layout) -> Option<Board>,
    ) -> Result<Self, Failure> {
        let mut records = Records::open(input, name, options)?;
        let places = records.layout.places(options, name)?;
        let mut columns = Columns::new(&places, options, board(&records.layout));
        while columns.elapsed() < seconds
            && let Some(row) = records.next()?
        {
            columns.take(&row)?;
        }
        let mut recording = columns.into_recording(name, &places, &records.layout)?;
        let current = recording.trace.current.as_deref().map_or(0.0, largest);
        let option = || hint::current(&places, &records.layout);
        let implausible = implausible_current(current, options.current_limit, option);
        recording.notes.extend(implausible);
        Ok(recording)
    }
}

/// `current=NAME`: the part of `--column` that names the motor current of a log called `name`, with the
/// columns of `options`; or the part for the column that probably has it, if none is read. `None` if there
/// is no such column.
///
/// # Errors
/// As [`Recording::read`].
pub fn current_option(
    input: impl Read,
    name: &str,
    options: &ReadOptions,
) -> Result<Option<String>, Failure> {
    let layout = Records::open(input, name, options)?.layout;
    Ok(hint::current(&layout.places(options, name)?, &layout))
}

/// A log of a test, read with the text of `--column` if it is not empty.
#[cfg(test)]
fn read_log(text: &str, columns: &str) -> Result<Recording, String> {
    read_log_at(None, text, columns)
}

/// As [`read_log`], with a value of `--row-rate`, Hz.
#[cfg(test)]
fn read_log_at(row_rate_hz: Option<f64>, text: &str, columns: &str) -> Result<Recording, String> {
    let mut options = ReadOptions::default();
    if !columns.is_empty() {
        options.add_columns(columns).unwrap();
    }
    if let Some(hz) = row_rate_hz {
        options.set_row_rate(hz).unwrap();
    }
    Recording::parse_as(text.as_bytes(), "r.csv", &options).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Recording, String> {
        Recording::parse(text.as_bytes(), "r.csv").map_err(|failure| failure.to_string())
    }

    #[test]
    fn columns_are_found_by_name_in_any_order() {
        let text =
            "note,counts_large, t ,true_omega\nx,-1,0.0,1.5\ny,4294967296,0.001,2\nz,2,0.002,3\n";
        let recording = parse(text).unwrap();
        assert_eq!(recording.trace.rate_hz, 1000.0);
        assert_eq!(recording.trace.counts_large, [u32::MAX, 0, 2]);
        assert_eq!(recording.trace.true_omega, Some(vec![1.5, 2.0, 3.0]));
        assert_eq!(recording.trace.current, None);
        assert_eq!(recording.uneven_steps, 0);
        let quoted = parse("\"t\", \"counts_large\"\n0.0, 7\n0.001, 9\n").unwrap();
        assert_eq!(quoted.trace.counts_large, [7, 9]);
    }

    #[test]
    fn counts_written_as_floats_are_read() {
        let text =
            "t,counts_large\n0,-3.0\n0.001,1e3\n0.002,-2.5e1\n0.003,4294967295.0\n0.004,+7\n";
        let counts = parse(text).unwrap().trace.counts_large;
        let expected = [-3, 1000, -25, -1, 7].map(|count: i32| count as u32);
        assert_eq!(counts, expected);
        for fraction in ["-3.5", "1e-3", "0.25e1"] {
            let error = parse(&format!("t,counts_large\n0,0\n0.001,{fraction}\n")).unwrap_err();
            let said = "r.csv: line 3: column counts_large: ";
            assert!(error.starts_with(said), "{error}");
            let remedy = "is not a whole number of counts; if it is an angle, state its unit, for example \
                          --column 'counts_large=counts_large:deg', or :rad or :rev; if the counts are interpolated, \
                          multiply them, and the counts per revolution, to whole numbers";
            assert!(error.ends_with(remedy), "{error}");
        }
    }

    #[test]
    fn edge_columns_are_converted_to_ages() {
        let text =
            "t,counts_large,edge_tick,edge_bound\n0,0,,\n0.001,0,42000,-3\n0.002,1,168001,1\n";
        let edges = parse(text).unwrap().trace.edges.unwrap();
        assert_eq!(edges[0], None);
        let edge = edges[1].unwrap();
        assert!((edge.age_s - 500e-6).abs() < 1e-12);
        assert_eq!(edge.boundary, (-3_i32) as u32);
        assert_eq!(edges[2].unwrap().age_s, 0.0);
    }

    #[test]
    fn invalid_field_is_reported_by_line_and_column() {
        for (text, said) in [
            ("", "r.csv: line 1: no column t;"),
            (
                "t,counts_small\n0,0\n",
                "r.csv: line 1: no column counts_large;",
            ),
            ("t,counts_large,t\n", "r.csv: line 1: two columns t;"),
            (
                "t,counts_large,edge_tick\n0,0,0\n",
                "r.csv: line 1: no column edge_bound;",
            ),
            (
                "t,counts_large\n0,0\n0.1,one\n",
                "r.csv: line 3: column counts_large: 'one' is not a number",
            ),
            (
                "t,counts_large\n0,0\n0.1,\n",
                "r.csv: line 3: column counts_large: '' is not a number",
            ),
            (
                "t,counts_large\n0,0\nNaN,1\n",
                "r.csv: line 3: column t: 'NaN' is not a number",
            ),
            (
                "t,counts_large\n0,0\n0.1,1.5\n",
                "r.csv: line 3: column counts_large: 1.5 is not a whole",
            ),
            (
                "t,counts_large\n0,0\n0.2,1\n0.1,2\n",
                "r.csv: line 4: column t: 0.1 s is before the 0.2 s",
            ),
            (
                "t,counts_large\n0,0\n0.1\n",
                "r.csv: line 3: 1 field where the first line has 2",
            ),
            ("t,counts_large\n0,0\n", "r.csv: fewer than two rows"),
            (
                "t,counts_large\n0,0\n1e-8,1\n",
                "r.csv: column t: rows 1e-8 s apart are 100000000 Hz, which is above 10000000 Hz",
            ),
            (
                "t,counts_large\n1,0\n1,0\n1,0\n",
                "r.csv: column t: 67 % of the rows have the time of the row before, the first in line 3",
            ),
            (
                "t,counts_large,current\n0,0,inf\n",
                "r.csv: line 2: column current: 'inf' is not a number",
            ),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.starts_with(said), "{text:?}: {error}");
        }
    }

    #[test]
    fn first_seconds_end_with_the_row_that_is_past_them() {
        let row = |k: u32| format!("{},{k}\n", 5.0 + f64::from(k) / 16.0);
        let text = format!("t,counts_large\n{}", (0..40).map(row).collect::<String>());
        let first = |seconds| {
            let options = ReadOptions::default();
            let recording = Recording::parse_first(text.as_bytes(), "r", &options, seconds);
            recording.map(|recording| recording.t.len())
        };
        assert_eq!(first(0.25).unwrap(), 5);
        assert_eq!(first(0.26).unwrap(), 6);
    }
}
