//! Which parameter values an estimator runs with: tuned presets, a file, the command line.

mod tuned;

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::estimators::{Kind, Search, Setup, Values, check};
use terminal::failure::Failure;

/// Whether the plant has Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlantKind {
    /// As the device says.
    Friction,
    /// The same device without Coulomb friction: the plant of the paper's model.
    Frictionless,
}

impl PlantKind {
    /// The name in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Frictionless => "frictionless",
        }
    }

    /// The kind after the word "plant".
    #[must_use]
    pub fn phrase(self) -> &'static str {
        match self {
            Self::Friction => "with friction",
            Self::Frictionless => "without friction",
        }
    }
}

/// Tuned parameters: what `tune` writes and `--presets` reads.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Presets {
    /// One entry for each rate and plant tuned for.
    #[serde(default)]
    pub preset: Vec<Preset>,
    /// The file that they come from, as messages name it.
    #[serde(skip)]
    pub source: String,
}

/// Tuned parameters at one rate on one plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// PlantKind.
    pub plant: PlantKind,
    /// Counts per revolution of the large encoder; `None` in files that do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_rev: Option<u32>,
    /// Values by estimator and parameter.
    pub estimators: BTreeMap<String, BTreeMap<String, f64>>,
}

impl Presets {
    /// The presets shipped with the program, written by `host-sim tune`.
    #[must_use]
    pub fn shipped() -> Self {
        Self::parse(include_str!("../../presets.toml"), "the shipped presets")
            .expect("the shipped presets are tested")
    }

    /// Reads a file that `tune` wrote.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file and what is wrong in it.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|error| Failure::Input(format!("{name}: cannot read: {error}")))?;
        Self::parse(&text, &name)
    }

    /// The file's text.
    ///
    /// # Errors
    /// [`Failure::Input`]; none is known to happen.
    pub fn to_toml(&self) -> Result<String, Failure> {
        toml::to_string(self).map_err(|error| Failure::Input(error.to_string()))
    }

    fn parse(text: &str, name: &str) -> Result<Self, Failure> {
        let mut presets: Self = toml::from_str(text).map_err(|error| {
            let line = error
                .span()
                .map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            Failure::Input(format!("{name}: line {line}: {}", error.message()))
        })?;
        presets.source = name.to_owned();
        for preset in &presets.preset {
            let wrong = |what: String| Failure::Input(format!("{name}: {what}"));
            if !(preset.rate_hz > 0.0 && preset.rate_hz.is_finite()) {
                return Err(wrong(format!(
                    "rate_hz = {}: must be above 0 Hz",
                    preset.rate_hz
                )));
            }
            for (estimator, values) in &preset.estimators {
                let kind = Kind::named(estimator).map_err(|e| wrong(e.to_string()))?;
                for (parameter, &value) in values {
                    let index = kind
                        .parameter(parameter)
                        .map_err(|e| wrong(e.to_string()))?;
                    check(&kind.parameters[index], estimator, value)
                        .map_err(|e| wrong(e.to_string()))?;
                }
            }
        }
        Ok(presets)
    }

    /// The values tuned for `kind` at the nearest rate (by ratio) on that plant.
    fn nearest(
        &self,
        kind: &Kind,
        rate_hz: f64,
        plant: PlantKind,
    ) -> Option<&BTreeMap<String, f64>> {
        let preset = self.nearest_preset(kind, rate_hz, plant)?;
        preset.estimators.get(kind.name)
    }

    /// The preset of those values.
    fn nearest_preset(&self, kind: &Kind, rate_hz: f64, plant: PlantKind) -> Option<&Preset> {
        let far = |preset: &Preset| (preset.rate_hz / rate_hz).ln().abs();
        self.preset
            .iter()
            .filter(|preset| preset.plant == plant && preset.estimators.contains_key(kind.name))
            .min_by(|a, b| far(a).total_cmp(&far(b)))
    }
}

/// Where parameter values come from, the strongest last: shipped presets, a presets file, values
/// set by name.
#[derive(Clone, Debug)]
pub struct Parameters {
    layers: Vec<Presets>,
    overrides: Vec<Override>,
}

#[derive(Clone, Debug)]
struct Override {
    kind: &'static str,
    index: usize,
    value: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            layers: vec![Presets::shipped()],
            overrides: Vec::new(),
        }
    }
}

impl Parameters {
    /// Puts a presets file over what there is.
    pub fn layer(&mut self, presets: Presets) {
        self.layers.push(presets);
    }

