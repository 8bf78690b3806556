//! Captures of the two lines of an incremental encoder, as a logic analyser writes them.

mod decoder;
mod levels;

use std::io::Read;

use terminal::failure::Failure;

use super::Recording;
use super::header::{found, short};
use super::layout::{Layout, Place};
use super::options::{Column, Mapping, ReadOptions};
use super::own_times::OwnTimes;
use super::records::Records;
use decoder::Decoder;
use levels::level;

/// Where the times of the rows are from.
#[derive(Clone, Copy, Debug)]
enum Clock {
    Column(Place),
    /// Rows at a constant rate, Hz.
    Rate(f64),
}

/// How a capture is read, and the recording that is made of it.
///
/// The count goes up by one at each change of a line while A leads B: A rises, B rises, A falls, B falls.
/// It begins at 0, and the time of the recording begins with the capture.
#[derive(Clone, Debug)]
pub struct Capture {
    options: ReadOptions,
    lines: Option<[String; 2]>,
    rate_hz: f64,
}

impl Capture {
    /// A recording of `rate_hz` is made. `columns` are texts of `--column` that may name the time, `lines`
    /// the names or numbers of the columns of the lines A and B. Rows without a time are at `row_rate_hz`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the option.
    pub fn new(
        columns: &[String],
        lines: Option<[String; 2]>,
        row_rate_hz: Option<f64>,
        rate_hz: f64,
    ) -> Result<Self, Failure> {
        let mut options = ReadOptions::default();
        for text in columns {
            options.add_columns(text)?;
        }
        let other = |mapping: &&Mapping| mapping.column != Column::T;
        if let Some(mapping) = options.columns.iter().find(other) {
            let ours = mapping.column.name();
            return Err(Failure::Input(format!(
                "--column {ours}={}: a capture has the column t and two lines; name the lines with --lines A B",
                mapping.theirs
            )));
        }
        if let Some(hz) = row_rate_hz {
            options.set_row_rate(hz)?;
        }
        Ok(Self {
            options,
            lines,
            rate_hz,
        })
    }

    /// The recording of the capture `input`, which messages call `name`: counts, and the latest edge with its
    /// time.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn decode(&self, input: impl Read, name: &str) -> Result<Recording, Failure> {
        let mut records = Records::open(input, name, &self.options)?;
        let clock = self.clock(&records.layout, name)?;
        let lines = self.lines(&records.layout, clock, name)?;
        let called = [0, 1].map(|line| called(&records.layout, lines[line]));
        let mut times = OwnTimes::default();
        let mut decoder = Decoder::new(self.rate_hz);
        let mut rows = 0_u64;
        while let Some(row) = records.next()? {
            let t = match clock {
                Clock::Column(at) => times.of(&row, at)?,
                Clock::Rate(hz) => rows as f64 / hz,
            };
            rows += 1;
            let levels = [
                level(&row, &called[0], lines[0])?,
                level(&row, &called[1], lines[1])?,
            ];
            decoder.take(t, levels, &row)?;
        }
        let mut notes = vec![source(&records.layout, clock, &called)];
        notes.extend(times.notes());
        decoder.finish(notes, &called, name)
    }

    fn clock(&self, layout: &Layout, name: &str) -> Result<Clock, Failure> {
        let mapping = match (
            self.options.mapping(Column::T),
            self.options.row_rate_hz,
            layout.names.iter().find(|name| is_time(name)),
        ) {
            (Some(_), Some(hz), _) => {
                return Err(Failure::Input(format!(
                    "{name}: --row-rate {hz}: --column names a column of time; leave one of the two out"
                )));
            }
            (Some(mapping), None, _) => mapping.clone(),
            (None, Some(hz), _) => return Ok(Clock::Rate(hz)),
            (None, None, Some(theirs)) => Mapping {
                column: Column::T,
                theirs: theirs.clone(),
                unit: None,
            },
            (None, None, None) => {
                return Err(Failure::Input(format!(
                    "{name}: line {}: no column of time; {}; name it with --column t=TIME:UNIT, or give the rate \
                     of the rows with --row-rate HZ",
                    layout.line.max(1),
                    found(layout)
                )));
            }
        };
        layout.mapped(&mapping, name).map(Clock::Column)
    }

    /// The places of the lines A and B: those of the options, or the only two that are no time.
    fn lines(&self, layout: &Layout, clock: Clock, name: &str) -> Result<[usize; 2], Failure> {
        let failure = |why: String| {
            Failure::Input(format!(
                "{name}: line {}: {why}; {}; name the columns of the encoder's lines with --lines A B",
                layout.line.max(1),
                found(layout)
            ))
        };
        let Some(named) = &self.lines else {
            let is_line = |place: &usize| match clock {
                Clock::Column(time) => *place != time.place,
                Clock::Rate(_) => !is_time(&layout.names[*place]),
            };
            let others: Vec<_> = (0..layout.names.len()).filter(is_line).collect();
            return others.try_into().map_err(|others: Vec<_>| {
                failure(format!(
                    "columns besides the time: {}, and an encoder has two lines",
                    others.len()
                ))
            });
        };
        let place = |line: &String| {
            let called = layout.names.iter().filter(|name| *name == line);
            match (called.count(), layout.place(line)) {
                (2.., _) => Err(failure(format!(
                    "several columns '{}': give the numbers of the columns",
                    short(line)
                ))),
                (_, Some(place)) => Ok(place),
                (_, None) => Err(failure(format!("no column '{}'", short(line)))),
            }
        };
        let [a, b] = [place(&named[0])?, place(&named[1])?];
        let is_time = matches!(clock, Clock::Column(time) if [a, b].contains(&time.place));
        if a == b || is_time {
            return Err(failure(
                "the time and the two lines are three columns".to_owned(),
            ));
        }
        Ok([a, b])
    }
}

/// Whether a column is one of times by its name.
fn is_time(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    name == "t" || name.starts_with("time")
}

/// What messages call the column at `place`.
fn called(layout: &Layout, place: usize) -> String {
    match layout.has_header() {
        true => format!("'{}'", short(&layout.names[place])),
        false => (place + 1).to_string(),
    }
}

/// The note on the columns that are read.
fn source(layout: &Layout, clock: Clock, lines: &[String; 2]) -> String {
    let time = match clock {
        Clock::Column(at) => format!("t from {} ({})", called(layout, at.place), at.unit.name()),
        Clock::Rate(hz) => format!("rows at {hz} Hz"),
    };
    format!(
        "{time}, line A from column {}, line B from column {}",
        lines[0], lines[1]
    )
}

#[cfg(test)]
mod tests;
