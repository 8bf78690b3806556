//! The pass over a log that runs the estimators.

use std::io;
use std::ops::Range;
use std::path::Path;

use experiments::reference::{Reference, ShaftMotion, TruthCheck};
use experiments::replay::{self, Against, BoardSummary, Run, section_rows};
use indicatif::ProgressBar;
use recordings::recording::Parts;
use simulation::device::Device;
use terminal::failure::Failure;
use terminal::output::{note, write_with};
use terminal::wording::wrapped;

use super::super::page::progress;
use super::{ReferenceUse, Replay};

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

impl<'a> Passes<'a> {
    /// The pass over the rows of `parts`, so many, for `run`, before its first section.
    pub(super) fn new(
        options: &Replay,
        (parts, rows): (Parts<'a>, usize),
        run: &Run,
        device: &Device,
        against: &Against,
        reference: Option<&'a Reference>,
    ) -> Self {
        let section = section_rows(rows);
        let steps = rows.div_ceil(section) * run.estimates.len();
        Self {
            parts,
            summary: BoardSummary::default(),
            truth: TruthCheck::default(),
            motion: ShaftMotion::default(),
            counts_per_rev: device.stages.large.counts_per_rev,
            bar: progress(steps, "estimating"),
            section,
            reference,
            scores: matches!(against, Against::Reference(_)),
            columns: options.reference == Some(ReferenceUse::Columns),
            deviations: options.deviations,
            passed: 0..0,
        }
    }

    /// Prints what the rows of the recording `name` tell of the board, and whether its truth is that of its counts,
    /// after the `interruptions` of its reference.
    pub(super) fn note(&self, name: &str, device: &Device, interruptions: Option<String>) {
        for line in self.summary.lines(device) {
            note(format_args!("{name}: {line}"));
        }
        for line in interruptions.into_iter().chain(self.truth.line()) {
            note(wrapped(&format!("{name}: {line}"), 2));
        }
    }

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
