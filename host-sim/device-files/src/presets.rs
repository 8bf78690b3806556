//! Tuned parameters of the estimators, as `host-sim tune` writes them.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use estimator_catalogue::Parameter;
use serde::{Deserialize, Serialize};

use crate::decimal;
use crate::device::{COUNTS_PER_REV, counts_per_rev_rule};
use crate::read::{Step, at_line, one_line};

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

/// The motors of [`Presets::image`].
const MOTORS: [&str; 2] = ["large", "handle"];

/// Rates of recordings, and control rates of a preset, Hz: `tune` runs on recordings too.
pub const RATES_HZ: RangeInclusive<f64> = 5.0..=10e6;

/// Largest ratio of rates, or of counts per revolution, to which tuned values are scaled without a
/// warning.
const FAR: f64 = 1.5;

/// Whether values that were tuned for a rate, or for counts per revolution, are scaled to the `used`
/// one without a warning: neither is more than 1.5 times the other.
#[must_use]
pub fn is_near(tuned: f64, used: f64) -> bool {
    (1.0 / FAR..=FAR).contains(&(tuned / used))
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

/// Whether a tuned value, scaled to other counts and another rate by these ratios, would be outside of the range of the
/// parameter, whose end [`Parameter::scaled`] then gives.
#[must_use]
pub fn leaves_range(parameter: &Parameter, tuned: f64, counts: f64, rate: f64) -> bool {
    let factor = parameter.scaling.factor(counts, rate);
    // A value that is not scaled was checked when the file was read.
    let wanted = tuned * factor;
    // A whole parameter is rounded.
    let rounding = if parameter.whole { 0.5 } else { 0.0 };
    let least = parameter.lowest * (1.0 - 1e-9) - rounding;
    let most = parameter.highest * (1.0 + 1e-9) + rounding;
    factor != 1.0 && !(least..=most).contains(&wanted)
}

/// Checks a value of a parameter of `estimator`.
///
/// # Errors
/// One line with the value and the range.
pub fn check_value(parameter: &Parameter, estimator: &str, value: f64) -> Result<(), String> {
    if parameter.accepts(value) {
        return Ok(());
    }
    Err(format!(
        "{estimator}.{} = {}: must be a {}number from {} to {}{}{}",
        parameter.name,
        decimal(value),
        if parameter.whole { "whole " } else { "" },
        decimal(parameter.lowest),
        decimal(parameter.highest),
        if parameter.unit.is_empty() { "" } else { " " },
        parameter.unit,
    ))
}

impl Presets {
    /// The presets shipped with the program.
    #[must_use]
    pub fn shipped() -> Self {
        Self::parse(include_str!("../../presets.toml"), "the shipped presets")
            .expect("the shipped presets are tested")
    }

    /// The presets as text of a file.
    ///
    /// # Errors
    /// One line if the values cannot be serialised.
    pub fn to_toml(&self) -> Result<String, String> {
        toml::to_string(self).map_err(|error| error.to_string())
    }

    /// Reads the text of a presets file that messages call `name`. [`Self::check_values`] checks the names of its
    /// estimators.
    ///
    /// # Errors
    /// One line that names the file and the wrong entry.
    pub fn parse(text: &str, name: &str) -> Result<Self, String> {
        let mut presets: Self =
            toml::from_str(text).map_err(|error| format!("{name}: {}", one_line(text, &error)))?;
        presets.source = name.to_owned();
        presets
            .check()
            .map_err(|(way, error)| format!("{name}: {}", at_line(text, &way, &error)))?;
        Ok(presets)
    }

    /// Checks rates, counts and motors, and that no value stands twice. The error has the way to the wrong
    /// value.
    fn check(&self) -> Result<(), (Vec<Step<'_>>, String)> {
        for (k, preset) in self.preset.iter().enumerate() {
            let rate = decimal(preset.rate_hz);
            let wrong = |key, error| {
                Err((
                    vec![Step::Key("preset"), Step::Entry(k), Step::Key(key)],
                    error,
                ))
            };
            if !RATES_HZ.contains(&preset.rate_hz) {
                let error = format!(
                    "rate_hz = {rate}: must be from {} to {} Hz",
                    RATES_HZ.start(),
                    RATES_HZ.end()
                );
                return wrong("rate_hz", error);
            }
            let counts = preset.counts_per_rev;
            if let Some(counts) = counts.filter(|counts| !COUNTS_PER_REV.contains(counts)) {
                let rule = counts_per_rev_rule(Some(counts.into()));
                let error =
                    format!("counts_per_rev = {counts} at rate_hz = {rate}: must be {rule}");
                return wrong("counts_per_rev", error);
            }
            let same =
                |other: &&Preset| (other.rate_hz, other.plant) == (preset.rate_hz, preset.plant);
            for other in self.preset[..k].iter().filter(same) {
                let mut names = preset.estimators.keys();
                if let Some(name) = names.find(|name| other.estimators.contains_key(*name)) {
                    let error = format!(
                        "[[preset]]: {name} at rate_hz = {rate} on the plant {} is in an earlier [[preset]] too; \
                         remove one",
                        preset.plant.phrase()
                    );
                    return wrong("rate_hz", error);
                }
            }
        }
        for motor in self.image.keys() {
            if !MOTORS.contains(&motor.as_str()) {
                return Err((
                    vec![Step::Key("image"), Step::Key(motor)],
                    format!(
                        "image.{motor}: no such motor; there are {}",
                        MOTORS.join(" and ")
                    ),
                ));
            }
        }
        Ok(())
    }

    /// Calls `check` with the name and the values of each estimator of the file with this `text`. An error of
    /// `check` is a message and, if one parameter is wrong, its name.
    ///
    /// # Errors
    /// The first error of `check`, in one line that names the file and the line.
    pub fn check_values<'a>(
        &'a self,
        text: &str,
        check: impl Fn(&'a str, &'a BTreeMap<String, f64>) -> Result<(), (Option<&'a str>, String)>,
    ) -> Result<(), String> {
        let tuned = self.preset.iter().enumerate().map(|(k, preset)| {
            let way = vec![Step::Key("preset"), Step::Entry(k), Step::Key("estimators")];
            (way, &preset.estimators)
        });
        let image = self.image.iter();
        let image = image
            .map(|(motor, estimators)| (vec![Step::Key("image"), Step::Key(motor)], estimators));
        for (way, estimators) in tuned.chain(image) {
            for (name, values) in estimators {
                check(name, values).map_err(|(parameter, error)| {
                    let mut way = way.clone();
                    way.push(Step::Key(name));
                    way.extend(parameter.map(Step::Key));
                    format!("{}: {}", self.source, at_line(text, &way, &error))
                })?;
            }
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "\
        [[preset]]\nrate_hz = 1000.0\nplant = \"friction\"\ncounts_per_rev = 1024\n\
        [preset.estimators.pll]\nbandwidth_hz = 10.0\n\
        [[preset]]\nrate_hz = 4000.0\nplant = \"friction\"\n\
        [preset.estimators.pll]\nbandwidth_hz = 40.0\n\
        [[preset]]\nrate_hz = 1000.0\nplant = \"frictionless\"\n\
        [preset.estimators.pll]\nbandwidth_hz = 11.0\n\
        [[preset]]\nrate_hz = 2000.0\nplant = \"friction\"\n\
        [preset.estimators.low-pass]\ncutoff_hz = 5.0\n\
        [image.handle.pll]\nbandwidth_hz = 12.0\n";

    fn file() -> Presets {
        Presets::parse(FILE, "mine.toml").unwrap()
    }

    #[test]
    fn written_file_is_read_to_the_same_presets() {
        let text = file().to_toml().unwrap();
        assert_eq!(Presets::parse(&text, "mine.toml").unwrap(), file());
        for kind in [PlantKind::Friction, PlantKind::Frictionless] {
            assert!(
                text.contains(&format!("plant = \"{}\"", kind.name())),
                "{text}"
            );
        }
    }

    /// The nearest rate by ratio: 2000 Hz is as far from 1000 Hz as from 4000 Hz.
    #[test]
    fn preset_of_the_nearest_rate_on_the_plant_is_taken() {
        let file = file();
        let rate = |name: &str, rate_hz, plant| Some(file.nearest(name, rate_hz, plant)?.rate_hz);
        for (rate_hz, nearest) in [
            (10.0, 1000.0),
            (1990.0, 1000.0),
            (2010.0, 4000.0),
            (1e5, 4000.0),
        ] {
            assert_eq!(
                rate("pll", rate_hz, PlantKind::Friction),
                Some(nearest),
                "{rate_hz}"
            );
        }
        assert_eq!(rate("pll", 1e5, PlantKind::Frictionless), Some(1000.0));
        assert_eq!(rate("low-pass", 1e5, PlantKind::Friction), Some(2000.0));
        assert_eq!(rate("low-pass", 1e5, PlantKind::Frictionless), None);
        assert_eq!(rate("foaw-end-fit", 1e3, PlantKind::Friction), None);
    }

    #[test]
    fn values_are_scaled_without_a_warning_up_to_one_and_a_half() {
        for (tuned, used, near) in [
            (1000.0, 1500.0, true),
            (1500.0, 1000.0, true),
            (1000.0, 1501.0, false),
            (1501.0, 1000.0, false),
            (4096.0, 90.0, false),
        ] {
            assert_eq!(is_near(tuned, used), near, "{tuned} {used}");
        }
    }

    /// A window of 40 intervals at 1 kHz has 400 at 10 kHz, and 128 at most.
    #[test]
    fn value_that_would_leave_its_range_is_known() {
        let mut rows = estimator_catalogue::ROWS.iter();
        let row = rows.find(|row| row.name == "foaw-best-fit").unwrap();
        let n = row.parameters.iter().find(|p| p.name == "n").unwrap();
        assert_eq!(n.highest, 128.0);
        // 0.4 intervals are rounded to none, and 0.6 to one.
        assert!(leaves_range(n, 4.0, 1.0, 0.1) && !leaves_range(n, 4.0, 1.0, 0.15));
        for (tuned, rate, leaves) in [
            (40.0, 3.2, false),
            (40.0, 10.0, true),
            (128.0, 1.0, false),
            (4.0, 0.5, false),
        ] {
            assert_eq!(leaves_range(n, tuned, 1.0, rate), leaves, "{tuned} {rate}");
            assert_eq!(
                n.scaled(tuned, 1.0, rate) == 128.0,
                leaves || rate == 3.2 || tuned == 128.0
            );
        }
    }

    #[test]
    fn value_is_scaled_by_the_ratios_of_encoder_and_rate() {
        let file = file();
        let row = estimator_catalogue::ROWS
            .iter()
            .find(|row| row.name == "pll");
        let parameter = &row.unwrap().parameters[0];
        let [first, second] = [&file.preset[0], &file.preset[1]];
        assert_eq!(first.counts_ratio(4096), 4.0);
        // A file that does not name its encoder is for any.
        assert_eq!(second.counts_ratio(4096), 1.0);
        for (preset, tuned, counts, rate) in [(first, 10.0, 4.0, 0.5), (second, 40.0, 1.0, 0.125)] {
            let value = preset.value("pll", parameter, 4096, 500.0);
            assert_eq!(value, Some(parameter.scaled(tuned, counts, rate)));
        }
        assert_eq!(first.value("pll", parameter, 1024, 1000.0), Some(10.0));
        assert_eq!(first.value("low-pass", parameter, 1024, 1000.0), None);
    }
}
