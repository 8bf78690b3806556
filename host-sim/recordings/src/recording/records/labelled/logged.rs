//! The time and the words that the log of a program has before the names of a row, as the logging of Python writes
//! them: `2026-03-01 12:00:00,123 - INFO - angle:1.5`.

use super::super::named_fields::{Field, Mark};
use crate::recording::times::moment::Moment;

/// Name of the column of these times.
pub(super) const NAME: &str = "logged_time";

/// What ends the words between the time and the names.
const MARKS: [&str; 4] = [" - ", " | ", "] ", "> "];

/// The time that `line` begins with, and what is behind it.
fn time(line: &str) -> Option<(&str, &str)> {
    // Most rows begin with a name.
    if !line.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    // A date may be a word of its own.
    let ends: Vec<_> = line.match_indices(' ').take(2).collect();
    let mut parts = ends.iter().rev().map(|(end, _)| line.split_at(*end));
    parts.find(|(time, _)| Moment::parse(time).is_some())
}

/// The fields of a row behind a time: the time, and those of its names and numbers, which `named` finds. `None` for a
/// row without a time, and for one without names behind it.
pub(super) fn fields(line: &str, named: impl Fn(&str) -> Option<Vec<Field>>) -> Option<Vec<Field>> {
    let (time, rest) = time(line)?;
    let behind = |mark: &'static str| rest.match_indices(mark).map(move |(at, _)| at + mark.len());
    let mut begins: Vec<_> = MARKS.into_iter().flat_map(behind).collect();
    begins.push(0);
    begins.sort_unstable();
    let is_name = |field: &Field| {
        let name = format!(" {}", field.name);
        !MARKS.iter().any(|mark| name.contains(mark))
    };
    let mut rows = begins
        .into_iter()
        .filter_map(|begin| named(rest[begin..].trim_start()));
    let row = rows.find(|fields| fields.first().is_some_and(is_name))?;
    let time = Field {
        name: NAME.to_owned(),
        text: time.to_owned(),
        mark: Mark::Text,
    };
    Some(std::iter::once(time).chain(row).collect())
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    /// Rows of 100 Hz, 1 degree each, with these words around their times.
    fn rows(words: [&str; 3]) -> String {
        let row = |k: u32| {
            let [before, between, behind] = words;
            let ms = 990 + 10 * k;
            format!(
                "{before}12:59:{:02},{:03}{between}angle: {k} deg{behind}\n",
                58 + ms / 1000,
                ms % 1000
            )
        };
        (0..90).map(row).collect()
    }

    #[test]
    fn time_of_a_logger_is_that_of_the_row() {
        for words in [
            ["2026-03-01 ", " - ", " , vel: -0.5"],
            ["2026-03-01 ", " - INFO - ", " vel: -0.5"],
            ["2026-03-01T", " - motor.control - INFO - ", ""],
            ["2026-03-01 ", " | INFO     | __main__:main:10 - ", ""],
            ["2026-03-01 ", " [INFO] ", ""],
            ["", " ", " - vel: -0.5"],
        ] {
            let recording = read(&rows(words), "").unwrap();
            assert_eq!(recording.trace.counts_large[..3], [0, 11, 23], "{words:?}");
            let passed = recording.t[89] - recording.t[0];
            assert!((passed - 0.89).abs() < 1e-9, "{words:?}: {passed}");
            let said = "t from 'logged_time'";
            assert!(recording.notes[0].contains(said), "{:?}", recording.notes);
        }
    }

    #[test]
    fn lines_of_a_logger_without_the_names_are_left_out() {
        let log = rows(["2026-03-01 ", " - INFO - ", ""]);
        let (first, rest) = log.split_at(5 * log.lines().next().unwrap().len() + 5);
        let stamp = "2026-03-01 12:59:59,039 - INFO - ";
        let log = format!("{stamp}ready\n{first}{stamp}temp: 30\n{stamp}stalled\n{rest}");
        let recording = read(&log, "").unwrap();
        assert_eq!(recording.t.len(), 90);
        let said = "2 lines have none of the names and are left out, the first is line 7";
        assert!(
            recording.notes.iter().any(|note| note == said),
            "{:?}",
            recording.notes
        );
    }
}
