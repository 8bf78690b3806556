//! Recordings that a program has in memory.

use simulation::trace::Trace;
use terminal::failure::Failure;

use super::Recording;
use super::times::clock;
use super::times::steps::{FASTEST_HZ, SLOWEST_HZ};

impl Recording {
    /// A recording that a program has in memory: its times, s, and the columns of `columns`, whose rate
    /// and periods follow from the times.
    ///
    /// # Errors
    /// [`Failure::Input`] that calls the recording `name`, if columns differ in their number of rows, or
    /// if `t` does not increase from row to row or has fewer than two rows.
    pub fn of_columns(t: Vec<f64>, columns: Trace, name: &str) -> Result<Self, Failure> {
        check_lengths(&columns, ("t", t.len()), name)?;
        if let Some(k) = t.windows(2).position(|pair| pair[1] <= pair[0]) {
            let is = if t[k + 1] < t[k] {
                "before"
            } else {
                "not after"
            };
            return Err(Failure::Input(format!(
                "{name}: row {}: column t: {} s is {is} the {} s above it",
                k + 1,
                t[k + 1],
                t[k]
            )));
        }
        let (rate_hz, uneven_steps) = clock::rate(&t, name)?;
        Ok(Self {
            trace: Trace {
                rate_hz,
                periods: clock::periods(&t, rate_hz),
                ..columns
            },
            t,
            uneven_steps,
            ..Self::default()
        })
    }

    /// A recording that a program has in memory, whose rows come at the constant rate of `columns`.
    ///
    /// # Errors
    /// [`Failure::Input`] that calls the recording `name`, if columns differ in their number of rows, or if no
    /// recording has this rate.
    pub fn at_rate(columns: Trace, name: &str) -> Result<Self, Failure> {
        let rate_hz = columns.rate_hz;
        if !(SLOWEST_HZ..=FASTEST_HZ).contains(&rate_hz) {
            return Err(Failure::Input(format!(
                "{name}: rate={rate_hz}: must be from {SLOWEST_HZ} to {FASTEST_HZ} Hz"
            )));
        }
        check_lengths(&columns, ("counts_large", columns.len()), name)?;
        Ok(Self {
            t: (0..columns.len()).map(|k| k as f64 / rate_hz).collect(),
            trace: columns,
            ..Self::default()
        })
    }
}

/// Refuses columns of another number of rows than that of the column `first`.
fn check_lengths(columns: &Trace, first: (&str, usize), name: &str) -> Result<(), Failure> {
    let of = |(column, rows): (&'static str, Option<usize>)| Some((column, rows?));
    let mut others = lengths(columns).into_iter().filter_map(of);
    match others.find(|(_, rows)| *rows != first.1) {
        None => Ok(()),
        Some((column, rows)) => Err(Failure::Input(format!(
            "{name}: column {column} has {rows} rows where {} has {}; give columns of equal length",
            first.0, first.1
        ))),
    }
}

/// Names of the optional and the necessary columns of a trace, with their number of rows.
fn lengths(columns: &Trace) -> [(&'static str, Option<usize>); 5] {
    [
        ("counts_large", Some(columns.counts_large.len())),
        ("counts_small", columns.counts_small.as_ref().map(Vec::len)),
        ("current", columns.current.as_ref().map(Vec::len)),
        ("edge_tick", columns.edges.as_ref().map(Vec::len)),
        ("true_omega", columns.true_omega.as_ref().map(Vec::len)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_in_memory_are_those_of_the_same_file() {
        let text = "t,counts_large,current,true_omega\n\
                    0,5,0.5,1\n0.001,6,0.25,2\n0.0023,9,0,3\n0.0033,10,1,4\n0.0043,11,1,5\n";
        let read = Recording::parse(text.as_bytes(), "r").unwrap();
        let columns = Trace {
            periods: None,
            rate_hz: 0.0,
            ..read.trace.clone()
        };
        let made = Recording::of_columns(read.t.clone(), columns.clone(), "m").unwrap();
        assert!(read.trace.periods.is_some());
        assert_eq!(made.trace.periods, read.trace.periods);
        assert_eq!(made.trace.rate_hz, read.trace.rate_hz);
        assert_eq!(made.uneven_steps, read.uneven_steps);
        let of = |t: &[f64]| {
            let made = Recording::of_columns(t.to_vec(), columns.clone(), "m");
            made.unwrap_err().to_string()
        };
        assert!(of(&[0.0, 0.001]).contains("m: column counts_large has 5 rows where t has 2"));
        let back = of(&[0.0, 0.002, 0.001, 0.003, 0.004]);
        assert!(
            back.starts_with("m: row 2: column t: 0.001 s is before the 0.002 s"),
            "{back}"
        );
        assert!(of(&[1.0; 5]).contains("m: row 1: column t: 1 s is not after the 1 s"));
    }

    #[test]
    fn rows_at_a_rate_that_no_recording_has_are_refused() {
        let at = |rate_hz| {
            let columns = Trace {
                rate_hz,
                counts_large: vec![0, 1, 2],
                ..Trace::default()
            };
            Recording::at_rate(columns, "r").map(|recording| recording.t)
        };
        assert_eq!(at(10.0).unwrap(), [0.0, 0.1, 0.2]);
        assert_eq!(at(1e7).unwrap()[1], 1e-7);
        let uneven = Trace {
            rate_hz: 1e3,
            counts_large: vec![0, 1, 2],
            current: Some(vec![0.5; 2]),
            ..Trace::default()
        };
        let error = Recording::at_rate(uneven, "r").unwrap_err().to_string();
        assert!(error.starts_with("r: column current has 2 rows where counts_large has 3;"));
        for rate_hz in [4.9, 1.1e7, 1e30, 0.0, f64::NAN] {
            let error = at(rate_hz).unwrap_err().to_string();
            let said = format!("r: rate={rate_hz}: must be from 5 to 10000000 Hz");
            assert_eq!(error, said);
        }
    }
}
