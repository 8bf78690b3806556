//! Text of an input file, and errors in it.

use std::borrow::Cow;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::device::counts_per_rev_rule;
use crate::presets::PlantKind;

/// The text of a regular file.
///
/// # Errors
/// One line that names the path, if it is not a readable file of UTF-8 text.
pub fn text(path: &Path) -> Result<String, String> {
    let named = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
    let unread = |error| named(&format_args!("cannot read: {error}"));
    let metadata = std::fs::metadata(path).map_err(unread)?;
    if !metadata.is_file() {
        return Err(named(&"not a regular file; give a TOML file"));
    }
    utf8(path)
}

/// The text of a file or of a pipe.
///
/// # Errors
/// One line that names the path, if it cannot be read, or if it is no UTF-8 text.
pub fn utf8(path: &Path) -> Result<String, String> {
    let named = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
    let bytes =
        std::fs::read(path).map_err(|error| named(&format_args!("cannot read: {error}")))?;
    String::from_utf8(bytes).map_err(|error| {
        let (valid, bytes) = (error.utf8_error().valid_up_to(), error.as_bytes());
        // The mark at the start of UTF-16, in both orders of the bytes.
        if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
            return named(
                &"is UTF-16, as > of Windows PowerShell writes it; save the file as UTF-8, for example with \
                  Set-Content -Encoding utf8",
            );
        }
        let line = 1 + bytes[..valid].iter().filter(|&&byte| byte == b'\n').count();
        named(&format_args!("line {line}: is not UTF-8 text; save the file as UTF-8"))
    })
}

/// A step on the way to a value of a TOML text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step<'a> {
    /// To the value of a key.
    Key(&'a str),
    /// To an entry of an array, from 0.
    Entry(usize),
}

/// `error` with the number of the line that has the value at `path`; without it where the text has no such
/// value, as where the value is a default.
pub(crate) fn at_line(text: &str, path: &[Step], error: &str) -> String {
    match line_of(text, path) {
        Some(number) => format!("line {number}, {error}"),
        None => error.to_owned(),
    }
}

/// The line of `text`, from 1, with the value at `path`.
fn line_of(text: &str, path: &[Step]) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let (Step::Key(first), rest) = path.split_first()? else {
        return None;
    };
    let mut value = table.get_ref().get(*first)?;
    for step in rest {
        value = match (value.get_ref(), step) {
            (DeValue::Array(entries), Step::Entry(entry)) => entries.get(*entry)?,
            (DeValue::Table(table), Step::Key(key)) => table.get(*key)?,
            _ => return None,
        };
    }
    Some(line_at(text, value.span().start))
}

/// The number of the line, from 1, of a byte of `text`.
fn line_at(text: &str, byte: usize) -> usize {
    let before = &text.as_bytes()[..byte.min(text.len())];
    1 + before.iter().filter(|&&byte| byte == b'\n').count()
}

/// Most characters of a key or a value that a message repeats.
const LONGEST: usize = 40;

/// The first characters of `text`, if it is too long for a message.
fn shortened(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]).into(),
        None => text.into(),
    }
}

/// `text` with each name in it between quotes shortened.
fn shortened_quotes(text: &str) -> String {
    let parts = text.split_inclusive(['`', '"']);
    let parts = parts.enumerate().map(|(k, part)| {
        let inside = part.trim_end_matches(['`', '"']);
        match k % 2 {
            1 => format!("{}{}", shortened(inside), &part[inside.len()..]),
            _ => part.to_owned(),
        }
    });
    parts.collect()
}

/// Whether `value` is meant as a number and is none: it begins as one, and the parser's `error` is about quotes or
/// digits.
fn is_meant_as_number(value: &str, error: &toml::de::Error) -> bool {
    let digits = value.trim_start_matches(['+', '-', '.']);
    let reasons = [
        "string values must be quoted",
        "unexpected key or value",
        "invalid float",
    ];
    let parts = [
        "invalid mantissa",
        "invalid fraction",
        "invalid exponent",
        "unexpected leading zero",
    ];
    digits.starts_with(|c: char| c.is_ascii_digit())
        && (reasons.iter().chain(&parts)).any(|reason| error.message().starts_with(reason))
}

/// What a file without `key` lacks.
fn lacking(key: &str) -> String {
    match key {
        "rate_hz" => "rate_hz = 1000, the control rate in Hz".to_owned(),
        "plant" => [PlantKind::Friction, PlantKind::Frictionless]
            .map(|plant| format!("plant = \"{}\"", plant.name()))
            .join(" or "),
        "estimators" => {
            "[preset.estimators.NAME] with the values of an estimator, as host-sim tune writes it"
                .to_owned()
        }
        _ => format!("a line '{key} = '"),
    }
}

/// `what`, an error of the parser about a key, with the nearest known key or with a line for one that is missing.
fn with_remedy(what: &str) -> String {
    let quoted = |text: &str| text.split('`').nth(1).unwrap_or("").to_owned();
    if let Some(rest) = what.strip_prefix("missing field ") {
        return format!("{what}; add {}", lacking(&quoted(rest)));
    }
    let unknown = ["unknown field ", "unknown variant "]
        .iter()
        .any(|start| what.starts_with(start));
    let (said, expected) = match what.split_once(", expected ") {
        Some((said, expected)) if unknown => (said, expected),
        _ => return what.to_owned(),
    };
    // Names and the text between them take turns.
    let known = expected.split('`').skip(1).step_by(2);
    match spelling::nearest(&quoted(said), known) {
        Some(nearest) => format!("{said}; did you mean `{nearest}`? expected {expected}"),
        None => what.to_owned(),
    }
}

/// The parser's error in one line, with the line's number and its key.
pub(crate) fn one_line(text: &str, error: &toml::de::Error) -> String {
    let what = error
        .message()
        .trim()
        .replace('\n', ", ")
        .replace("expected f64", "expected a number")
        // Counts per revolution are the only whole numbers.
        .replace(
            "expected u32",
            &format!(
                "expected a whole number {}, without a decimal point",
                counts_per_rev_rule(None)
            ),
        );
    let what = with_remedy(&shortened_quotes(&what));
    let Some(span) = error.span() else {
        return what;
    };
    let number = line_at(text, span.start);
    let line = text.lines().nth(number - 1).unwrap_or("");
    let key = shortened(line.split(['=', '#']).next().unwrap_or("").trim());
    if key.is_empty() {
        return format!("line {number}: {what}");
    }
    let value =
        (line.split_once('=')).map(|(_, value)| value.split('#').next().unwrap_or("").trim());
    let has_no_value = value == Some("");
    let what = match key.starts_with("[[") && what.starts_with("invalid type: map") {
        true => "not a list of sections; write its name between single brackets".to_owned(),
        false if has_no_value => "no value; write one after '=', or remove the line".to_owned(),
        false => match value.filter(|value| is_meant_as_number(value, error)) {
            Some(value) => format!(
                "'{}' is no number; write it as 0.015 or 1.5e-2, with a point and without a unit",
                shortened(value)
            ),
            None => what,
        },
    };
    format!("line {number}, {key}: {what}")
}
