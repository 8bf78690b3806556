//! Parameter values of the estimators: from tuned presets, a file, the command line.

mod tuned;

use std::path::Path;

pub use device_files::presets::{PlantKind, Preset, Presets};
use serde::{Deserialize, Serialize};

use device_files::presets::leaves_range;

use crate::estimators::{Kind, Parameter, Search, Setup, Values, check};
use terminal::failure::Failure;

/// Reads a presets file and checks its estimators and their parameters.
///
/// # Errors
/// [`Failure::Input`] that names the file and the wrong entry.
pub fn read(path: &Path) -> Result<Presets, Failure> {
    let name = path.display().to_string();
    let text = device_files::utf8(path).map_err(Failure::Input)?;
    checked(&text, &name).map_err(Failure::Input)
}

fn checked(text: &str, name: &str) -> Result<Presets, String> {
    let presets = Presets::parse(text, name)?;
    presets.check_values(text, |estimator, values| {
        let kind = Kind::named(estimator).map_err(|error| (None, error.to_string()))?;
        for (parameter, &value) in values {
            let checked = kind
                .parameter(parameter)
                .and_then(|index| check(&kind.parameters[index], estimator, value));
            checked.map_err(|error| (Some(parameter.as_str()), error.to_string()))?;
        }
        Ok(())
    })?;
    Ok(presets)
}

