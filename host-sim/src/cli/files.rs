//! The files of a command line: an output that is an input, two outputs that are one file, a file that would
//! replace one of a report, a report that would replace a file of the user, and an output without a place are
//! refused before the command runs.

use std::any::TypeId;
use std::path::{Path, PathBuf};

use clap::{Arg, ArgMatches, Command};
use terminal::failure::Failure;
use terminal::output::{self, Folder, check_place, is_same, is_stdout, one_file};

use super::{compare, feel, robust, sensitivity, zwidth};

/// Options that name an output. All other paths are inputs.
const OUTPUTS: [&str; 5] = ["out", "json", "csv", "report", "mcap"];

/// The only output that may be an input: `identify --out` keeps the other keys of `--device`.
const KEPT: [&str; 3] = ["identify", "out", "device"];

/// A command that writes a report.
struct Report {
    command: &'static str,
    /// Its folder where none is given; `None` if no report is written then.
    usual: Option<&'static str>,
    /// Names of its files beside the figures.
    files: &'static [&'static str],
}

impl Report {
    const fn new(
        command: &'static str,
        usual: Option<&'static str>,
        files: &'static [&'static str],
    ) -> Self {
        Self {
            command,
            usual,
            files,
        }
    }
}

/// The commands that write reports.
const REPORTS: [Report; 8] = [
    Report::new(
        COMPARE,
        Some(compare::REPORT),
        &[
            "index.html",
            "scores.csv",
            "scores.json",
            "closed-loop.csv",
            "closed-loop.json",
        ],
    ),
    Report::new(
        "feel",
        Some(feel::PAGE),
        &["index.html", "feel.json", "causes.csv", "switched-off.csv"],
    ),
    Report::new("identify", None, &["index.html"]),
    Report::new("real", None, &["index.html", "real.csv", "real.json"]),
    Report::new("recommend", None, &["index.html"]),
    Report::new(
        "robust",
        Some(robust::REPORT),
        &["index.html", "summary.svg", "robust.csv", "robust.json"],
    ),
    Report::new(
        "sensitivity",
        Some(sensitivity::PAGE),
        &["index.html", "sensitivity.csv", "sensitivity.json"],
    ),
    Report::new(
        "zwidth",
        Some(zwidth::PAGE),
        &["index.html", "zwidth.csv", "zwidth.json"],
    ),
];

/// The command that runs where none is given.
const COMPARE: &str = "compare";

/// A path of the command line with the identifier of its argument and its name in messages.
struct Named {
    id: String,
    name: String,
    path: PathBuf,
    /// Whether it is a folder and no file.
    is_folder: bool,
    /// Whether it is the folder of a shard's file, and of no report.
    is_shard: bool,
}

/// Checks the paths of the command in `matches`.
///
/// # Errors
/// [`Failure::Input`] that names an output that is an input, two outputs that are one file, a file that may be
/// one of a report, or an output without a place.
pub(super) fn check(root: &Command, matches: &ArgMatches) -> Result<(), Failure> {
    let (name, matches) = matches.subcommand().unwrap_or((COMPARE, matches));
    let command = root.find_subcommand(name);
    let arguments = command.into_iter().flat_map(Command::get_arguments);
    let paths = arguments.filter(|argument| is_path(argument));
    let paths = paths.flat_map(|argument| given(argument, matches));
    let (mut outputs, inputs): (Vec<_>, Vec<_>) =
        paths.partition(|of| OUTPUTS.contains(&of.id.as_str()));
    // First, so that an option is named that is in its way.
    outputs.splice(0..0, usual_folder(name, matches));
    for (k, output) in outputs.iter().enumerate() {
        for input in &inputs {
            if [name, &output.id, &input.id] != KEPT {
                refuse_input(&output.name, &output.path, &input.path)?;
            }
        }
        let mut others = outputs[..k].iter();
        if let Some(other) = others.find(|other| is_same(&other.path, &output.path)) {
            return Err(one_file(&output.name, &output.path, &other.name));
        }
        for folder in outputs.iter().filter(|other| other.is_folder) {
            refuse_reported(output, folder)?;
        }
        // Of merge, the run of the shards decides whether its output is a file, and takes no time.
        match output.is_folder {
            _ if name == "merge" && output.id == "out" => {}
            true => check_folder(name, output)?,
            false if is_stdout(&output.path) => {}
            false => check_place(&output.path)?,
        }
    }
    Ok(())
}

