//! The second of two passes over a log: its rows in parts, of which only one is in memory.

use std::io::Read;

use estimator_core::Count;
use terminal::failure::Failure;

use super::Recording;
use super::board::Board;
use super::columns::Columns;
use super::encoder::absolute;
use super::options::ReadOptions;
use super::records::Records;
use super::survey::Survey;
use super::times::clock::{Gaps, Uneven};

/// Rows that are read at once.
pub(super) const BLOCK: usize = 1 << 13;

/// The rows of a log in parts, after a survey of the same log.
pub struct Parts<'a> {
    records: Records<'a>,
    columns: Columns<'a>,
    survey: &'a Survey,
    /// The last count of each encoder, unwrapped.
    unwrapped: [Option<Count>; 2],
    gaps: Gaps,
    uneven: Uneven,
    /// Steps to the rows that were taken and not yet returned, over the period.
    periods: Vec<f32>,
    /// Rows of the log that new rows lie between.
    between: Recording,
    /// Number of rows that replaced those of the log.
    resampled: usize,
    /// Rows that are not yet returned.
    waiting: Recording,
    ended: bool,
}

impl<'a> Parts<'a> {
    /// Begins the second pass over the log of `survey`, which was read with the same `options`.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn open(
        input: impl Read + 'a,
        name: &'a str,
        options: &'a ReadOptions,
        survey: &'a Survey,
    ) -> Result<Self, Failure> {
        let records = Records::open(input, name, options)?;
        let board = Board::in_parts(&records.layout, survey.resample);
        let mut columns = Columns::new(&records.layout.places(options, name)?, options, board);
        let empty = columns.drain(0, survey.columns.rate_hz);
        Ok(Self {
            records,
            columns,
            survey,
            unwrapped: [None; 2],
            gaps: Gaps::default(),
            uneven: Uneven::new(survey.period),
            // The first row has no step.
            periods: vec![1.0],
            between: empty.clone(),
            resampled: 0,
            waiting: Recording {
                trace: survey.columns.clone(),
                ..empty
            },
            ended: false,
        })
    }

    /// The next rows, at most `rows`; an empty recording after the last one. The parts have no notes.
    ///
    /// # Errors
    /// As [`Parts::open`].
    pub fn next(&mut self, rows: usize) -> Result<Recording, Failure> {
        while self.waiting.t.len() < rows && !self.ended {
            let part = self.read()?;
            self.ended = part.t.is_empty();
            match self.survey.resample {
                None => self.waiting.append(part),
                Some(rate_hz) => self.resample(part, rate_hz),
            }
        }
        Ok(self.waiting.split_front(rows))
    }

    /// Notes on the clock of the rows that were read, one line each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let replaced = self.survey.resample.and_then(|_| self.uneven.note());
        self.gaps.note().into_iter().chain(replaced).collect()
    }

    /// Description of the uneven steps of the rows; `None` if there are none.
    #[must_use]
    pub fn unevenness(&self) -> Option<String> {
        match self.survey.resample {
            Some(_) => None,
            None => self.uneven.note(),
        }
    }

    /// The next rows of the log, with unwrapped counts.
    fn read(&mut self) -> Result<Recording, Failure> {
        let (gaps, uneven, rate_hz) = (&mut self.gaps, &mut self.uneven, self.survey.rate_hz);
        let columns = &self.survey.columns;
        let periods = &mut self.periods;
        let mut part = self
            .columns
            .read(&mut self.records, BLOCK, |t, step, line| {
                gaps.add(step, rate_hz, t, || line);
                uneven.add(step);
                periods.push((step * rate_hz) as f32);
            })?;
        part.trace.rate_hz = columns.rate_hz;
        let periods = self.periods.drain(..part.t.len()).collect();
        part.trace.periods = columns.periods.as_ref().map(|_| periods);
        let trace = &mut part.trace;
        let [large, small] = self.survey.wraps;
        if let Some(modulus) = large {
            for (k, count) in trace.counts_large.iter_mut().enumerate() {
                let raw = *count;
                *count = next_count(&mut self.unwrapped[0], raw, modulus);
                if let Some(Some(edge)) = trace.edges.as_mut().map(|edges| &mut edges[k]) {
                    edge.boundary = absolute::boundary(edge.boundary, raw, *count, modulus);
                }
            }
        }
        if let (Some(modulus), Some(counts)) = (small, &mut trace.counts_small) {
            for count in counts {
                *count = next_count(&mut self.unwrapped[1], *count, modulus);
            }
        }
        Ok(part)
    }

    /// Replaces rows of the log by those at a constant rate that lie before its latest row.
    fn resample(&mut self, part: Recording, rate_hz: f64) {
        self.between.append(part);
        let t = &self.between.t;
        let last = t.last().copied().unwrap_or_default();
        let times = (self.resampled..self.survey.rows)
            .map(|k| self.survey.first_t + k as f64 / rate_hz)
            .take_while(|now| self.ended || *now < last);
        let times: Vec<_> = times.collect();
        let Some(latest) = times.last().copied() else {
            return;
        };
        self.resampled += times.len();
        let mut new = self.between.clone();
        new.replace_rows(times, rate_hz);
        self.waiting.append(new);
        let passed = self.between.t.partition_point(|t| *t <= latest);
        self.between.split_front(
            passed
                .saturating_sub(1)
                .min(self.between.t.len().saturating_sub(2)),
        );
    }
}

