//! The device, the parameters and the estimator that arguments name.

use std::collections::BTreeMap;
use std::path::PathBuf;

use catalogue::estimators::{Kind, Setup, Values};
use catalogue::parameters::{Parameters, PlantKind};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recordings::arguments::differing_counts;
use simulation::device::Device;
use terminal::failure::Failure;

use crate::error::{check_file, os_error, value_error};
use crate::integer::CountsPerRev;

/// A device file: its path, or a mapping with its sections and keys.
pub(crate) struct DeviceFile {
    name: String,
    text: String,
    has_lines: bool,
}

impl<'py> FromPyObject<'_, 'py> for DeviceFile {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(sections) = object.cast::<PyDict>() {
            let text = toml::to_string(&table(&sections, "")?)
                .map_err(|error| value_error(format!("device: {error}")))?;
            let name = "device".to_owned();
            return Ok(Self {
                name,
                text,
                has_lines: false,
            });
        }
        let path: PathBuf = object.extract().map_err(|_| {
            PyTypeError::new_err(
                "device: give the path of a device file, or a dict with its sections",
            )
        })?;
        let name = path.display().to_string();
        let text =
            std::fs::read_to_string(&path).map_err(|error| os_error(object.py(), error, &path))?;
        Ok(Self {
            name,
            text,
            has_lines: true,
        })
    }
}

/// The path of a presets file that can be opened.
pub(crate) struct PresetsFile(PathBuf);

impl<'py> FromPyObject<'_, 'py> for PresetsFile {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let path: PathBuf = object
            .extract()
            .map_err(|_| PyTypeError::new_err("presets: give the path of a presets file"))?;
        check_file(object.py(), &path)?;
        Ok(Self(path))
    }
}

/// The table of a device file with the content of a dict; `within` is the name of the section and a full
/// stop. A section has no sections: a dict may have itself as a value.
fn table(dict: &Bound<'_, PyDict>, within: &str) -> PyResult<toml::Table> {
    let mut table = toml::Table::new();
    for (key, value) in dict.iter() {
        let wrong = |what: &str| PyTypeError::new_err(format!("device: {within}{key}: {what}"));
        let name: String = key.extract().map_err(|_| wrong("a key must be a str"))?;
        let value = if let Ok(section) = value.cast::<PyDict>() {
            if !within.is_empty() {
                return Err(value_error(format!(
                    "device: {within}{key}: is a section in a section; give a number"
                )));
            }
            toml::Value::Table(self::table(section, &format!("{within}{name}."))?)
        } else if let Ok(text) = value.extract::<String>() {
            toml::Value::String(text)
        } else if let Ok(flag) = value.extract::<bool>() {
            toml::Value::Boolean(flag)
        } else if let Ok(whole) = value.extract::<i64>() {
            toml::Value::Integer(whole)
        } else if let Ok(number) = value.extract::<f64>() {
            toml::Value::Float(number)
        } else {
            return Err(wrong("give a number"));
        };
        table.insert(name, value);
    }
    Ok(table)
}

/// The device of a file, or the default one; `counts_per_rev` replaces the counts of the large encoder.
pub(crate) fn device(
    file: Option<&DeviceFile>,
    counts_per_rev: Option<CountsPerRev>,
) -> Result<Device, Failure> {
    let mut device = match file {
        None => Device::default(),
        Some(DeviceFile {
            name,
            text,
            has_lines,
        }) => Device::from_toml_str(text).map_err(|error| {
            // `line N, ` is of the text that was made of a dict.
            let error = match error.split_once(", ") {
                Some((line, error)) if !has_lines && line.starts_with("line ") => error,
                _ => &error,
            };
            format!("{name}: {error}")
        })?,
    };
    if let Some(counts) = counts_per_rev {
        device.stages.large.counts_per_rev = counts.get();
    }
    Ok(device)
}

/// What gives the counts per revolution of the large encoder: the argument, or a device file that states them.
pub(crate) fn counts_source(
    file: Option<&DeviceFile>,
    counts_per_rev: Option<CountsPerRev>,
) -> Option<&str> {
    match counts_per_rev {
        Some(_) => Some("counts_per_rev"),
        None => file
            .filter(|file| Device::states_counts(&file.text))
            .map(|file| file.name.as_str()),
    }
}

