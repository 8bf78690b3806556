//! Error messages for a header without a needed column.

use terminal::failure::Failure;

use super::formats::Format;
use super::hint::{self, guessed_unit, theirs};
use super::{Layout, Places};
use crate::recording::options::{Column, Mapping};
use crate::recording::text::prefixed;

/// Characters of a header that a message shows.
const SHOWN: usize = 60;

/// Characters of one name that a message shows.
const NAME: usize = 30;

/// Error for a log without `column`, with the header as found and a hint at the remedy.
pub(crate) fn missing(column: Column, layout: &Layout, places: &Places, name: &str) -> Failure {
    let ours = column.name();
    let is_needed = matches!(column, Column::T | Column::CountsLarge);
    if let (true, Some(why)) = (is_needed, hint::reason(layout, places)) {
        return Failure::Input(format!("{name}: line {}: {why}", layout.line.max(1)));
    }
    let found = found(layout);
    let stamped = prefixed::remedy_of(layout);
    let remedy = match (column, stamped) {
        (Column::T | Column::CountsLarge, Some(remedy)) => remedy,
        (Column::T | Column::CountsLarge, None) => format!(
            "{}{}; read without options are t with counts_large, and the logs of {}",
            hint::option(layout, places),
            hint::without_time(layout),
            known()
        ),
        _ => format!("name it with --column {ours}=THEIRS, or rename a column"),
    };
    Failure::Input(format!(
        "{name}: line {}: no column {ours}; {found}; {remedy}",
        layout.line.max(1)
    ))
}

/// Error for a `--column` whose name is not in the header, or whose unit is none.
pub(crate) fn unknown(mapping: &Mapping, layout: &Layout, name: &str) -> Failure {
    let (theirs, ours) = (&mapping.theirs, mapping.column.name());
    if let Some(why) = hint::barred(layout) {
        return Failure::Input(format!("{name}: line {}: {why}", layout.line.max(1)));
    }
    if let Some((column, unit)) = theirs.rsplit_once(':')
        && layout.place(column).is_some()
    {
        let quantity = mapping.column.quantity();
        if let (Some(unit), Some(_)) = (mapping.unit, quantity.unit(unit)) {
            return Failure::Input(format!(
                "{name}: --column {ours}={}:{}: the unit is stated twice; write --column {ours}={}:{1}",
                short(theirs),
                unit.name(),
                short(column)
            ));
        }
        let units = quantity.list();
        return Failure::Input(format!(
            "{name}: --column {ours}={}: '{}' is no unit of {ours}; there are {units}",
            short(theirs),
            short(unit)
        ));
    }
    Failure::Input(format!(
        "{name}: line {}: no column '{}', which --column names for {ours}; {}; write {}the number of the column",
        layout.line.max(1),
        short(theirs),
        found(layout),
        match layout.has_header() {
            true => "one of these names, or ",
            false => "",
        }
    ))
}

/// Checks that the header has the name of a `--column` no more than once.
///
/// # Errors
/// [`Failure::Input`] with the numbers of the columns.
pub(crate) fn check_one(mapping: &Mapping, layout: &Layout, name: &str) -> Result<(), Failure> {
    let called = layout.names.iter().zip(1..);
    let called = called.filter(|(known, _)| **known == mapping.theirs);
    let numbers: Vec<_> = called.map(|(_, number): (_, u32)| number).collect();
    if numbers.len() < 2 {
        return Ok(());
    }
    let listed: Vec<_> = numbers.iter().map(u32::to_string).collect();
    let unit = mapping.unit.map(|unit| format!(":{}", unit.name()));
    Err(Failure::Input(format!(
        "{name}: line {}: {} columns '{}', of which --column names one for {ours}: the numbers {}; write one \
         of the numbers, for example --column {ours}={}{}",
        layout.line,
        numbers.len(),
        short(&mapping.theirs),
        listed.join(", "),
        numbers[0],
        unit.unwrap_or_default(),
        ours = mapping.column.name(),
    )))
}

/// Error for the `column` at `place` whose unit is not stated, and whose name ends as if it had another `unit`.
pub(crate) fn unknown_unit(
    column: Column,
    place: usize,
    unit: &str,
    layout: &Layout,
    name: &str,
) -> Failure {
    let (ours, quantity) = (column.name(), column.quantity());
    Failure::Input(format!(
        "{name}: line {}: '{}' at the end of the name is no unit of {ours}; there are {}; convert the numbers, \
         or state the unit where it is one of these, for example --column '{ours}={}:{}'",
        layout.line.max(1),
        short(unit),
        quantity.list(),
        theirs(layout, place),
        guessed_unit(layout, quantity, place)
    ))
}

