//! Stale readings: rows with the position of the row before where the shaft moves, as where a bus lost a message.

use crate::recording::columns::Columns;
use crate::recording::columns::left_out::LeftOut;
use crate::recording::options::{Column, ReadOptions};

/// Least step from row to row of a shaft that does not stop within a row, counts.
pub(crate) const FAST: i64 = 4;

/// Most stale readings in turn. A shaft whose position stays for longer rests.
pub(crate) const LONGEST: usize = 3;

/// Steps of one speed differ by this part at most or by a count, and the times of rows by this part.
const ALIKE: f64 = 0.25;

/// Largest part of a step that is a small one.
const SMALL: f64 = 0.25;

/// Fewest places that tell, and least ratio of them to those that only a noise makes.
const FEWEST: usize = 4;
const CLEAR: usize = 4;

/// Least part of the steps of a fast shaft that are 0 where the encoder is read less often than the log is written.
const LESS_OFTEN: f64 = 0.1;

/// Fewest such steps.
const FEWEST_HELD: usize = 50;

/// The step to a row from the one before.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    counts: i64,
    seconds: f64,
    line: u64,
}

impl Step {
    /// Whether its speed is `times` that of `other`, in rows of the same period.
    fn is_like(&self, other: &Self, times: f64) -> bool {
        let expected = times * other.counts as f64;
        (self.counts as f64 - expected).abs() <= (ALIKE * expected.abs()).max(1.0)
            && (self.seconds - other.seconds).abs() <= ALIKE * other.seconds
    }
}

/// Number of steps that a place is judged by: two before the stale readings, and two behind them.
const STEPS: usize = LONGEST + 4;

/// Steps of a position that are 0 between those of a fast shaft.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stale {
    last: Option<(i64, f64)>,
    /// The latest steps, the newest one first.
    steps: [Step; STEPS],
    /// Rows of places where the next step makes up for those of 0, number of places, and the line of the first row.
    rows: usize,
    places: usize,
    first: u64,
    /// Places with a small step in the place of one of 0: the shaft has a noise of counts.
    noisy: usize,
    /// Steps of 0 that the next one does not make up for, and steps of a fast shaft.
    held: usize,
    fast: usize,
    /// Readings that were left out, and those of them in turn.
    left_out: LeftOut,
    in_turn: usize,
}

impl Stale {
    /// Whether the reading `count` is a stale one, which is left out then.
    pub(crate) fn is_left_out(&mut self, count: i64, line: u64) -> bool {
        // A slow shaft has one large step where an absolute encoder wraps.
        let is_fast = self.steps[..2].iter().all(|step| step.counts.abs() >= FAST);
        let is_same = self.last.is_some_and(|(last, _)| last == count);
        if !(is_fast && is_same && self.in_turn < LONGEST) {
            return false;
        }
        self.in_turn += 1;
        self.left_out.add(line);
        true
    }

    /// Number of rows that were left out.
    pub(crate) fn left_out(&self) -> usize {
        self.left_out.rows
    }

    /// Adds the reading `count` of the row at `t`, s.
    pub(crate) fn add(&mut self, count: i64, t: f64, line: u64) {
        let Some((last, before)) = self.last.replace((count, t)) else {
            return;
        };
        // A step over rows that were left out is that of several rows.
        let rows = 1 + std::mem::take(&mut self.in_turn);
        self.steps.rotate_right(1);
        self.steps[0] = Step {
            counts: count.saturating_sub(last) / rows as i64,
            seconds: (t - before) / rows as f64,
            line,
        };
        self.fast += usize::from(self.steps[0].counts.abs() >= FAST);
        self.judge();
    }

    /// Looks for stale readings that end two rows before the newest one.
    fn judge(&mut self) {
        let [after, next, ..] = self.steps;
        if next.counts.abs() < FAST {
            return;
        }
        for rows in 1..=LONGEST {
            let middle = &self.steps[2..2 + rows];
            let [before, earlier] = [self.steps[2 + rows], self.steps[3 + rows]];
            if before.counts.abs() < FAST {
                continue;
            }
            let is_even = middle
                .iter()
                .all(|step| (step.seconds - before.seconds).abs() <= ALIKE * before.seconds);
            let all =
                |is: &dyn Fn(i64) -> bool| is_even && middle.iter().all(|step| is(step.counts));
            let largest = (SMALL * before.counts.abs() as f64) as i64;
            let is_zero = all(&|counts| counts == 0);
            let is_small = all(&|counts| counts != 0 && counts.abs() <= largest);
            let makes_up = next.is_like(&before, 1.0 + rows as f64)
                && earlier.is_like(&before, 1.0)
                && after.is_like(&before, 1.0);
            match (is_zero, makes_up) {
                (true, true) => {
                    if self.places == 0 {
                        self.first = middle[rows - 1].line;
                    }
                    self.places += 1;
                    self.rows += rows;
                }
                (true, false) if next.is_like(&before, 1.0) => self.held += rows,
                (false, true) => self.noisy += usize::from(is_small),
                _ => {}
            }
        }
    }

    /// The note on the readings of a `column`, which come at `rate_hz`.
    pub(crate) fn note(&self, column: &str, rate_hz: f64, options: &ReadOptions) -> Option<String> {
        let LeftOut { rows, first } = self.left_out;
        if rows > 0 {
            let (rows, are) = match rows {
                1 => ("1 row".to_owned(), "is"),
                _ => (format!("{rows} rows"), "are"),
            };
            return Some(format!(
                "{rows} {are} left out where {column} stays in a fast motion, the first in line {first}"
            ));
        }
        if self.places >= FEWEST && self.places > CLEAR * self.noisy {
            let remedy = match options.takes_options {
                true => "add --drop-stale to leave these rows out",
                false => "remove these rows",
            };
            return Some(format!(
                "{column} stays in {} rows of a fast motion and makes up for it in the next row, the first in line {}: \
                 the readings are stale, as where a bus lost a message, and the estimators take them for a stop and a \
                 jump; {remedy}",
                self.rows, self.first
            ));
        }
        let share = self.held as f64 / (self.held + self.fast) as f64;
        (self.held >= FEWEST_HELD && self.held > self.noisy && share >= LESS_OFTEN).then(|| {
            format!(
                "{column} stays in {:.0} % of the rows of a fast motion: it is read about {:.0} times a second, less often \
                 than the log is written, and the estimators take the other rows for rest; log each reading once, with \
                 its own time",
                100.0 * share,
                rate_hz * (1.0 - share)
            )
        })
    }
}

impl Columns<'_> {
    /// The note on stale readings of the large motor's encoder in rows at `rate_hz`. Those that are held over a number of
    /// rows have their own.
    pub(crate) fn stale(&self, rate_hz: f64) -> Option<String> {
        if self.counts_large.held(0, rate_hz).is_some() {
            return None;
        }
        self.stale
            .note(Column::CountsLarge.name(), rate_hz, self.options)
    }
}

#[cfg(test)]
mod tests;
