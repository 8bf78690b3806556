//! Columns of a recording while it is read.

mod checked;
pub(super) mod currents;
pub(super) mod left_out;
pub(super) mod stamps;

use simulation::trace::{EDGE_CLOCK_HZ, EdgeStamp, Trace};
use terminal::failure::Failure;

use super::Recording;
use super::board::Board;
use super::encoder::stale::Stale;
use super::encoder::{Encoder, absolute};
use super::layout::{Layout, Place, Places};
use super::options::units::WRAP;
use super::options::{Column, ReadOptions};
use super::records::Records;
use super::text::lines::LineNumbers;
use super::text::row::Row;
use super::text::thousands::Thousands;
use super::times::clock::{self, Gaps};
use super::times::jitter::Jitter;
use super::times::own_times::OwnTimes;
use super::times::{self, Repeated, Replaced};
use currents::Current;
use left_out::LeftOut;
use stamps::{Stamp, Stamps};

/// Columns whose numbers may have separators of thousands.
const MARKED: [Column; 2] = [Column::CountsLarge, Column::CountsSmall];

/// The columns that are read, and their rows so far.
pub(super) struct Columns<'a> {
    pub(super) options: &'a ReadOptions,
    places: [Option<Place>; Column::ALL.len()],
    /// The log's own times, which --row-rate replaces.
    replaced_place: Option<Place>,
    replaced: Replaced,
    pub(super) repeated: Repeated,
    own_times: OwnTimes,
    pub(super) jitter: Jitter,
    /// Marks in the numbers of the two positions.
    thousands: [Thousands; 2],
    /// Number of rows that were taken, and the time of the last one, s.
    taken: usize,
    first_t: f64,
    last_t: f64,
    t: Vec<f64>,
    lines: LineNumbers,
    pub(super) counts_large: Encoder,
    pub(super) counts_small: Encoder,
    pub(super) stale: Stale,
    current: Current,
    current_small: Current,
    edges: Vec<Option<EdgeStamp>>,
    stamps: Stamps,
    true_omega: Vec<f64>,
    /// The board's columns, if they are read too.
    board: Option<Board>,
    /// Rows of other signals, and lines that are no rows.
    of_others: LeftOut,
    messages: LeftOut,
    /// Line of the last row, if it may be cut.
    cut: Option<u64>,
}

impl<'a> Columns<'a> {
    pub(super) fn new(places: &Places, options: &'a ReadOptions, board: Option<Board>) -> Self {
        Self {
            options,
            places: Column::ALL.map(|column| places.get(column)),
            replaced_place: places.replaced_time,
            replaced: Replaced::default(),
            repeated: Repeated::default(),
            own_times: OwnTimes::default(),
            jitter: Jitter::default(),
            thousands: Default::default(),
            taken: 0,
            first_t: f64::NAN,
            last_t: f64::NEG_INFINITY,
            t: Vec::new(),
            lines: LineNumbers::default(),
            counts_large: Encoder::default(),
            counts_small: Encoder::default(),
            stale: Stale::default(),
            current: Current::default(),
            current_small: Current::default(),
            edges: Vec::new(),
            stamps: Stamps::default(),
            true_omega: Vec::new(),
            board,
            of_others: LeftOut::default(),
            messages: LeftOut::default(),
            cut: None,
        }
    }

    /// Time of the last row from the first one, s; below every number before the first row.
    pub(super) fn elapsed(&self) -> f64 {
        match self.taken {
            0 => f64::NEG_INFINITY,
            _ => self.last_t - self.first_t,
        }
    }

    fn place(&self, column: Column) -> Option<Place> {
        self.places[column as usize]
    }

