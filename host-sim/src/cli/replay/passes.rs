//! The pass over a log that runs the estimators.

use std::io;
use std::ops::Range;
use std::path::Path;

use experiments::reference::{Reference, ShaftMotion, TruthCheck};
use experiments::replay::{self, BoardSummary, Run};
use indicatif::ProgressBar;
use recordings::recording::Parts;
use terminal::failure::Failure;
use terminal::output::write_with;

/// The second pass over a log.
pub(super) struct Passes<'a> {
    pub(super) parts: Parts<'a>,
    pub(super) summary: BoardSummary,
    /// Whether the true velocity is that of the counts.
    pub(super) truth: TruthCheck,
    pub(super) motion: ShaftMotion,
    pub(super) counts_per_rev: u32,
    pub(super) bar: ProgressBar,
    /// Rows of a section.
    pub(super) section: usize,
    pub(super) reference: Option<&'a Reference>,
    /// Whether scores are against the reference.
    pub(super) scores: bool,
    /// Whether the reference is written.
    pub(super) columns: bool,
    /// Whether standard deviations are written.
    pub(super) deviations: bool,
    /// The latest rows.
    pub(super) passed: Range<usize>,
}

impl Passes<'_> {
    /// Runs the estimators over the next section; `false` after the last one.
    pub(super) fn step(&mut self, run: &mut Run) -> Result<bool, Failure> {
        let mut rows = self.parts.next(self.section)?;
        if rows.t.is_empty() {
            return Ok(false);
        }
        self.passed = self.passed.end..self.passed.end + rows.t.len();
        self.truth.add(&rows, self.counts_per_rev);
        self.motion.add(&rows);
        if let (Some(reference), true) = (self.reference, self.scores) {
            reference.to_trace(&mut rows.trace, self.passed.clone());
        }
        let bar = &self.bar;
        let board = std::mem::take(&mut rows.board);
        run.add(rows, &|| bar.inc(1))?;
        match self.scores {
            true => self.summary.learn(&board),
            false => self.summary.add(&run.section.trace, &board),
        }
        Ok(true)
    }

    /// The reference of the latest rows and its standard deviation, if they are written.
    fn reference_columns(&self) -> Vec<&[f64]> {
        let reference = self.reference.filter(|_| self.columns);
        let columns = reference.map(|reference| [&reference.omega, &reference.sd]);
        let columns = columns.into_iter().flatten();
        columns.map(|column| &column[self.passed.clone()]).collect()
    }
}

/// Runs the estimators over all sections and writes the velocities of each.
pub(super) fn write_rows(out: &Path, passes: &mut Passes, run: &mut Run) -> Result<(), Failure> {
    let mut refused = None;
    let written = write_with(out, |to| {
        let mut is_first = true;
        loop {
            match passes.step(run) {
                Ok(true) => {
                    let (names, columns): (Vec<_>, Vec<_>) =
                        run.columns(passes.deviations).into_iter().unzip();
                    let reference = passes.reference_columns();
                    if std::mem::take(&mut is_first) {
                        let of_reference = match reference.is_empty() {
                            true => &[][..],
                            false => &replay::REFERENCE_COLUMNS,
                        };
                        let names = names.iter().map(String::as_str);
                        replay::csv_header(to, names.chain(of_reference.iter().copied()))?;
                    }
                    replay::csv(to, run.t(), &columns, &reference)?;
                }
                Ok(false) => return Ok(()),
                Err(failure) => {
                    let error = io::Error::other(failure.to_string());
                    refused = Some(failure);
                    return Err(error);
                }
            }
        }
    });
    refused.map_or(written, Err)
}
