//! Failures of the crates as exceptions.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use terminal::failure::Failure;

/// A `ValueError` with the message of a failure, in the words of this package.
pub(crate) fn value_error(failure: impl Into<Failure>) -> PyErr {
    PyValueError::new_err(in_python(&failure.into().to_string()))
}

/// The `OSError` of Python, for example a `FileNotFoundError`, with the name of the file.
pub(crate) fn os_error(py: Python<'_>, error: io::Error, path: &Path) -> PyErr {
    let Some(number) = error.raw_os_error() else {
        return error.into();
    };
    let built = || -> PyResult<_> {
        let text = py.import("os")?.call_method1("strerror", (number,))?;
        // Python chooses the class by the number.
        py.get_type::<PyOSError>()
            .call1((number, text, path.as_os_str()))
    };
    built().map_or_else(|failed| failed, PyErr::from_value)
}

/// A note on the counts of arrays: `replay` and `Recording` have no modulus.
pub(crate) fn of_arrays(note: &str) -> String {
    let unwrapped = |note: String, column: &str, argument: &str| {
        let option = format!("--modulus {column}=");
        match note.split_once(&option) {
            None => note,
            Some((before, value)) => {
                let (period, after) = value.split_at(value_end(value));
                let unwrapped = format!("numpy.unwrap({argument}.astype(int), period={period})");
                format!("{before}{argument}={unwrapped}{after}")
            }
        }
    };
    let note = unwrapped(note.to_owned(), "counts_large", "counts");
    attributes(&in_python(&unwrapped(note, "counts_small", "coupled")))
}

/// A message with the names of a `Recording` in the place of those of the columns of a log, but where a column is
/// named with `columns=` or `modulus=`.
fn attributes(message: &str) -> String {
    let phrases = [
        ("no column true_omega", "no true_velocity"),
        ("rename the column for", "leave it out for"),
        ("shift the column", "shift it"),
        (
            "give the unit, columns=",
            "convert it to rad/s, or read the log with columns=",
        ),
    ];
    let text = (phrases.iter()).fold(message.to_owned(), |text, (column, attribute)| {
        text.replace(column, attribute)
    });
    let names = [
        ("true_omega", "true_velocity"),
        ("counts_large", "counts"),
        ("counts_small", "coupled"),
    ];
    names.iter().fold(text, |text, (column, attribute)| {
        let mut renamed = String::new();
        for (at, part) in text.split(column).enumerate() {
            let is_option = renamed.ends_with(['=', '\'']);
            if at > 0 {
                renamed += if is_option { column } else { attribute };
            }
            renamed += part;
        }
        renamed
    })
}

/// A message on the times of arrays, which have no unit that an option states.
pub(crate) fn of_times(message: &str) -> String {
    message
        .replace(", which --column t=NAME:ms states", ", and multiply it")
        .replace(", or state its unit with --column t=NAME:UNIT", "")
}

/// A message on recordings in memory: `recommend` and `tune` have no `resample`, and the reader of logs has it.
pub(crate) fn of_logs(message: &str) -> String {
    let Some((before, after)) = message.split_once("--resample") else {
        return of_arrays(message);
    };
    let number = after
        .strip_prefix(' ')
        .map_or(0, |value| 1 + value_end(value));
    let (number, after) = after.split_at(number);
    of_arrays(&format!(
        "{before}--resample{number} of limpid.read_log{after}"
    ))
}

/// Where a number or a name at the begin of `text` ends.
fn value_end(text: &str) -> usize {
    text.find(|c: char| !c.is_ascii_alphanumeric())
        .unwrap_or(text.len())
}

/// The modulus of a column, `counts_small=4096`, as a dict, and the text behind it.
fn modulus(value: &str) -> Option<(String, &str)> {
    let (column, rest) = value.split_once('=')?;
    if !["counts_large", "counts_small"].contains(&column) {
        return None;
    }
    let (number, after) = rest.split_at(value_end(rest));
    Some((format!("{{'{column}': {number}}}"), after))
}

/// The command that tunes at a rate as a call.
fn tuned_at_a_rate(text: &str) -> String {
    let Some((before, rate)) = text.split_once("host-sim tune rate=") else {
        return text.to_owned();
    };
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let end = rate.find(|c| !is_digit(c)).unwrap_or(rate.len());
    let (rate, after) = rate.split_at(end);
    format!("{before}limpid.tune(rate={rate}){after}")
}

/// Checks that a file can be opened; otherwise the `OSError` of Python. A pipe is not opened twice.
pub(crate) fn check_file(py: Python<'_>, path: &Path) -> PyResult<()> {
    let opened = || -> io::Result<()> {
        let metadata = std::fs::metadata(path)?;
        if metadata.is_dir() {
            // A folder is opened, and refused as one when it is read.
            File::open(path)?.read_exact(&mut [0])?;
        }
        if metadata.is_file() {
            File::open(path)?;
        }
        Ok(())
    };
    opened().map_err(|error| os_error(py, error, path))
}

/// Options without a value.
const FLAGS: [&str; 1] = ["drop-stale"];

/// A message for the command line with keywords of this package instead of options:
/// `--resample 1000` is `resample=1000`.
pub(crate) fn in_python(message: &str) -> String {
    let mut text = String::new();
    let mut rest = message;
    while let Some(at) = rest.find("--") {
        let (before, option) = rest.split_at(at);
        text.push_str(before);
        let option = &option[2..];
        let is_name = |c: char| c.is_ascii_lowercase() || c == '-';
        let end = option.find(|c: char| !is_name(c)).unwrap_or(option.len());
        let (name, after) = option.split_at(end);
        text.push_str(&match name {
            "set" => "parameters".to_owned(),
            "column" => "columns".to_owned(),
            _ => name.replace('-', "_"),
        });
        text.push('=');
        if FLAGS.contains(&name) {
            text.push_str("True");
        }
        if name == "modulus"
            && let Some((dict, after)) = after.strip_prefix(' ').and_then(modulus)
        {
            text.push_str(&dict);
            rest = after;
            continue;
        }
        // The value of an option follows after a space or an equals sign; other words do not.
        let value = after.strip_prefix([' ', '=']);
        let is_value = |value: &&str| {
            value.starts_with(|c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '-')
                || value
                    .split(' ')
                    .next()
                    .is_some_and(|word| word.contains(['=', '.']))
        };
        rest = value.filter(is_value).unwrap_or(after);
    }
    text.push_str(rest);
    tuned_at_a_rate(&text)
        .replace("host-sim tune RECORDING", "limpid.tune(log)")
        .replace("lines=A B", "lines=['A', 'B']")
        .replace("hall=U V W", "hall=['U', 'V', 'W']")
        .replace("host-sim estimators", "limpid.estimators()")
        .replace("host-sim scenarios", "limpid.scenarios()")
        .replace("host-sim ", "limpid.")
}
