//! Time stamps of edges, compared with the times of their rows.

use terminal::failure::Failure;

use crate::recording::numbers::shown;
use crate::recording::options::units::Quantity;

/// Largest share of the stamps that may lie beside their rows: more have another unit or another origin.
const MOST_BESIDE: f64 = 0.1;

/// One stamp of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stamp {
    /// Time of the edge, s.
    pub(crate) at_s: f64,
    /// Period of a counter of 32 bits in the unit of the column, s.
    pub(crate) wrap_s: f64,
    /// Boundary that was crossed.
    pub(crate) boundary: i64,
}

/// Whether the stamps lie between the row before and their row. A stamp that stays is older.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stamps {
    /// The latest stamp in the log, and its time with the periods that have passed, s.
    last: Option<(Stamp, f64)>,
    row_s: f64,
    /// The latest step of the rows that is not zero, s: the tolerance.
    step_s: f64,
    new: u64,
    beside: u64,
    first: Option<Beside>,
    /// Line of the first stamp to which periods of a counter of 32 bits were added.
    wraps: Option<u64>,
}

/// A stamp beside its row.
#[derive(Clone, Copy, Debug)]
struct Beside {
    line: u64,
    stamp_s: f64,
    rows_s: [f64; 2],
}

impl Stamps {
    /// Adds the stamp of the row at `row_s` in `line` and returns its time on the scale of the rows, s: a
    /// new stamp that is whole periods of a counter of 32 bits before its row gets them added.
    pub(crate) fn add(&mut self, stamp: Stamp, row_s: f64, line: u64) -> f64 {
        let rows_s = [self.row_s, row_s];
        self.row_s = row_s;
        let at_s = match self.last {
            None => stamp.at_s,
            Some((last, at_s)) if last == stamp => at_s,
            Some(_) => self.add_new(stamp, rows_s, line),
        };
        self.last = Some((stamp, at_s));
        at_s
    }

    fn add_new(&mut self, stamp: Stamp, rows_s: [f64; 2], line: u64) -> f64 {
        if rows_s[1] > rows_s[0] {
            self.step_s = rows_s[1] - rows_s[0];
        }
        self.new += 1;
        let [from, to] = [rows_s[0] - self.step_s, rows_s[1] + self.step_s];
        let Stamp { at_s, wrap_s, .. } = stamp;
        let passed = ((rows_s[1] - at_s) / wrap_s).round();
        let unwrapped_s = at_s + passed * wrap_s;
        if (from..=to).contains(&at_s) {
            at_s
        } else if passed > 0.0 && (from..=to).contains(&unwrapped_s) {
            self.wraps.get_or_insert(line);
            unwrapped_s
        } else {
            self.beside += 1;
            self.first.get_or_insert(Beside {
                line,
                stamp_s: at_s,
                rows_s,
            });
            at_s
        }
    }

    /// Notes on the stamps that were unwrapped, and on those beside their rows.
    pub(crate) fn notes(&self) -> impl Iterator<Item = String> {
        let wraps = self.wraps.map(|line| {
            format!(
                "edge_tick wraps at 2^32 and is unwrapped, the first time in line {line}: a counter of 32 bits"
            )
        });
        let beside = self.first.map(|first| {
            format!(
                "{} of {} new stamps of edge_tick are not between the row before and their row, the first in \
                 line {}",
                self.beside, self.new, first.line
            )
        });
        wraps.into_iter().chain(beside)
    }

    /// Checks that the stamps of the column `theirs` in the recording `name` are on the scale of t.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy, if too many are beside their rows.
    pub(crate) fn check(&self, name: &str, theirs: &str) -> Result<(), Failure> {
        let Some(first) = self.first else {
            return Ok(());
        };
        if self.beside as f64 <= MOST_BESIDE * self.new as f64 {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "{name}: line {}: column edge_tick: the stamp is at {} s, where the row before is at {} s and \
             the row at {} s ({} of {} new stamps); stamps are on the scale of t; state their unit ({}), for \
             example --column 'edge_tick={theirs}:us'",
            first.line,
            shown(first.stamp_s),
            shown(first.rows_s[0]),
            shown(first.rows_s[1]),
            self.beside,
            self.new,
            Quantity::Edge.list()
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
        for (unit, per_s) in [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)] {
            let stamps = log(5.0, |_, edge| per_s * edge);
            let recording = read(&stamps, &format!("edge_tick=edge_tick:{unit}")).unwrap();
            let age = recording.trace.edges.unwrap()[50].unwrap().age_s;
            assert!((age - 0.3e-3).abs() < 1e-9, "{unit}: {age}");
        }
        let late = log(5.0, |_, edge| 84e9 * edge);
        assert!(
            read(&late, "")
                .unwrap_err()
                .contains("line 3: column edge_tick")
        );
    }

    #[test]
    fn counter_of_32_bits_is_unwrapped() {
        let wraps = 4_294_967_296.0;
        let counter = |per_s: f64| move |_: usize, edge: f64| (per_s * edge).rem_euclid(wraps);
        let note = |line: u64| {
            format!(
                "edge_tick wraps at 2^32 and is unwrapped, the first time in line {line}: a counter of 32 bits"
            )
        };
        for (unit, per_s) in [("ticks", 84e6), ("us", 1e6)] {
            let at_wrap = log(wraps / per_s - 0.05, counter(per_s));
            let after_wraps = log(3.0 * wraps / per_s + 7.0, counter(per_s));
            for (text, line) in [(at_wrap, 53), (after_wraps, 3)] {
                let recording = read(&text, &format!("edge_tick=edge_tick:{unit}")).unwrap();
                assert!(
                    recording.notes.contains(&note(line)),
                    "{:?}",
                    recording.notes
                );
                let edges = recording.trace.edges.unwrap();
                for edge in &edges[1..] {
                    assert!(
                        (edge.unwrap().age_s - 0.3e-3).abs() < 2e-6,
                        "{unit}: {edge:?}"
                    );
                }
            }
        }
        // Stamps that wrap in less than 2^32 are not understood.
        let short = log(60.0, |_, edge| (84e6 * edge).rem_euclid(65_536.0));
        assert!(read(&short, "").unwrap_err().contains("state their unit"));
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
        // A tenth of the 99 new stamps is 9.
        let beside = |most: usize| {
            move |k: usize, edge: f64| {
                if k % 10 == 7 && k < most {
                    0.0
                } else {
                    84e6 * edge
                }
            }
        };
        assert!(read(&log(0.0, beside(90)), "").is_ok());
        let error = read(&log(0.0, beside(100)), "").unwrap_err();
        assert!(error.contains("(10 of 99 new stamps)"), "{error}");
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
