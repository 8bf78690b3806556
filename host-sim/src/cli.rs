//! The command line.

mod arguments;
mod closed_loop;
mod coarsen;
mod compare;
mod decode;
mod export;
mod feel;
mod files;
mod identify;
mod limit;
mod line;
mod list;
mod page;
mod plot;
mod rates;
mod real;
mod recommend;
mod record;
mod replay;
mod report_extras;
mod robust;
mod sensitivity;
mod shard;
mod simulate;
mod tune;
mod zwidth;

use std::ffi::OsString;

use clap::{CommandFactory as _, FromArgMatches as _};

use arguments::{Arguments, Command};
use line::{command_line, run_line};
use terminal::explain;
use terminal::failure::Failure;
use terminal::parse::matches;

/// Runs the command line `arguments`, whose first element is the program's name. Without a command,
/// `compare` runs with its defaults.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let (command_line, run_line) = (command_line(&arguments), run_line(&arguments));
    let mut root = arguments::command_line();
    let matches = matches(&mut root, arguments.clone());
    let parsed = matches.and_then(|matches| {
        let parsed = Arguments::from_arg_matches(&matches);
        Ok((parsed.map_err(|error| error.format(&mut root))?, matches))
    });
    let (parsed, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return explain(&error, &program(&arguments)),
    };
    files::check(&root, &matches)?;
    match parsed.command {
        None => compare::run(&compare::Compare::default(), "host-sim compare"),
        Some(Command::Compare(options)) if options.closed_loop => {
            closed_loop::run(&options, &command_line)
        }
        Some(Command::Compare(options)) => compare::run(&options, &command_line),
        Some(Command::Replay(options)) => replay::run(&options),
        Some(Command::Real(options)) => real::run(&options, &command_line),
        Some(Command::Recommend(options)) => recommend::run(&options, &command_line),
        Some(Command::Coarsen(options)) => coarsen::run(&options),
        Some(Command::Decode(options)) => decode::run(&options),
        Some(Command::Export(options)) => export::run(&options),
        Some(Command::Record(options)) => record::run(&options),
        Some(Command::Plot(options)) => plot::run(&options),
        Some(Command::Identify(options)) => identify::run(&options, &command_line),
        Some(Command::Simulate(options)) => simulate::run(&options),
        Some(Command::Tune(options)) => tune::run(&options, &run_line),
        Some(Command::Sensitivity(options)) => sensitivity::run(&options, &run_line),
        Some(Command::Limit(options)) => limit::run(&options),
        Some(Command::Feel(options)) => feel::run(&options, &command_line),
        Some(Command::Zwidth(options)) => zwidth::run(&options, &run_line),
        Some(Command::Robust(options)) => robust::run(&options, &run_line),
        Some(Command::Merge(options)) => shard::merge(&options),
        Some(Command::Estimators) => list::estimators(),
        Some(Command::Scenarios) => list::scenarios(),
        Some(Command::Device(options)) => list::device(&options),
    }
}

/// The program and the command of `arguments`, for the hint to `--help` in an error.
fn program(arguments: &[OsString]) -> String {
    let name = arguments.get(1).map(|name| name.to_string_lossy());
    let known = |name: &str| Arguments::command().find_subcommand(name).is_some();
    match name.filter(|name| known(name)) {
        Some(name) => format!("host-sim {name}"),
        None => "host-sim".to_owned(),
    }
}