/// The device for `recordings`, each a name and the counts per revolution that it states, and a line for each
/// that states others than those that are given.
pub(crate) fn device_of(
    file: Option<&DeviceFile>,
    counts_per_rev: Option<CountsPerRev>,
    recordings: &[(&str, Option<CountsPerRev>)],
) -> Result<(Device, Vec<String>), Failure> {
    let Some(source) = counts_source(file, counts_per_rev) else {
        return Ok((device(file, common_counts(recordings)?)?, Vec::new()));
    };
    let device = device(file, counts_per_rev)?;
    let used = device.stages.large.counts_per_rev;
    let differing = recordings.iter().filter_map(|(name, stated)| {
        let stated = stated.map(CountsPerRev::get);
        let stated = stated.filter(|stated| *stated != used)?;
        Some(format!(
            "{name}: {}",
            differing_counts(used, source, stated)
        ))
    });
    let lines = differing.collect();
    Ok((device, lines))
}

/// The counts per revolution that all recordings state.
fn common_counts(
    recordings: &[(&str, Option<CountsPerRev>)],
) -> Result<Option<CountsPerRev>, Failure> {
    let Some((first, counts)) = recordings.first() else {
        return Ok(None);
    };
    let states = |counts: &Option<CountsPerRev>| {
        counts.map_or("none".to_owned(), |counts| counts.to_string())
    };
    match recordings.iter().find(|(_, other)| other != counts) {
        None => Ok(*counts),
        Some((other, others)) => Err(Failure::Input(format!(
            "logs: {first} and {other} state different counts per revolution, {} and {}; pass recordings of one \
             encoder, or counts_per_rev",
            states(counts),
            states(others)
        ))),
    }
}

/// Values of parameters by name, of one estimator.
pub(crate) type Named = BTreeMap<String, f64>;

/// The values of a mapping.
pub(crate) fn named(mapping: &Bound<'_, PyAny>) -> PyResult<Named> {
    let dict = mapping.py().get_type::<PyDict>().call1((mapping,));
    let named = dict.and_then(|dict| dict.extract());
    named.map_err(|_| {
        PyTypeError::new_err("parameters: give a dict of names with numbers as values")
    })
}

/// An estimator with the values of its parameters, for a device at a rate.
pub(crate) struct Built {
    pub(crate) kind: &'static Kind,
    pub(crate) estimator: catalogue::estimators::Estimator,
    pub(crate) values: Values,
    /// A line if the values were tuned for another encoder or rate.
    pub(crate) notes: Vec<String>,
}

/// The parameters of a presets file and those set by name.
pub(crate) fn parameters(
    presets: Option<&PresetsFile>,
    estimator: &str,
    named: &Named,
) -> Result<Parameters, Failure> {
    let mut parameters = Parameters::default();
    if let Some(PresetsFile(path)) = presets {
        parameters.layer(catalogue::parameters::read(path)?);
    }
    for (name, value) in named {
        parameters.set(&format!("{estimator}.{name}={value}"))?;
    }
    Ok(parameters)
}

impl Built {
    /// Builds the estimator `name` as `host-sim replay` does: for a device with friction.
    pub(crate) fn new(
        name: &str,
        device: &Device,
        rate_hz: f64,
        presets: Option<&PresetsFile>,
        named: &Named,
    ) -> Result<Self, Failure> {
        let kind = Kind::named(name)?;
        if !(rate_hz > 0.0 && rate_hz.is_finite()) {
            return Err(Failure::Input(format!(
                "rate={rate_hz}: must be positive and finite (Hz)"
            )));
        }
        let parameters = parameters(presets, name, named)?;
        let setup = Setup::of(device, rate_hz);
        let values = parameters.values(kind, &setup, PlantKind::Friction);
        Ok(Self {
            kind,
            estimator: kind.build(&setup, &values)?,
            values,
            notes: parameters.used_far_away(&[kind], &setup, PlantKind::Friction),
        })
    }

    /// The values by name.
    pub(crate) fn named(&self) -> BTreeMap<&'static str, f64> {
        let names = self.kind.parameters.iter().map(|p| p.name);
        names.zip(self.values.iter().copied()).collect()
    }
}
