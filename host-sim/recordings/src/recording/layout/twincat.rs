//! Text exports of TwinCAT Scope: a header of the file, lines of `key, value, value, ...` for the channels, and
//! rows in which the channels of each sample time stand behind their time, in milliseconds.
//!
//! Source of the layout: the exports in the tests of pytcs, a reader for Python (C. Fabry, MIT licence).

use super::Layout;
use super::search::is_number;
use crate::recording::text::separator::Separator;

/// The key of the names, and the first word of such a file.
const NAME: &str = "Name";

/// The key of a line of the header of the file.
const START: &str = "Starttime of export";

/// The key of the units of the channels.
const UNIT: &str = "Unit";

/// What the columns of time are called here; the file has a key in their place.
const TIME: &str = "Time";

impl Layout {
    /// The layout of an export of TwinCAT Scope whose names are among `lines`; `None` for another text.
    pub(super) fn twincat(lines: &[&str]) -> Option<Self> {
        let after = lines.first()?.strip_prefix(NAME)?;
        let separators = [Separator::Tab, Separator::Semicolon, Separator::Comma];
        let separator = separators
            .into_iter()
            .find(|separator| after.starts_with(char::from(separator.byte())))?;
        let with_key = |key: &str| {
            let has_key =
                move |line: &str| separator.split(line).first().map(String::as_str) == Some(key);
            (lines.iter().enumerate().skip(1))
                .find_map(|(index, line)| has_key(line).then_some(index))
        };
        with_key(START)?;
        let index = with_key(NAME)?;
        let names = separator.split(lines[index]);
        let is_time: Vec<_> = names.iter().map(|name| name == NAME).collect();
        let units = with_key(UNIT).map_or_else(Vec::new, |at| separator.split(lines[at]));
        // A unit has its quantity behind it, as in `deg (Angle)`.
        let unit = |place: usize| match (is_time[place], units.get(place)) {
            (true, _) => "ms",
            (false, Some(unit)) => unit.split(" (").next().unwrap_or_default(),
            (false, None) => "",
        };
        let unit = |place: usize| match unit(place) {
            "(None)" => String::new(),
            unit => unit.to_owned(),
        };
        let is_row = |line: &&str| {
            let first = separator.split(line).into_iter().next();
            first.is_some_and(|field| is_number(&field, separator))
        };
        let rows = lines[index..].iter().position(is_row);
        let called = |(name, is_time): (String, &bool)| match is_time {
            true => TIME.to_owned(),
            false => name,
        };
        Some(Self {
            units: (0..names.len()).map(unit).collect(),
            skip: rows.map_or(lines.len(), |rows| index + rows) as u64,
            ..Self::header(
                separator,
                names.into_iter().zip(&is_time).map(called).collect(),
                index,
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    /// An export of 200 rows at 1 kHz, 3 counts a row, behind a current that is sampled twice as often.
    fn export(separator: char, decimal: char, unit: &str) -> String {
        let keys =
            |key: &str, values: [&str; 2]| format!("{key}\t{}\t{key}\t{}\n", values[0], values[1]);
        let number = |value: f64| value.to_string().replace('.', &decimal.to_string());
        let row = |k: u32| {
            let [half, current] = [f64::from(k) * 0.5, 0.25].map(number);
            format!("{half}\t{current}\t{k}\t{}\n", 3 * k)
        };
        let text = format!(
            "Name\tx\nFile\tC:\\x.csv\nStarttime of export\t133500000000000000\tFreitag\t16:00:00.000\n\
             Endtime of export\t133500000001990000\tFreitag\t16:00:00.199\n\n\n{}{}{}{}{}\n{}EOF\n",
            keys("Name", ["Current", "ActPos"]),
            keys("SampleTime[ms]", ["0,5", "1"]),
            keys("Unit", ["A (Current)", unit]),
            keys("Unit ScaleFactor", ["1", "1"]),
            keys("Unit Offset", ["0", "0"]),
            (0..200).map(row).collect::<String>()
        );
        text.replace('\t', &separator.to_string())
    }

    #[test]
    fn exports_are_read_with_the_time_of_the_channel() {
        for (separator, decimal) in [('\t', ','), ('\t', '.'), (';', ','), (',', '.')] {
            let text = export(separator, decimal, "(None)");
            let error = read(&text, "").unwrap_err();
            let said =
                "r.csv: line 7: no column t; found: Time; Current; Time; ActPos, separated by ";
            assert!(error.starts_with(said), "{error}");
            let said =
                "--column 't=Time,counts_large=ActPos:counts', where the unit counts is a guess";
            assert!(error.contains(said), "{error}");
            let recording =
                read(&text, "t=Time,counts_large=ActPos:counts,current=Current").unwrap();
            assert_eq!(recording.t.len(), 200);
            assert!((recording.t[199] - 0.199).abs() < 1e-12);
            assert_eq!(recording.trace.counts_large[198..], [594, 597]);
            assert_eq!(recording.trace.current.as_ref().unwrap()[7], 0.25);
            let said = "t from 'Time', column 3 (ms), counts_large from 'ActPos' (counts), current from 'Current' (A)";
            assert_eq!(recording.notes[0], said);
        }
    }

    #[test]
    fn channels_have_the_units_of_the_export() {
        let recording = read(
            &export('\t', ',', "deg (Angle)"),
            "t=Time,counts_large=ActPos",
        );
        assert_eq!(recording.unwrap().trace.counts_large[..2], [0, 34]);
    }

    #[test]
    fn channels_of_one_sample_time_share_their_time() {
        let text = "Name\tx\nStarttime of export\t1\n\nName\tv\tp\nUnit\t(None)\tdeg (Angle)\n\n\
                    0\t7\t0\n1\t7\t90\n2\t7\t180\n";
        let recording = read(text, "counts_large=p").unwrap();
        assert_eq!(recording.t, [0.0, 0.001, 0.002]);
        assert_eq!(recording.trace.counts_large, [0, 1024, 2048]);
        // A table whose first name is another program's.
        let other = text.replace("Starttime of export", "Start");
        assert!(read(&other, "counts_large=p").is_err());
    }
}
