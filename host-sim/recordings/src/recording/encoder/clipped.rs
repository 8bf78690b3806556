//! Counts that stay at the end of the numbers of 16 bits, where a logger has clipped them.

/// Ends of the numbers of 16 bits. A count of 0 is that of a shaft at rest.
const ENDS: [i64; 3] = [i16::MIN as i64, i16::MAX as i64, u16::MAX as i64];

/// Steps to an end, counts. A slow shaft comes to each count, and stays there; a counter that wraps has larger ones.
const STEPS: std::ops::Range<u64> = 2..1 << 15;

/// Rows in turn at an end from which they are reported.
const ROWS: usize = 10;

/// Rows at the end of a number.
#[derive(Default)]
pub(super) struct Clipped {
    last: Option<i64>,
    /// Rows in turn at the end to which the count came fast.
    run: usize,
    /// Rows of all runs that are reported, and the end of the first one.
    rows: usize,
    end: Option<i64>,
}

impl Clipped {
    /// Adds the count of a row.
    pub(super) fn add(&mut self, count: i64) {
        match self.last.replace(count) {
            Some(last) if last == count => self.run += usize::from(self.run > 0),
            Some(last) => {
                let is_fast = STEPS.contains(&last.abs_diff(count));
                self.run = usize::from(is_fast && ENDS.contains(&count));
            }
            None => {}
        }
        self.rows += match self.run {
            ROWS => ROWS,
            run => usize::from(run > ROWS),
        };
        if self.run == ROWS {
            self.end.get_or_insert(count);
        }
    }

    /// The note on clipped counts of a `column`.
    pub(super) fn note(&self, column: &str) -> Option<String> {
        let end = self.end?;
        Some(format!(
            "{column} comes to {end} and stays there, in {} rows in all at an end of the numbers of 16 bits: the \
             counts are clipped, and the velocities there are wrong; log more bits, or let the counter wrap",
            self.rows
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::Clipped;

    fn note(counts: impl IntoIterator<Item = i64>) -> Option<String> {
        let mut clipped = Clipped::default();
        counts.into_iter().for_each(|count| clipped.add(count));
        clipped.note("counts_large")
    }

    #[test]
    fn counts_that_stay_at_an_end_of_16_bits_are_clipped() {
        let swing = |k: i64| (40_000.0 * (k as f64 * 0.01).sin()) as i64;
        let clipped = (0..600).map(|k| swing(k).clamp(-32_768, 32_767));
        let at_end = clipped
            .clone()
            .filter(|count| [-32_768, 32_767].contains(count));
        let said = note(clipped).unwrap();
        let begin = format!(
            "counts_large comes to 32767 and stays there, in {} rows in all at",
            at_end.count()
        );
        assert!(said.starts_with(&begin), "{said}");
        let unsigned = (0..600).map(|k| (swing(k) + 30_000).clamp(0, 65_535));
        assert!(note(unsigned).unwrap().contains(" 65535 and"));
        let of = |rows| note([32_765].into_iter().chain(vec![32_767; rows]));
        assert_eq!(of(9), None);
        assert!(of(10).unwrap().contains("in 10 rows"));
    }

    #[test]
    fn counter_that_wraps_or_rests_is_not_clipped() {
        assert_eq!(note((0..600).map(|k| i64::from((250 * k) as i16))), None);
        // A slow shaft is at each count for many rows.
        assert_eq!(
            note((0..600).map(|k| i64::from((32_760 + k / 50) as i16))),
            None
        );
        // The first count of the log.
        assert_eq!(note(vec![32_767; 40]), None);
        assert_eq!(note((0..400).map(|k| 3 * k.min(100))), None);
    }
}
