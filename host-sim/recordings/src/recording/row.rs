//! Fields of one row of a recording.

use csv::ByteRecord;

use terminal::failure::Failure;

/// One row, to read fields from.
pub(super) struct Row<'a> {
    pub(super) name: &'a str,
    pub(super) line: u64,
    pub(super) record: &'a ByteRecord,
    /// Whether a comma in a number is a decimal comma.
    pub(super) decimal_comma: bool,
}

impl Row<'_> {
    pub(super) fn failure(&self, column: &str, what: &str) -> Failure {
        Failure::Input(format!(
            "{}: line {}: column {column}: {what}",
            self.name, self.line
        ))
    }

    pub(super) fn text(&self, column: &str, place: usize) -> Result<&str, Failure> {
        let bytes = self.record.get(place).unwrap_or_default().trim_ascii();
        std::str::from_utf8(bytes).map_err(|_| self.failure(column, "not text"))
    }

    pub(super) fn number(&self, column: &str, place: usize) -> Result<f64, Failure> {
        let text = self.text(column, place)?;
        match self.parse(text) {
            Some(number) if number.is_finite() => Ok(number),
            _ => Err(self.failure(column, &not_a_number(text))),
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
    pub(super) fn count(&self, column: &str, place: usize) -> Result<i64, Failure> {
        let text = self.text(column, place)?;
        if let Ok(count) = text.parse::<i64>() {
            return Ok(count);
        }
        // Some tools write integers as floats: 12.0.
        match self.parse(text) {
            Some(number) if number.fract() == 0.0 && number.abs() < 9e15 => Ok(number as i64),
            Some(number) if number.is_finite() => {
                Err(self.failure(column, &format!("{number} is not a whole number of counts")))
            }
            _ => Err(self.failure(column, &not_a_number(text))),
        }
    }
}

fn not_a_number(text: &str) -> String {
    let hint = match text {
        "" => "; remove the row, or fill the field",
        _ if text.contains(',') && text.contains('.') => {
            "; write it without separators of thousands"
        }
        _ if text.contains(',') => "; write it with a decimal point",
        _ => "",
    };
    format!("{} is not a number{hint}", quoted(text))
}

/// A field for a message: shortened, without control characters.
fn quoted(text: &str) -> String {
    let short: String = text.chars().take(20).flat_map(char::escape_debug).collect();
    format!("'{short}'")
}
