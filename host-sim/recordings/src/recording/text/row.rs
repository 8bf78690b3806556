//! Fields of one row of a recording.

use csv::ByteRecord;

use terminal::failure::Failure;

use super::fields::{is_without_value, not_a_number};
use super::thousands::is_grouped;
use crate::recording::numbers::shown;
use crate::recording::records::named_fields::Mark;

/// One row, to read fields from.
pub(crate) struct Row<'a> {
    pub(crate) name: &'a str,
    pub(crate) line: u64,
    pub(crate) record: &'a ByteRecord,
    /// What each field of a row with names is; nothing for a row without.
    pub(crate) marks: &'a [Mark],
    /// Names of the columns as the log has them.
    pub(crate) names: &'a [String],
    /// Whether the row is the first one below the header.
    pub(crate) is_first: bool,
    /// Whether its last field may be cut: no end of line follows it.
    pub(crate) is_cut: bool,
    /// Whether a comma in a number is a decimal comma.
    pub(crate) decimal_comma: bool,
}

impl Row<'_> {
    pub(crate) fn failure(&self, column: &str, what: &str) -> Failure {
        Failure::Input(format!(
            "{}: line {}: column {column}: {what}",
            self.name, self.line
        ))
    }

    pub(crate) fn text(&self, column: &str, place: usize) -> Result<&str, Failure> {
        if self.marks.get(place) == Some(&Mark::Twice) {
            let what = format!(
                "two fields '{}' in one line; rename or remove one",
                self.theirs(column, place)
            );
            return Err(self.failure(column, &what));
        }
        let bytes = self.record.get(place).unwrap_or_default().trim_ascii();
        std::str::from_utf8(bytes).map_err(|_| self.failure(column, "not text"))
    }

    /// Whether a field that is read at one of the `places` may be cut or is missing. The fields of a row with names may have any order.
    pub(crate) fn is_cut_at(&self, mut places: impl Iterator<Item = usize>) -> bool {
        let has_names = !self.marks.is_empty();
        self.is_cut && (has_names || places.any(|place| place + 1 >= self.record.len()))
    }

    /// Whether a line is none of the rows, whose fields have names: it has none of them.
    pub(crate) fn is_message(&self) -> bool {
        !self.marks.is_empty() && self.marks.iter().all(|mark| *mark == Mark::Missing)
    }

    /// Number of the columns with a place that `is_meant` that have a value.
    pub(crate) fn values(&self, is_meant: impl Fn(usize) -> bool) -> usize {
        let is_value = |field: &[u8]| {
            !std::str::from_utf8(field).is_ok_and(|text| is_without_value(text.trim()))
        };
        let fields = self.record.iter().enumerate();
        let meant = fields.filter(|(place, field)| is_meant(*place) && is_value(field));
        meant.count()
    }

    pub(crate) fn number(&self, column: &str, place: usize) -> Result<f64, Failure> {
        let text = self.text(column, place)?;
        match self.parse(text) {
            Some(number) if number.is_finite() => Ok(number),
            _ => Err(self.failure(column, &self.not_a_number(text, column, place))),
        }
    }

    fn parse(&self, text: &str) -> Option<f64> {
        if let Ok(number) = text.parse() {
            return Some(number);
        }
        // A second mark would be one of thousands.
        let (whole, fraction) = text.split_once(',').filter(|_| self.decimal_comma)?;
        match fraction.contains([',', '.']) || whole.contains('.') {
            true => None,
            false => format!("{whole}.{fraction}").parse().ok(),
        }
    }

    /// A whole number, modulo 2^32.
    pub(crate) fn count(&self, column: &str, place: usize) -> Result<i64, Failure> {
        let text = self.text(column, place)?;
        if let Ok(count) = text.parse::<i64>() {
            return Ok(count);
        }
        // Some tools write integers as floats: 12.0.
        match self.parse(text) {
            Some(number) if number.fract() == 0.0 && number.abs() < 9e15 => Ok(number as i64),
            Some(number) if number.is_finite() => {
                let mut what = self.not_whole(number, column, place);
                if is_grouped(text) {
                    what += "; if the mark separates thousands, write the numbers without it";
                }
                Err(self.failure(column, &what))
            }
            _ => Err(self.failure(column, &self.not_a_number(text, column, place))),
        }
    }

    fn not_a_number(&self, text: &str, column: &str, place: usize) -> String {
        let theirs = self.theirs(column, place);
        let text = match self.marks.get(place) {
            Some(Mark::Missing) => {
                return format!("no field '{theirs}' in the line; add it, or remove the line");
            }
            Some(Mark::Blank(word)) => word,
            _ => text,
        };
        not_a_number(text, [column, theirs], self.is_first)
    }

    /// The name of a column in the log.
    fn theirs<'b>(&'b self, column: &'b str, place: usize) -> &'b str {
        self.names.get(place).map_or(column, String::as_str)
    }

    fn not_whole(&self, number: f64, column: &str, place: usize) -> String {
        let number_text = shown(number);
        if number.fract() == 0.0 {
            return format!(
                "{number_text} is too large for a count; correct the field, or remove the row"
            );
        }
        let theirs = self.theirs(column, place);
        format!(
            "{number_text} is not a whole number of counts; if it is an angle, state its unit, for example \
             --column '{column}={theirs}:deg', or :rad or :rev; if the counts are interpolated, multiply \
             them, and the counts per revolution, to whole numbers"
        )
    }
}
