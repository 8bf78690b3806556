//! The first of two passes over a log, for a recording in parts: what all rows tell.

use std::io::Read;

use estimator_core::{Count, WrapError};
use simulation::trace::Trace;
use terminal::failure::Failure;

use super::board::Board;
use super::columns::Columns;
use super::columns::currents::{implausible_current, largest};
use super::encoder::absolute::{self, Extent, Found};
use super::layout::hint;
use super::options::ReadOptions;
use super::parts::BLOCK;
use super::records::Records;
use super::times::clock;
use super::times::resample::resampled_rows;
use super::times::steps::Steps;

/// Properties of a log as a whole, from a pass over all of its rows.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The columns and the rate of the recording, without rows.
    pub columns: Trace,
    /// Number of rows of the recording.
    pub rows: usize,
    /// Notes of the reader on the columns and the encoders, one line each.
    pub notes: Vec<String>,
    /// Rate at which rows replace those of the log, Hz.
    pub(super) resample: Option<f64>,
    /// Period of the log's rows, s, and rate, Hz.
    pub(super) period: f64,
    pub(super) rate_hz: f64,
    pub(super) first_t: f64,
    /// Rows that are left out because they have the time of the row before.
    repeated_rows: usize,
    steps: Steps,
    /// Modulus at which the counts of each encoder are unwrapped.
    pub(super) wraps: [Option<u32>; 2],
}

/// What a survey keeps of one encoder.
#[derive(Clone, Copy, Debug)]
struct Seen {
    extent: Extent,
    /// The last count, unwrapped at each of the moduli; an error stays.
    unwrapped: [Result<Option<Count>, WrapError>; 2],
}

impl Seen {
    fn nothing() -> Self {
        Self {
            extent: Extent::default(),
            unwrapped: [Ok(None); 2],
        }
    }

    /// Adds a count and returns its distance from the last one.
    fn add(&mut self, count: u32, moduli: [u32; 2]) -> i64 {
        let signed = i64::from(count as i32);
        for (unwrapped, modulus) in self.unwrapped.iter_mut().zip(moduli) {
            *unwrapped = unwrapped.and_then(|last| absolute::after(last, count, modulus).map(Some));
        }
        self.extent.add(signed, moduli)
    }

    /// What the counts with the largest jump `jump` are.
    fn found(&self, jump: (i64, f64), per_rev: u32) -> Option<Found> {
        let found = absolute::found(jump, &self.extent, per_rev);
        let Some(Found::Wraps(modulus)) = found else {
            return found;
        };
        let tried = absolute::moduli(per_rev).into_iter().zip(self.unwrapped);
        let error = tried
            .filter(|(tried, _)| *tried == modulus)
            .find_map(|(_, unwrapped)| unwrapped.err());
        error.map_or(found, |error| Some(Found::Refused(modulus, error)))
    }
}

impl Survey {
    /// Reads all rows of the log called `name` in messages. `resample` is the rate of
    /// the rows that replace them, Hz.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn new(
        input: impl Read,
        name: &str,
        options: &ReadOptions,
        resample: Option<f64>,
    ) -> Result<Self, Failure> {
        let per_rev = options.counts_per_rev;
        let moduli = per_rev.map(absolute::moduli);
        let mut records = Records::open(input, name, options)?;
        let places = records.layout.places(options, name)?;
        let board = Board::in_parts(&records.layout, resample);
        let mut columns = Columns::new(&places, options, board);
        let mut steps = Steps::default();
        let mut seen = [Seen::nothing(); 2];
        let mut ends: Option<[f64; 2]> = None;
        let mut rows = 0;
        let mut current: f64 = 0.0;
        loop {
            let block = columns.read(&mut records, BLOCK, |_, _, _| ())?;
            if block.t.is_empty() {
                break;
            }
            rows += block.t.len();
            current = current.max(block.trace.current.as_deref().map_or(0.0, largest));
            for (k, &t) in block.t.iter().enumerate() {
                let large = seen[0].add(block.trace.counts_large[k], moduli[0]);
                let small = block.trace.counts_small.as_ref();
                let small = small.map_or(0, |counts| seen[1].add(counts[k], moduli[1]));
                if let Some([_, last]) = ends {
                    steps.add(t - last, [large, small]);
                }
                ends = Some([ends.map_or(t, |[first, _]| first), t]);
            }
        }
        let mut notes = columns.checked(name, &places, &records.layout)?;
        let option = || hint::current(&places, &records.layout);
        notes.extend(implausible_current(current, options.current_limit, option));
        let repeated_rows = columns.repeated.rows();
        let (period, rate_hz) = steps.period(name)?;
        notes.extend(clock::fast(rate_hz));
        notes.extend(columns.jitter(rate_hz));
        notes.extend(columns.held(rate_hz).filter(|_| resample.is_none()));
        notes.extend(columns.stale(rate_hz));
        let mut wraps = [None; 2];
        for (motor, seen) in seen.iter().enumerate() {
            let jump = steps.largest_jump(1.0 / rate_hz, motor);
            let found = seen.found(jump, per_rev[motor]);
            if let Some(Found::Wraps(modulus)) = found {
                wraps[motor] = Some(modulus);
            }
            notes.extend(found.map(|found| found.note(motor, options)));
        }
        let [first_t, last_t] = ends.unwrap_or_default();
        let rows = match resample {
            Some(hz) => resampled_rows(first_t, last_t, rows, hz, name)?,
            None => rows,
        };
        let mut columns = columns.drain(0, resample.unwrap_or(rate_hz)).trace;
        let are_uneven = resample.is_none() && steps.are_uneven(1.0 / rate_hz);
        columns.periods = are_uneven.then(Vec::new);
        Ok(Self {
            columns,
            rows,
            notes,
            resample,
            period,
            rate_hz,
            first_t,
            repeated_rows,
            steps,
            wraps,
        })
    }

    /// Description of the uneven steps of the rows; `None` if there are none.
    #[must_use]
    pub fn unevenness(&self) -> Option<String> {
        match self.resample {
            Some(_) => None,
            None => clock::unevenness(&self.steps, self.period),
        }
    }

    /// Checks that the times of the rows are known; see
    /// [`Recording::check_times`](super::Recording::check_times).
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy.
    pub fn check_times(&self, name: &str) -> Result<(), Failure> {
        match self.resample {
            Some(_) => Ok(()),
            None => {
                self.steps.check_bursts(self.repeated_rows, name)?;
                self.steps.check_times(self.rate_hz, name)
            }
        }
    }
}
