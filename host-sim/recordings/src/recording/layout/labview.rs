//! Measurement files of LabVIEW (.lvm): a header of the file, one of the data, the names, the rows.
//!
//! Source of the fields: NI, "Specification for the LabVIEW Measurement File (.lvm)".

use super::Layout;
use crate::recording::text::separator::Separator;

/// The first field of such a file.
const MARK: &str = "LabVIEW Measurement";

/// The end of either header.
const END: &str = "***End_of_Header***";

/// The column of the values on the horizontal axis.
pub(super) const X_VALUE: &str = "X_Value";

/// The name of the remark that may end a row.
const REMARK: &str = "Comment";

impl Layout {
    /// The layout of a measurement file of LabVIEW whose names are among `lines`; `None` for another text.
    /// Columns have the units of the header, and the horizontal axis that of a time where it is one.
    pub(super) fn labview(lines: &[&str]) -> Option<Self> {
        let after = lines.first()?.trim_end().strip_prefix(MARK)?;
        let separator = match after.starts_with(',') {
            true => Separator::Comma,
            false => Separator::Tab,
        };
        let is_end = |line: &&str| line.starts_with(END);
        let mut ends = lines.iter().enumerate().filter(|(_, line)| is_end(line));
        let end = ends.nth(1)?.0;
        let names = separator.split(lines.get(end + 1)?);
        let remarks = names.last().is_some_and(|name| name == REMARK);
        let value = |key: &str, place: usize| {
            let fields = lines[..end].iter().map(|line| separator.split(line));
            let mut named = fields.filter(|fields| fields.first().is_some_and(|name| name == key));
            let value = named.next().and_then(|fields| fields.get(place).cloned());
            value.unwrap_or_default()
        };
        // Each value of the header stands in the column of the measured values.
        let unit = |place: usize| match (names[place] == X_VALUE, value("X_Columns", 1).as_str()) {
            (true, "No") => String::new(),
            (true, _) if value("X_Dimension", place + 1) == "Time" => "s".to_owned(),
            _ => value("Y_Unit_Label", place),
        };
        let named = names.len() - usize::from(remarks);
        let period: Option<f64> = value("Delta_X", 1).replacen(',', ".", 1).parse().ok();
        let is_timed = value("X_Columns", 1) != "No";
        Some(Self {
            units: (0..named).map(unit).collect(),
            remarks,
            row_rate_hz: period
                .filter(|period| !is_timed && *period > 0.0)
                .map(f64::recip),
            ..Self::header(separator, names[..named].to_vec(), end + 1)
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::{ReadOptions, Recording, read_log as read};

    /// A file of 400 rows at 1 kHz: 3 counts a row.
    fn log(columns: &str, unit: &str, decimal: char) -> String {
        let pair = |one: &str, other: &str| match columns {
            "Multi" => format!("{one}\t\t{other}\t"),
            _ => format!("{one}\t{other}\t"),
        };
        let names = match columns {
            "Multi" => "X_Value\tPosition\tX_Value\tCurrent\tComment",
            _ => "X_Value\tPosition\tCurrent\tComment",
        };
        let rows = (0..400).map(|k| {
            let [x, position] = [f64::from(k) * 1e-3, f64::from(3 * k)].map(|v| format!("{v:.6}"));
            let remark = if k == 0 { "\tstarted" } else { "" };
            match columns {
                "No" => format!("\t{position}\t0.500000{remark}\n"),
                "Multi" => format!("{x}\t{position}\t{x}\t0.500000{remark}\n"),
                _ => format!("{x}\t{position}\t0.500000{remark}\n"),
            }
        });
        let text = format!(
            "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n\
             Multi_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tAbsolute\nOperator\tx\nDate\t2026/03/10\n\
             Time\t12:22:22.2500000\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t{}\n\
             Y_Unit_Label\t{}\nX_Dimension\t{}\nX0\t{}\nDelta_X\t{}\n***End_of_Header***\t\t\t\n{names}\n{}",
            pair("400", "400"),
            pair(unit, "A"),
            pair("Time", "Time"),
            pair("0.0000000000000000E+0", "0.0000000000000000E+0"),
            pair("0.001000", "0.001000"),
            rows.collect::<String>()
        );
        text.replace('.', &decimal.to_string())
    }

    fn check(recording: &Recording, case: &str) {
        assert_eq!(recording.t.len(), 400, "{case}");
        assert!((recording.t[399] - 0.399).abs() < 1e-12, "{case}");
        assert_eq!(recording.trace.counts_large[398..], [1194, 1197], "{case}");
    }

    #[test]
    fn measurement_files_are_read_with_the_units_of_their_header() {
        for decimal in ['.', ','] {
            let recording = read(&log("One", "counts", decimal), "").unwrap();
            check(&recording, "counts");
            let said = "read by the names of its columns: t from 'X_Value' (s), counts_large from 'Position' \
                        (counts); others are named with --column";
            assert_eq!(recording.notes[0], said);
        }
        let commas = log("One", "counts", '.').replace('\t', ",");
        check(&read(&commas, "").unwrap(), "commas");
        let current = read(&log("One", "counts", '.'), "current=Current").unwrap();
        assert_eq!(current.trace.current.unwrap()[..2], [0.5; 2]);
        let degrees = read(&log("One", "deg", '.'), "").unwrap();
        assert_eq!(degrees.trace.counts_large[..2], [0, 34]);
        let spectrum =
            log("One", "counts", '.').replace("X_Dimension\tTime", "X_Dimension\tFrequency");
        let error = read(&spectrum, "").unwrap_err();
        assert!(error.contains("no column t; found: X_Value; "), "{error}");
        // A file without units.
        let none = log("One", "", '.');
        let error = read(&none, "").unwrap_err();
        let remedy = "line 21: no column counts_large; found: X_Value; Position; Current, separated by tabs; name \
                      the columns and units, for example --column 't=X_Value,counts_large=Position:counts'";
        assert!(error.contains(remedy), "{error}");
        check(&read(&none, "counts_large=Position").unwrap(), "no unit");
    }

    #[test]
    fn each_signal_may_have_a_time_of_its_own() {
        let two = log("Multi", "counts", '.');
        for (columns, number) in [
            ("t=X_Value,counts_large=Position", 1),
            ("counts_large=2,t=X_Value", 1),
            ("t=X_Value,counts_large=Current:counts", 3),
        ] {
            let text = two.replace("\t0.500000", "\t1");
            let recording = read(&text, columns).unwrap();
            assert_eq!(recording.t.len(), 400);
            let said = format!("t from 'X_Value', column {number} (s), counts_large");
            assert!(
                recording.notes[0].starts_with(&said),
                "{:?}",
                recording.notes
            );
        }
        check(
            &read(&two, "t=X_Value,counts_large=Position").unwrap(),
            "two",
        );
        check(&read(&two, "t=1,counts_large=Position").unwrap(), "first");
        // No time stands before the position.
        let behind = "p,time_ms,v,time_ms\n0,0,1,0\n1,1,1,1\n2,2,1,2\n";
        let error = read(behind, "t=time_ms,counts_large=p").unwrap_err();
        let said = "2 columns 'time_ms', of which --column names one for t: the numbers 2, 4";
        assert!(error.contains(said), "{error}");
    }

    #[test]
    fn rows_without_a_time_have_the_rate_of_the_header() {
        let text = log("No", "counts", ',');
        let error = read(&text, "").unwrap_err();
        let said = "r.csv: line 21: no column t: the rows have no time, and the header states 1000 rows a second; \
                    give this rate with --row-rate 1000";
        assert_eq!(error, said);
        let mut options = ReadOptions::default();
        options.set_row_rate(1000.0).unwrap();
        let recording = Recording::parse_as(text.as_bytes(), "r.csv", &options).unwrap();
        check(&recording, "no time");
        let error = read(&text.replace("0,001000\t", "0,000000\t"), "").unwrap_err();
        assert!(error.contains("--row-rate HZ"), "{error}");
    }

    #[test]
    fn a_header_that_ends_early_is_searched_as_any_text() {
        for text in [
            "LabVIEW Measurement\t\n",
            "LabVIEW Measurement\n***End_of_Header***\n1\t2\n",
        ] {
            let error = read(text, "").unwrap_err();
            assert!(error.contains("no column t"), "{error}");
        }
        let two = log("One", "counts", '.') + "\t\nChannels\t2\t\t\n***End_of_Header***\n";
        let error = read(&two, "").unwrap_err();
        assert!(error.contains("line 423: "), "{error}");
    }
}
