//! The edges of a capture, and the recording that samples their count.

use simulation::trace::{EdgeStamp, Trace};
use terminal::failure::Failure;

use super::LINES;
use super::levels::{Change, Kind, Levels};
use crate::recording::Recording;
use crate::recording::numbers::{shown, shown_span};
use crate::recording::text::row::Row;
use crate::recording::times::back;

/// Largest number of rows of a recording: a day at 1 kHz.
const MOST_ROWS: f64 = 1e8;

/// Part of a tick by which the end of a capture may be rounded.
const ROUNDING: f64 = 1e-6;

/// Largest share of changes that may be of several edges at once, or to levels that do not occur.
const LOST_SHARE: f64 = 0.01;

/// Counts the edges of a capture, and samples the count.
pub(super) struct Decoder {
    rate_hz: f64,
    /// Time of the first row, and of the latest one, s.
    first: Option<f64>,
    last: f64,
    levels: Levels,
    /// The latest edge: its time, s from the first row on, and the boundary.
    edge: Option<(f64, u32)>,
    edges: u64,
    /// Rows with an edge or with levels that do not occur, and those of them with lost edges or such levels.
    changes: u64,
    wrong: u64,
    /// Line of the first one of the latter.
    first_wrong: Option<u64>,
    /// Line from which on the lines have no levels.
    unknown: Option<u64>,
    t: Vec<f64>,
    counts: Vec<u32>,
    stamps: Vec<Option<EdgeStamp>>,
}

impl Decoder {
    pub(super) fn new(kind: Kind, lines: usize, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            first: None,
            last: f64::NEG_INFINITY,
            levels: Levels::new(kind, lines),
            edge: None,
            edges: 0,
            changes: 0,
            wrong: 0,
            first_wrong: None,
            unknown: None,
            t: Vec::new(),
            counts: Vec::new(),
            stamps: Vec::new(),
        }
    }

    /// Takes the levels of a row, which are at the lines from its time on.
    pub(super) fn take(
        &mut self,
        t: f64,
        levels: Option<Vec<bool>>,
        row: &Row,
    ) -> Result<(), Failure> {
        let Some(levels) = levels else {
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
        let edges = match self.levels.take(&levels) {
            Change::None => return Ok(()),
            Change::Edge => 1,
            Change::Lost(edges) => edges,
            Change::Invalid => 0,
        };
        self.changes += 1;
        if edges != 1 {
            self.wrong += 1;
            self.first_wrong.get_or_insert(row.line);
        }
        if edges > 0 {
            let at = t - self.first.unwrap_or(t);
            self.edges += u64::from(edges);
            self.edge = Some((at, self.levels.boundary()));
        }
        Ok(())
    }

    /// Samples the count at the ticks before the time `t`, s.
    fn advance(&mut self, t: f64, row: &Row) -> Result<(), Failure> {
        let first = *self.first.get_or_insert(t);
        if t < self.last {
            return Err(back(row, t, [first, self.last], 0));
        }
        let rows = (t - first) * self.rate_hz;
        if rows > MOST_ROWS {
            let s = shown_span(t - first);
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
    pub(super) fn finish(
        mut self,
        mut notes: Vec<String>,
        called: &[String],
        name: &str,
    ) -> Result<Recording, Failure> {
        let failure = |why: String| Err(Failure::Input(format!("{name}: {why}")));
        let Some(first) = self.first else {
            return failure("no row has levels of all lines".to_owned());
        };
        let duration = self.last - first;
        // The time of the last row may be rounded.
        let end = duration + ROUNDING / self.rate_hz;
        self.sample(|tick| tick <= end);
        for (line, moved) in called.iter().zip(&self.levels.moved) {
            if !moved {
                return failure(format!(
                    "column {line} does not change; name the columns of the encoder's lines with {LINES}, and look \
                     for a line that is not connected"
                ));
            }
        }
        let wrong = self.wrong as f64 / self.changes as f64;
        if wrong > LOST_SHARE {
            return failure(format!(
                "{:.0} % of the changes are of several edges at once or to levels that do not occur, the first in \
                 line {}: these are not the lines of an encoder, or the capture is too slow for the motion; name the \
                 lines with {LINES}, or sample faster",
                1e2 * wrong,
                self.first_wrong.unwrap_or_default()
            ));
        }
        if self.t.len() < 2 {
            return failure(format!(
                "{} s are fewer than two rows at {} Hz; give a higher --rate",
                shown_span(duration),
                self.rate_hz
            ));
        }
        notes.push(format!(
            "{} edges in {} s; the count ends at {}",
            self.edges,
            shown_span(duration),
            self.levels.count().cast_signed()
        ));
        if let Some(line) = self.first_wrong {
            notes.push(format!(
                "{} rows have several edges at once, or levels that do not occur, the first is line {line}: the \
                 shorter way is taken for the motion, and of two equal ones that of the edge before",
                self.wrong
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
