//! The files of a command line: an output that is an input, that has no place, or that is the file of
//! another output, is refused before the command runs.

use std::any::TypeId;
use std::path::{Path, PathBuf};

use clap::{Arg, ArgMatches, Command};
use terminal::failure::Failure;
use terminal::output::{check_place, is_same, is_stdout};

/// Options that name an output. All other paths are inputs.
const OUTPUTS: [&str; 5] = ["out", "json", "csv", "report", "mcap"];

/// The only output that may be an input: `identify --out` keeps the other keys of `--device`.
const KEPT: [&str; 3] = ["identify", "out", "device"];

/// A path of the command line with the identifier of its argument and its name in messages.
struct Named {
    id: String,
    name: String,
    path: PathBuf,
    /// Whether it is a file and no folder.
    is_file: bool,
}

/// Checks the paths of the command in `matches`.
///
/// # Errors
/// [`Failure::Input`] that names an output that is an input or has no place, or two outputs that are one
/// file.
pub(super) fn check(root: &Command, matches: &ArgMatches) -> Result<(), Failure> {
    let Some((name, matches)) = matches.subcommand() else {
        return Ok(());
    };
    let command = root.find_subcommand(name);
    let arguments = command.into_iter().flat_map(Command::get_arguments);
    let paths = arguments.filter(|argument| is_path(argument));
    let paths = paths.flat_map(|argument| given(argument, matches));
    let (outputs, inputs): (Vec<_>, Vec<_>) =
        paths.partition(|of| OUTPUTS.contains(&of.id.as_str()));
    for (k, output) in outputs.iter().enumerate() {
        for input in &inputs {
            if [name, &output.id, &input.id] != KEPT {
                refuse_input(&output.name, &output.path, &input.path)?;
            }
        }
        if output.is_file && !is_stdout(&output.path) {
            check_place(&output.path)?;
        }
        let mut others = outputs[..k].iter();
        if let Some(other) = others.find(|other| is_same(&other.path, &output.path)) {
            return Err(Failure::Input(format!(
                "{} {}: is the file of {} too; name another one",
                output.name,
                output.path.display(),
                other.name
            )));
        }
    }
    Ok(())
}

/// Refuses an output, of the option `name`, that would overwrite an input.
///
/// # Errors
/// [`Failure::Input`] that names both.
pub(super) fn refuse_input(name: &str, output: &Path, input: &Path) -> Result<(), Failure> {
    // Standard input may be a file.
    let is_stdin = recordings::log::is_stdin(input);
    let read = if is_stdin {
        Path::new("/dev/stdin")
    } else {
        input
    };
    match is_same(output, read) {
        false => Ok(()),
        true => Err(Failure::Input(format!(
            "{name} {}: would overwrite the input {}; name another file",
            output.display(),
            recordings::log::called(input)
        ))),
    }
}

fn is_path(argument: &Arg) -> bool {
    argument.get_value_parser().type_id() == TypeId::of::<PathBuf>()
}

/// The values of an argument that are files. Several outputs may go to `-` one after the other.
fn given(argument: &Arg, matches: &ArgMatches) -> Vec<Named> {
    let id = argument.get_id().to_string();
    let name = match argument.get_long() {
        Some(long) => format!("--{long}"),
        None => id.clone(),
    };
    // With --shard the output is the folder of the shard's file.
    let in_shards = matches
        .try_get_raw("shard")
        .is_ok_and(|part| part.is_some());
    let values = argument.get_value_names().unwrap_or_default();
    let is_file = !in_shards && values.iter().any(|value| value.starts_with("FILE"));
    let raw = matches.try_get_raw(&id).ok().flatten();
    let named = |value| Named {
        id: id.clone(),
        name: name.clone(),
        path: PathBuf::from(value),
        is_file,
    };
    raw.into_iter().flatten().map(named).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory as _;

    use super::super::arguments::Arguments;
    use super::*;

    #[test]
    fn every_path_of_a_command_is_an_input_or_an_output() {
        let mut root = Arguments::command();
        root.build();
        let arguments = root.get_subcommands().flat_map(Command::get_arguments);
        let ids = arguments.filter(|argument| is_path(argument));
        let ids: BTreeSet<_> = ids.map(|argument| argument.get_id().as_str()).collect();
        let inputs = [
            "data",
            "device",
            "fine",
            "image",
            "logs",
            "presets",
            "recording",
            "recordings",
            "shards",
            "stream",
            "trace",
        ];
        assert_eq!(ids, inputs.into_iter().chain(OUTPUTS).collect());
    }
}
