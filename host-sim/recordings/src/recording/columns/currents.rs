//! The current of a motor while a recording is read.

use terminal::failure::Failure;

use super::scaled;
use crate::recording::layout::Place;
use crate::recording::numbers::shown;
use crate::recording::options::Column;
use crate::recording::text::row::Row;

/// Current that no amplifier of the device delivers, relative to its limit.
const IMPLAUSIBLE: f64 = 20.0;

/// The largest size of a current, A.
pub(crate) fn largest(current: &[f64]) -> f64 {
    current.iter().fold(0.0, |most, i| most.max(i.abs()))
}

/// A line on a large motor's current of up to `largest_a` that no amplifier with the limit `limit_a`
/// delivers; `None` for a plausible one. `option` is the part of `--column` without a unit that names its
/// column.
#[must_use]
pub fn implausible_current(
    largest_a: f64,
    limit_a: f64,
    option: impl FnOnce() -> Option<String>,
) -> Option<String> {
    (largest_a > IMPLAUSIBLE * limit_a).then(|| {
        format!(
            "column current reaches {} A, where large.current_limit_a is {limit_a}; if it is in mA, give \
             --column '{}:mA'",
            shown(largest_a),
            option().unwrap_or_else(|| "current=current".to_owned())
        )
    })
}

/// Current of a motor from each row to the next one, A: the measured one where it is known, otherwise the
/// command.
#[derive(Default)]
pub(crate) struct Current {
    pub(crate) values: Vec<f64>,
    /// Number of rows but the first without a measured current.
    pub(crate) unmeasured: usize,
}

impl Current {
    /// Adds a row. Its `measured` current is the mean since the row before, so it is that row's current.
    /// A row keeps the `command` if the next row has no measured current, or if there is no next row.
    pub(crate) fn take(
        &mut self,
        row: &Row,
        [command, measured]: [Option<Place>; 2],
        torque_constant: f64,
    ) -> Result<(), Failure> {
        let mut mean = None;
        if let Some(at) = measured {
            let is_first = self.values.is_empty();
            // Without a command nothing stands in for the measured current.
            let may_lack = is_first || command.is_some();
            if !(may_lack && row.text(at.column.name(), at.place)?.is_empty()) {
                mean = Some(scaled(row, at, torque_constant)?);
            }
            if let (Some(before), Some(mean)) = (self.values.last_mut(), mean) {
                *before = mean;
            }
            self.unmeasured += usize::from(!is_first && mean.is_none());
        }
        match command {
            Some(at) => self.values.push(scaled(row, at, torque_constant)?),
            None if measured.is_some() => self.values.push(mean.unwrap_or_default()),
            None => {}
        }
        Ok(())
    }
}

/// Note on a column of measured currents, which `lack` rows do not have.
pub(crate) fn measured_note(column: Column, lack: usize) -> String {
    let (measured, command) = (column.name(), column.command().map_or("", Column::name));
    let lack = match lack {
        0 => String::new(),
        lack => format!("; {command} where the next row has none (rows: {lack})"),
    };
    format!("the current of each row is {measured} of the next row, not {command}{lack}")
}

#[cfg(test)]
mod tests {
    use super::implausible_current;
    use crate::recording::read_log as read;

    const LOG: &str = "t,counts_large,current,current_measured,current_small,current_small_measured\n\
                       0,0,1,,10,\n\
                       0.001,0,2,1.5,20,15\n\
                       0.002,0,3,,30,25\n\
                       0.003,0,4,3.5,40,35\n";

    #[test]
    fn row_has_the_current_that_is_measured_with_the_next_one() {
        let recording = read(LOG, "").unwrap();
        // The third row has no measured current, so the second one keeps its command, as the last one does.
        assert_eq!(recording.trace.current, Some(vec![1.5, 2.0, 3.5, 4.0]));
        assert_eq!(recording.current_small, Some(vec![15.0, 25.0, 35.0, 40.0]));
        let notes = [
            "the current of each row is current_measured of the next row, not current; current where the next \
             row has none (rows: 1)",
            "the current of each row is current_small_measured of the next row, not current_small",
        ];
        assert_eq!(recording.notes, notes);
    }

    #[test]
    fn current_that_is_asked_for_is_the_command() {
        let recording = read(LOG, "current=current").unwrap();
        assert_eq!(recording.trace.current, Some(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(recording.current_small, Some(vec![15.0, 25.0, 35.0, 40.0]));
        let recording = read(LOG, "current=current,current_measured=current_small:mA").unwrap();
        assert_eq!(recording.trace.current, Some(vec![0.02, 0.03, 0.04, 4.0]));
    }

    #[test]
    fn measured_current_needs_no_command() {
        let log = "t,counts_large,current_measured\n0,0,\n0.001,0,1.5\n0.002,0,2.5\n";
        let recording = read(log, "").unwrap();
        assert_eq!(recording.trace.current, Some(vec![1.5, 2.5, 2.5]));
        assert_eq!(recording.current_small, None);
        let error = read(&log.replace("1.5", ""), "").unwrap_err();
        let said = "r.csv: line 3: column current_measured: '' is not a number; remove the row, or fill \
                    the field";
        assert_eq!(error, said);
    }

    #[test]
    fn measured_current_that_is_no_number_is_reported() {
        let optional = "remove the rows without a value, or rename the column current_measured if the command does \
                        without it";
        for (good, bad, line, remedy) in [
            ("1.5", "x", 3, "correct the field, or remove the row"),
            ("3.5", "nan", 5, optional),
        ] {
            let error = read(&LOG.replace(good, bad), "").unwrap_err();
            let said = format!(
                "r.csv: line {line}: column current_measured: '{bad}' is not a number; {remedy}"
            );
            assert_eq!(error, said);
        }
    }

    /// A peak of a few times the limit is one of an amplifier, not of another unit.
    #[test]
    fn current_beyond_twenty_times_its_limit_is_doubted() {
        let doubt = |largest_a| implausible_current(largest_a, 6.0, || None);
        assert_eq!(doubt(120.0), None);
        let said = "column current reaches 121 A, where large.current_limit_a is 6; if it is in mA, give --column \
                    'current=current:mA'";
        assert_eq!(doubt(121.0).as_deref(), Some(said));
    }
}
