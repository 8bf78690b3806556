//! A line below the header with the units of the columns: `[ms],[deg]`, or `ms,deg`.

use super::endings::{Ending, bracketed, is_any_unit};
use super::search::is_number;
use super::{Layout, is_content};
use crate::recording::options::units::Quantity;
use crate::recording::text::separator::{Separator, comment};

/// Units of the columns, and the index of their line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UnitRow {
    pub(super) index: usize,
    separator: Separator,
    units: Vec<String>,
    has_brackets: bool,
}

/// Characters of the longest unit without brackets.
const LONGEST: usize = 12;

impl UnitRow {
    /// The first line of which every field is empty or has brackets around it, at least one of them around a unit; or
    /// of which most fields are units without brackets, and none is a number.
    pub(super) fn find(lines: &[&str]) -> Option<Self> {
        let row = |(index, line): (usize, &&str)| {
            let line = comment(line).unwrap_or(line);
            // Most lines are numbers, and need no search.
            if !line.contains(is_letter) {
                return None;
            }
            Separator::ALL.into_iter().find_map(|separator| {
                let fields = separator.split(line);
                let inside: Option<Vec<_>> = fields.iter().map(|field| inside(field)).collect();
                let is_unit = |name: &String| Quantity::of_unit(name).is_some();
                let inside = inside.filter(|inside| inside.iter().any(is_unit));
                let has_brackets = inside.is_some();
                let bare = || are_bare(separator, &fields).then_some(fields);
                inside.or_else(bare).map(|units| Self {
                    index,
                    separator,
                    units,
                    has_brackets,
                })
            })
        };
        lines.iter().enumerate().find_map(row)
    }

    /// `layout` with these units, if its header is the line above them; `None` if it is not. A name for each of them is
    /// above units without brackets.
    pub(super) fn below(self, layout: Layout, lines: &[&str]) -> Option<Layout> {
        let header = layout.line as usize;
        let between = lines.get(header..self.index)?;
        let is_header = layout.has_header()
            && (layout.separator == self.separator || layout.names.len() == 1)
            && layout.names.len() == self.units.len()
            && (self.has_brackets || layout.names.iter().all(|name| is_name(name)))
            && !between.iter().any(|line| is_content(line));
        is_header.then(|| Layout {
            skip: self.index as u64 + 1,
            units: self.units,
            ..layout
        })
    }
}

/// Whether the fields of a line are units without brackets: one of time or of position, most of the others of any
/// quantity, and all as short as units are.
fn are_bare(separator: Separator, fields: &[String]) -> bool {
    let filled: Vec<_> = fields.iter().filter(|field| !field.is_empty()).collect();
    let is_text =
        |field: &&String| field.chars().count() <= LONGEST && !is_number(field, separator);
    if filled.len() < 2 || !filled.iter().all(is_text) {
        return false;
    }
    let is_ours = |field: &&String| {
        matches!(
            Quantity::of_unit(field),
            Some(Quantity::Time | Quantity::Position)
        )
    };
    let units = filled.iter().filter(|field| is_any_unit(field)).count();
    2 * units > filled.len() && filled.iter().any(is_ours)
}

/// Whether `c` is a letter of a unit, and none of an exponent.
fn is_letter(c: char) -> bool {
    c == '\u{b0}' || (c.is_alphabetic() && !c.eq_ignore_ascii_case(&'e'))
}

/// Whether a field of a header is a name: neither empty nor a unit.
fn is_name(field: &str) -> bool {
    !field.is_empty() && !is_any_unit(field)
}

/// The text in brackets that are the whole field; empty for an empty field.
fn inside(field: &str) -> Option<String> {
    match (field, bracketed(field)) {
        ("", _) => Some(String::new()),
        (_, Some(("", inside))) => Some(inside.to_owned()),
        _ => None,
    }
}

