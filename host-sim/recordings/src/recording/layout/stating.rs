//! Columns whose names say what they are: one is a time with its unit, one a position with its unit.

use super::endings::Ending;
use super::hint;
use super::words::{POSITIONS, TIMES, has, is_derived, is_duration, is_indirect};
use super::{Layout, Place, labview};
use crate::recording::options::Column;
use crate::recording::options::units::Unit;

/// The end of a name that counts anything: samples, errors, or an encoder's lines.
const COUNT: &str = "count";

impl Layout {
    /// The column of the header that is `column` by its name and none of those that are `known`; `None` if
    /// there is none, or a second one.
    /// A name is a unit alone, or has the unit at its end and a word for the quantity; t is one for a
    /// time. A position without a unit could be the one that is meant too, and so could one of a target or an
    /// error, which is never taken.
    pub(super) fn stating(&self, column: Column, known: &[Place]) -> Option<Place> {
        let quantity = column.quantity();
        let words = match column {
            Column::T => TIMES,
            _ => POSITIONS,
        };
        let could_be = |place: usize, name: &str| {
            let lower = name.trim().to_lowercase();
            let is_named = has(name, words) || quantity.unit(&lower).is_some();
            match (column, self.ending(quantity, place)) {
                (_, Ending::Unknown(_)) => false,
                (Column::T, _) if is_duration(name) => false,
                (Column::T, Ending::Unit(unit)) if self.part_of_second(place, unit).is_some() => {
                    true
                }
                (Column::T, Ending::Unit(_)) if lower.starts_with('t') => {
                    is_named || !lower[1..].starts_with(char::is_alphanumeric)
                }
                (Column::T, Ending::Unit(_)) if name == labview::X_VALUE => true,
                (Column::T, _) => is_named,
                _ => !is_derived(name) && (is_named || lower.ends_with(COUNT)),
            }
        };
        let names = self.names.iter().enumerate();
        let is_known = |place: usize| known.iter().any(|known| known.place == place);
        let like: Vec<_> = names
            .filter(|(place, name)| !is_known(*place) && could_be(*place, name))
            .collect();
        // The part of a second is one of the time beside it.
        let is_part = |part: usize| like.iter().any(|(whole, _)| self.is_part_of(part, *whole));
        let mut like = like.iter().filter(|(place, _)| !is_part(*place));
        let (place, name) = *like.next()?;
        let is_only = like.next().is_none() && self.has_header() && hint::barred(self).is_none();
        let lower = name.trim().to_lowercase();
        let is_sure = has(name, words) || !lower.ends_with(COUNT);
        let is_sure = is_sure && (column == Column::T || !is_indirect(name));
        let unit = match self.ending(quantity, place) {
            Ending::Unit(unit) => Some(unit),
            Ending::Nothing if column == Column::T => self.unit_by_value(place),
            _ => None,
        };
        let unit = unit.filter(|_| is_only && is_sure)?;
        Some(self.at(column, place, unit))
    }

    /// The unit of a time that its value in the first row tells: a date has none, and a time since 1970 is one in a
    /// single unit.
    fn unit_by_value(&self, place: usize) -> Option<&'static Unit> {
        let time = Column::T.quantity();
        if self.moments.contains(&place) {
            return time.units().first();
        }
        let mut known = self.since_1970.iter().filter(|(known, _)| *known == place);
        known.next().and_then(|(_, unit)| time.unit(unit))
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    fn rows(names: &str) -> String {
        let fields = names.split(',').count() - 1;
        let row = |k: usize| format!("{k}{}\n", format!(",{}", 2 * k).repeat(fields));
        format!("{names}\n{}", (0..9).map(row).collect::<String>())
    }

