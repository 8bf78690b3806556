//! Rate and encoder for which parameter values were tuned.

use std::collections::BTreeMap;

use super::{Override, Parameters, PlantKind, Preset, Presets};
use crate::estimators::{Kind, Search, Setup};
use device_files::presets::is_near;
use simulation::simulate::RATES_HZ;

/// Largest number of estimators that are named where all are concerned.
const LISTED: usize = 4;

impl Parameters {
    /// Sources of the values in order of falling priority, for messages.
    #[must_use]
    pub fn sources(&self) -> String {
        let set = (!self.overrides.is_empty()).then_some("--set");
        let layers = self.layers.iter().rev().map(|layer| layer.source.as_str());
        let sources: Vec<_> = set.into_iter().chain(layers).collect();
        sources.join(", then ")
    }

    /// One line for each preset whose values are scaled to a rate or an encoder that is far from the
    /// tuned one: the estimators, by their names or as all that have tuned values; both rates and encoders;
    /// and the remedy: a recording is tuned on at any rate, the simulated device only at those of
    /// [`RATES_HZ`].
    #[must_use]
    pub fn used_far_away(&self, kinds: &[&Kind], setup: &Setup, plant: PlantKind) -> Vec<String> {
        let mut far: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        let mut tuned_kinds = 0;
        for kind in kinds {
            let Some((source, preset)) = self.tuned(kind, setup, plant) else {
                continue;
            };
            tuned_kinds += 1;
            let here = setup.stages.large.counts_per_rev;
            let counts = preset.counts_per_rev.unwrap_or(here);
            let near = is_near(preset.rate_hz, setup.rate.0)
                && is_near(f64::from(counts), f64::from(here));
            if !near {
                let tuned = format!("{source} for {counts} counts/rev at {} Hz", preset.rate_hz);
                far.entry(tuned).or_default().push(kind.name);
            }
        }
        let here = format!(
            "{} counts/rev at {} Hz",
            setup.stages.large.counts_per_rev, setup.rate.0
        );
        let simulated = match (RATES_HZ.0..=RATES_HZ.1).contains(&setup.rate.0) {
            true => format!(" or host-sim tune --rate {}", setup.rate.0),
            false => String::new(),
        };
        let line = |(tuned, names): (String, Vec<&str>)| {
            let which = match names.len() {
                number if number == tuned_kinds && number > LISTED => {
                    format!("those of all {number} estimators with tuned parameters")
                }
                _ => names.join(", "),
            };
            format!(
                "parameters tuned in {tuned} are scaled to {here}, far from there: {which}; to be better, tune them \
                 with host-sim tune RECORDING{simulated}, with --device FILE.toml, and give its file as \
                 --presets, or set values with --set"
            )
        };
        far.into_iter().map(line).collect()
    }

    /// The preset with the values of `kind`, and the name of its file; `None` if no value is tuned, or
    /// all are set by name.
    fn tuned(&self, kind: &Kind, setup: &Setup, plant: PlantKind) -> Option<(&str, &Preset)> {
        let set = |index: usize| {
            let of = |change: &Override| change.kind == kind.name && change.index == index;
            self.overrides.iter().any(of)
        };
        let mut searched = kind.parameters.iter().enumerate();
        if searched.all(|(index, p)| matches!(p.search, Search::Fixed(_)) || set(index)) {
            return None;
        }
        let preset = |layer: &'_ Presets| layer.nearest(kind.name, setup.rate.0, plant).is_some();
        let layer = self.layers.iter().rev().find(|layer| preset(layer))?;
        let preset = layer.nearest(kind.name, setup.rate.0, plant)?;
        Some((&layer.source, preset))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn far(parameters: &Parameters, kinds: &[&str], rate_hz: f64, counts: u32) -> Vec<String> {
        let mut setup = Setup::default();
        setup.rate.0 = rate_hz;
        setup.stages.large.counts_per_rev = counts;
        let kinds: Vec<_> = kinds
            .iter()
            .map(|name| Kind::named(name).unwrap())
            .collect();
        parameters.used_far_away(&kinds, &setup, PlantKind::Friction)
    }

    #[test]
    fn preset_scaled_far_from_its_rate_or_encoder_is_reported() {
        let shipped = Parameters::default();
        let kinds = ["finite-difference", "pll", "foaw-end-fit"];
        for (rate_hz, counts) in [
            (1000.0, 4096),
            (1400.0, 4096),
            (1000.0, 6000),
            (11_600.0, 4096),
        ] {
            assert_eq!(far(&shipped, &kinds, rate_hz, counts), Vec::<String>::new());
        }
        let said = far(&shipped, &kinds, 1000.0, 90);
        assert_eq!(said.len(), 1, "{said:?}");
        let words = "the shipped presets for 4096 counts/rev at 1000 Hz are scaled to 90 counts/rev at \
                     1000 Hz, far from there: pll, foaw-end-fit; to be better, tune them with host-sim tune \
                     RECORDING or host-sim tune --rate 1000, with --device FILE.toml, and";
        assert!(said[0].contains(words), "{said:?}");
        // The simulated device has no such rate.
        for rate_hz in [50.0, 200_000.0] {
            let said = far(&shipped, &["pll"], rate_hz, 4096);
            let words = "tune them with host-sim tune RECORDING, with --device FILE.toml, and";
            assert!(said[0].contains(words), "{said:?}");
        }
        assert!(far(&shipped, &kinds, 300.0, 4096)[0].contains("at 300 Hz, far from there"));
        assert_eq!(
            far(&shipped, &["finite-difference"], 1000.0, 90),
            Vec::<String>::new()
        );
        let many = [
            "low-pass",
            "finite-difference",
            "pll",
            "foaw-end-fit",
            "foaw-best-fit",
            "observer",
        ];
        let said = far(&shipped, &many, 1000.0, 90);
        assert!(
            said[0]
                .contains("far from there: those of all 5 estimators with tuned parameters; to be"),
            "{said:?}"
        );
    }

    #[test]
    fn presets_file_and_values_set_by_name_are_considered() {
        let file = "[[preset]]\nrate_hz = 1000\nplant = 'friction'\ncounts_per_rev = 90\n\
                    estimators = { pll = { bandwidth_hz = 10 } }";
        let mut parameters = Parameters::default();
        parameters.layer(Presets::parse(file, "mine.toml").unwrap());
        assert_eq!(far(&parameters, &["pll"], 1000.0, 90), Vec::<String>::new());
        let said = far(&parameters, &["pll"], 1000.0, 4096);
        assert!(
            said[0].contains("tuned in mine.toml for 90 counts/rev"),
            "{said:?}"
        );
        assert_eq!(parameters.sources(), "mine.toml, then the shipped presets");
        // A value of another estimator is none of this one.
        parameters.set("low-pass.cutoff_hz=20").unwrap();
        assert_eq!(far(&parameters, &["pll"], 1000.0, 4096).len(), 1);
        parameters.set("pll.bandwidth_hz=20").unwrap();
        assert_eq!(
            far(&parameters, &["pll"], 1000.0, 4096),
            Vec::<String>::new()
        );
    }
}
