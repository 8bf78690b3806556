//! Numbers with separators of thousands that look like decimal numbers.

use terminal::failure::Failure;

/// What the numbers of a column look like: `900` below `1,000` has a separator of thousands, and read as decimal
/// numbers these are 900 and 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Thousands {
    /// Line of the first number with a mark before its last three digits.
    grouped: Option<u64>,
    /// Whether one digit was before that mark: numbers come from below 1000.
    is_small: bool,
    /// Whether a number from 100 to 999 has no mark.
    is_plain_below: bool,
    /// Whether a number is a decimal one, or one from 1000 on without a mark.
    is_decimal: bool,
}

impl Thousands {
    /// Looks at the number `text` in `line`.
    #[inline]
    pub(crate) fn see(&mut self, text: &str, line: u64) {
        if self.is_decimal {
            return;
        }
        let digits = text.trim_start_matches(['+', '-']);
        let (whole, rest) = match digits.split_once([',', '.']) {
            Some((whole, rest)) => (whole, Some(rest)),
            None => (digits, None),
        };
        let is_short = (1..=3).contains(&whole.len());
        let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        match rest {
            None if is_short && is_number(whole) => self.is_plain_below |= whole.len() == 3,
            Some(rest) if is_short && is_number(whole) && !whole.starts_with('0') => {
                match rest.len() == 3 && is_number(rest) {
                    true => {
                        self.grouped = self.grouped.or(Some(line));
                        self.is_small |= whole.len() == 1;
                    }
                    false => self.is_decimal = true,
                }
            }
            _ => self.is_decimal = true,
        }
    }

    /// Checks that the numbers of `column` in the log called `name` have no separators of thousands.
    ///
    /// # Errors
    /// [`Failure::Input`] with the line of the first one if all numbers look so.
    pub(crate) fn check(&self, name: &str, column: &str) -> Result<(), Failure> {
        match self.found() {
            None => Ok(()),
            Some(line) => Err(Failure::Input(format!(
                "{name}: line {line}: column {column}: the mark in this and the other numbers from 1000 on, and in \
                 none below, separates thousands; write the numbers without it"
            ))),
        }
    }

    /// The line of a number with a separator of thousands, if all numbers look so.
    fn found(&self) -> Option<u64> {
        self.grouped
            .filter(|_| self.is_plain_below && self.is_small && !self.is_decimal)
    }
}

/// Whether a mark in a number may separate thousands.
pub(crate) fn is_grouped(text: &str) -> bool {
    let mut seen = Thousands::default();
    seen.see(text, 0);
    seen.grouped.is_some()
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    #[test]
    fn separators_of_thousands_are_no_decimal_marks() {
        for mark in [",", "."] {
            let row = |k: usize| {
                let x = 100 * k;
                match x < 1000 {
                    true => format!("{k};{x}\n"),
                    false => format!("{k};{}{mark}{:03}\n", x / 1000, x % 1000),
                }
            };
            let rows: String = (0..30).map(row).collect();
            let columns = "t=time:ms,counts_large=pos:mdeg";
            let error = read(&format!("time;pos\n{rows}"), columns).unwrap_err();
            let said = "r.csv: line 12: column counts_large: the mark in this and the other numbers from 1000 on, and \
                        in none below, separates thousands; write the numbers without it";
            assert_eq!(error, said);
            // One that is a decimal number for sure.
            for decimal in ["0,5", "1,25", "2000", "1,5e1"] {
                let text = format!("time;pos\n{rows}30;{}\n", decimal.replace(',', mark));
                read(&text, columns).unwrap();
            }
        }
        // Counts have no fraction.
        for (text, tells) in [("1.002", true), ("0.002", false), ("1.25", false)] {
            let error = read(&format!("t;counts_large\n0,001;{text}\n"), "").unwrap_err();
            let said = "; if the mark separates thousands, write the numbers without it";
            assert_eq!(error.ends_with(said), tells, "{error}");
        }
        // No number below 1000 but above 99, or from 1000 on but below 10000.
        for x in [20, 500] {
            let row = |k: usize| format!("{k};{x},{:03}\n", k + 1);
            let rows: String = (0..30).map(row).collect();
            let text = format!("time;pos\n{rows}30;{x}\n");
            read(&text, "t=time:ms,counts_large=pos:deg").unwrap();
        }
        // Three digits behind the mark of all numbers.
        let row = |k: usize| format!("{k};{},{:03}\n", 1 + k / 10, 100 * (k % 10));
        let rows: String = (0..30).map(row).collect();
        read(
            &format!("time;pos\n{rows}"),
            "t=time:ms,counts_large=pos:deg",
        )
        .unwrap();
    }
}
