//! `cargo stress`: every estimator over a long and hostile course, beside its f64 twin.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use measured::tables::{STRESS, STRESS_PARAMETERS, STRESS_SIGNALS};
use shards::file::{self, Run};
use shards::{Experiment as _, Part, Shards};
use simulation::simulate::RATES_HZ as RANGE_HZ;
use terminal::explain;
use terminal::failure::{Failure, ended};
use terminal::output::{Folder, check_place, is_stdout, print_bytes, write_whole};
use terminal::parse::parsed;
use terminal::wording::WIDTH;

use stress::experiment::{Row, Settings};
use stress::parts::build;
use stress::table;

/// Runs every estimator over a long course of extreme motions, in f32 beside its generated f64
/// twin.
///
/// The course has rest, top speed, ties of the quantiser, creep with 64 ticks between edges, an
/// edge at every tick, random 32-bit counts, currents that are not numbers, and wraps of both
/// counter widths. Every tick compares f32 with f64, the 16-bit counter with the 32-bit one, and
/// the covariance with its invariants. Some ticks compare the window with its definition in exact
/// fractions. After every stretch the time until the output is at rest is measured.
///
/// Further runs use signals of a simulated device, and parameters at the limits of their ranges.
/// Exit status 1 if a check fails. With UPDATE_GOLDEN=1 in the environment the documented tables
/// are written.
#[derive(Debug, Parser)]
#[command(
    name = "stress",
    bin_name = "cargo stress",
    version,
    max_term_width = WIDTH,
    after_help = "Examples:
  cargo stress --ticks 1e6 --rate 1000 --estimator foaw
  cargo stress --ticks 1e10 --shard 3/64
  cargo stress --merge target/stress/shard-*-of-64.jsonl"
)]
struct Arguments {
    /// Ticks per estimator and rate, 1 to 1e15; 1e9 takes more than an hour on two free cores
    #[arg(long, value_name = "N", default_value = "1e9", value_parser = ticks)]
    ticks: u64,
    #[arg(long = "rate", value_name = "HZ", default_values_t = RATES_HZ, value_parser = rate, help = rate_help())]
    rates: Vec<f64>,
    /// Run only estimators whose name begins with NAME [default: all]
    #[arg(long, value_name = "NAME")]
    estimator: Option<String>,
    /// Seed of the course
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Run only every Nth job from the Kth on, for example 1/4, and write a file for --merge, no tables
    /// and no verdict. A job is 1e8 ticks of an estimator at a rate, its signals of a device, or an
    /// estimator at the limits of its parameters
    #[arg(long, value_name = "K/N", conflicts_with_all = ["json", "markdown"])]
    shard: Option<Part>,
    /// Folder of the shard's file
    #[arg(
        long,
        value_name = "DIR",
        default_value = "target/stress",
        requires = "shard"
    )]
    out: PathBuf,
    /// Merge all files that --shard wrote for one run, in any order: print and write what the run
    /// without --shard does. The program is that which wrote them
    #[arg(long, value_name = "SHARD", num_args = 1.., conflicts_with_all =
        ["ticks", "rates", "estimator", "seed", "resume", "shard"])]
    merge: Vec<PathBuf>,
    /// Save finished parts in FILE, and skip parts that the same program has saved there
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Write the findings as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print the tables as Markdown
    #[arg(long)]
    markdown: bool,
}

/// Rates of the documented tables, Hz.
const RATES_HZ: [f64; 2] = [1000.0, 10_000.0];

/// A whole number of ticks, `1e9` allowed.
fn ticks(text: &str) -> Result<u64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if number.fract() == 0.0 && (1.0..=1e15).contains(&number) {
        Ok(number as u64)
    } else {
        Err("must be a whole number from 1 to 1e15".to_owned())
    }
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (RANGE_HZ.0..=RANGE_HZ.1).contains(&rate) => Ok(rate),
        _ => Err(format!("must be {} to {} Hz", RANGE_HZ.0, RANGE_HZ.1)),
    }
}

/// Help text of `--rate`.
fn rate_help() -> String {
    let (lowest, highest) = RANGE_HZ;
    format!("Control rate, {lowest} to {highest} Hz; repeatable")
}

