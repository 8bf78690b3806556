//! `host-sim coarsen`.

use std::path::PathBuf;

use clap::Args;

use experiments::real::wanted::Wanted;
use recordings::arguments::{ColumnOptions, DeviceFile};
use recordings::log::called;
use recordings::recording::counts_per_rev_line;
use simulation::device::parsed_counts_per_rev;
use terminal::failure::Failure;
use terminal::output::{note, write_whole};

use super::rates::recording_rate_help;

#[derive(Debug, Args)]
pub(super) struct Coarsen {
    /// Recording of a fine encoder, as replay reads it: t or time_s (s), counts_large or fine_count,
    /// optional columns current (A) or motor_torque_nm (N.m), true_omega or true_omega_rad_s (rad/s);
    /// - is standard input
    #[arg(value_name = "FINE.csv")]
    fine: PathBuf,
    #[command(flatten)]
    columns: ColumnOptions,
    /// Counts per revolution of the coarse encoder, at most half of those of the fine one
    #[arg(long, value_name = "C", value_parser = parsed_counts_per_rev)]
    counts_per_rev: u32,
    /// Counts per revolution of the fine encoder [default: those in the recordings.toml beside the
    /// file, or those that the file states]
    #[arg(long, value_name = "F", value_parser = parsed_counts_per_rev)]
    fine_counts_per_rev: Option<u32>,
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, help = recording_rate_help(
        "Rate of the coarse recording", ", at most that of the fine one"))]
    rate: f64,
    /// Position of the coarse encoder's boundaries, coarse counts
    #[arg(long, value_name = "COUNTS", default_value_t = 0.37)]
    phase: f64,
    /// Part of the recording that is used, s from its start [default: all]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// The device's torque constant turns a torque into the column current
    #[command(flatten)]
    device: DeviceFile,
    /// Write the recording to FILE, with its counts per revolution in a comment that the commands on
    /// recordings read; - is standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub(super) fn run(options: &Coarsen) -> Result<(), Failure> {
    let wanted = Wanted {
        counts_per_rev: options.counts_per_rev,
        fine_counts_per_rev: options.fine_counts_per_rev,
        rate_hz: options.rate,
        phase: options.phase,
        seconds: options.seconds,
        columns: options.columns.clone(),
        device: options.device.load()?,
    };
    let recording = wanted.of_file(&options.fine)?;
    let mut text = counts_per_rev_line(options.counts_per_rev).into_bytes();
    text.extend(recording.to_csv());
    write_whole(&options.out, &text)?;
    let name = called(&options.fine);
    for line in &recording.notes {
        note(format_args!("{name}: {line}"));
    }
    Ok(())
}
