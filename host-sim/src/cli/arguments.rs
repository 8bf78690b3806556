//! Commands of the command line, and the options that several commands share.

use std::path::PathBuf;

use clap::{Args, CommandFactory as _, Parser, Subcommand};

use super::compare::longer_than_skipped;
use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::designed::{Place, designed};
use experiments::distinct;
use experiments::transparency::compare::DEFAULT_ESTIMATOR;
use recordings::arguments::DeviceFile;
use recordings::log::{Log, is_stdin};
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;
use terminal::output::note;
use terminal::parse::options_with_negative_numbers;
use terminal::wording::WIDTH;

/// Velocity estimation for a dual-stage haptic device, simulated and scored.
///
/// Without a command, host-sim runs compare with all defaults.
#[derive(Debug, Parser)]
#[command(
    name = "host-sim",
    bin_name = "host-sim",
    version = report::version::VERSION,
    max_term_width = WIDTH,
    after_help = "Example:\n  host-sim compare --scenario track --rate 1000"
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Simulate the device, run the estimators, print their scores and write a report
    #[command(after_help = "Examples:
  host-sim compare --scenario track --rate 1000 --estimator foaw-best-fit
  host-sim compare --closed-loop --scene wall --out target/wall")]
    Compare(super::compare::Compare),
    /// Run the estimators on a recording and write their velocities
    #[command(after_help = "Example:
  host-sim replay motor.csv --estimator pll --out velocity.csv")]
    Replay(super::replay::Replay),
    /// Run the estimators on recordings of real devices with a known velocity and score them
    #[command(after_help = "Examples:
  host-sim real
  host-sim real --counts-per-rev 64,1024,16384 --rate 500,1000 --out page")]
    Real(super::real::Real),
    /// Name the estimator to use for a device from recordings of it, with the lines of Rust
    #[command(after_help = "Examples:
  host-sim recommend motor.csv --counts-per-rev 4096
  host-sim recommend free.csv wall.csv --device mine.toml --report page")]
    Recommend(super::recommend::Recommend),
    /// Turn the recording of a fine encoder into what a coarse encoder would have seen
    #[command(after_help = "Example:
  host-sim coarsen fine.csv --counts-per-rev 1024 --rate 500 --out coarse.csv")]
    Coarsen(super::coarsen::Coarsen),
    /// Turn a logic analyser's capture of an encoder's lines into a recording
    #[command(after_help = "Examples:
  host-sim decode capture.csv --counts-per-rev 4096 --out motor.csv
  host-sim decode samples.csv --row-rate 1e6 --lines D0 D1 --out motor.csv
  host-sim decode hall.csv --hall D0 D1 D2 --counts-per-rev 42 --out motor.csv")]
    Decode(super::decode::Decode),
    /// Convert the firmware's telemetry to a recording (CSV)
    #[command(after_help = "Example:
  host-sim record firmware.log --out motor.csv")]
    Record(super::record::Record),
    /// Convert a recording, with estimates, to MCAP for Foxglove, PlotJuggler and Rerun (a part of cargo export,
    /// which is this program with its MCAP writer), or write the parameters of an estimator for C
    #[command(after_help = "Examples:
  host-sim export motor.csv --estimator pll --mcap motor.mcap
  host-sim export --estimator imm --rate 1000 --c --out parameters.h")]
    Export(super::export::Export),
    /// Draw a recording as SVG: counts, velocities, currents
    #[command(after_help = "Example:
  host-sim plot motor.csv --from 1 --to 2.5 --out motor.svg")]
    Plot(super::plot::Plot),
    /// Fit the device's constants to recordings with the motor current and write a device file
    #[command(after_help = "Example:
  host-sim identify excite.csv --out device.toml --report target/identify")]
    Identify(super::identify::Identify),
    /// Simulate a scene or a scenario and write it as a recording (CSV)
    #[command(after_help = "Example:
  host-sim simulate --scene wall --hand moving --seconds 5 --out wall.csv")]
    Simulate(super::simulate::Simulate),
    /// Search the estimators' parameters on separate tuning seeds, or on recordings, and write a
    /// presets file
    #[command(after_help = "Examples:
  host-sim tune --estimator pll --rate 1000 --out presets.toml
  host-sim tune log.csv --device mine.toml --estimator pll --out presets.toml")]
    Tune(super::tune::Tune),
    /// Measure how errors in the device's constants degrade each estimator
    #[command(after_help = "Example:
  host-sim sensitivity --estimator kalman-motor --estimator adaptive")]
    Sensitivity(super::sensitivity::Sensitivity),
    /// Compute the RMS error of a particle filter: in scenario stochastic, where it has the true model, the
    /// least error that any estimator can have
    #[command(after_help = "Example:
  host-sim limit --scenario step --seconds 2")]
    Limit(super::limit::Limit),
    /// Divide the force that a hand feels beside the scene among its causes, and switch each cause off
    #[command(after_help = "Examples:
  host-sim feel --scene free-air --estimator adaptive
  host-sim feel --causes-only --rate 1000 --rate 10000")]
    Feel(super::feel::Feel),
    /// Find the largest stiffness and damping that stay passive and free of limit cycles
    #[command(after_help = "Example:
  host-sim zwidth --estimator pll --rate 10000 --lines 1024")]
    Zwidth(super::zwidth::Zwidth),
    /// Check the closed loop on devices whose constants differ from the controller's
    #[command(after_help = "Example:
  host-sim robust --scene wall --devices 100")]
    Robust(super::robust::Robust),
    /// Merge the shards of a run of robust, sensitivity, tune or zwidth: print and write what the
    /// command without --shard does
    #[command(after_help = "Examples:
  host-sim merge target/robust/shard-*-of-4.jsonl
  host-sim merge parts/shard-*-of-16.jsonl --out target/zwidth")]
    Merge(super::shard::Merge),
    /// List the estimators with their parameters, ranges and tuned values
    #[command(after_help = "Example:
  host-sim estimators")]
    Estimators,
    /// List the scenarios
    #[command(after_help = "Example:
  host-sim scenarios")]
    Scenarios,
    /// Check a device file and print it as TOML with all values and defaults
    #[command(after_help = "Example:
  host-sim device --device mine.toml")]
    Device(DeviceFile),
}