    /// Adds a row.
    pub(super) fn take(&mut self, row: &Row) -> Result<(), Failure> {
        let places = self.places.iter().flatten();
        let read = places.flat_map(|place| place.indices());
        let of_board = self.board.iter().flat_map(Board::indices);
        if row.is_cut_at(read.chain(of_board)) {
            self.cut = Some(row.line);
            return Ok(());
        }
        if row.is_message() {
            self.messages.add(row.line);
            return Ok(());
        }
        if self.is_of_others(row)? {
            self.of_others.add(row.line);
            return Ok(());
        }
        let marked = MARKED.iter().zip(&mut self.thousands);
        for (column, thousands) in marked {
            if let Some(at) = self.places[*column as usize] {
                thousands.see(row.text(column.name(), at.place)?, row.line);
            }
        }
        let t = self.time(row)?;
        if t < self.last_t {
            return Err(times::back(row, t, [self.first_t, self.last_t], self.taken));
        }
        if t == self.last_t {
            self.repeated.add(row.line, t);
            return Ok(());
        }
        let replaced = self
            .replaced_place
            .and_then(|at| self.own_times.of(row, at).ok());
        if let Some(own) = replaced {
            self.replaced.add(own);
        }
        let options = self.options;
        let large = self.place(Column::CountsLarge);
        let large = large.map(|at| self.counts_large.reading(row, at, options, 0));
        let large = large.transpose()?;
        if let Some(large) = large {
            if options.drop_stale && self.stale.is_left_out(large.raw, row.line) {
                return Ok(());
            }
            self.stale.add(large.raw, t, row.line);
        }
        if self.taken == 0 {
            self.first_t = t;
        }
        self.last_t = t;
        self.taken += 1;
        self.t.push(t);
        self.lines.push(row.line);
        if let Some(large) = large {
            let count = self.counts_large.add(large, row, options, 0)?;
            self.jitter.add(t, count);
        }
        if let Some(at) = self.place(Column::CountsSmall) {
            let small = self.counts_small.reading(row, at, options, 1)?;
            self.counts_small.add(small, row, options, 1)?;
        }
        let places = [Column::Current, Column::CurrentMeasured].map(|column| self.place(column));
        self.current.take(row, places, options.torque_constant[0])?;
        let places =
            [Column::CurrentSmall, Column::CurrentSmallMeasured].map(|column| self.place(column));
        self.current_small
            .take(row, places, options.torque_constant[1])?;
        if let (Some(tick), Some(bound)) =
            (self.place(Column::EdgeTick), self.place(Column::EdgeBound))
        {
            let edge = self.edge(row, tick, bound, replaced.unwrap_or(t))?;
            self.edges.push(edge);
        }
        if let Some(at) = self.place(Column::TrueOmega) {
            self.true_omega.push(scaled(row, at, 1.0)?);
        }
        match &mut self.board {
            Some(board) => board.take(row),
            None => Ok(()),
        }
    }

    fn time(&mut self, row: &Row) -> Result<f64, Failure> {
        match (self.options.row_rate_hz, self.place(Column::T)) {
            (None, Some(at)) => self.own_times.of(row, at),
            (rate_hz, _) => {
                let rows = self.taken + self.stale.left_out();
                Ok(rows as f64 / rate_hz.unwrap_or(1.0))
            }
        }
    }

    /// The latest edge; `None` if both fields are empty, before the first edge.
    fn edge(
        &mut self,
        row: &Row,
        tick: Place,
        bound: Place,
        now: f64,
    ) -> Result<Option<EdgeStamp>, Failure> {
        let text = |at: Place| row.text(at.column.name(), at.place);
        if text(tick)?.is_empty() && text(bound)?.is_empty() {
            return Ok(None);
        }
        let at_s = scaled(row, tick, 1.0)? / EDGE_CLOCK_HZ;
        let boundary = row.count(bound.column.name(), bound.place)?;
        let stamp = Stamp {
            at_s,
            wrap_s: tick.unit.scale.of(WRAP, 1.0) / EDGE_CLOCK_HZ,
            boundary,
        };
        let at_s = self.stamps.add(stamp, now, row.line);
        let large = &self.counts_large;
        Ok(Some(EdgeStamp {
            // `t` has fewer digits than the stamp, so an edge at the tick can appear after it.
            age_s: (now - at_s).max(0.0),
            boundary: match self.options.modulus[0] {
                None => boundary as u32,
                Some(modulus) => {
                    let away = absolute::centred(boundary - large.raw, modulus);
                    large
                        .last
                        .map_or(0, |count| count.wrapping_add(away as u32))
                }
            },
        }))
    }

