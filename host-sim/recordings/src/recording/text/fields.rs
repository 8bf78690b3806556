//! What is wrong with a field that is no number, and the remedy.

use super::prefixed;
use crate::recording::options::Column;
use crate::recording::options::units::Quantity;

/// Characters of a field that a message shows.
const SHOWN: usize = 40;

/// What stands for no value, in any case.
const NO_VALUE: [&str; 7] = ["", "nan", "-nan", "null", "none", "na", "n/a"];

/// Whether a field has no value: it is empty, or says so.
pub(crate) fn is_without_value(text: &str) -> bool {
    NO_VALUE.iter().any(|word| text.eq_ignore_ascii_case(word))
}

/// The error for `text` in `column`, which the log calls `theirs`. `is_first` is true for the row below
/// the header.
pub(crate) fn not_a_number(text: &str, [column, theirs]: [&str; 2], is_first: bool) -> String {
    let remedy = match (text == theirs, prefixed::remedy(text)) {
        (true, _) => "the header is repeated: cut the log there".to_owned(),
        (false, Some(stamped)) => stamped,
        (false, None) => remedy(text, [column, theirs], is_first),
    };
    format!("{} is not a number; {remedy}", quoted(text))
}

fn remedy(text: &str, [column, theirs]: [&str; 2], is_first: bool) -> String {
    let digits = |c: char| c.is_ascii_digit();
    let lower = text.to_lowercase();
    let is_needed = [Column::T, Column::CountsLarge]
        .map(Column::name)
        .contains(&column);
    match lower.trim_start_matches(['+', '-']) {
        "" => "remove the row, or fill the field".to_owned(),
        word if is_without_value(word) || ["inf", "infinity"].contains(&word) => match is_needed {
            true => "remove the rows without a value".to_owned(),
            false => format!(
                "remove the rows without a value, or rename the column {theirs} if the command does without it"
            ),
        },
        hex if hex.starts_with("0x") => "it is hexadecimal: write it in decimal".to_owned(),
        list if list.starts_with(['[', '{']) => {
            let is_list = list.contains(|c: char| c.is_whitespace() || c == ',');
            match is_list {
                true => "it is a list: write each of its numbers in a field of its own".to_owned(),
                false => "write it without brackets".to_owned(),
            }
        }
        time if column == Column::T.name() && is_date(time) => {
            "write it in s, as 2025-03-01T12:00:00.000, or as 12:00:00.000".to_owned()
        }
        time if column != Column::T.name() && time.contains(':') && time.starts_with(digits) => {
            "it is a time: name another column with --column".to_owned()
        }
        number if has_fortran_exponent(number) => {
            "write its exponent with E in the place of D".to_owned()
        }
        measured if has_unit(measured) => "write it without its unit".to_owned(),
        minus if minus.starts_with('\u{2212}') => "write the minus sign as '-'".to_owned(),
        _ if has_thousands(text) => "write it without separators of thousands".to_owned(),
        _ if is_hexadecimal(&lower) => {
            "if it is hexadecimal, write it in decimal; else correct the field, or remove the row"
                .to_owned()
        }
        _ if text.contains(',') => "write it with a decimal point".to_owned(),
        _ if is_first && !text.contains(digits) => {
            "remove the line if it has the units, and state them with --column".to_owned()
        }
        _ => "correct the field, or remove the row".to_owned(),
    }
}

/// Whether a word of digits and letters to f may be a hexadecimal number. A number with an exponent that is cut is none.
fn is_hexadecimal(lower: &str) -> bool {
    let has = |of: fn(char) -> bool| lower.contains(of);
    lower.chars().all(|c| c.is_ascii_hexdigit())
        && has(|c| c.is_ascii_digit())
        && has(|c| ('a'..='f').contains(&c) && c != 'e')
}

/// Whether a field is a date or a time of a form that is not read: it has a number with colons, or one with two hyphens
/// or a T in it.
fn is_date(text: &str) -> bool {
    let has_digits = text.contains(|c: char| c.is_ascii_digit());
    let begins = text.starts_with(|c: char| c.is_ascii_digit());
    has_digits
        && (text.contains(':') || begins && (text.matches('-').count() > 1 || text.contains('t')))
}

/// Whether a field, in lower case, is a number of double precision as Fortran writes it: 1.0D+00.
fn has_fortran_exponent(text: &str) -> bool {
    let is_exponent = |text: &str| text.parse::<i32>().is_ok();
    text.split_once('d')
        .is_some_and(|(number, exponent)| number.parse::<f64>().is_ok() && is_exponent(exponent))
}

