//! Text exports of TwinCAT Scope: a header of the file, lines of `key, value, value, ...` for the channels, and
//! rows in which the channels of each sample time stand behind their time, in milliseconds or as a date of Windows.
//!
//! Source of the layout: the exports in the tests of pytcs, a reader for Python (C. Fabry, MIT licence).

use super::Layout;
use super::search::{is_number, number};
use crate::recording::options::units::FILETIME;
use crate::recording::text::separator::Separator;

/// The key of the names, and the first word of such a file.
const NAME: &str = "Name";

/// The key of a line of the header of the file.
const START: &str = "Starttime of export";

/// The key of the units of the channels.
const UNIT: &str = "Unit";

/// What a time in units of 100 ns from 1601 on exceeds since the year 1917, and none in milliseconds does.
const FILETIMES: f64 = 1e17;

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
        let is_row = |line: &&str| {
            let first = separator.split(line).into_iter().next();
            first.is_some_and(|field| is_number(&field, separator))
        };
        let rows = lines[index..].iter().position(is_row);
        let first = rows.map_or_else(Vec::new, |rows| separator.split(lines[index + rows]));
        let is_filetime = |place: usize| {
            let time = first.get(place).and_then(|field| number(field, separator));
            time.is_some_and(|time| time > FILETIMES)
        };
        // A unit has its quantity behind it, as in `deg (Angle)`.
        let unit = |place: usize| match (is_time[place], units.get(place)) {
            (true, _) if is_filetime(place) => FILETIME.name(),
            (true, _) => "ms",
            (false, Some(unit)) => unit.split(" (").next().unwrap_or_default(),
            (false, None) => "",
        };
        let unit = |place: usize| match unit(place) {
            "(None)" => String::new(),
            unit => unit.to_owned(),
        };
        let called = |(name, is_time): (String, &bool)| match is_time {
            true => TIME.to_owned(),
            false => name,
        };
        Some(Self {
            units: (0..names.len()).map(unit).collect(),
            // Channels of a longer sample time have fewer rows.
            ends_early: true,
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

    /// Of two channels, the one that is read ends after 200 rows.
    #[test]
    fn rows_behind_the_end_of_a_channel_are_left_out() {
        for (is_last, columns) in [(true, "t=3,counts_large=p"), (false, "t=1,counts_large=p")] {
            let row = |k: u32| {
                let (slow, fast) = (
                    format!("{k}\t{}", 3 * k),
                    format!("{}\t5", f64::from(k) * 0.5),
                );
                match (is_last, k < 200) {
                    (true, true) => format!("{fast}\t{slow}\n"),
                    (true, false) => format!("{fast}\n"),
                    (false, true) => format!("{slow}\t{fast}\n"),
                    (false, false) => format!(" \t \t{fast}\n"),
                }
            };
            let names = if is_last {
                "Name\tv\tName\tp"
            } else {
                "Name\tp\tName\tv"
            };
            let rows: String = (0..400).map(row).collect();
            let text = format!("Name\tx\nStarttime of export\t1\n\n{names}\n\n{rows}EOF\n");
            let recording = read(&text, columns).unwrap();
            assert_eq!(recording.t.len(), 200);
            assert_eq!(recording.trace.counts_large[198..], [594, 597]);
            let said = "200 rows without a position are left out, the first in line 206";
            assert!(
                recording.notes.iter().any(|note| note == said),
                "{:?}",
                recording.notes
            );
        }
    }

    #[test]
    fn dates_of_windows_are_times_of_100_ns() {
        let row = |k: u64| format!("{};{k};{}\n", 133_500_000_000_000_000 + 10_000 * k, 8 * k);
        let rows: String = (0..300).map(row).collect();
        let text = format!(
            "Name;x;\nStarttime of export;133500000000000000;Friday\n\nName;v;p\nSampleTime;1\n\n{rows}EOF\n"
        );
        let recording = read(&text, "t=Time,counts_large=p:counts").unwrap();
        let passed = recording.t[299] - recording.t[0];
        assert!((passed - 0.299).abs() < 1e-9, "{passed}");
        assert_eq!(recording.trace.counts_large[298..], [2384, 2392]);
        assert_eq!(
            recording.notes[0],
            "t from 'Time' (100ns), counts_large from 'p' (counts)"
        );
        // The same unit by option.
        let rows: String = (0..9)
            .map(|k| format!("{},{}\n", 20_000 * k, 8 * k))
            .collect();
        let ticks = format!("ticks,p\n{rows}");
        let recording = read(&ticks, "t=ticks:100ns,counts_large=p:counts").unwrap();
        assert_eq!(recording.t[..3], [0.0, 0.002, 0.004]);
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