/// The command line.
pub(super) fn command_line() -> clap::Command {
    options_with_negative_numbers(Arguments::command())
}

#[derive(Clone, Debug, Default, Args)]
pub(super) struct ParameterOptions {
    /// Presets file written by host-sim tune; its values replace the shipped presets
    #[arg(long, value_name = "FILE.toml")]
    presets: Option<PathBuf>,
    /// Set one parameter of an estimator, for example pll.bandwidth_hz=200; replaces all presets;
    /// repeatable
    #[arg(long = "set", value_name = "NAME.PARAM=VALUE")]
    set: Vec<String>,
}

impl ParameterOptions {
    /// The parameters. A value from `--set` replaces one from `--presets`, which replaces a shipped
    /// one. `run` are the estimators of the command.
    ///
    /// # Errors
    /// [`Failure::Input`], also if `--set` names an estimator that is not run.
    pub(super) fn load(&self, run: &[&Kind]) -> Result<Parameters, Failure> {
        let mut parameters = Parameters::default();
        if let Some(path) = &self.presets {
            parameters.layer(catalogue::parameters::read(path)?);
        }
        for text in &self.set {
            let kind = parameters.set(text)?;
            if !run.iter().any(|known| known.name == kind.name) {
                return Err(Failure::Input(format!(
                    "--set {text}: {} is not run; add --estimator {0}, or remove --set",
                    kind.name
                )));
            }
        }
        Ok(parameters)
    }
}