fn main() -> ExitCode {
    ended(match parsed::<Arguments>(std::env::args_os()) {
        Ok(arguments) => run(&arguments),
        Err(error) => explain(&error, "cargo stress"),
    })
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let version = format!("{} (build {:016x})", env!("CARGO_PKG_VERSION"), build()?);
    if !arguments.merge.is_empty() {
        let shards = Shards::read(&arguments.merge, &version)?;
        let program = shards.shard_of();
        let other = || {
            let said =
                format!("shards of {program}, not of cargo stress; merge them with host-sim merge");
            Failure::Input(said)
        };
        let (settings, rows) = shards.merge::<Settings>()?.ok_or_else(other)?;
        return finish(arguments, &settings, rows);
    }
    let settings = Settings {
        ticks: arguments.ticks,
        rates_hz: arguments.rates.clone(),
        estimator: arguments.estimator.clone(),
        seed: arguments.seed,
        resume: arguments.resume.clone(),
    };
    is_documented(&settings)?;
    if let Some(path) = arguments.json.as_deref().filter(|path| !is_stdout(path)) {
        check_place(path)?;
    }
    if arguments.shard.is_some() {
        Folder::check("--out", &arguments.out)?;
    }
    let jobs = settings.jobs()?;
    let part = arguments.shard;
    let count = part.map_or(jobs.len(), |part| part.count(jobs.len()));
    let bar = ProgressBar::new(count as u64);
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} {eta} left");
    bar.set_style(style.map_err(|error| Failure::Input(error.to_string()))?);
    if let Some(part) = part {
        let run = Run {
            version: &version,
            command: &settings.command(),
        };
        let path = file::run_part(&settings, run, part, &arguments.out, &|| bar.inc(1))?;
        bar.finish_and_clear();
        return print_bytes(format!("{}\n", path.display()).as_bytes());
    }
    let rows = settings.rows(&jobs, &|| bar.inc(1))?;
    bar.finish_and_clear();
    finish(arguments, &settings, rows)
}

/// Refuses to write the documented tables from other settings than theirs.
fn is_documented(settings: &Settings) -> Result<(), Failure> {
    match measured::update() && (settings.estimator.is_some() || settings.rates_hz != RATES_HZ) {
        true => Err(Failure::Input("UPDATE_GOLDEN=1 writes all estimators at 1 and 10 kHz: leave out --estimator and --rate".to_owned())),
        false => Ok(()),
    }
}

/// Prints the tables and writes the outputs of all rows, whether they were run now or merged.
fn finish(arguments: &Arguments, settings: &Settings, rows: Vec<Row>) -> Result<(), Failure> {
    is_documented(settings)?;
    let results = settings.results(rows)?;
    let tables = [
        (STRESS, table::cells(&results.findings)),
        (STRESS_SIGNALS, table::signals(&results.differences)),
        (STRESS_PARAMETERS, table::sensitivity(&results.limits)),
    ];
    let [found, signals, ends] = tables
        .each_ref()
        .map(|(table, rows)| table.markdown(&[], rows));
    let found = if arguments.markdown {
        found
    } else {
        table::text(&results.findings)
    };
    let to_stdout = arguments.json.as_deref().is_some_and(is_stdout);
    if !to_stdout {
        // An estimator without parameters has no limits of them.
        let ends = match results.limits.is_empty() {
            true => String::new(),
            false => format!("\n{ends}"),
        };
        print_bytes(format!("{found}\n{signals}{ends}").as_bytes())?;
    }
    if measured::update() {
        for (table, rows) in &tables {
            table.write(&[], rows).map_err(Failure::Input)?;
        }
    }
    if let Some(path) = &arguments.json {
        let json = serde_json::to_vec_pretty(&results.findings);
        let json = json.map_err(|error| Failure::Input(error.to_string()))?;
        write_whole(path, &json)?;
    }
    let failed = results.findings.iter().filter(|one| !one.passed()).count()
        + results
            .limits
            .iter()
            .filter(|one| !one.broken.is_empty())
            .count();
    if failed > 0 {
        return Err(Failure::Check(format!("{failed} rows did not hold")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Arguments, explain, parsed};

    #[test]
    fn negative_number_is_told_with_its_option() {
        for (option, must) in [
            ("--ticks", "must be a whole number from 1 to 1e15"),
            ("--rate", "must be 100 to 100000 Hz"),
            ("--seed", "must be a whole number from 0 on"),
        ] {
            let line = ["stress", option, "-5"].map(Into::into);
            let error = parsed::<Arguments>(line).unwrap_err();
            let said = explain(&error, "cargo stress").unwrap_err().to_string();
            assert!(
                said.starts_with(&format!("invalid value '-5' for '{option} <")),
                "{said}"
            );
            assert!(said.contains(must), "{said}");
        }
    }
}
