//! What a coarse encoder on the same shaft would have reported.
//!
//! Between two rows of the fine encoder the position is a straight line. In coarse counts it is
//!
//! ```text
//! x = fine * C / F + phase        C coarse and F fine counts per revolution
//! ```
//!
//! The coarse count is `floor(x)`, and the boundary `e` is crossed where `x = e`. A tick between two
//! rows, as at a rate that does not divide that of the rows or where the rows are uneven, takes the
//! position and the truth by linear interpolation.

use recordings::recording::Recording;
use simulation::trace::{EdgeStamp, Trace};
use terminal::failure::Failure;

use super::fine::Fine;

/// Largest distance of a tick from a row that counts as the same instant, s.
const SAME_INSTANT_S: f64 = 1e-9;

/// Smallest number of fine counts in a coarse one. Below it the staircase of the fine encoder
/// decides where the edges are.
pub(crate) const FEWEST_FINE_COUNTS: f64 = 2.0;

/// Largest rate, in mean rates of the rows: times in a file are rounded.
const ROUNDED: f64 = 1.0001;

/// The coarse encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarse {
    /// Counts per revolution of the fine encoder.
    pub fine_counts_per_rev: u32,
    /// Counts per revolution of the coarse encoder.
    pub counts_per_rev: u32,
    /// Rate of the ticks, Hz.
    pub rate_hz: f64,
    /// Position of the coarse encoder's boundaries relative to the zero of the fine one, counts.
    pub phase: f64,
}

impl Coarse {
    /// Whether `fine` is fine and fast enough: at least [`FEWEST_FINE_COUNTS`] in a coarse count, and
    /// a row a tick on the average.
    #[must_use]
    pub(crate) fn is_resolved_by(&self, fine: &Fine) -> bool {
        self.has_counts() && self.has_rows(fine)
    }

    fn has_counts(&self) -> bool {
        f64::from(self.fine_counts_per_rev) >= FEWEST_FINE_COUNTS * f64::from(self.counts_per_rev)
    }

    fn has_rows(&self, fine: &Fine) -> bool {
        self.rate_hz <= ROUNDED * fine.mean_rate_hz()
    }

    /// Position in coarse counts.
    fn position(&self, fine: i64) -> f64 {
        fine as f64 * f64::from(self.counts_per_rev) / f64::from(self.fine_counts_per_rev)
            + self.phase
    }

    /// The recording that the coarse encoder makes of `fine`, called `name` in messages. Its time
    /// begins at 0, and its edges are empty before the first one.
    ///
    /// # Errors
    /// [`Failure::Input`] if the recording does not resolve the coarse encoder or the rate, or lasts
    /// less than a tick.
    pub fn recording(&self, fine: &Fine, name: &str) -> Result<Recording, Failure> {
        let refused = |why: String| Err(Failure::Input(format!("{name}: {why}")));
        let rows_hz = fine.mean_rate_hz();
        if !self.has_rows(fine) {
            return refused(format!(
                "its rows come at {rows_hz:.2} Hz on the average, which is less than the {} Hz of --rate; ask \
                 for at most --rate {:.0}, or cut the log at its gaps",
                self.rate_hz,
                (ROUNDED * rows_hz).floor()
            ));
        }
        if !self.has_counts() {
            let most = (f64::from(self.fine_counts_per_rev) / FEWEST_FINE_COUNTS).floor();
            return refused(format!(
                "{} fine counts/rev do not resolve {} counts/rev; ask for at most {most} counts/rev",
                self.fine_counts_per_rev, self.counts_per_rev
            ));
        }
        self.along(fine, name)
    }

