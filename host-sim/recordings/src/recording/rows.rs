//! Rows that are moved between recordings.

use simulation::trace::Trace;

use super::Recording;

impl Recording {
    /// Adds the rows of another recording with the same columns.
    pub fn append(&mut self, mut other: Self) {
        let (trace, added) = (&mut self.trace, &mut other.trace);
        self.t.append(&mut other.t);
        trace.counts_large.append(&mut added.counts_large);
        add(&mut trace.counts_small, &mut added.counts_small);
        add(&mut trace.current, &mut added.current);
        add(&mut self.current_small, &mut other.current_small);
        add(&mut trace.edges, &mut added.edges);
        add(&mut trace.periods, &mut added.periods);
        add(&mut trace.true_omega, &mut added.true_omega);
        add(&mut trace.known, &mut added.known);
        self.board.append(other.board);
    }

    /// Removes the first `rows` rows, or all if there are fewer, and returns them.
    pub fn split_front(&mut self, rows: usize) -> Self {
        let rows = rows.min(self.t.len());
        let trace = &mut self.trace;
        Self {
            t: self.t.drain(..rows).collect(),
            current_small: front(&mut self.current_small, rows),
            board: self.board.split_front(rows),
            uneven_steps: 0,
            repeated_rows: 0,
            finer: None,
            notes: Vec::new(),
            trace: Trace {
                rate_hz: trace.rate_hz,
                counts_large: trace.counts_large.drain(..rows).collect(),
                counts_small: front(&mut trace.counts_small, rows),
                current: front(&mut trace.current, rows),
                edges: front(&mut trace.edges, rows),
                periods: front(&mut trace.periods, rows),
                true_omega: front(&mut trace.true_omega, rows),
                known: front(&mut trace.known, rows),
                true_damping: front(&mut trace.true_damping, rows),
            },
        }
    }
}

fn add<T>(column: &mut Option<Vec<T>>, added: &mut Option<Vec<T>>) {
    if let (Some(column), Some(added)) = (column, added) {
        column.append(added);
    }
}

fn front<T>(column: &mut Option<Vec<T>>, rows: usize) -> Option<Vec<T>> {
    column.as_mut().map(|column| column.drain(..rows).collect())
}
