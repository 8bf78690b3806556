//! Line numbers of the rows of a file.

/// The line of each row, in few entries: rows follow one another but for comments and blank lines.
#[derive(Clone, Debug, Default)]
pub(super) struct LineNumbers {
    /// Row and line where a run of adjacent lines begins.
    runs: Vec<(usize, u64)>,
    rows: usize,
}

impl LineNumbers {
    /// Adds the line of the next row.
    pub(super) fn push(&mut self, line: u64) {
        if self.of(self.rows) != line {
            self.runs.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// The line of `row`; 0 if there is none.
    pub(super) fn of(&self, row: usize) -> u64 {
        let after = self.runs.partition_point(|(first, _)| *first <= row);
        let run = after.checked_sub(1).and_then(|run| self.runs.get(run));
        run.map_or(0, |(first, line)| line + (row - first) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_rows_are_kept_in_runs() {
        let mut lines = LineNumbers::default();
        let all = [2, 3, 4, 7, 8, 20];
        for line in all {
            lines.push(line);
        }
        assert_eq!(lines.runs.len(), 3);
        for (row, line) in all.into_iter().enumerate() {
            assert_eq!(lines.of(row), line);
        }
    }
}
