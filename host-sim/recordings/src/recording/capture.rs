//! Captures of the two lines of an incremental encoder, as a logic analyser writes them.

mod levels;

use std::io::Read;

use simulation::trace::{EdgeStamp, Trace};
use terminal::failure::Failure;

use super::Recording;
use super::header::{found, short};
use super::layout::{Layout, Place};
use super::numbers::shown;
use super::options::{Column, Mapping, ReadOptions};
use super::own_times::OwnTimes;
use super::records::Records;
use super::row::Row;
use super::times::back;
use levels::{Change, Levels, level};

/// Largest number of rows of a recording: a day at 1 kHz.
const MOST_ROWS: f64 = 1e8;

/// Part of a tick by which the end of a capture may be rounded.
const ROUNDING: f64 = 1e-6;

/// Largest share of changes that may be of both lines at once.
const LOST_SHARE: f64 = 0.01;

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

/// Counts the edges of a capture, and samples the count.
struct Decoder {
    rate_hz: f64,
    /// Time of the first row, and of the latest one, s.
    first: Option<f64>,
    last: f64,
    levels: Levels,
    /// The latest edge: its time, s from the first row on, and the boundary.
    edge: Option<(f64, u32)>,
    edges: u64,
    /// Changes of both lines at once, and the line of the first one.
    both: u64,
    first_both: u64,
    /// Line from which on the lines have no levels.
    unknown: Option<u64>,
    t: Vec<f64>,
    counts: Vec<u32>,
    stamps: Vec<Option<EdgeStamp>>,
}

impl Decoder {
    const fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            first: None,
            last: f64::NEG_INFINITY,
            levels: Levels::START,
            edge: None,
            edges: 0,
            both: 0,
            first_both: 0,
            unknown: None,
            t: Vec::new(),
            counts: Vec::new(),
            stamps: Vec::new(),
        }
    }

    /// Takes the levels of a row, which are at the lines from its time on.
    fn take(&mut self, t: f64, levels: [Option<bool>; 2], row: &Row) -> Result<(), Failure> {
        let [Some(a), Some(b)] = levels else {
            if self.first.is_some() && self.unknown.is_none() {
                self.unknown = Some(row.line);
                self.advance(t, row)?;
            }
            return Ok(());
        };
        if let Some(line) = self.unknown {
            return Err(Failure::Input(format!(
                "{}: line {}: the lines have no level from line {line} to here, and edges may be missing; cut the \
                 capture there, or export a part without a gap",
                row.name, row.line
            )));
        }
        self.advance(t, row)?;
        let change = self.levels.take([a, b]);
        let at = t - self.first.unwrap_or(t);
        match change {
            Change::None => return Ok(()),
            Change::Edge => self.edges += 1,
            Change::Both => {
                self.edges += 2;
                self.both += 1;
                if self.first_both == 0 {
                    self.first_both = row.line;
                }
            }
        }
        self.edge = Some((at, self.levels.boundary()));
        Ok(())
    }

    /// Samples the count at the ticks before the time `t`, s.
    fn advance(&mut self, t: f64, row: &Row) -> Result<(), Failure> {
        let first = *self.first.get_or_insert(t);
        if t < self.last {
            return Err(back(row, t, [first, self.last]));
        }
        let rows = (t - first) * self.rate_hz;
        if rows > MOST_ROWS {
            let s = shown(t - first);
            return Err(row.failure(
                "t",
                &format!(
                    "{s} s after the first row: {rows:.0} rows at {} Hz; state the unit of the time with --column \
                     t=TIME:UNIT, or a lower --rate",
                    self.rate_hz
                ),
            ));
        }
        self.last = t;
        self.sample(|tick| tick < t - first);
        Ok(())
    }

    /// Samples the count at the ticks for which `is_due` holds.
    fn sample(&mut self, is_due: impl Fn(f64) -> bool) {
        loop {
            let tick = self.t.len() as f64 / self.rate_hz;
            if !is_due(tick) {
                return;
            }
            self.t.push(tick);
            self.counts.push(self.levels.count());
            self.stamps.push(self.edge.map(|(at, boundary)| EdgeStamp {
                age_s: tick - at,
                boundary,
            }));
        }
    }

    /// The recording, up to the latest row.
    fn finish(
        mut self,
        mut notes: Vec<String>,
        called: &[String; 2],
        name: &str,
    ) -> Result<Recording, Failure> {
        let failure = |why: String| Err(Failure::Input(format!("{name}: {why}")));
        let Some(first) = self.first else {
            return failure("no row has levels of both lines".to_owned());
        };
        let duration = self.last - first;
        // The time of the last row may be rounded.
        let end = duration + ROUNDING / self.rate_hz;
        self.sample(|tick| tick <= end);
        for (line, moved) in called.iter().zip(self.levels.moved) {
            if !moved {
                return failure(format!(
                    "column {line} does not change; name the columns of the encoder's two lines with --lines A B, \
                     and look for a line that is not connected"
                ));
            }
        }
        // A change of both lines has two edges.
        let lost = self.both as f64 / (self.edges - self.both) as f64;
        if lost > LOST_SHARE {
            return failure(format!(
                "{:.0} % of the changes are of both lines at once, the first in line {}: these are not the two lines \
                 of an encoder, or the capture is too slow for the motion; name the lines with --lines A B, or \
                 sample faster",
                1e2 * lost,
                self.first_both
            ));
        }
        if self.t.len() < 2 {
            return failure(format!(
                "{} s are fewer than two rows at {} Hz; give a higher --rate",
                shown(duration),
                self.rate_hz
            ));
        }
        notes.push(format!(
            "{} edges in {} s; the count ends at {}",
            self.edges,
            shown(duration),
            self.levels.count().cast_signed()
        ));
        if self.both > 0 {
            notes.push(format!(
                "{} times both lines changed at once, the first time in line {}: such a motion is taken to go on \
                 in the direction of the edge before",
                self.both, self.first_both
            ));
        }
        if first != 0.0 {
            notes.push(format!(
                "t = 0 is at {} s of the capture, its first row",
                shown(first)
            ));
        }
        if let Some(line) = self.unknown {
            notes.push(format!("the lines have no level from line {line} on"));
        }
        Ok(Recording {
            t: self.t,
            trace: Trace {
                rate_hz: self.rate_hz,
                counts_large: self.counts,
                edges: Some(self.stamps),
                ..Trace::default()
            },
            notes,
            ..Recording::default()
        })
    }
}

#[cfg(test)]
mod tests;
