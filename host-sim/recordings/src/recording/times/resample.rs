//! Even rows from a recording with an uneven clock.

use simulation::trace::EdgeStamp;
use terminal::failure::Failure;

use crate::recording::numbers::shown_span;
use crate::recording::{BoardColumns, Recording};

/// Largest number of new rows for each row of the recording.
const MOST_ROWS: f64 = 100.0;

/// Rounding of the product of a time and a rate, periods.
const ROUNDING: f64 = 1e-6;

impl Recording {
    /// Replaces the rows by rows at a constant rate, from the first row on.
    ///
    /// At a new row's time, a count is interpolated linearly between the rows on both sides and rounded
    /// to the nearest whole count, and so is the true velocity, without rounding. With time stamps of
    /// edges, the counts and the latest edge are those of the latest row instead, because a stamp tells
    /// exactly when the count changed. A current holds from its row to the next one.
    ///
    /// # Errors
    /// [`Failure::Input`] if the rate is out of reach for the recording called `name`.
    pub fn resample(&mut self, rate_hz: f64, name: &str) -> Result<(), Failure> {
        let [first, .., last] = self.t[..] else {
            return Ok(());
        };
        let rows = resampled_rows(first, last, self.t.len(), rate_hz, name)?;
        let t = (0..rows).map(|k| first + k as f64 / rate_hz).collect();
        self.replace_rows(t, rate_hz);
        self.remove_held_notes();
        Ok(())
    }

    /// Replaces the rows by rows at the times `t`, which are within those of the rows.
    pub(crate) fn replace_rows(&mut self, t: Vec<f64>, rate_hz: f64) {
        let mut row = 0;
        // For each new row: the latest row, and the part of its step that has passed.
        let at: Vec<(usize, f64)> = (t.iter())
            .map(|now| {
                while row + 2 < self.t.len() && self.t[row + 1] <= *now {
                    row += 1;
                }
                let step = self.t[row + 1] - self.t[row];
                let part = if step > 0.0 {
                    (now - self.t[row]) / step
                } else {
                    1.0
                };
                match part >= 1.0 {
                    true => (row + 1, 0.0),
                    false => (row, part),
                }
            })
            .collect();
        let held = |column: &[f64]| at.iter().map(|(row, _)| column[*row]).collect::<Vec<_>>();
        let trace = &mut self.trace;
        let stamped = trace.edges.is_some();
        trace.counts_large = resampled(&trace.counts_large, &at, stamped);
        let small = trace.counts_small.as_deref();
        trace.counts_small = small.map(|column| resampled(column, &at, stamped));
        trace.edges = trace.edges.as_deref().map(|edges| {
            let edge = |(new, &(row, _)): (usize, &(usize, f64))| {
                let older_s = t[new] - self.t[row];
                edges[row].map(|edge| EdgeStamp {
                    age_s: edge.age_s + older_s,
                    ..edge
                })
            };
            at.iter().enumerate().map(edge).collect()
        });
        trace.current = trace.current.as_deref().map(held);
        self.current_small = self.current_small.as_deref().map(held);
        trace.true_omega = trace.true_omega.as_deref().map(|omega| {
            let value = |&(row, part): &(usize, f64)| {
                let next = omega[(row + 1).min(omega.len() - 1)];
                omega[row] + part * (next - omega[row])
            };
            at.iter().map(value).collect()
        });
        // Rows at other times are not those of the board.
        self.board = BoardColumns::default();
        trace.rate_hz = rate_hz;
        trace.periods = None;
        self.uneven_steps = 0;
        self.t = t;
    }
}

/// Number of rows at `rate_hz` from `first` to `last`, s, that replace `rows` rows.
///
/// # Errors
/// [`Failure::Input`] if the rate is out of reach for the recording called `name`.
pub(crate) fn resampled_rows(
    first: f64,
    last: f64,
    rows: usize,
    rate_hz: f64,
    name: &str,
) -> Result<usize, Failure> {
    let duration_s = last - first;
    // Times have rounding errors: a step that lacks less than this part of a period is whole.
    let wanted = (duration_s * rate_hz + ROUNDING).floor() + 1.0;
    let seconds = shown_span(duration_s);
    if !(rate_hz >= super::steps::SLOWEST_HZ && wanted >= 2.0) {
        return Err(Failure::Input(format!(
            "--resample {rate_hz}: {name} has {seconds} s, of which at least two rows at {} Hz or more \
             must result",
            super::steps::SLOWEST_HZ
        )));
    }
    if wanted > MOST_ROWS * rows as f64 {
        return Err(Failure::Input(format!(
            "--resample {rate_hz}: {name} has {rows} rows in {seconds} s, which would become {wanted}; \
             choose a lower rate, or cut the recording at its pauses"
        )));
    }
    Ok(wanted as usize)
}