impl Layout {
    /// What name and unit of the column at `place` say about the unit of `quantity`.
    pub(crate) fn ending(&self, quantity: Quantity, place: usize) -> Ending<'_> {
        match self.units.get(place).filter(|unit| !unit.is_empty()) {
            None => Ending::of(quantity, &self.names[place]),
            Some(unit) => quantity
                .unit(unit)
                .map_or(Ending::Unknown(unit), Ending::Unit),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{ReadOptions, Recording, read_log as read};

    fn log(header: &str) -> String {
        let rows = (0..9).map(|k| format!("{k},{},0.5\n", 90 * k));
        format!("{header}\n{}", rows.collect::<String>())
    }

    #[test]
    fn units_below_the_header_are_those_of_the_columns() {
        for (header, column) in [
            ("Time,Position,Iq\n[ms],[deg],[A]", ""),
            ("Time,Position,Iq\n(ms),(deg),\n", ""),
            ("# Time, Position, Iq\n# [ms], [deg], [A]", ""),
            ("a log (of today)\nTime,Position,Iq\n\n(ms),(deg),(A)", ""),
            ("a,b,c\n[ms],[deg],[A]", "t=a,counts_large=b"),
            ("t,counts_large,c\n[ms],[deg],[A]", ""),
            (
                "t,counts_large,c\n[ms],[deg],[A]",
                "counts_large=counts_large",
            ),
        ] {
            let recording = read(&log(header), column).unwrap();
            assert_eq!(recording.t[..3], [0.0, 0.001, 0.002], "{header}");
            assert_eq!(
                recording.trace.counts_large[..3],
                [0, 1024, 2048],
                "{header}"
            );
        }
        let one = "Position\n[deg]\n0\n90\n180\n";
        let mut options = ReadOptions::default();
        options.set_row_rate(1000.0).unwrap();
        let recording = Recording::parse_as(one.as_bytes(), "r.csv", &options).unwrap();
        assert_eq!(recording.trace.counts_large, [0, 1024, 2048]);
        let error = read(&log("Time,Position,Iq\n[ms],[mm],[A]"), "").unwrap_err();
        assert!(error.contains("no column counts_large"), "{error}");
        let error = read(&log("t,counts_large,Iq\n[min],[deg],[A]"), "").unwrap_err();
        let said = "r.csv: line 1: 'min' at the end of the name is no unit of t";
        assert!(error.starts_with(said), "{error}");
    }

    #[test]
    fn units_need_no_brackets() {
        for (header, column) in [
            ("Time,Position,Iq\nms,deg,A", ""),
            ("Time,Position,Iq\nms,deg,", ""),
            ("# Time, Position, Gain\n# ms, deg, rad.s", ""),
            ("Zeit,Winkel,Iq\nms,deg,A", "t=Zeit,counts_large=Winkel"),
            ("t,counts_large,speed\nms,deg,rpm", ""),
            // They are the names themselves.
            ("ms,deg,A", ""),
            ("a log,of today\nms,deg,A", ""),
        ] {
            let recording = read(&log(header), column).unwrap();
            assert_eq!(recording.t[..3], [0.0, 0.001, 0.002], "{header}");
            let counts = &recording.trace.counts_large[..3];
            assert_eq!(counts, [0, 1024, 2048], "{header}");
        }
    }

    #[test]
    fn names_above_bare_units_say_what_a_column_is() {
        for (header, said) in [
            (
                "Time,Angle Setpoint,Speed\ns,deg,rpm",
                "by its name 'Angle Setpoint' is a rate, a target",
            ),
            (
                "Time,Target Position,Actual Position\ns,deg,deg",
                "for example --column 't=Time,counts_large=Actual Position'",
            ),
            (
                "Zeit,Sollwinkel,Istwinkel\ns,°,°",
                "for example --column 't=Zeit,counts_large=Istwinkel'",
            ),
            (
                "Time,Commanded Angle,Encoder\ns,deg,ticks",
                "for example --column 't=Time,counts_large=Encoder'",
            ),
            (
                "Voltage,Position,Output Speed\nV,deg,rad.s",
                "found: Voltage; Position; Output Speed,",
            ),
        ] {
            let error = read(&log(header), "").unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn names_in_brackets_are_a_header_where_no_names_are_above() {
        for above in ["", "a log\n", "one,two\n"] {
            let text = log(&format!("{above}(ms),(deg),(A)"));
            let read = read(&text, "t=(ms),counts_large=(deg)").unwrap();
            assert_eq!(read.trace.counts_large[..2], [0, 1024], "{above}");
        }
    }
}