/// The estimators of these names without duplicates; all estimators if no name is given.
pub(super) fn kinds(names: &[String]) -> Result<Vec<&'static Kind>, Failure> {
    if names.is_empty() {
        return Ok(Kind::all().iter().collect());
    }
    let mut kinds: Vec<&'static Kind> = Vec::new();
    for name in names {
        let kind = Kind::named(name)?;
        if !kinds.iter().any(|known| known.name == kind.name) {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// Checks that a device can be simulated at these rates, Hz, for a duration in s that can be scored, before
/// anything is said about estimators at them. `None` stands for a duration that suits every rate.
pub(super) fn check_rates(rates_hz: &[f64], seconds: Option<f64>) -> Result<(), Failure> {
    for &rate_hz in rates_hz {
        simulation::simulate::ticks(rate_hz, seconds.unwrap_or(1.0))?;
    }
    seconds.map_or(Ok(()), longer_than_skipped)
}

/// As [`kinds`]. If no name is given, estimators that the shipped presets do not give at all of `places` are
/// left out, with a note.
pub(super) fn kinds_at(
    names: &[String],
    parameters: &Parameters,
    places: &[Place],
) -> Result<Vec<&'static Kind>, Failure> {
    let kinds = kinds(names)?;
    if !names.is_empty() {
        return Ok(kinds);
    }
    let (kinds, lines) = designed(&kinds, parameters, places);
    lines.iter().for_each(note);
    Ok(kinds)
}

/// The scenarios of these names without duplicates; `default` if no name is given.
pub(super) fn scenarios(
    names: &[String],
    default: &[ScenarioName],
) -> Result<Vec<ScenarioName>, Failure> {
    if names.is_empty() {
        return Ok(default.to_vec());
    }
    let scenarios = names.iter().map(|name| name.parse());
    let scenarios: Vec<_> = scenarios.collect::<Result<_, String>>()?;
    Ok(distinct(&scenarios, &[]))
}

/// Help text of a `--handle-estimator` with this condition, which may be empty, and the default.
pub(super) fn handle_help(condition: &str) -> String {
    format!("Estimator of the handle's velocity{condition} [default: {DEFAULT_ESTIMATOR}]")
}

/// Help text of the `--seconds` of scenarios, with the default and the scenarios that have another one.
pub(super) fn seconds_help() -> String {
    let usual = ScenarioName::Step.default_seconds();
    let mut help = format!("Duration of each run, s [default: {usual}");
    for scenario in ScenarioName::ALL {
        let seconds = scenario.default_seconds();
        if seconds != usual {
            help += &format!("; scenario {scenario}: {seconds}");
        }
    }
    help + "]"
}

/// Opens these recordings. `name` is that of the argument. A recording that is there twice is refused: it says
/// nothing new, and would have twice the weight.
pub(super) fn open_logs(name: &str, recordings: &[PathBuf]) -> Result<Vec<Log>, Failure> {
    one_stdin(name, recordings)?;
    let logs = recordings.iter().map(|path| Log::open(path));
    let logs: Vec<_> = logs.collect::<Result<_, _>>()?;
    let mut sums: Vec<u64> = Vec::new();
    for log in logs.iter().filter(|_| logs.len() > 1) {
        let sum = log.sum()?;
        if let Some(k) = sums.iter().position(|known| *known == sum) {
            return Err(Failure::Input(format!(
                "{}: is already given by {}; give each recording once",
                log.name(),
                logs[k].name()
            )));
        }
        sums.push(sum);
    }
    Ok(logs)
}

/// Checks that standard input is among these recordings once at most. `name` is that of the argument.
fn one_stdin(name: &str, recordings: &[PathBuf]) -> Result<(), Failure> {
    match recordings.iter().filter(|path| is_stdin(path)).count() {
        0 | 1 => Ok(()),
        _ => Err(Failure::Input(format!(
            "{name} -: standard input can be read once; give - once"
        ))),
    }
}

/// The given values without duplicates; `default` if none is given.
pub(super) fn distinct<T: Copy + PartialEq>(given: &[T], default: &[T]) -> Vec<T> {
    let values = if given.is_empty() { default } else { given };
    distinct::distinct(values.iter().copied())
}

#[cfg(test)]
mod tests {
    use clap::Arg;

    use super::*;

    /// The lines of the examples in a help text.
    fn examples(help: &str) -> Vec<&str> {
        let (_, examples) = help.split_once("\nExample").unwrap_or_default();
        let lines = examples.lines().skip(1);
        lines
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect()
    }

    #[test]
    fn option_with_a_negative_number_is_named() {
        let mut root = command_line();
        root.build();
        for command in root.clone().get_subcommands() {
            let options = command.get_arguments().filter_map(Arg::get_long);
            for option in options.filter(|name| !["help", "version"].contains(name)) {
                let line = ["host-sim", command.get_name(), &format!("--{option}"), "-1"];
                let parsed = root.clone().try_get_matches_from(line);
                let said = parsed.map_or_else(|error| error.to_string(), |_| String::new());
                let is_flag = command.get_arguments().any(|argument| {
                    argument.get_long() == Some(option) && !argument.get_action().takes_values()
                });
                assert!(
                    is_flag || !said.contains("unexpected argument"),
                    "{line:?}: {said}"
                );
            }
        }
    }

    #[test]
    fn examples_of_every_help_text_are_command_lines() {
        let mut root = Arguments::command();
        root.build();
        let mut texts = vec![("".to_owned(), root.render_long_help().to_string())];
        for command in root.get_subcommands_mut() {
            if command.get_name() != "help" {
                let help = command.render_long_help().to_string();
                texts.push((command.get_name().to_owned(), help));
            }
        }
        assert_eq!(texts.len(), 22);
        for (name, help) in texts {
            let examples = examples(&help);
            assert!(!examples.is_empty(), "{name}: {help}");
            for example in examples {
                assert!(
                    example.starts_with(&format!("host-sim {name}")),
                    "{example}"
                );
                let parsed = Arguments::try_parse_from(example.split(' '));
                assert!(parsed.is_ok(), "{example}: {}", parsed.unwrap_err());
            }
            for line in help.lines() {
                assert!(line.chars().count() <= WIDTH, "{name}: {line}");
            }
        }
    }
}