    /// Takes rows until `rows` are there, and returns them, with measured currents all but the last one:
    /// its current comes with the next row. `step` is called at each row that is taken but the first of
    /// the log, with its time, the step to it, and its line.
    pub(super) fn read(
        &mut self,
        records: &mut Records,
        rows: usize,
        mut step: impl FnMut(f64, f64, u64),
    ) -> Result<Recording, Failure> {
        let mut ended = false;
        while self.t.len() < rows && !ended {
            let Some(row) = records.next()? else {
                ended = true;
                continue;
            };
            let (taken, before) = (self.taken, self.last_t);
            self.take(&row)?;
            if taken > 0 && self.taken > taken {
                step(self.last_t, self.last_t - before, row.line);
            }
        }
        let waits = !ended && self.measured().next().is_some();
        Ok(self.drain(self.t.len() - usize::from(waits), f64::NAN))
    }

    /// The columns of measured currents that there are, each with the number of rows without a value.
    fn measured(&self) -> impl Iterator<Item = (Column, usize)> {
        let columns = [
            (Column::CurrentMeasured, self.current.unmeasured),
            (Column::CurrentSmallMeasured, self.current_small.unmeasured),
        ];
        let is_there = |column: Column| self.place(column).is_some();
        columns
            .into_iter()
            .filter(move |(column, _)| is_there(*column))
    }

    /// The recording of all rows.
    pub(super) fn into_recording(
        mut self,
        name: &str,
        places: &Places,
        layout: &Layout,
    ) -> Result<Recording, Failure> {
        let mut notes = self.checked(name, places, layout)?;
        let (rate_hz, uneven_steps) = clock::rate(&self.t, name)?;
        notes.extend(clock::fast(rate_hz));
        notes.extend(self.jitter(rate_hz));
        notes.extend(self.held(rate_hz));
        notes.extend(self.stale(rate_hz));
        let mut gaps = Gaps::default();
        for (k, step) in self.t.windows(2).enumerate() {
            gaps.add(step[1] - step[0], rate_hz, step[1], || self.lines.of(k + 1));
        }
        notes.extend(gaps.note());
        let periods = clock::periods(&self.t, rate_hz);
        let mut recording = Recording {
            finer: self.counts_large.finer(0, self.options),
            uneven_steps,
            repeated_rows: self.repeated.rows(),
            notes,
            ..self.drain(self.t.len(), rate_hz)
        };
        recording.trace.periods = periods;
        Ok(recording)
    }

    /// Removes the first `rows` rows and returns them, without notes.
    pub(super) fn drain(&mut self, rows: usize, rate_hz: f64) -> Recording {
        let has = self.places.map(|place| place.is_some());
        let any = |columns: &[Column]| columns.iter().any(|column| has[*column as usize]);
        self.lines = LineNumbers::default();
        let large = front(&mut self.counts_large.counts, rows);
        let small = front(&mut self.counts_small.counts, rows);
        let current = front(&mut self.current.values, rows);
        let current_small = front(&mut self.current_small.values, rows);
        let edges = front(&mut self.edges, rows);
        let true_omega = front(&mut self.true_omega, rows);
        let board = self.board.as_mut().map(|board| board.drain(rows));
        Recording {
            board: board.unwrap_or_default(),
            t: front(&mut self.t, rows),
            finer: None,
            uneven_steps: 0,
            repeated_rows: 0,
            current_small: any(&[Column::CurrentSmall, Column::CurrentSmallMeasured])
                .then_some(current_small),
            trace: Trace {
                rate_hz,
                counts_large: large,
                counts_small: any(&[Column::CountsSmall]).then_some(small),
                current: any(&[Column::Current, Column::CurrentMeasured]).then_some(current),
                edges: any(&[Column::EdgeTick]).then_some(edges),
                true_omega: any(&[Column::TrueOmega]).then_some(true_omega),
                known: None,
                true_damping: None,
                periods: None,
            },
            notes: Vec::new(),
        }
    }
}

/// Removes the first `rows` values of a column and returns them; a column that is not read has none.
fn front<T>(column: &mut Vec<T>, rows: usize) -> Vec<T> {
    let rest = column.split_off(rows.min(column.len()));
    std::mem::replace(column, rest)
}

/// A number in the unit of the recording; `torque_constant` converts torques.
pub(super) fn scaled(row: &Row, at: Place, torque_constant: f64) -> Result<f64, Failure> {
    let number = row.number(at.column.name(), at.place)?;
    Ok(at.unit.scale.of(number, torque_constant))
}

#[cfg(test)]
mod tests;