/// Sources of parameter values in order of rising priority: shipped presets, a presets file, values
/// set by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    layers: Vec<Presets>,
    overrides: Vec<Override>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Override {
    kind: String,
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
    /// Adds a presets file with priority over the present values.
    pub fn layer(&mut self, presets: Presets) {
        self.layers.push(presets);
    }

    /// Sets a value from `NAME.PARAM=VALUE`, and returns the estimator.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the wrong part and the possible ones, or a parameter that is set
    /// already.
    pub fn set(&mut self, text: &str) -> Result<&'static Kind, Failure> {
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
        let is_same = |known: &Override| known.kind == kind.name && known.index == index;
        if self.overrides.iter().any(is_same) {
            return Err(Failure::Input(format!(
                "--set {text}: {}.{} is given twice; keep one",
                kind.name, kind.parameters[index].name
            )));
        }
        self.overrides.push(Override {
            kind: kind.name.to_owned(),
            index,
            value,
        });
        Ok(kind)
    }

    /// The values for `kind` at a rate on a plant.
    ///
    /// A tuned value is scaled from the encoder and the rate of its preset to those of `setup`
    /// ([`Preset::value`]). A tuned frequency above half the
    /// rate is lowered to it. A value set by name is taken as it is.
    #[must_use]
    pub fn values(&self, kind: &Kind, setup: &Setup, plant: PlantKind) -> Values {
        let mut values: Values = kind.parameters.iter().map(|p| middle(p.search)).collect();
        for layer in &self.layers {
            let nearest = layer.nearest(kind.name, setup.rate.0, plant);
            let Some(preset) = nearest else { continue };
            let counts = setup.stages.large.counts_per_rev;
            for (value, parameter) in values.iter_mut().zip(kind.parameters) {
                let tuned = preset.value(kind.name, parameter, counts, setup.rate.0);
                *value = tuned.unwrap_or(*value);
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

    /// Names of the parameters of `kind` whose tuned values, scaled to `setup`, would leave their ranges. They have the
    /// end of the range. Values that are set by name are left out.
    #[must_use]
    pub fn at_range_ends(&self, kind: &Kind, setup: &Setup, plant: PlantKind) -> Vec<&'static str> {
        let is_set = |index: usize| {
            let mut set = self.overrides.iter();
            set.any(|change| change.kind == kind.name && change.index == index)
        };
        let counts = setup.stages.large.counts_per_rev;
        let is_at_end = |parameter: &Parameter| {
            let mut layers = self.layers.iter().rev();
            layers.find_map(|layer| {
                let preset = layer.nearest(kind.name, setup.rate.0, plant)?;
                let tuned = *preset.estimators.get(kind.name)?.get(parameter.name)?;
                let rate = setup.rate.0 / preset.rate_hz;
                Some(leaves_range(
                    parameter,
                    tuned,
                    preset.counts_ratio(counts),
                    rate,
                ))
            })
        };
        let parameters = kind.parameters.iter().enumerate();
        parameters
            .filter(|(index, parameter)| !is_set(*index) && is_at_end(parameter) == Some(true))
            .map(|(_, parameter)| parameter.name)
            .collect()
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
    use estimator_core::Hertz;
    use haptic_control::DualStage;

    fn setup(rate: f64) -> Setup {
        Setup {
            rate: Hertz(rate),
            stages: DualStage::DEFAULT,
        }
    }

    /// A logarithmic range is halved by its factor, an integer one has its first quarter.
    #[test]
    fn search_starts_inside_its_range() {
        assert_eq!(middle(Search::Log(1.0, 100.0)), 10.0);
        assert_eq!(middle(Search::Each(8, 16)), 10.0);
        assert_eq!(middle(Search::Fixed(3.0)), 3.0);
    }

    #[test]
    fn one_value_is_set_once() {
        let mut parameters = Parameters::default();
        // The same index of another kind, and another index of the same kind.
        for text in [
            "pll.bandwidth_hz=20",
            "low-pass.cutoff_hz=30",
            "foaw-end-fit.n=4",
            "foaw-end-fit.d=2",
        ] {
            parameters.set(text).unwrap();
        }
        let error = parameters.set("foaw-end-fit.d=3").unwrap_err().to_string();
        assert_eq!(
            error,
            "--set foaw-end-fit.d=3: foaw-end-fit.d is given twice; keep one"
        );
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
    fn preset_of_the_nearest_rate_is_scaled_and_a_set_value_has_priority() {
        let file = "[[preset]]\nrate_hz = 1000\nplant = 'friction'\nestimators = { pll = { bandwidth_hz = 10 } }\n\
                    [[preset]]\nrate_hz = 10000\nplant = 'friction'\nestimators = { pll = { bandwidth_hz = 20 } }";
        let mut parameters = Parameters::default();
        parameters.layer(checked(file, "f").unwrap());
        let pll = Kind::named("pll").unwrap();
        // Below the tuned rate both poles fall with its fourth root.
        for (rate, tuned, at) in [
            (600.0, 10.0, 1000.0),
            (1000.0, 10.0, 1000.0),
            (3000.0, 10.0, 3000.0),
            (3300.0, 20.0, 10_000.0),
            (10_000.0, 20.0, 10_000.0),
            (20_000.0, 20.0, 20_000.0),
        ] {
            let value = parameters.values(pll, &setup(rate), PlantKind::Friction)[0];
            let wanted: f64 = tuned * (rate / at).powf(0.25);
            assert!((value / wanted - 1.0).abs() < 1e-12, "{rate}: {value}");
        }
        assert_eq!(
            parameters.values(pll, &setup(4.0), PlantKind::Friction),
            [2.0]
        );
        parameters.set("pll.bandwidth_hz=33").unwrap();
        assert_eq!(
            parameters.values(pll, &setup(3000.0), PlantKind::Friction),
            [33.0]
        );
    }

    #[test]
    fn shipped_value_is_the_tuned_one_at_its_own_encoder_and_rate() {
        let parameters = Parameters::default();
        let mut compared = 0;
        for preset in &Presets::shipped().preset {
            let mut setup = setup(preset.rate_hz);
            setup.stages.large.counts_per_rev = preset.counts_per_rev.unwrap();
            for (name, tuned) in &preset.estimators {
                let kind = Kind::named(name).unwrap();
                let values = parameters.values(kind, &setup, preset.plant);
                for (parameter, value) in kind.parameters.iter().zip(values) {
                    if let Some(tuned) = tuned.get(parameter.name) {
                        assert_eq!(value, *tuned, "{name}.{}", parameter.name);
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 100, "{compared}");
    }

    #[test]
    fn bank_that_follows_an_observer_has_the_values_of_the_observer() {
        let shipped = Presets::shipped();
        for (bank, observer) in [
            ("imm-adaptive", "adaptive"),
            ("imm-adaptive-edge", "adaptive-edge"),
        ] {
            let of = |name: &str| -> Vec<_> {
                let presets = shipped.preset.iter();
                presets.map(|p| p.estimators.get(name).cloned()).collect()
            };
            assert!(of(observer).iter().any(Option::is_some), "{observer}");
            assert_eq!(of(bank), of(observer), "{bank}");
        }
    }

    /// The counts per revolution are those of the file; a file without them is not scaled by them.
    #[test]
    fn value_is_scaled_by_the_counts_of_its_preset() {
        let pll = Kind::named("pll").unwrap();
        let mut coarse = setup(1000.0);
        coarse.stages.large.counts_per_rev = 256;
        for (counts, wanted) in [
            ("", 10.0),
            ("counts_per_rev = 256", 10.0),
            ("counts_per_rev = 4096", 2.5),
            ("counts_per_rev = 64", 10.0),
        ] {
            let file = format!(
                "[[preset]]\nrate_hz = 1000\nplant = 'friction'\n{counts}\n\
                 estimators = {{ pll = {{ bandwidth_hz = 10 }} }}"
            );
            let mut parameters = Parameters::default();
            parameters.layer(Presets::parse(&file, "f").unwrap());
            let value = parameters.values(pll, &coarse, PlantKind::Friction)[0];
            assert!(
                (value / wanted - 1.0_f64).abs() < 1e-12,
                "{counts}: {value}"
            );
            parameters.set("pll.bandwidth_hz=33").unwrap();
            let set = parameters.values(pll, &coarse, PlantKind::Friction);
            assert_eq!(set, [33.0]);
        }
    }

    #[test]
    fn errors_of_a_presets_file_name_the_line() {
        let preset = "[[preset]]\nrate_hz = 1000\nplant = 'friction'\n";
        for (text, said) in [
            (
                "[preset.estimators.pl]\nbandwidth_hz = 1\n",
                "line 4, no estimator 'pl'; did you mean pll?",
            ),
            (
                "[preset.estimators.pll]\n\nband = 1\n",
                "line 6, pll has no parameter 'band'; ",
            ),
            (
                "[preset.estimators.pll]\nbandwidth_hz = -1\n",
                "line 5, pll.bandwidth_hz = -1: must be a number from ",
            ),
            (
                "estimators = {}\n[image.large.pll]\nbandwidth_hz = -1\n",
                "line 6, pll.bandwidth_hz = -1: ",
            ),
            (
                "estimators = {}\n[image.foot.pll]\nbandwidth_hz = 1\n",
                "line 5, image.foot: no such motor; there are large and handle",
            ),
        ] {
            let text = format!("{preset}{text}");
            let error = checked(&text, "f.toml").unwrap_err();
            assert!(error.starts_with(&format!("f.toml: {said}")), "{error}");
        }
    }

    #[test]
    fn invalid_values_are_refused_by_name() {
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
                .starts_with("f.toml: line 3, plan: unknown field `plan`"),
            "{unknown}"
        );
    }
}
