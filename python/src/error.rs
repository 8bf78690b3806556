//! Failures of the crates as exceptions.

use std::io;
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
    text.replace("host-sim estimators", "limpid.estimators()")
        .replace("host-sim scenarios", "limpid.scenarios()")
        .replace("host-sim ", "limpid.")
}