/// The folder of the report of `command`, or of the file of a shard, where `--out` does not name one.
fn usual_folder(command: &str, matches: &ArgMatches) -> Option<Named> {
    let raw = |id| matches.try_get_raw(id).ok().flatten();
    let is_set = |id| matches!(matches.try_get_one::<bool>(id), Ok(Some(true)));
    let mut json = raw("json").into_iter().flatten();
    // The report of a single device is written only where it is asked for.
    let is_unwritten = is_set("no_report") || raw("only").is_some();
    if raw("out").is_some() || is_unwritten || json.any(|path| is_stdout(Path::new(path))) {
        return None;
    }
    let mut reports = REPORTS.iter();
    let report = reports.find(|report| report.command == command)?;
    Some(Named {
        id: "out".to_owned(),
        name: "the default --out".to_owned(),
        path: PathBuf::from(report.usual?),
        is_folder: true,
        is_shard: raw("shard").is_some(),
    })
}

/// Checks that the folder of an output has a place, and no file that the report of `command` would replace and
/// that is not of an earlier run.
fn check_folder(command: &str, output: &Named) -> Result<(), Failure> {
    Folder::check(&output.name, &output.path)?;
    if output.is_shard {
        return Ok(());
    }
    let reports = REPORTS.iter().filter(|report| report.command == command);
    let names = reports.flat_map(|report| report.files.iter().copied());
    Folder::check_files(&output.name, &output.path, names)
}

/// Refuses a file in the folder of a report that may replace a file of the report.
fn refuse_reported(file: &Named, folder: &Named) -> Result<(), Failure> {
    let above = file.path.parent().unwrap_or(Path::new(""));
    let above = if above.as_os_str().is_empty() {
        Path::new(".")
    } else {
        above
    };
    let stem = file.path.file_stem();
    let mut names = REPORTS.iter().flat_map(|report| report.files);
    let is_reported = names.any(|name| Path::new(name).file_stem() == stem);
    if file.is_folder || !is_reported || !is_same(above, &folder.path) {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{} {}: may be a file of {} {}; choose another name",
        file.name,
        file.path.display(),
        folder.name,
        folder.path.display()
    )))
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
    output::refuse_input(name, output, read, recordings::log::called(input))
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
    let raw = matches.try_get_raw(&id).ok().flatten();
    // A shard is a file in the folder of --out, also of a command whose --out is a file.
    let is_shard = id == "out" && matches!(matches.try_get_raw("shard"), Ok(Some(_)));
    let mut values = argument.get_value_names().unwrap_or_default().iter();
    let is_folder = is_shard || values.any(|name| name == "DIR");
    let named = |value| Named {
        id: id.clone(),
        name: name.clone(),
        path: PathBuf::from(value),
        is_folder,
        is_shard,
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
    fn every_file_of_a_report_is_known() {
        let mut paths: Vec<PathBuf> = vec![concat!(env!("CARGO_MANIFEST_DIR"), "/src/cli").into()];
        let mut names = BTreeSet::new();
        while let Some(path) = paths.pop() {
            if let Ok(folder) = std::fs::read_dir(&path) {
                paths.extend(folder.map(|entry| entry.unwrap().path()));
                continue;
            }
            let text = std::fs::read_to_string(path).unwrap();
            let calls = text.split(".add(\"").skip(1);
            let name = |call: &str| call.split('"').next().unwrap().to_owned();
            // The text of this test is no call.
            names.extend(calls.map(name).filter(|name| name.contains('.')));
        }
        let known = REPORTS.iter().flat_map(|report| report.files);
        let known: BTreeSet<_> = known.map(|name| (*name).to_owned()).collect();
        assert_eq!(names, known);
    }

    #[test]
    fn every_path_of_a_command_is_an_input_or_an_output() {
        let mut root = Arguments::command();
        root.build();
        let arguments = root.get_subcommands().flat_map(Command::get_arguments);
        let ids = arguments.filter(|argument| is_path(argument));
        let ids: BTreeSet<_> = ids.map(|argument| argument.get_id().as_str()).collect();
        let inputs = [
            "capture",
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