    /// As [`Coarse::recording`], also at a resolution or a rate that the rows do not resolve: between
    /// two rows the position is a straight line.
    ///
    /// # Errors
    /// [`Failure::Input`] if the recording lasts less than a tick.
    pub fn along(&self, fine: &Fine, name: &str) -> Result<Recording, Failure> {
        let start = fine.t[0];
        let last = fine.t[fine.t.len() - 1] - start;
        let ticks = ((last + SAME_INSTANT_S) * self.rate_hz).floor() as usize + 1;
        if ticks < 2 {
            return Err(Failure::Input(format!("{name}: lasts less than a tick")));
        }
        let mut walk = Walk::new(self, fine);
        let mut trace = Trace {
            rate_hz: self.rate_hz,
            current: fine.current.as_ref().map(|_| Vec::new()),
            true_omega: fine.omega.as_ref().map(|_| Vec::new()),
            ..Trace::default()
        };
        let mut edges = Vec::new();
        let mut t = Vec::new();
        for k in 0..ticks {
            let now = k as f64 / self.rate_hz;
            let at = walk.to(start + now);
            t.push(now);
            trace.counts_large.push(at.count as u32);
            edges.push(at.edge.map(|(time, boundary)| EdgeStamp {
                age_s: (start + now - time).max(0.0),
                boundary: boundary as u32,
            }));
            if let (Some(current), Some(fine)) = (&mut trace.current, &fine.current) {
                current.push(fine[at.row]);
            }
            if let (Some(truth), Some(omega)) = (&mut trace.true_omega, &fine.omega) {
                let next = omega[(at.row + 1).min(omega.len() - 1)];
                truth.push(omega[at.row] + at.part * (next - omega[at.row]));
            }
        }
        trace.edges = Some(edges);
        Ok(Recording {
            t,
            trace,
            ..Recording::default()
        })
    }
}

/// What the encoder has seen up to a tick.
struct Seen {
    count: i64,
    /// Instant and boundary of the latest edge.
    edge: Option<(f64, i64)>,
    /// The row at or before the tick, and the part of the way to the next row, 0 to 1.
    row: usize,
    part: f64,
}

/// A walk along the path, from tick to tick.
struct Walk<'a> {
    coarse: &'a Coarse,
    fine: &'a Fine,
    row: usize,
    /// The latest place: time and position in coarse counts.
    place: (f64, f64),
    edge: Option<(f64, i64)>,
}

impl<'a> Walk<'a> {
    fn new(coarse: &'a Coarse, fine: &'a Fine) -> Self {
        let place = (fine.t[0], coarse.position(fine.counts[0]));
        Self {
            coarse,
            fine,
            row: 0,
            place,
            edge: None,
        }
    }

    /// Walks to the time `t`, which is not before the last one and not after the last row.
    fn to(&mut self, t: f64) -> Seen {
        let rows = self.fine.t.len();
        while self.row + 1 < rows && self.fine.t[self.row + 1] <= t + SAME_INSTANT_S {
            self.row += 1;
            let x = self.coarse.position(self.fine.counts[self.row]);
            self.step((self.fine.t[self.row], x));
        }
        let row = self.row;
        let mut part = 0.0;
        if row + 1 < rows && t > self.fine.t[row] + SAME_INSTANT_S {
            let [t0, t1] = [self.fine.t[row], self.fine.t[row + 1]];
            let [x0, x1] = [row, row + 1].map(|row| self.coarse.position(self.fine.counts[row]));
            part = (t - t0) / (t1 - t0);
            self.step((t, x0 + part * (x1 - x0)));
        }
        let count = self.place.1.floor() as i64;
        Seen {
            count,
            edge: self.edge,
            row,
            part,
        }
    }

    /// Goes straight to `to`, a time and a position, and keeps the last boundary that it crosses.
    fn step(&mut self, to: (f64, f64)) {
        let (t0, x0) = std::mem::replace(&mut self.place, to);
        let (before, after) = (x0.floor(), to.1.floor());
        if before != after {
            // Forwards the last boundary crossed is below the new count, backwards above it.
            let boundary = if after > before { after } else { after + 1.0 };
            let part = (boundary - x0) / (to.1 - x0);
            self.edge = Some((t0 + part * (to.0 - t0), boundary as i64));
        }
    }
}

#[cfg(test)]
mod tests;