/// Whether a field is a number and a unit: 0.5 deg.
fn has_unit(text: &str) -> bool {
    let end = text
        .trim_end_matches(|c: char| c.is_alphabetic() || matches!(c, '/' | '\u{b0}' | '%' | '.'));
    let unit = &text[end.len()..];
    end.trim_end().parse::<f64>().is_ok()
        && Quantity::ALL
            .iter()
            .any(|quantity| quantity.unit(unit).is_some())
}

/// Whether groups of three digits follow the first one, which is not 0: 1,000 or 1'234.5; or `,` and `.` both occur.
fn has_thousands(text: &str) -> bool {
    let marks = [',', '\'', '_', ' ', '\u{2019}', '\u{a0}', '\u{202f}'];
    let whole = text.split('.').next().unwrap_or_default();
    let mut groups = whole.trim_start_matches(['+', '-']).split(marks);
    let first = groups.next().unwrap_or_default();
    let is_number = |group: &str| !group.is_empty() && group.chars().all(|c| c.is_ascii_digit());
    let groups: Vec<_> = groups.collect();
    let in_threes = is_number(first)
        && first.len() <= 3
        && !first.starts_with('0')
        && !groups.is_empty()
        && groups
            .iter()
            .all(|group| is_number(group) && group.len() == 3);
    in_threes || (text.contains(',') && text.contains('.'))
}

/// A field for a message: shortened, without control characters.
fn quoted(text: &str) -> String {
    let mut short: String = text
        .chars()
        .take(SHOWN)
        .flat_map(char::escape_debug)
        .collect();
    if text.chars().count() > SHOWN {
        short += "...";
    }
    format!("'{short}'")
}

#[cfg(test)]
mod tests {
    use crate::recording::Recording;

    #[test]
    fn field_that_is_no_number_is_reported_with_a_remedy() {
        for (field, remedy) in [
            ("nan", "remove the rows without a value"),
            ("0x1F", "it is hexadecimal: write it in decimal"),
            (
                "0FA5",
                "if it is hexadecimal, write it in decimal; else correct the field, or remove the row",
            ),
            ("12e", "correct the field, or remove the row"),
            (
                "12:00:00.5",
                "it is a time: name another column with --column",
            ),
            ("\u{2212}5", "write the minus sign as '-'"),
            ("\"1,000\"", "write it without separators of thousands"),
            ("1'000", "write it without separators of thousands"),
            ("\"1.234,5\"", "write it without separators of thousands"),
            ("\"1,5\"", "write it with a decimal point"),
            ("\"0,125\"", "write it with a decimal point"),
            ("5 deg", "write it without its unit"),
            ("5 x", "correct the field, or remove the row"),
            (
                "\"[1,2]\"",
                "it is a list: write each of its numbers in a field of its own",
            ),
            (
                "[1. 2.]",
                "it is a list: write each of its numbers in a field of its own",
            ),
            ("[0.5]:", "write it without brackets"),
            ("-1.25D+00", "write its exponent with E in the place of D"),
            ("x", "correct the field, or remove the row"),
        ] {
            let text = format!("t,counts_large\n0,0\n0.001,{field}\n");
            let error = Recording::parse(text.as_bytes(), "r.csv").unwrap_err();
            let said = format!(
                "r.csv: line 3: column counts_large: '{}' is not a number; {remedy}",
                field.trim_matches('"').escape_debug()
            );
            assert_eq!(error.to_string(), said);
        }
        for (text, said) in [
            (
                "x,counts_large,t\n0,0,0\nx,counts_large,t\n",
                "line 3: column t: 't' is not a number; the header is repeated: cut the log there",
            ),
            (
                "t,counts_large\n1-Mar-2025 12:00:00,0\n",
                "'1-Mar-2025 12:00:00' is not a number; write it in s, as 2025-03-01T12:00:00.000, or as \
                 12:00:00.000",
            ),
            (
                "t,counts_large\n20260301T120000Z,0\n",
                "is not a number; write it in s, as 2025-03-01T12:00:00.000",
            ),
            (
                "t,counts_large\nMar 1 2026 12:00:00,0\n",
                "is not a number; write it in s, as 2025-03-01T12:00:00.000",
            ),
            (
                "t,counts_large\n0.5 rad,0\n",
                "'0.5 rad' is not a number; write it without its unit",
            ),
            (
                "t,counts_large\nZeit,Inkremente\n0,0\n",
                "line 2: column t: 'Zeit' is not a number; remove the line if it has the units, and state \
                 them with --column",
            ),
            (
                "t,counts_large,current\n0,0,1\n0.001,0,NaN\n",
                "'NaN' is not a number; remove the rows without a value, or rename the column current \
                 if the command does without it",
            ),
        ] {
            let error = Recording::parse(text.as_bytes(), "r.csv").unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
    }
}
