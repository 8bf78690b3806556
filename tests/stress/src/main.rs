//! `cargo stress`: every estimator over a long and hostile course, beside its f64 twin.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use measured::tables::{STRESS, STRESS_PARAMETERS, STRESS_SIGNALS};
use rayon::prelude::*;
use terminal::explain;
use terminal::failure::{Failure, ended};
use terminal::output::{print_bytes, write_whole};
use terminal::wording::WIDTH;

use stress::parts::Plan;
use stress::tested::{TestedEstimator, at};
use stress::{sensitivity, signals, table};

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
    after_help = "Example:\n  cargo stress --ticks 1e6 --rate 1000 --estimator foaw"
)]
struct Arguments {
    /// Ticks per estimator and rate, 1 to 1e15; 1e9 takes 20 minutes on two free cores
    #[arg(long, value_name = "N", default_value = "1e9", value_parser = ticks)]
    ticks: u64,
    /// Control rate, 100 to 100000 Hz; repeatable
    #[arg(long = "rate", value_name = "HZ", default_values_t = RATES_HZ, value_parser = rate)]
    rates: Vec<f64>,
    /// Run only estimators whose name begins with NAME [default: all]
    #[arg(long, value_name = "NAME")]
    estimator: Option<String>,
    /// Seed of the course
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Save finished parts in FILE, and skip parts that the same program has saved there
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Write the findings as JSON to FILE
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
        Ok(rate) if (100.0..=100_000.0).contains(&rate) => Ok(rate),
        _ => Err("must be 100 to 100000 Hz".to_owned()),
    }
}

fn main() -> ExitCode {
    ended(match Arguments::try_parse() {
        Ok(arguments) => run(&arguments),
        Err(error) => explain(&error, "cargo stress"),
    })
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let golden = measured::update();
    if golden && (arguments.estimator.is_some() || arguments.rates != RATES_HZ) {
        return Err(Failure::Input("UPDATE_GOLDEN=1 writes all estimators at 1 and 10 kHz: leave out --estimator and --rate".to_owned()));
    }
    let tested_estimators = tested_estimators(arguments)?;
    let bar = ProgressBar::new(
        arguments
            .ticks
            .saturating_mul(tested_estimators.len() as u64),
    );
    let style = ProgressStyle::with_template("{bar:40} {percent}% of the ticks, {eta} left");
    bar.set_style(style.map_err(|error| Failure::Input(error.to_string()))?);
    let plan = Plan {
        seed: arguments.seed,
        ticks: arguments.ticks,
    };
    let all = plan
        .run(&tested_estimators, arguments.resume.as_deref(), |n| {
            bar.inc(n);
        })
        .map_err(Failure::Input)?;
    bar.finish_and_clear();
    let device: Vec<_> = differences(&tested_estimators, arguments);
    let extremes = sensitivity::all();
    let tables = [
        (STRESS, table::cells(&all)),
        (STRESS_SIGNALS, table::signals(&device)),
        (STRESS_PARAMETERS, table::sensitivity(&extremes)),
    ];
    let [found, signals, ends] = tables
        .each_ref()
        .map(|(table, rows)| table.markdown(&[], rows));
    let found = if arguments.markdown {
        found
    } else {
        table::text(&all)
    };
    print_bytes(format!("{found}\n{signals}\n{ends}").as_bytes())?;
    if golden {
        for (table, rows) in &tables {
            table.write(&[], rows).map_err(Failure::Input)?;
        }
    }
    if let Some(path) = &arguments.json {
        let json = serde_json::to_vec_pretty(&all);
        let json = json.map_err(|error| Failure::Input(error.to_string()))?;
        write_whole(path, &json)?;
    }
    let failed = all.iter().filter(|one| !one.passed()).count()
        + extremes.iter().filter(|one| !one.broken.is_empty()).count();
    if failed > 0 {
        return Err(Failure::Check(format!("{failed} rows above did not hold")));
    }
    Ok(())
}

/// Error by f32 of each estimator on a device's signals.
fn differences(
    tested_estimators: &[TestedEstimator],
    arguments: &Arguments,
) -> Vec<signals::Difference> {
    let mut all = Vec::new();
    for rate in &arguments.rates {
        let scenarios = signals::at(*rate, arguments.seed);
        let same_rate = tested_estimators
            .par_iter()
            .filter(|one| one.rate_hz.to_bits() == rate.to_bits());
        all.par_extend(same_rate.map(|one| signals::difference(one, &scenarios)));
    }
    all
}

fn tested_estimators(arguments: &Arguments) -> Result<Vec<TestedEstimator>, Failure> {
    let mut all: Vec<TestedEstimator> = arguments.rates.iter().flat_map(|rate| at(*rate)).collect();
    if let Some(wanted) = &arguments.estimator {
        let names: Vec<String> = at(arguments.rates[0]).into_iter().map(|c| c.name).collect();
        all.retain(|tested| tested.name.starts_with(wanted));
        if all.is_empty() {
            return Err(Failure::Input(format!(
                "--estimator {wanted}: no such estimator; there are {}",
                names.join(", ")
            )));
        }
    }
    Ok(all)
}
