//! A first row without its begin: a capture of a serial port begins in the middle of a line.

use super::Layout;
use super::search::{number, rows};

/// Rows below the first one that are compared with it.
const COMPARED: usize = 20;

/// Ratio of the first step of the first column to its largest other one from which it is none of the log.
const FAR: f64 = 10.0;

impl Layout {
    /// Leaves out the first line of a text without a header if it is a row whose first number lacks its first digits: the
    /// other rows count up in this column, and the digits are the last ones of the number before these.
    pub(super) fn leave_out_cut_row(&mut self, lines: &[&str]) {
        if self.has_header() || self.skip > 0 {
            return;
        }
        let rows = rows(self, &lines[..lines.len().min(COMPARED + 1)]);
        let fields = rows.iter().filter_map(|row| row.first());
        let numbers: Option<Vec<_>> = fields.map(|field| number(field, self.separator)).collect();
        let Some([first, next @ ..]) = numbers.as_deref() else {
            return;
        };
        let steps: Vec<_> = next.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let [step, ..] = steps[..] else { return };
        let largest = steps.iter().copied().fold(0.0, f64::max);
        let whole = rows[0][0].chars().take_while(char::is_ascii_digit).count();
        let all = next[0].trunc().to_string().len();
        // The last digits of the number before the second one, from which the first may be a step apart.
        let scale = 10.0_f64.powi(whole as i32);
        let off = (next[0] - step - first).rem_euclid(scale);
        let is_cut = steps.iter().all(|step| *step > 0.0)
            && next.len() == COMPARED
            && (1..all).contains(&whole)
            && next[0] - first > FAR * largest
            && off.min(scale - off) <= largest;
        if is_cut && let Some(second) = lines.get(1) {
            self.skip = 1;
            self.first_row = second.trim().to_owned();
            self.cuts_first = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    /// Rows of 1 kHz in microseconds, with a first line of its own.
    fn rows(first: &str) -> Result<Vec<String>, String> {
        let row = |k: u32| format!("{},{}\n", 1_235_567 + 1000 * k + k % 3, 4 * k);
        let rows: String = (0..100).map(row).collect();
        let recording = read(&format!("{first}\n{rows}"), "t=1:us,counts_large=2:counts")?;
        let said = recording.notes.into_iter();
        Ok(said.filter(|note| !note.starts_with("t from")).collect())
    }

    #[test]
    fn first_row_without_its_begin_is_left_out() {
        for cut in ["67,-4", "7,-4", "4567,-4", "234567,-4", "4563,-4"] {
            let said = "line 1, the first one, is left out: its first number may be cut";
            assert_eq!(rows(cut).unwrap(), [said], "{cut}");
        }
        assert!(rows("1234567,-4").unwrap().is_empty());
        // A pause behind the first row, which has other digits.
        for first in ["200000,-4", "9000,-4"] {
            let notes = rows(first).unwrap();
            assert!(notes[0].contains("rows are missing"), "{first}: {notes:?}");
        }
    }
}
