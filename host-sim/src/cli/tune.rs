//! `host-sim tune`.

use std::path::PathBuf;

use clap::Args;

use crate::belief::Belief;
use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::parameters::{PlantKind, Presets};
use crate::scenario::ScenarioName;
use crate::simulate;
use crate::tune::{FIRST_SEED, Ground, tune};

use super::arguments::{DeviceFile, kinds, rates, scenarios};
use super::page::progress;

#[derive(Debug, Args)]
pub(super) struct Tune {
    /// Take the mean over right and wrong beliefs in the device, as sensitivity tries them
    #[arg(long)]
    pub(super) doubting: bool,
    /// Scenario to tune on; repeatable [default: step, permanent, track]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    /// Control rate, Hz; repeatable [default: 1000, 10000 and 11600]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Estimator to tune; repeatable [default: all that have parameters]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// How many tuning seeds, from 2^32 on
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(super) seeds: u64,
    /// Duration of each run, s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 10.0,
        allow_negative_numbers = true
    )]
    pub(super) seconds: f64,
    /// Tune on the plant without Coulomb friction only [default: on both]
    #[arg(long)]
    pub(super) frictionless: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    /// File to write; compare and replay take it as --presets
    #[arg(long, value_name = "FILE.toml", default_value = "target/presets.toml")]
    pub(super) out: PathBuf,
}

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