    /// Takes a `NAME.PARAM=VALUE`.
    ///
    /// # Errors
    /// [`Failure::Input`] that says what is not right about it.
    pub fn set(&mut self, text: &str) -> Result<(), Failure> {
        let form = || {
            Failure::Input(format!(
                "--set {text}: must be NAME.PARAM=VALUE; host-sim estimators lists them"
            ))
        };
        let (path, value) = text.split_once('=').ok_or_else(form)?;
        let (kind, parameter) = path.split_once('.').ok_or_else(form)?;
        let kind = Kind::named(kind.trim())?;
        let index = kind.parameter(parameter.trim())?;
        let value = value.trim().parse().map_err(|_| form())?;
        check(&kind.parameters[index], kind.name, value)?;
        self.overrides.push(Override {
            kind: kind.name,
            index,
            value,
        });
        Ok(())
    }

    /// The values for `kind` at a rate on a plant.
    ///
    /// A tuned frequency above half the rate is lowered to it; a value set by name is not.
    #[must_use]
    pub fn values(&self, kind: &Kind, setup: &Setup, plant: PlantKind) -> Values {
        let mut values: Values = kind.parameters.iter().map(|p| middle(p.search)).collect();
        for layer in &self.layers {
            let Some(tuned) = layer.nearest(kind, setup.rate.0, plant) else {
                continue;
            };
            for (value, parameter) in values.iter_mut().zip(kind.parameters) {
                if let Some(&tuned) = tuned.get(parameter.name) {
                    *value = tuned;
                }
            }
        }
        for (value, parameter) in values.iter_mut().zip(kind.parameters) {
            if parameter.unit == "Hz" {
                *value = value.min(setup.rate.0 / 2.0);
            }
        }
        for change in self
            .overrides
            .iter()
            .filter(|change| change.kind == kind.name)
        {
            values[change.index] = change.value;
        }
        values
    }
}

/// The value from which a search starts, for a parameter that no preset gives.
#[must_use]
pub fn middle(search: Search) -> f64 {
    match search {
        Search::Log(low, high) => (low * high).sqrt(),
        Search::Each(low, high) => f64::from(low + (high - low) / 4),
        Search::Fixed(value) => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Device, Hertz};

    fn setup(rate: f64) -> Setup {
        Setup {
            rate: Hertz(rate),
            device: Device::DCX35L,
            friction_nm: 4e-3,
            amplifier_lag_s: 80e-6,
            small_counts_per_rev: 20_000,
        }
    }

    #[test]
    fn shipped_presets_build_every_estimator_at_every_rate() {
        let parameters = Parameters::default();
        for kind in Kind::all() {
            for rate in [100.0, 500.0, 1e3, 2e3, 1e4, 11.6e3, 2e4, 1e5] {
                for plant in [PlantKind::Friction, PlantKind::Frictionless] {
                    let values = parameters.values(kind, &setup(rate), plant);
                    assert!(
                        kind.build(&setup(rate), &values).is_ok(),
                        "{} {rate}",
                        kind.name
                    );
                }
            }
        }
    }

    #[test]
    fn the_nearest_rate_counts_by_ratio_and_a_set_value_wins() {
        let file = "[[preset]]\nrate_hz = 1000\nplant = 'friction'\nestimators = { pll = { bandwidth_hz = 10 } }\n\
                    [[preset]]\nrate_hz = 10000\nplant = 'friction'\nestimators = { pll = { bandwidth_hz = 20 } }";
        let mut parameters = Parameters::default();
        parameters.layer(Presets::parse(file, "f").unwrap());
        let pll = Kind::named("pll").unwrap();
        assert_eq!(
            parameters.values(pll, &setup(3000.0), PlantKind::Friction),
            [10.0]
        );
        assert_eq!(
            parameters.values(pll, &setup(3300.0), PlantKind::Friction),
            [20.0]
        );
        assert_eq!(
            parameters.values(pll, &setup(15.0), PlantKind::Friction),
            [7.5]
        );
        parameters.set("pll.bandwidth_hz=33").unwrap();
        assert_eq!(
            parameters.values(pll, &setup(3000.0), PlantKind::Friction),
            [33.0]
        );
    }

    #[test]
    fn bad_values_are_refused_by_name() {
        let mut parameters = Parameters::default();
        for (text, said) in [
            ("pll", "NAME.PARAM=VALUE"),
            ("pll.bandwidth_hz=fast", "NAME.PARAM=VALUE"),
            ("pll.bandwidth_hz=NaN", "must be a number"),
            ("pl.bandwidth_hz=1", "no estimator 'pl'"),
            (
                "pll.cutoff=1",
                "pll has no parameter 'cutoff'; there are bandwidth_hz",
            ),
            ("foaw-end-fit.n=300", "from 1 to 128"),
            ("foaw-end-fit.n=2.5", "a whole number"),
        ] {
            let error = parameters.set(text).unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
        let unknown = Presets::parse("[[preset]]\nrate_hz = 1\nplan = 1", "f.toml").unwrap_err();
        assert!(
            unknown
                .to_string()
                .starts_with("f.toml: line 3: unknown field `plan`"),
            "{unknown}"
        );
    }
}