/// Error for a log of `format`, which has no time.
pub(crate) fn without_time(format: &Format, name: &str) -> Failure {
    Failure::Input(format!(
        "{name}: line 1: no column t: the rows look like the monitor of {}, which has no time; give the rate of the \
         rows with --row-rate HZ, or the columns with --column t=1,counts_large=2:rad",
        format.name
    ))
}

/// Names of the known logs.
fn known() -> String {
    let mut names: Vec<_> = Format::all()
        .filter(|format| !format.own)
        .map(|format| format.name)
        .collect();
    names.dedup();
    names.join(", ")
}

/// A name as a message shows it; a long one has its begin.
pub(crate) fn short(name: &str) -> String {
    let escaped = name.chars().take(NAME).flat_map(char::escape_debug);
    let cut = if name.chars().count() > NAME {
        "..."
    } else {
        ""
    };
    escaped.chain(cut.chars()).collect()
}

/// The columns as found, and their separator.
pub(crate) fn found(layout: &Layout) -> String {
    let number = layout.names.len();
    if !layout.has_header() {
        let columns = match number {
            1 => "1 column".to_owned(),
            _ => format!("{number} columns, separated by {}", layout.separator.name()),
        };
        return match layout.misfit {
            None => format!("there are no names but {columns}"),
            Some((line, names)) => {
                format!("line {line} has {names} names, and the rows have {columns}")
            }
        };
    }
    let names: Vec<_> = layout.names.iter().map(|name| short(name)).collect();
    let all = names.join("; ");
    let shown: String = all.chars().take(SHOWN).collect();
    let more = if shown.len() < all.len() { " ..." } else { "" };
    let searched = layout.searched.as_ref();
    if let (Some(searched), true) = (searched, all.is_empty()) {
        return format!("no header within the first {searched}");
    }
    let other = searched.map(|searched| format!("; no other header within the first {searched}"));
    let other = other.unwrap_or_default();
    match number {
        0 | 1 => format!("found: '{shown}{more}'{other}"),
        _ if layout.named_values => format!("found: {shown}{more}"),
        _ => format!(
            "found: {shown}{more}, separated by {}{other}",
            layout.separator.name()
        ),
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{Recording, read_log};

    fn error(text: &str) -> String {
        let error = Recording::parse(text.as_bytes(), "r.csv").unwrap_err();
        error.to_string()
    }

    #[test]
    fn error_shows_the_header_and_the_option_that_reads_it() {
        for (text, said) in [
            (
                "time_ms;angle\n0;1\n1;2\n",
                "line 1: no column counts_large; found: time_ms; angle, separated by ';'; name the columns and \
                 units, for example --column 't=time_ms,counts_large=angle:counts'",
            ),
            (
                "",
                "line 1: no column t; found: ''; the file has no rows; write t,counts_large in its first line",
            ),
            (
                "T,counts_large\n0,1\n",
                "found: T; counts_large, separated by ','; name the columns and units, for example \
                 --column 't=T:s'",
            ),
            (
                "t,Counts_Large\n0,1\n",
                "no column counts_large; found: t; Counts_Large, separated by ','; name the columns and \
                 units, for example --column 'counts_large=Counts_Large:counts'",
            ),
            (
                "0,1\n0.1,2\n",
                "no column t; there are no names but 2 columns, separated by ','; give the \
                 numbers of the columns, for example --column t=1:s,counts_large=2:counts",
            ),
            (
                "time (s),pos,pwm:Kp=1,Kd=2\n0,1,5\n0.1,2,6\n",
                "line 1: no column t; line 1 has 4 names, and the rows have 3 columns, separated by ','; \
                 write one name for each column, or give the numbers of the columns, for example --column \
                 t=1:s,counts_large=2:counts",
            ),
            (
                "a log of time, of position\n0,1,5\n0.1,2,6\n",
                "line 1 has 2 names, and the rows have 3 columns",
            ),
            (
                "started at 12:00, by me\n0,1,5\n0.1,2,6\n",
                "no column t; there are no names but 3 columns",
            ),
            // Some field of each row is a text.
            (
                "S,0,1\nS,0.1,2\n",
                "no column t; there are no names but 3 columns, separated by ','; give the numbers",
            ),
            (
                "% a log\n%time,name,angle\n# first\n0,joint,1\n0.1,joint,2\n",
                "line 2: no column t; found: time; name; angle, separated by ','; name the columns",
            ),
            (
                "stamp,2,state\n0,1,ok\n1,2,ok\n",
                "line 1: no column t; found: stamp; 2; state, separated by ','; name the columns",
            ),
            (
                "# a log\nsome text\n\nstamp angle\n0 1\n1 2\n",
                "line 4: no column t; found: stamp; angle, separated by spaces; name the columns and \
                 units, for example --column 't=stamp:s,counts_large=angle:counts'",
            ),
            // Values with names have no separator.
            (
                "{\"x\": 0, \"angle\": 1}\n{\"x\": 0.1, \"angle\": 2}\n",
                "line 1: no column t; found: x; angle; name the columns",
            ),
            (
                "__time,/a/position,/b/position\n0,0.1,0.2\n",
                "line 1: 2 positions fit a log of PlotJuggler: /a/position; /b/position; name one, for \
                 example --column 't=__time:s,counts_large=/a/position:rad'",
            ),
            (
                "stamp,robot/joint_states/left_arm/shoulder_lift/counts_raw\n0,1\n",
                "--column 't=stamp:s,counts_large=robot/joint_states/left_arm/shoulder_lift/counts_raw:counts'",
            ),
            (
                "t_us,joint [deg]\n0,1\n",
                "--column 't=t_us,counts_large=joint [deg]'",
            ),
            (
                "time_min,pos_urad\n0,1\n",
                "--column 't=time_min:UNIT,counts_large=pos_urad:UNIT', where 'min' is no unit of t (s, ms, us, ns), \
                 and 'urad' is no unit of counts_large (counts, deg, rad, rev, mdeg, mrad, arcmin, arcsec): write \
                 the unit of the numbers in the place of UNIT, or convert them to one; read",
            ),
            (
                "stamp,the user's count\n0,1\n",
                "--column 't=stamp:s,counts_large=2'",
            ),
            (
                "Time:ms,Angle:deg\n0,1\n",
                "found: Time:ms; Angle:deg, separated by ','",
            ),
            (
                "t|counts_large\n0|1\n",
                "line 1: '|' separates no fields; write commas, semicolons, tabs or spaces",
            ),
            (
                "| time_ms | counts |\n|---|---|\n| 0 | 1 |\n",
                "line 1: '|' separates no fields; write commas",
            ),
            (
                "stamp,axis0.encoder.pos_estimate_of_load\n0,1\n",
                "found: stamp; axis0.encoder.pos_estimate_of_..., separated by ','",
            ),
            (
                "a,b\n1,2\n",
                "for example --column 't=TIME:s,counts_large=POSITION:counts'",
            ),
        ] {
            let error = error(text);
            assert!(error.starts_with("r.csv: line "), "{error}");
            assert!(error.contains(said), "{text:?}: {error}");
        }
    }

    #[test]
    fn error_names_the_known_logs() {
        let error = error("a,b\n1,2\n");
        for name in ["moteus", "ODrive", "VESC Tool", "SimpleFOC", "PlotJuggler"] {
            assert!(error.contains(name), "{name}: {error}");
        }
    }

    #[test]
    fn name_that_no_column_has_is_refused_with_what_can_be_written() {
        let rows = "0,1\n0.1,2\n";
        let none = "no column 'zeit', which --column names for t; ";
        let names_or_number = "write one of these names, or the number of the column";
        for (header, said) in [
            (
                "stamp,pos\n",
                &[none, "found: stamp; pos, ", names_or_number][..],
            ),
            ("", &[none, "; write the number of the column"]),
            (
                "time,pos,x\n",
                &[
                    none,
                    "line 1 has 3 names, ",
                    "; write the number of the column",
                ],
            ),
        ] {
            let error = read_log(&format!("{header}{rows}"), "t=zeit").unwrap_err();
            for said in said {
                assert!(error.contains(said), "{header}: {error}");
            }
        }
    }

    #[test]
    fn name_of_several_columns_is_refused_with_their_numbers() {
        let read = |column: &str| read_log("t,pos,x,pos\n0,1,0,5\n0.001,2,0,7\n", column);
        let said = "r.csv: line 1: 2 columns 'pos', of which --column names one for counts_large: the numbers \
                    2, 4; write one of the numbers, for example --column counts_large=2:deg";
        assert_eq!(read("counts_large=pos:deg").unwrap_err(), said);
        let recording = read("counts_large=4").unwrap();
        assert_eq!(recording.trace.counts_large, [5, 7]);
    }

    #[test]
    fn long_names_and_headers_are_shortened() {
        let text = format!("{},{}\n1,2\n", "x".repeat(500), "y".repeat(500));
        let error = error(&text);
        assert!(error.len() < 600, "{}", error.len());
        assert!(!error.contains(&"x".repeat(31)), "{error}");
    }
}
