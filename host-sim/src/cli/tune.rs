//! `host-sim tune`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;

use catalogue::constant_error::ConstantError;
use catalogue::estimators::Kind;
use catalogue::parameters::{PlantKind, Preset, Presets};
use experiments::tune::{FIRST_SEED, TuningSet, image_section, tune};
use simulation::scenario::{Role, ScenarioName};
use simulation::simulate;
use terminal::failure::Failure;
use terminal::output::{is_stdout, print_bytes, write_whole};

use super::arguments::{DeviceFile, kinds, rates, scenarios};
use super::page::progress;

/// Defaults of the tuning options for one kind of estimators.
struct Recipe {
    roles: &'static [Role],
    seeds: u64,
    seconds: f64,
    perturbed: bool,
}

impl Recipe {
    /// For filters: the paper's experiment.
    const PLAIN: Self = Self {
        roles: &[Role::Tuning],
        seeds: 3,
        seconds: 10.0,
        perturbed: false,
    };
    /// For observers. Their error never leaves the haptic interval in the paper's experiment, so
    /// that experiment does not discriminate between parameters. Observers use constants of the
    /// device, which may be wrong.
    const OBSERVER: Self = Self {
        roles: &[Role::Tuning, Role::Judging],
        seeds: 1,
        seconds: 4.0,
        perturbed: true,
    };
}

#[derive(Debug, Args)]
pub(super) struct Tune {
    /// Average the cost over the true and perturbed device constants, with the errors of host-sim
    /// sensitivity [default: only for observers, and only without --scenario]
    #[arg(long = "perturbed", visible_alias = "doubting")]
    pub(super) perturbed: bool,
    /// Scenario to tune on, see host-sim scenarios; repeatable [default: step, permanent, track;
    /// observers: all with friction except heating]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    /// Control rate, 100 to 100000 Hz; repeatable [default: 1000, 10000 and 11600]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Estimator to tune, see host-sim estimators; repeatable [default: all that have parameters]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Number of tuning seeds, 1 to 1000; they start at 2^32. The seed after the last one decides
    /// between the result and the shipped parameters [default: 3; observers: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(super) seeds: Option<u64>,
    /// Duration of each run, s [default: 10; observers: 4]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) seconds: Option<f64>,
    /// Tune only on the plant without Coulomb friction [default: on both plants]
    #[arg(long)]
    pub(super) frictionless: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    /// Write the parameters to FILE, a presets file for other commands; - is standard output. The
    /// section [image] of an existing FILE is kept
    #[arg(long, value_name = "FILE.toml", default_value = "target/presets.toml")]
    pub(super) out: PathBuf,
}

impl Tune {
    fn tuning_set(&self, recipe: &Recipe) -> Result<TuningSet, Failure> {
        let perturbed = self.perturbed || recipe.perturbed && self.scenarios.is_empty();
        Ok(TuningSet {
            device: self.device.load()?,
            scenarios: scenarios(&self.scenarios, &ScenarioName::of(recipe.roles))?,
            seeds: self.seeds.unwrap_or(recipe.seeds),
            seconds: self.seconds.unwrap_or(recipe.seconds),
            constant_errors: match perturbed {
                true => ConstantError::extremes(),
                false => Vec::new(),
            },
        })
    }
}

pub(super) fn run(options: &Tune, command_line: &str) -> Result<(), Failure> {
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
    let (observers, others): (Vec<_>, Vec<_>) =
        kinds.iter().copied().partition(|kind| kind.is_observer());
    let groups: Vec<_> = [(others, Recipe::PLAIN), (observers, Recipe::OBSERVER)]
        .into_iter()
        .filter(|(kinds, _)| !kinds.is_empty())
        .map(|(kinds, recipe)| Ok((kinds, options.tuning_set(&recipe)?)))
        .collect::<Result<_, Failure>>()?;
    let rates = rates(&options.rates, &[1e3, 10e3, 11.6e3]);
    for (_, set) in &groups {
        for &rate in &rates {
            simulate::ticks(rate, set.seconds)?;
        }
    }
    let plants: &[_] = match options.frictionless {
        true => &[PlantKind::Frictionless],
        false => &[PlantKind::Friction, PlantKind::Frictionless],
    };
    let kept = match is_stdout(&options.out) {
        true => String::new(),
        false => image_section(&options.out).map_err(Failure::Input)?,
    };
    let bar = progress(rates.len() * plants.len() * kinds.len(), "tuning");
    let mut presets = Presets::default();
    let mut notes = Vec::new();
    for &rate in &rates {
        for &plant in plants {
            let mut preset = Preset {
                rate_hz: rate,
                plant,
                counts_per_rev: groups
                    .first()
                    .map(|(_, set)| set.device.stages.large.counts_per_rev),
                estimators: BTreeMap::new(),
            };
            for (kinds, set) in &groups {
                let tuned = tune(set, kinds, rate, plant, || bar.inc(1))?;
                preset.estimators.extend(tuned.preset.estimators);
                let at = format!("{rate} Hz, {}", plant.name());
                notes.extend(tuned.notes.iter().map(|note| format!("{at}: {note}")));
            }
            presets.preset.push(preset);
        }
    }
    bar.finish_and_clear();
    let mut text = format!("# {command_line}\n");
    for (kinds, set) in &groups {
        text += &tuned_on(kinds, set);
    }
    for note in &notes {
        terminal::output::note(format_args!("note: {note}"));
        text += &format!("# {note}\n");
    }
    text += &format!("\n{}", presets.to_toml().map_err(Failure::Input)?);
    if !kept.is_empty() {
        text += &format!("\n{kept}");
    }
    write_whole(&options.out, text.as_bytes())?;
    if is_stdout(&options.out) {
        return Ok(());
    }
    print_bytes(format!("{}\n", options.out.display()).as_bytes())
}

/// Comment line of the presets file: the tuning set of these estimators.
fn tuned_on(kinds: &[&Kind], set: &TuningSet) -> String {
    let names: Vec<_> = kinds.iter().map(|kind| kind.name).collect();
    let scenarios: Vec<_> = set
        .scenarios
        .iter()
        .map(|scenario| scenario.as_str())
        .collect();
    let constants = match set.constant_errors.is_empty() {
        true => "right constants",
        false => "right and wrong constants",
    };
    format!(
        "# {}: tuned on {}, {} s each, {constants}, seeds {FIRST_SEED} to {}.\n",
        names.join(", "),
        scenarios.join(", "),
        set.seconds,
        FIRST_SEED + set.seeds - 1,
    )
}
