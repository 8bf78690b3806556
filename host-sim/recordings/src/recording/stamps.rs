//! Time stamps of edges, compared with the times of their rows.

use simulation::trace::EDGE_CLOCK_HZ;
use terminal::failure::Failure;

use super::numbers::shown;
use super::units::Quantity;

/// Largest share of the stamps that may lie beside their rows: more have another unit or another origin.
const MOST_BESIDE: f64 = 0.1;

/// Period of a counter of 32 bits, s.
const WRAP_S: f64 = 4_294_967_296.0 / EDGE_CLOCK_HZ;

/// Whether the stamps lie between the row before and their row. A stamp that stays is older.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stamps {
    /// The latest stamp, s, and its boundary.
    last: Option<(f64, i64)>,
    row_s: f64,
    /// The latest step of the rows that is not zero, s: the tolerance.
    step_s: f64,
    new: u64,
    beside: u64,
    first: Option<Beside>,
}

/// A stamp beside its row.
#[derive(Clone, Copy, Debug)]
struct Beside {
    line: u64,
    stamp_s: f64,
    rows_s: [f64; 2],
    /// Whether the stamp is right but for 2^32 ticks.
    wraps: bool,
}

impl Stamps {
    /// Adds the stamp `stamp_s` of the row at `row_s` in `line`.
    pub(super) fn add(&mut self, stamp_s: f64, boundary: i64, row_s: f64, line: u64) {
        let rows_s = [self.row_s, row_s];
        self.row_s = row_s;
        let is_first = self.last.is_none();
        if self.last.replace((stamp_s, boundary)) == Some((stamp_s, boundary)) || is_first {
            return;
        }
        if rows_s[1] > rows_s[0] {
            self.step_s = rows_s[1] - rows_s[0];
        }
        self.new += 1;
        let [from, to] = [rows_s[0] - self.step_s, rows_s[1] + self.step_s];
        let is_beside = |stamp_s: f64| !(from..=to).contains(&stamp_s);
        if is_beside(stamp_s) {
            self.beside += 1;
            self.first.get_or_insert(Beside {
                line,
                stamp_s,
                rows_s,
                wraps: !is_beside(stamp_s + WRAP_S),
            });
        }
    }

    /// Note on the stamps beside their rows; `None` if there are none.
    pub(super) fn note(&self) -> Option<String> {
        let first = self.first?;
        Some(format!(
            "{} of {} new stamps of edge_tick are not between the row before and their row, the first in \
             line {}",
            self.beside, self.new, first.line
        ))
    }

    /// Checks that the stamps of the column `theirs` in the recording `name` are on the scale of t.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy, if too many are beside their rows.
    pub(super) fn check(&self, name: &str, theirs: &str) -> Result<(), Failure> {
        let Some(first) = self.first else {
            return Ok(());
        };
        if self.beside as f64 <= MOST_BESIDE * self.new as f64 {
            return Ok(());
        }
        let remedy = match first.wraps {
            true => "a counter of 32 bits wraps: add 2^32 to the stamps after each wrap".to_owned(),
            false => format!(
                "stamps are on the scale of t; state their unit ({}), for example --column \
                 'edge_tick={theirs}:us'",
                Quantity::Edge.list()
            ),
        };
        Err(Failure::Input(format!(
            "{name}: line {}: column edge_tick: the stamp is at {} s, where the row before is at {} s and \
             the row at {} s ({} of {} new stamps); {remedy}",
            first.line,
            shown(first.stamp_s),
            shown(first.rows_s[0]),
            shown(first.rows_s[1]),
            self.beside,
            self.new
        )))
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    /// Rows 1 ms apart from `start` s, each with an edge 0.3 ms before it.
    fn log(start: f64, stamp: impl Fn(usize, f64) -> f64) -> String {
        let mut text = String::from("t,counts_large,edge_tick,edge_bound\n");
        for k in 0..100 {
            let t = start + f64::from(k) * 1e-3;
            text += &format!("{t},{k},{},{k}\n", stamp(k as usize, t - 0.3e-3));
        }
        text
    }

    #[test]
    fn stamps_of_another_unit_are_refused() {
        let seconds = log(5.0, |_, edge| edge);
        let error = read(&seconds, "").unwrap_err();
        assert!(
            error.starts_with("r.csv: line 3: column edge_tick: the stamp is at "),
            "{error}"
        );
        let said = "s, where the row before is at 5 s and the row at 5.001 s (99 of 99 new stamps); stamps \
                    are on the scale of t; state their unit (ticks, s, ms, us, ns), for example --column \
                    'edge_tick=edge_tick:us'";
        assert!(error.contains(said), "{error}");
        let recording = read(&seconds, "edge_tick=edge_tick:s").unwrap();
        let age = recording.trace.edges.unwrap()[50].unwrap().age_s;
        assert!((age - 0.3e-3).abs() < 1e-9, "{age}");
        let late = log(5.0, |_, edge| 84e9 * edge);
        assert!(
            read(&late, "")
                .unwrap_err()
                .contains("line 3: column edge_tick")
        );
    }

    #[test]
    fn counter_of_32_bits_that_wraps_is_refused() {
        let wraps = 4_294_967_296.0;
        let text = log(wraps / 84e6 - 0.05, |_, edge| {
            (84e6 * edge).rem_euclid(wraps)
        });
        let error = read(&text, "").unwrap_err();
        assert!(
            error.contains("a counter of 32 bits wraps: add 2^32"),
            "{error}"
        );
    }

    #[test]
    fn few_stamps_beside_their_rows_are_reported() {
        let recording = read(
            &log(0.0, |k, edge| if k == 7 { 0.0 } else { 84e6 * edge }),
            "",
        );
        let said = "1 of 99 new stamps of edge_tick are not between the row before and their row, the \
                    first in line 9";
        assert_eq!(recording.unwrap().notes, [said]);
        // At rest the stamp stays, and grows old.
        let rest = "t,counts_large,edge_tick,edge_bound\n0,0,,\n0.001,1,42000,1\n0.002,1,42000,1\n\
                    0.05,1,42000,1\n0.051,2,4250000,2\n";
        let notes = read(rest, "").unwrap().notes;
        assert!(
            notes.iter().all(|note| !note.contains("edge_tick")),
            "{notes:?}"
        );
    }
}
