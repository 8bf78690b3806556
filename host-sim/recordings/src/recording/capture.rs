//! Captures of the lines of an incremental encoder or of Hall sensors, as a logic analyser writes them.

mod decoder;
mod levels;

use std::io::Read;

use terminal::failure::Failure;

use super::Recording;
use super::layout::header::{found, short};
use super::layout::{Layout, Place};
use super::options::{Column, Mapping, ReadOptions};
use super::records::Records;
use super::times::own_times::OwnTimes;
use decoder::Decoder;
use levels::{Kind, level};

/// The option that names the lines, for messages.
const LINES: &str = "--lines A B, or three Hall lines with --hall U V W";

/// Where the times of the rows are from.
#[derive(Clone, Copy, Debug)]
enum Clock {
    Column(Place),
    /// Rows at a constant rate, Hz.
    Rate(f64),
}

/// How a capture is read, and the recording that is made of it.
///
/// The count goes up by one at each change of a line while A leads B: A rises, B rises, A falls, B falls. Of
/// three lines of Hall sensors it goes up while U leads V and V leads W, each by a third of a period: U rises,
/// W falls, V rises, U falls, W rises, V falls.
/// It begins at 0, and the time of the recording begins with the capture.
#[derive(Clone, Debug)]
pub struct Capture {
    options: ReadOptions,
    lines: Option<Vec<String>>,
    rate_hz: f64,
}

impl Capture {
    /// A recording of `rate_hz` is made. `columns` are texts of `--column` that may name the time, `lines`
    /// the names or numbers of the columns of the lines, two or three. Rows without a time are at `row_rate_hz`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the option.
    pub fn new(
        columns: &[String],
        lines: Option<Vec<String>>,
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
                "--column {ours}={}: a capture has the column t and lines; name the lines with {LINES}",
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
        let Some(kind) = Kind::of(lines.len()) else {
            return Err(Failure::Input(format!(
                "{name}: {} lines: name the lines of the encoder with {LINES}",
                lines.len()
            )));
        };
        let called = lines.iter().map(|place| called(&records.layout, *place));
        let called: Vec<_> = called.collect();
        let mut times = OwnTimes::default();
        let mut decoder = Decoder::new(kind, lines.len(), self.rate_hz);
        let mut rows = 0_u64;
        while let Some(row) = records.next()? {
            let t = match clock {
                Clock::Column(at) => times.of(&row, at)?,
                Clock::Rate(hz) => rows as f64 / hz,
            };
            rows += 1;
            let levels = called.iter().zip(&lines);
            let levels = levels.map(|(called, place)| level(&row, called, *place));
            let levels: Vec<_> = levels.collect::<Result<_, _>>()?;
            // Lines without a level have none together.
            let levels = levels.into_iter().collect();
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
                part: None,
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
        layout
            .mapped(&mapping, &self.options, name)
            .map(Clock::Column)
    }

    /// The places of the lines: those of the options, or the only two that are no time.
    fn lines(&self, layout: &Layout, clock: Clock, name: &str) -> Result<Vec<usize>, Failure> {
        let failure = |why: String| {
            Failure::Input(format!(
                "{name}: line {}: {why}; {}; name the columns of the encoder's lines with {LINES}",
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
            return match others.len() {
                2 => Ok(others),
                others => Err(failure(format!(
                    "columns besides the time: {others}, and an encoder has two lines"
                ))),
            };
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
        let places: Vec<_> = named.iter().map(place).collect::<Result<_, _>>()?;
        let is_time = matches!(clock, Clock::Column(time) if places.contains(&time.place));
        let is_twice = (1..places.len()).any(|k| places[..k].contains(&places[k]));
        if is_twice || is_time {
            return Err(failure(
                "the time and the lines are different columns".to_owned(),
            ));
        }
        Ok(places)
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
fn source(layout: &Layout, clock: Clock, lines: &[String]) -> String {
    let time = match clock {
        Clock::Column(at) => format!("t from {} ({})", called(layout, at.place), at.unit.name()),
        Clock::Rate(hz) => format!("rows at {hz} Hz"),
    };
    let names = match lines.len() {
        2 => ["A", "B", ""],
        _ => ["U", "V", "W"],
    };
    let lines = names.iter().zip(lines);
    let lines = lines.map(|(name, column)| format!(", line {name} from column {column}"));
    format!("{time}{}", lines.collect::<String>())
}

#[cfg(test)]
mod tests;
