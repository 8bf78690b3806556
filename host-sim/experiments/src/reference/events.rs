//! The observations of a recording in the order of time.

use recordings::recording::Recording;

/// What was observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A row: the count.
    Row,
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
    pub kind: Kind,
}

/// The observations of the rows `rows`, with times in periods of `period_s`.
pub(super) fn events(
    recording: &Recording,
    rows: std::ops::Range<usize>,
    period_s: f64,
) -> Vec<Event> {
    let trace = &recording.trace;
    let counts = &trace.counts_large;
    let mut events = Vec::with_capacity(rows.len());
    let mut last: Option<(f64, u32)> = None;
    let mut push = |t: f64, origin: u32, kind: Kind| {
        let (since, shift) = match last {
            Some((before, from)) => (
                (t - before).max(0.0),
                f64::from(from.wrapping_sub(origin) as i32),
            ),
            None => (0.0, 0.0),
        };
        last = Some((t, origin));
        events.push(Event {
            since: since / period_s,
            shift,
            kind,
        });
    };
    for k in rows.clone() {
        let t = recording.t[k];
        let stamps = trace.edges.as_ref().filter(|_| k > rows.start);
        if let Some((edge, before)) = stamps.and_then(|e| Some((e[k]?, recording.t[k - 1]))) {
            // An edge of this interval; an older one was observed with an earlier row.
            let at = t - edge.age_s;
            if at > before && edge.age_s >= 0.0 {
                push(at, edge.boundary, Kind::Edge);
            }
        }
        push(t, counts[k], Kind::Row);
    }
    events
}