    #[test]
    fn names_that_say_what_they_are_need_no_option() {
        for (names, said) in [
            (
                "time_ms,counts",
                "t from 'time_ms' (ms), counts_large from 'counts' (counts)",
            ),
            (
                "Time [ms],Encoder [counts]",
                "t from 'Time [ms]' (ms), counts_large from 'Encoder [counts]' (counts)",
            ),
            (
                "ms,current_mA,pos_deg,target_A",
                "t from 'ms' (ms), counts_large from 'pos_deg' (deg with 4096 counts/rev)",
            ),
            (
                "time_ms,wheel_encoder_count",
                "t from 'time_ms' (ms), counts_large from 'wheel_encoder_count' (counts)",
            ),
            (
                "time_us,encoder_counts,encoder_velocity,encoder_acc_rad_s2,pos_mm",
                "t from 'time_us' (us), counts_large from 'encoder_counts' (counts)",
            ),
            (
                "loop_time_us,time_us,frequency,encoder_counts",
                "t from 'time_us' (us), counts_large from 'encoder_counts' (counts)",
            ),
            (
                "time_ms,theta_dot_rad,theta_rad,dtheta_rad",
                "t from 'time_ms' (ms), counts_large from 'theta_rad' (rad with 4096 counts/rev)",
            ),
            (
                "t_ms,t_motor_C,ticks",
                "t from 't_ms' (ms), counts_large from 'ticks' (counts)",
            ),
        ] {
            let recording = read(&rows(names), "").unwrap();
            let note = &recording.notes[0];
            let whole =
                format!("read by the names of its columns: {said}; others are named with --column");
            assert_eq!(*note, whole);
        }
        let recording = read(&rows("time_ms,counts"), "").unwrap();
        assert_eq!(recording.trace.counts_large[..3], [0, 2, 4]);
        assert_eq!(recording.t[2], 0.002);
        // Comments may follow the names.
        let text = rows("time_ms,counts").replacen('\n', "\n# started\n\n# now\n", 1);
        assert_eq!(read(&text, "").unwrap().t[2], 0.002);
        // One of both is named by the user.
        read(&rows("time_ms,x"), "counts_large=x:counts").unwrap();
        read(&rows("x,counts"), "t=x:ms").unwrap();
        // What counts or lasts is no time for that.
        for names in ["time_ms,loopcount,counts", "time_ms,v_s,counts"] {
            read(&rows(names), "counts_large=counts").unwrap();
        }
        // Or one that could be meant is another one.
        let small = "counts_small=handle_counts";
        let recording = read(&rows("time_ms,motor_counts,handle_counts"), small).unwrap();
        assert!(recording.notes[0].contains("counts_large from 'motor_counts'"));
    }

    #[test]
    fn value_of_a_time_tells_its_unit() {
        for (name, first, second, said) in [
            ("ts", "1700000000123456789", "1700000000124456789", "ns"),
            ("timestamp", "1700000000123", "1700000000124", "ms"),
            ("time", "1700000000.123", "1700000000.124", "s"),
            (
                "ts",
                "2026-03-01T12:00:00.123Z",
                "2026-03-01T12:00:00.124Z",
                "s",
            ),
            ("Time", "12:00:00.123", "12:00:00.124", "s"),
        ] {
            let csv = format!("{name},counts\n{first},0\n{second},1\n");
            let quote = if first.contains(':') { "\"" } else { "" };
            let object = |t: &str, k| format!("{{\"{name}\":{quote}{t}{quote},\"counts\":{k}}}\n");
            for log in [csv, object(first, 0) + &object(second, 1)] {
                let recording = read(&log, "").unwrap();
                let step = recording.t[1] - recording.t[0];
                // Seconds since 1970 are a float with a resolution of 0.24 us.
                assert!((step - 1e-3).abs() < 1e-6, "{log}: {step}");
                let said = format!("t from '{name}' ({said})");
                assert!(recording.notes[0].contains(&said), "{:?}", recording.notes);
            }
        }
        // Two times leave a choice, and another name says nothing.
        for names in ["ts,stamp", "ts,time", "when,x"] {
            let log = format!(
                "{names},counts\n1700000000123,1700000000123,0\n1700000000124,1700000000124,1\n"
            );
            assert!(read(&log, "").is_err(), "{names}");
        }
    }

    #[test]
    fn names_that_leave_a_choice_are_refused() {
        for names in [
            "time_ms,left_counts,right_counts",
            "time_ms,target_deg_pos,pos_deg",
            // Nobody says what is counted.
            "time_ms,count",
            "time_ms,sample_count",
            "time_ms,sample_count,angle",
            "time_ms,boot_time_s,counts",
            "time_ms,position",
            "time,counts",
            "time_min,counts",
            "time_ms,loops",
            "time_ms,velocity_deg_s",
            "time_ms,pos_error_deg",
            "time_ms,target_pos_deg",
            "time_ms,electrical_angle_deg",
            "time_ms,theta_e_rad",
            "time_ms,delta_counts",
            "time_ms,angle_rate_deg",
            "time_ms,theta_dot_rad",
            "time_ms,theta_d_rad",
            "time_ms,angle_sp_deg",
            "time_ms,pos_demand_deg",
            "dt_ms,counts",
        ] {
            let error = read(&rows(names), "").unwrap_err();
            assert!(error.contains("r.csv: line 1: no column "), "{error}");
            assert!(error.contains("for example --column '"), "{error}");
        }
    }
}
