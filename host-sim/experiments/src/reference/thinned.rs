//! Rows of one count that say nothing more of a slow motion.
//!
//! A row that has the count of the rows beside it is taken for a Gaussian position. Over hundreds of such
//! rows the deviation shrinks to nothing in the middle of the cell. The edge that follows is then explained
//! by a jerk that the shaft does not have. The pieces over which the likelihood is computed have few edges,
//! too.

use recordings::recording::Recording;
use simulation::trace::Trace;

use super::sections::Row;

/// Rows from a change of the count to the next, but for the share [`FASTEST`] of them, from which on rows are left out.
/// With fewer the likelihood is right, and it needs all rows of an impact between long rests.
const MANY: usize = 64;

/// Share of the intervals between two changes of the count that may be shorter: those of the fastest motion.
const FASTEST: f64 = 0.2;

/// Rows from a change of the count to the next that are kept.
const KEPT: usize = 8;

/// Every n-th row of `recording`, where its count changes so rarely that rows are left out.
pub(super) fn thinned(recording: &Recording) -> Option<Recording> {
    let trace = &recording.trace;
    let every = every(recording);
    if every == 1 {
        return None;
    }
    let edges = trace.edges.as_ref();
    Some(Recording {
        t: recording.t.iter().copied().step_by(every).collect(),
        trace: Trace {
            rate_hz: trace.rate_hz / every as f64,
            counts_large: trace.counts_large.iter().copied().step_by(every).collect(),
            edges: edges.map(|edges| edges.iter().copied().step_by(every).collect()),
            ..Trace::default()
        },
        ..Recording::default()
    })
}

/// Takes every row of `recording` for one that says nothing, but for each n-th and those beside an edge.
pub(super) fn pass_over(rows: &mut [Row], recording: &Recording) {
    let every = every(recording);
    let (t, trace) = (&recording.t, &recording.trace);
    let counts = &trace.counts_large;
    let is_stamped = |k: usize| {
        let edge = trace.edges.as_ref().and_then(|edges| edges[k]);
        edge.is_some_and(|edge| edge.age_s < t[k] - t[k - 1])
    };
    if every == 1 {
        return;
    }
    for k in 1..rows.len().saturating_sub(1) {
        let is_within = counts[k - 1] == counts[k] && counts[k] == counts[k + 1];
        if k % every != 0 && rows[k] == Row::Next && is_within && !is_stamped(k) {
            rows[k] = Row::Bad;
        }
    }
}

/// Number n, if each n-th row is taken.
pub(super) fn every(recording: &Recording) -> usize {
    match gap(&recording.trace.counts_large) {
        0..MANY => 1,
        gap => gap / KEPT,
    }
}

/// Least number of rows from a change of the count to the next, but for the share [`FASTEST`] of them; 0 with fewer than
/// two changes.
fn gap(counts: &[u32]) -> usize {
    let changes: Vec<_> = (1..counts.len())
        .filter(|k| counts[*k] != counts[*k - 1])
        .collect();
    let mut gaps: Vec<_> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_unstable();
    let fastest = (FASTEST * gaps.len() as f64) as usize;
    gaps.get(fastest).copied().unwrap_or_default()
}
