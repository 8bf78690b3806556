//! Integer arguments, with errors that name the argument and its range.

use std::fmt::{self, Display};
use std::ops::RangeInclusive;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use simulation::device::parsed_counts_per_rev;

use crate::error::value_error;

/// An argument that is to be an integer of Python, of any size.
pub(crate) enum Integer {
    /// The value, `None` beyond 128 bits, and its digits.
    Whole(Option<i128>, String),
    /// The name of another type.
    Other(String),
}

impl<'py> FromPyObject<'_, 'py> for Integer {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let operator = object.py().import("operator")?;
        Ok(match operator.call_method1("index", (object,)) {
            Ok(index) => Self::Whole(index.extract().ok(), index.str()?.to_string()),
            Err(_) => Self::Other(object.get_type().name()?.to_string()),
        })
    }
}

impl Integer {
    /// Counts per revolution of an encoder.
    pub(crate) fn counts_per_rev(&self, name: &str) -> PyResult<u32> {
        let (_, digits) = self.whole(name)?;
        parsed_counts_per_rev(digits)
            .map_err(|rule| value_error(format!("{name}={digits}: {rule}")))
    }

    fn whole(&self, name: &str) -> PyResult<(Option<i128>, &str)> {
        match self {
            Self::Whole(value, digits) => Ok((*value, digits)),
            Self::Other(kind) => Err(PyTypeError::new_err(format!(
                "{name}: has the type {kind}; pass an integer"
            ))),
        }
    }

    /// The integer in a `range`. An error of another value ends with `remedy`.
    pub(crate) fn within<T>(
        &self,
        name: &str,
        range: &RangeInclusive<T>,
        remedy: &str,
    ) -> PyResult<T>
    where
        T: TryFrom<i128> + PartialOrd + Display,
    {
        let (value, digits) = self.whole(name)?;
        let value = value.and_then(|value| T::try_from(value).ok());
        value.filter(|value| range.contains(value)).ok_or_else(|| {
            value_error(format!(
                "{name}={digits}: must be from {} to {}{remedy}",
                range.start(),
                range.end()
            ))
        })
    }
}

/// Counts per revolution in the range that an encoder can have.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct CountsPerRev(u32);

impl<'py> FromPyObject<'_, 'py> for CountsPerRev {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let integer: Integer = object.extract()?;
        Ok(Self(integer.counts_per_rev("counts_per_rev")?))
    }
}

impl CountsPerRev {
    pub(crate) fn get(self) -> u32 {
        self.0
    }
}

impl Display for CountsPerRev {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The counts per revolution, checked as those of every argument.
#[pyfunction]
#[pyo3(signature = (counts_per_rev))]
pub(crate) fn checked_counts_per_rev(counts_per_rev: CountsPerRev) -> u32 {
    counts_per_rev.get()
}
