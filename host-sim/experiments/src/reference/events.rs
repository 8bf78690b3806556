//! The observations of a recording in the order of time.

use std::ops::Range;

use recordings::recording::{LONGEST_GAP, Recording};

use super::sections::Row;

/// What was observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A row: the count.
    Row,
    /// A row with a bad count: nothing.
    Bad,
    /// A stamped edge: the position is the boundary.
    Edge,
}

/// One observation. The position's origin is the lower end of the row's cell, or the edge's boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    /// Time since the event before, periods.
    pub since: f64,
    /// Origin of the event before less that of this one, counts.
    pub shift: f64,
    /// Whether nothing is known of the motion since the event before.
    pub restarts: bool,
    pub kind: Kind,
}

/// The events so far.
struct Events {
    events: Vec<Event>,
    /// Time, s, and origin of the latest event.
    last: Option<(f64, u32)>,
    period_s: f64,
    /// Longest interval over which the motion is followed, s.
    longest_s: f64,
}

impl Events {
    fn push(&mut self, t: f64, origin: u32, kind: Kind, jumped: bool) {
        let (since, shift) = match self.last {
            Some((before, from)) => (
                (t - before).max(0.0),
                f64::from(from.wrapping_sub(origin) as i32),
            ),
            None => (0.0, 0.0),
        };
        self.last = Some((t, origin));
        self.events.push(Event {
            since: since / self.period_s,
            shift,
            restarts: jumped || since > self.longest_s,
            kind,
        });
    }
}

/// The observations of the rows `range`, which say of the motion what `rows` states, with times in
/// periods of `period_s`.
pub(super) fn events(
    recording: &Recording,
    rows: &[Row],
    range: Range<usize>,
    period_s: f64,
) -> Vec<Event> {
    let trace = &recording.trace;
    let counts = &trace.counts_large;
    let mut events = Events {
        events: Vec::with_capacity(range.len()),
        last: None,
        period_s,
        longest_s: LONGEST_GAP * trace.period_s(),
    };
    // A range that begins with a bad count is from the first other one on: nothing is known of the motion between.
    let first = range.clone().find(|k| rows[*k] != Row::Bad);
    let first = counts[first.unwrap_or(range.start)];
    for k in range.clone() {
        let t = recording.t[k];
        if rows[k] == Row::Bad {
            let origin = events.last.map_or(first, |(_, origin)| origin);
            events.push(t, origin, Kind::Bad, false);
            continue;
        }
        let jumped = matches!(rows[k], Row::Jumped | Row::Returned | Row::Resumed);
        // It is not known on which side of a jump an edge is, nor what the shaft did in a long gap.
        let stamps = trace.edges.as_ref().filter(|_| k > range.start && !jumped);
        if let Some((edge, before)) = stamps.and_then(|e| Some((e[k]?, recording.t[k - 1]))) {
            // An edge of this interval; an older one was observed with an earlier row.
            let at = t - edge.age_s;
            if at > before && edge.age_s >= 0.0 {
                events.push(at, edge.boundary, Kind::Edge, false);
            }
        }
        events.push(t, counts[k], Kind::Row, jumped);
    }
    events.events
}