/// The next unwrapped count. The survey has unwrapped the same counts without an error.
fn next_count(last: &mut Option<Count>, raw: u32, modulus: u32) -> u32 {
    let next = absolute::after(*last, raw, modulus).unwrap_or(Count(raw));
    *last = Some(next);
    next.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same log as a whole and in parts of `rows` rows, with everything that is said about it.
    fn both(text: &str, resample: Option<f64>, rows: usize) -> [(Recording, Vec<String>); 2] {
        let options = ReadOptions::default();
        let mut whole = Recording::parse_as(text.as_bytes(), "r", &options).unwrap();
        let unwrapped = whole.unwrap_counts(&options);
        whole.notes.extend(unwrapped);
        let mut said = whole.notes.clone();
        said.extend(whole.unevenness());
        if let Some(hz) = resample {
            whole.resample(hz, "r").unwrap();
        }
        let survey = Survey::new(text.as_bytes(), "r", &options, resample).unwrap();
        let mut parts = Parts::open(text.as_bytes(), "r", &options, &survey).unwrap();
        let mut all = parts.next(rows).unwrap();
        loop {
            let part = parts.next(rows).unwrap();
            if part.t.is_empty() {
                break;
            }
            assert!(part.t.len() <= rows);
            all.append(part);
        }
        assert_eq!(survey.rows, all.t.len());
        let notes = survey.notes.iter().cloned().chain(parts.notes());
        let mut notes: Vec<_> = notes.chain(parts.unevenness()).collect();
        notes.sort();
        said.sort();
        [(whole, said), (all, notes)]
    }

    /// Rows with every column, of an absolute encoder, with late and missing rows.
    fn log() -> String {
        let mut text = String::from(
            "t,counts_large,counts_small,current,current_small,edge_tick,edge_bound,true_omega,\
             current_measured,current_small_measured\n",
        );
        for k in 0..40_000_i64 {
            let late = if k % 5 == 0 { 120e-6 } else { 0.0 };
            if k % 7000 == 6999 {
                continue;
            }
            let t = k as f64 * 1e-3 + late;
            let at = 2.4 * t * 1e3;
            let count = at.floor() as i64;
            let edge = count as f64 / 2400.0 * 84e6;
            let (wrapped, small) = (count.rem_euclid(4096), (3 * count).rem_euclid(20_000));
            let measured = if k % 17 == 0 {
                String::new()
            } else {
                format!("{k}")
            };
            text += &format!(
                "{t},{wrapped},{small},{},{},{edge},{wrapped},{at},{measured},{}\n",
                k % 11,
                k % 13,
                2 * k,
            );
        }
        text
    }

    #[test]
    fn parts_are_the_whole_recording() {
        let text = log();
        for (resample, rows) in [
            (None, 7),
            (None, 9000),
            (Some(1000.0), 9001),
            (Some(3210.0), 50_000),
        ] {
            let [(whole, said), (parts, notes)] = both(&text, resample, rows);
            assert_eq!(notes, said);
            assert!(said.len() > 3, "{said:?}");
            assert_eq!(parts.t, whole.t);
            assert_eq!(parts.current_small, whole.current_small);
            let (parts, whole) = (parts.trace, whole.trace);
            assert_eq!(parts.rate_hz, whole.rate_hz);
            assert_eq!(parts.counts_large, whole.counts_large);
            assert_eq!(parts.counts_small, whole.counts_small);
            assert_eq!(parts.current, whole.current);
            assert_eq!(parts.edges, whole.edges);
            assert_eq!(parts.true_omega, whole.true_omega);
            assert_eq!(parts.periods, whole.periods);
            assert_eq!(parts.periods.is_some(), resample.is_none());
        }
    }
}
