//! `host-sim coarsen`.

use std::fs;
use std::path::PathBuf;

use clap::Args;

use experiments::real::coarsen::Coarse;
use experiments::real::fine::{Fine, decompressed};
use experiments::real::sources::Source;
use recordings::arguments::DeviceFile;
use recordings::recording::counts_per_rev_line;
use terminal::failure::Failure;
use terminal::output::write_whole;

use recordings::log::{called, read};

#[derive(Debug, Args)]
pub(super) struct Coarsen {
    /// Recording of a fine encoder, CSV or gzip: the columns time_s (s) and fine_count, or t and
    /// counts_large; optional columns: motor_torque_nm (N.m), true_omega_rad_s or true_omega
    /// (rad/s); - is standard input
    #[arg(value_name = "FINE.csv")]
    fine: PathBuf,
    /// Counts per revolution of the coarse encoder, at most half of those of the fine one
    #[arg(long, value_name = "C", value_parser = clap::value_parser!(u32).range(16..=4_000_000))]
    counts_per_rev: u32,
    /// Counts per revolution of the fine encoder [default: those in the recordings.toml beside the
    /// file]
    #[arg(long, value_name = "F", value_parser = clap::value_parser!(u32).range(16..))]
    fine_counts_per_rev: Option<u32>,
    /// Rate of the coarse recording, 10 to 100000 Hz, at most that of the fine one
    #[arg(
        long,
        value_name = "HZ",
        default_value_t = 1000.0,
        allow_negative_numbers = true
    )]
    rate: f64,
    /// Position of the coarse encoder's boundaries, coarse counts
    #[arg(
        long,
        value_name = "COUNTS",
        default_value_t = 0.37,
        allow_negative_numbers = true
    )]
    phase: f64,
    /// Part of the recording that is used, s from its start [default: all]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    seconds: Option<f64>,
    /// The device's torque constant turns motor_torque_nm into the column current
    #[command(flatten)]
    device: DeviceFile,
    /// Write the recording to FILE, with its counts per revolution in a comment that the commands on
    /// recordings read; - is standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub(super) fn run(options: &Coarsen) -> Result<(), Failure> {
    let name = called(&options.fine);
    rate(options.rate)?;
    phase(options.phase)?;
    let seconds = options.seconds.map_or(Ok(f64::INFINITY), seconds)?;
    let known = match options.fine_counts_per_rev {
        None => Source::of(&options.fine)?.map(|source| source.counts_per_rev),
        given => given,
    };
    if options.fine.as_os_str() != "-"
        && let Err(error) = fs::metadata(&options.fine)
    {
        return Err(Failure::Input(format!("{name}: cannot read: {error}")));
    }
    let fine_counts_per_rev = known.ok_or_else(|| {
        Failure::Input(format!(
            "{name}: its counts per revolution are not known; give --fine-counts-per-rev, or list the \
             file in a recordings.toml beside it"
        ))
    })?;
    let coarse = Coarse {
        fine_counts_per_rev,
        counts_per_rev: options.counts_per_rev,
        rate_hz: options.rate,
        phase: options.phase,
        torque_constant: options.device.load()?.stages.large.torque_constant,
    };
    let text = decompressed(read(&options.fine)?, &name)?;
    let fine = Fine::parse(&text, &name, seconds)?;
    let mut text = counts_per_rev_line(coarse.counts_per_rev).into_bytes();
    text.extend(coarse.recording(&fine, &name)?.to_csv());
    write_whole(&options.out, &text)
}

/// A rate that a recording can have.
///
/// # Errors
/// [`Failure::Input`] that names the option.
pub(super) fn rate(hz: f64) -> Result<f64, Failure> {
    in_range("--rate", hz, [10.0, 1e5], "Hz")
}

/// A phase.
///
/// # Errors
/// As [`rate`].
pub(super) fn phase(counts: f64) -> Result<f64, Failure> {
    in_range("--phase", counts, [-1e6, 1e6], "counts")
}

/// A duration.
///
/// # Errors
/// As [`rate`].
pub(super) fn seconds(s: f64) -> Result<f64, Failure> {
    in_range("--seconds", s, [0.2, 1e5], "s")
}

/// A value of an option between two bounds.
///
/// # Errors
/// As [`rate`].
pub(super) fn in_range(
    option: &str,
    value: f64,
    [low, high]: [f64; 2],
    unit: &str,
) -> Result<f64, Failure> {
    match (low..=high).contains(&value) {
        true => Ok(value),
        false => Err(Failure::Input(format!(
            "{option} {value}: must be from {low} to {high} {unit}"
        ))),
    }
}
