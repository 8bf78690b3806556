//! `host-sim tune`.

use crate::belief::Belief;
use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::parameters::{PlantKind, Presets};
use crate::scenario::ScenarioName;
use crate::simulate;
use crate::tune::{FIRST_SEED, Ground, tune};

use super::arguments::{Tune, kinds, rates, scenarios};
use super::compare::progress;

pub(super) fn run(options: &Tune, command_line: &str) -> Result<(), Failure> {
    use ScenarioName::{Permanent, Step, Track};
    let kinds: Vec<_> = kinds(&options.estimators)?
        .into_iter()
        .filter(|kind| kind.is_tunable())
        .collect();
    if kinds.is_empty() {
        return Err(Failure::Input(
            "nothing to tune: the named estimators have no parameters; see host-sim estimators"
                .to_owned(),
        ));
    }
    let ground = Ground {
        device: options.device.load()?,
        scenarios: scenarios(&options.scenarios, &[Step, Permanent, Track])?,
        seeds: options.seeds,
        seconds: options.seconds,
        beliefs: match options.doubting {
            true => Belief::extremes(),
            false => Vec::new(),
        },
    };
    let rates = rates(&options.rates, &[1e3, 10e3, 11.6e3]);
    for &rate in &rates {
        simulate::ticks(rate, options.seconds)?;
    }
    let plants: &[_] = match options.frictionless {
        true => &[PlantKind::Frictionless],
        false => &[PlantKind::Friction, PlantKind::Frictionless],
    };
    let bar = progress(rates.len() * plants.len() * kinds.len(), "tuning");
    let mut presets = Presets::default();
    for &rate in &rates {
        for &plant in plants {
            presets
                .preset
                .push(tune(&ground, &kinds, rate, plant, || bar.inc(1))?);
        }
    }
    bar.finish_and_clear();
    let names: Vec<_> = ground
        .scenarios
        .iter()
        .map(|scenario| scenario.as_str())
        .collect();
    let text = format!(
        "# {command_line}\n# Tuned on {}, {} s each, seeds {FIRST_SEED} to {}.\n\n{}",
        names.join(", "),
        options.seconds,
        FIRST_SEED + options.seeds - 1,
        presets.to_toml()?,
    );
    write_whole(&options.out, text.as_bytes())?;
    print_bytes(format!("{}\n", options.out.display()).as_bytes())
}
