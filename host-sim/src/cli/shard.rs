//! Shards of the commands, and `host-sim merge`.

use std::path::{Path, PathBuf};

use clap::Args;

use report::version::VERSION;
use shards::file::{self, Run};
use shards::{Experiment, Part, Shards};
use terminal::failure::Failure;
use terminal::output::{Folder, print_bytes};

use super::line::with_outputs;
use super::page::{self, progress};
use super::{robust, sensitivity, tune, zwidth};

#[derive(Debug, Args)]
pub(super) struct Merge {
    /// All files that a command with --shard wrote for one run, in any order
    #[arg(value_name = "SHARD", required = true)]
    shards: Vec<PathBuf>,
    /// Output of the run, as --out of its command without --shard [default: that of the command]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the rows as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Part of an experiment, and outputs of its command.
#[derive(Debug, Args)]
pub(super) struct ShardOptions {
    /// Run only every Nth run from the Kth on, for example 1/4, and write a file for host-sim merge, no
    /// page and no verdict
    #[arg(long, value_name = "K/N", conflicts_with = "json")]
    shard: Option<Part>,
    /// Folder of index.html, its figures as SVG, the rows as CSV and JSON, or of the shard's file
    /// [default: the command's name in target; no folder with --json -]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the rows as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl ShardOptions {
    /// What the options ask of the command `run_line`, whose default folder is `usual`.
    pub(super) fn asked<'a>(
        &'a self,
        run_line: &'a str,
        usual: &'static str,
        doing: &'static str,
    ) -> Asked<'a> {
        Asked {
            outputs: Outputs {
                run_line,
                out: self.out.as_deref(),
                json: self.json.as_deref(),
            },
            part: self.shard,
            usual,
            doing,
        }
    }
}

/// Outputs of a whole run.
#[derive(Clone, Copy)]
pub(super) struct Outputs<'a> {
    /// Command line without outputs and part.
    pub(super) run_line: &'a str,
    /// Value of `--out`.
    pub(super) out: Option<&'a Path>,
    /// Value of `--json`.
    pub(super) json: Option<&'a Path>,
}

impl<'a> Outputs<'a> {
    /// Folder of the report, `usual` by default.
    pub(super) fn folder(&self, usual: &'static str) -> Result<Option<&'a Path>, Failure> {
        page::folder(self.out, self.json, usual)
    }

    /// Command line of the run without shards.
    pub(super) fn command_line(&self) -> String {
        with_outputs(self.run_line, self.out, self.json)
    }
}

/// A run of an experiment, or of a part of it.
pub(super) struct Asked<'a> {
    /// Outputs of a whole run.
    pub(super) outputs: Outputs<'a>,
    /// Value of `--shard`.
    pub(super) part: Option<Part>,
    /// Default folder of the report, and of a shard's file.
    pub(super) usual: &'static str,
    /// Text before the progress bar.
    pub(super) doing: &'static str,
}

impl Asked<'_> {
    /// Runs the part and writes its file, or runs the whole experiment and passes the rows to `finish`.
    pub(super) fn run<E: Experiment>(
        &self,
        experiment: &E,
        finish: impl FnOnce(&E, &[E::Row], Outputs<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Self {
            outputs,
            part,
            usual,
            doing,
        } = *self;
        if let Some(part) = part {
            let folder = outputs.out.unwrap_or(Path::new(usual));
            return run_part(experiment, part, outputs.run_line, folder, doing);
        }
        let jobs = experiment.jobs()?;
        // A folder that cannot be written is refused before a long run.
        outputs.folder(usual)?;
        finish(experiment, &rows(experiment, &jobs, doing)?, outputs)
    }
}

/// Runs a part of an experiment, writes its file to `folder` and prints the path of the file.
pub(super) fn run_part<E: Experiment>(
    experiment: &E,
    part: Part,
    run_line: &str,
    folder: &Path,
    doing: &'static str,
) -> Result<(), Failure> {
    Folder::check("--out", folder)?;
    let run = Run {
        version: VERSION,
        command: run_line,
    };
    let jobs = part.count(experiment.jobs()?.len());
    let bar = progress(jobs * E::STEPS_A_JOB, doing);
    let path = file::run_part(experiment, run, part, folder, &|| bar.inc(1))?;
    bar.finish_and_clear();
    print_bytes(format!("{}\n", path.display()).as_bytes())
}

/// Runs these jobs behind a progress bar.
pub(super) fn rows<E: Experiment>(
    experiment: &E,
    jobs: &[E::Job],
    doing: &'static str,
) -> Result<Vec<E::Row>, Failure> {
    let bar = progress(jobs.len() * E::STEPS_A_JOB, doing);
    let rows = experiment.rows(jobs, &|| bar.inc(1))?;
    bar.finish_and_clear();
    Ok(rows)
}

/// Merges shards: prints and writes what the command without `--shard` does.
pub(super) fn merge(options: &Merge) -> Result<(), Failure> {
    let shards = Shards::read(&options.shards, VERSION)?;
    let outputs = Outputs {
        run_line: shards.command(),
        out: options.out.as_deref(),
        json: options.json.as_deref(),
    };
    if let Some((settings, rows)) = shards.merge()? {
        return robust::finish(&settings, &rows, outputs);
    }
    if let Some((plan, cells)) = shards.merge()? {
        return sensitivity::finish(&plan, &cells, outputs);
    }
    if let Some((plan, boundaries)) = shards.merge()? {
        return zwidth::finish(&plan, &boundaries, outputs);
    }
    if let Some((plan, tuned)) = shards.merge()? {
        return tune::finish(&plan, &tuned, outputs);
    }
    if let Some((plan, tuned)) = shards.merge()? {
        return tune::finish_logs(&plan, &tuned, outputs);
    }
    let program = shards.shard_of();
    Err(Failure::Input(format!(
        "shards of {program}, which host-sim does not merge; merge them with {program} --merge"
    )))
}