/// Counts at new rows, each of which has a row and a part of that row's step.
fn resampled(column: &[u32], at: &[(usize, f64)], held: bool) -> Vec<u32> {
    let count = |&(row, part): &(usize, f64)| {
        let next = column[(row + 1).min(column.len() - 1)];
        let step = f64::from(next.wrapping_sub(column[row]) as i32);
        let moved = if held {
            0.0
        } else {
            (step * part + 0.5).floor()
        };
        column[row].wrapping_add(moved as i32 as u32)
    };
    at.iter().map(count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 200 rows of a shaft at 3 counts a millisecond, with stamps up to 0.45 ms off an even clock.
    fn uneven(with_edges: bool) -> Recording {
        let mut text = String::from("t,counts_large,current,true_omega");
        text += if with_edges {
            ",edge_tick,edge_bound\n"
        } else {
            "\n"
        };
        for k in 0..200_u32 {
            let t = f64::from(k) * 1e-3 + f64::from(k * 7 % 10) * 45e-6;
            let count = (3000.0 * t).floor();
            text += &format!("{t},{count},{k},{}", 10.0 * t);
            if with_edges {
                text += &format!(",{},{count}", count / 3000.0 * 84e6);
            }
            text += "\n";
        }
        Recording::parse(text.as_bytes(), "r").unwrap()
    }

    #[test]
    fn counts_are_interpolated_and_currents_held() {
        let original = uneven(false);
        for rate_hz in [500.0, 1000.0, 2345.0] {
            let mut recording = original.clone();
            recording.resample(rate_hz, "r").unwrap();
            assert_eq!(recording.trace.rate_hz, rate_hz);
            assert_eq!(recording.trace.len(), recording.t.len());
            assert!(recording.t.last() <= original.t.last());
            for (k, t) in recording.t.iter().enumerate() {
                assert_eq!(*t, k as f64 / rate_hz);
                // The rows have the count below the position, so interpolation is within one and a half.
                let off = f64::from(recording.trace.counts_large[k]) - (3000.0 * t - 0.5);
                assert!(off.abs() <= 1.0, "{t}: {off}");
                let omega = recording.trace.true_omega.as_ref().unwrap()[k];
                assert!((omega - 10.0 * t).abs() < 1e-12, "{t}: {omega}");
                let row = original.t.iter().rposition(|row| row <= t).unwrap();
                let current = recording.trace.current.as_ref().unwrap()[k];
                assert_eq!(current, original.trace.current.as_ref().unwrap()[row]);
            }
        }
    }

    #[test]
    fn stamped_counts_are_held_and_their_edges_age() {
        let mut recording = uneven(true);
        recording.resample(1000.0, "r").unwrap();
        let edges = recording.trace.edges.as_ref().unwrap();
        for (k, t) in recording.t.iter().enumerate() {
            let edge = edges[k].unwrap();
            assert_eq!(edge.boundary, recording.trace.counts_large[k]);
            let at = f64::from(edge.boundary) / 3000.0;
            assert!((t - edge.age_s - at).abs() < 1e-9, "{t}");
        }
    }

    #[test]
    fn handle_counts_are_held_beside_stamps_and_interpolated_without_them() {
        for (stamp, expected) in [(",84000,1", [0, 0, 40]), ("", [0, 20, 40])] {
            let edge = stamp.replace(|c: char| c.is_ascii_digit(), "");
            let header = if stamp.is_empty() {
                ""
            } else {
                ",edge_tick,edge_bound"
            };
            let text = format!(
                "t,counts_large,counts_small{header}\n0,0,0{edge}\n0.002,1,40{stamp}\n0.003,1,40{stamp}\n"
            );
            let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
            recording.resample(1000.0, "r").unwrap();
            let handle = recording.trace.counts_small.unwrap();
            assert_eq!(handle[..3], expected, "{text}");
        }
    }

    /// Rows at other times have no values of the board, and an even clock.
    #[test]
    fn new_rows_are_even_and_have_no_columns_of_the_board() {
        let options = crate::recording::ReadOptions::default();
        let mut text = String::from("t,counts_large,state\n");
        for k in 0..50_u32 {
            let t = f64::from(k) * 1e-3 + f64::from(k * 7 % 10) * 45e-6;
            text += &format!("{t},{k},2\n");
        }
        let mut recording = Recording::parse_with_board(text.as_bytes(), "r", &options).unwrap();
        assert!(recording.unevenness().is_some() && recording.board.column("state").is_some());
        recording.resample(500.0, "r").unwrap();
        assert_eq!(recording.unevenness(), None);
        assert!(recording.board.column("state").is_none());
    }

    #[test]
    fn counts_pass_the_wrap_of_32_bits_and_even_rows_stay() {
        let text = "t,counts_large\n0,-2\n0.001,1\n0.003,7\n";
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        recording.resample(1000.0, "r").unwrap();
        let counts: Vec<_> = recording
            .trace
            .counts_large
            .iter()
            .map(|count| *count as i32)
            .collect();
        assert_eq!(counts, [-2, 1, 4, 7]);
    }

    #[test]
    fn rates_out_of_reach_are_refused() {
        for rate_hz in [0.0, -5.0, 4.9, f64::NAN, f64::INFINITY, 1e9] {
            let error = uneven(false).resample(rate_hz, "r").unwrap_err();
            assert!(error.to_string().starts_with("--resample "), "{error}");
        }
    }

    /// 0.29 times 100 is 28.999999999999996 in floats.
    #[test]
    fn last_row_is_kept_where_a_product_is_rounded_down() {
        let rows = |last| resampled_rows(0.0, last, 30, 100.0, "r").unwrap();
        assert_eq!((rows(0.29), rows(0.2899)), (30, 29));
    }
}
