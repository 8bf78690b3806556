//! Tuned parameters of the estimators, as `host-sim tune` writes them.

use std::collections::BTreeMap;
use std::path::Path;

use estimator_catalogue::Parameter;
use serde::{Deserialize, Serialize};

use crate::decimal;
use crate::read::one_line;

/// Whether the plant has Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlantKind {
    /// With the Coulomb friction of the device.
    Friction,
    /// Without Coulomb friction: the plant of the paper's model.
    Frictionless,
}

impl PlantKind {
    /// Name in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Frictionless => "frictionless",
        }
    }

    /// Text that follows the word "plant".
    #[must_use]
    pub fn phrase(self) -> &'static str {
        match self {
            Self::Friction => "with friction",
            Self::Frictionless => "without friction",
        }
    }
}

/// Values by estimator and parameter.
pub type Estimators = BTreeMap<String, BTreeMap<String, f64>>;

/// A presets file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Presets {
    /// One entry for each tuned rate and plant.
    #[serde(default)]
    pub preset: Vec<Preset>,
    /// Values chosen for the control loop of a flash image, by motor: `large` or `handle`. They
    /// replace those of [`Self::preset`] there. `tune` does not write them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub image: BTreeMap<String, Estimators>,
    /// Name of the file in messages.
    #[serde(skip)]
    pub source: String,
}

/// Tuned parameters at one rate on one plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Plant.
    pub plant: PlantKind,
    /// Counts per revolution of the large encoder; `None` in files without this key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_rev: Option<u32>,
    /// The values.
    pub estimators: Estimators,
}

impl Preset {
    /// Ratio of `counts_per_rev` to the counts per revolution for which the values were tuned; 1 if the
    /// file does not name them.
    #[must_use]
    pub fn counts_ratio(&self, counts_per_rev: u32) -> f64 {
        f64::from(counts_per_rev) / f64::from(self.counts_per_rev.unwrap_or(counts_per_rev))
    }

    /// The value of a parameter of `estimator`, scaled to an encoder and a rate
    /// ([`Parameter::scaled`]); `None` if the preset has no such value.
    #[must_use]
    pub fn value(
        &self,
        estimator: &str,
        parameter: &Parameter,
        counts_per_rev: u32,
        rate_hz: f64,
    ) -> Option<f64> {
        let tuned = *self.estimators.get(estimator)?.get(parameter.name)?;
        let counts = self.counts_ratio(counts_per_rev);
        Some(parameter.scaled(tuned, counts, rate_hz / self.rate_hz))
    }
}

impl Presets {
    /// The presets shipped with the program.
    #[must_use]
    pub fn shipped() -> Self {
        Self::parse(include_str!("../../presets.toml"), "the shipped presets")
            .expect("the shipped presets are tested")
    }

    /// Reads a presets file. The names of its estimators are not checked.
    ///
    /// # Errors
    /// One line that names the file and the wrong entry.
    pub fn read(path: &Path) -> Result<Self, String> {
        Self::parse(&crate::text(path)?, &path.display().to_string())
    }

    /// The presets as text of a file.
    ///
    /// # Errors
    /// One line if the values cannot be serialised.
    pub fn to_toml(&self) -> Result<String, String> {
        toml::to_string(self).map_err(|error| error.to_string())
    }

    /// Reads the text of a presets file that messages call `name`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, name: &str) -> Result<Self, String> {
        let mut presets: Self =
            toml::from_str(text).map_err(|error| format!("{name}: {}", one_line(text, &error)))?;
        presets.source = name.to_owned();
        for preset in &presets.preset {
            let rate = preset.rate_hz;
            if !(rate > 0.0 && rate.is_finite()) {
                return Err(format!(
                    "{name}: rate_hz = {}: must be above 0 Hz",
                    decimal(rate)
                ));
            }
            if preset.counts_per_rev == Some(0) {
                return Err(format!(
                    "{name}: counts_per_rev = 0 at rate_hz = {}: must be above 0",
                    decimal(rate)
                ));
            }
        }
        Ok(presets)
    }

    /// The preset with values of `estimator` on this plant at the nearest rate (by ratio).
    #[must_use]
    pub fn nearest(&self, estimator: &str, rate_hz: f64, plant: PlantKind) -> Option<&Preset> {
        let far = |preset: &Preset| (preset.rate_hz / rate_hz).ln().abs();
        self.preset
            .iter()
            .filter(|preset| preset.plant == plant && preset.estimators.contains_key(estimator))
            .min_by(|a, b| far(a).total_cmp(&far(b)))
    }
}
