//! An estimator over rows in blocks, with the reports of all rows.

use catalogue::estimators::{Estimator, Kind, Lack, Reports, State};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Rows between two looks for Ctrl-C. Their columns and results are in the cache.
const SECTION: usize = 1 << 15;

/// Velocity, standard deviation, acceleration and ratio of the damping, as arrays.
pub(crate) type Arrays<'py> = (
    Bound<'py, PyArray1<f32>>,
    Option<Bound<'py, PyArray1<f32>>>,
    Option<Bound<'py, PyArray1<f32>>>,
    Option<Bound<'py, PyArray1<f32>>>,
);

/// The reports as arrays.
pub(crate) fn arrays(py: Python<'_>, reports: Reports) -> Arrays<'_> {
    let array = |column: Option<Vec<f32>>| column.map(|column| column.into_pyarray(py));
    (
        reports.velocity.into_pyarray(py),
        array(reports.deviation),
        array(reports.acceleration),
        array(reports.damping_ratio),
    )
}

/// An estimator and its state.
#[derive(Clone)]
pub(crate) struct Stream {
    estimator: Estimator,
    state: Option<State>,
    /// The last row, whose current acts until the next one.
    last: Option<Trace>,
}

impl Stream {
    pub(crate) fn new(estimator: Estimator) -> Self {
        Self {
            estimator,
            state: None,
            last: None,
        }
    }

    /// Runs over the rows of `trace`, which follow those before, and calls `look` after each section.
    pub(crate) fn run(
        &mut self,
        trace: &Trace,
        mut look: impl FnMut() -> PyResult<()>,
    ) -> PyResult<Reports> {
        let rows = trace.len();
        let mut all = Reports::default();
        let mut end = 0;
        while end < rows {
            let start = end;
            end = rows.min(start + SECTION);
            let (section, from) = match self.last.take() {
                None => (trace.rows(start..end), 0),
                Some(_) if start > 0 => (trace.rows(start - 1..end), 1),
                Some(last) => (followed(last, trace.rows(start..end)), 1),
            };
            let reports = self.estimator.resume(&mut self.state, &section, from);
            self.last = Some(trace.rows(end - 1..end));
            if all.velocity.is_empty() {
                all = reports;
                reserve(&mut all, rows - (end - start));
            } else {
                append(&mut all, reports);
            }
            look()?;
        }
        Ok(all)
    }
}

/// `last`, and the rows that follow.
fn followed(mut last: Trace, rows: Trace) -> Trace {
    fn join<T>(column: Option<Vec<T>>, more: Option<Vec<T>>) -> Option<Vec<T>> {
        let (mut column, more) = (column?, more?);
        column.extend(more);
        Some(column)
    }
    last.counts_large.extend(rows.counts_large);
    Trace {
        rate_hz: rows.rate_hz,
        periods: join(last.periods, rows.periods),
        counts_large: last.counts_large,
        counts_small: join(last.counts_small, rows.counts_small),
        current: join(last.current, rows.current),
        edges: join(last.edges, rows.edges),
        true_omega: None,
        known: None,
        true_damping: None,
    }
}

fn columns(reports: &mut Reports) -> [Option<&mut Vec<f32>>; 4] {
    [
        Some(&mut reports.velocity),
        reports.deviation.as_mut(),
        reports.acceleration.as_mut(),
        reports.damping_ratio.as_mut(),
    ]
}

fn reserve(reports: &mut Reports, rows: usize) {
    for column in columns(reports).into_iter().flatten() {
        column.reserve_exact(rows);
    }
}

fn append(reports: &mut Reports, mut more: Reports) {
    let pairs = columns(reports).into_iter().zip(columns(&mut more));
    for (column, more) in pairs {
        if let (Some(column), Some(more)) = (column, more) {
            column.append(more);
        }
    }
}

/// Reason why the estimator `kind` cannot run on rows with the columns of `trace`.
pub(crate) fn lack(kind: &Kind, trace: &Trace, name: &str) -> Result<(), Failure> {
    let Some(Lack::Column(column)) = kind.lack(trace) else {
        return Ok(());
    };
    let (what, argument) = match column {
        "current" => ("the current of the large motor", "current"),
        "counts_small" => ("the counts of the small encoder", "coupled"),
        _ => ("the latest edge", "edge_age and edge_boundary"),
    };
    Err(Failure::Input(format!(
        "{name}: {} needs {what}: pass {argument}, or choose an estimator without this need, see \
         limpid.estimators()",
        kind.name
    )))
}
