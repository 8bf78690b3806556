//! `host-sim decode`.

use std::path::PathBuf;

use clap::Args;

use experiments::real::wanted::rate;
use recordings::log::Log;
use recordings::recording::{Capture, counts_per_rev_line};
use simulation::device::parsed_counts_per_rev;
use terminal::failure::Failure;
use terminal::output::{note, write_whole};

use super::page::working;
use super::rates::recording_rate_help;

#[derive(Debug, Args)]
pub(super) struct Decode {
    /// Capture of the encoder's lines A and B, or of three Hall lines, by a logic analyser: CSV, where a row has
    /// the levels 0 or 1 of the lines from its time on, or VCD; - is standard input
    #[arg(value_name = "CAPTURE")]
    capture: PathBuf,
    /// Names or numbers of the columns of the lines; in the other order counts have the other sign
    /// [default: the only two columns that are no time]
    #[arg(long, num_args = 2, value_names = ["A", "B"])]
    lines: Option<Vec<String>>,
    /// Names or numbers of the columns of three Hall lines, a third of a period apart; in the other order
    /// counts have the other sign
    #[arg(long, num_args = 3, value_names = ["U", "V", "W"], conflicts_with = "lines")]
    hall: Option<Vec<String>>,
    /// Read the time from the column THEIRS: t='Time (us)', t=1:ns. Units: s, ms, us, ns [default: the
    /// column whose name begins with time]
    #[arg(long = "column", value_name = "t=THEIRS[:UNIT]")]
    columns: Vec<String>,
    /// Rate of the rows, for a capture with a row per sample and without a column of time
    #[arg(long, value_name = "HZ")]
    row_rate: Option<f64>,
    #[arg(long, value_name = "HZ", default_value_t = 1000.0,
        help = recording_rate_help("Rate of the recording", ""))]
    rate: f64,
    /// Counts per revolution of the encoder: four times its lines, or six times the pole pairs of Hall
    /// sensors, for a comment in the recording that
    /// the commands on recordings read
    #[arg(long, value_name = "N", value_parser = parsed_counts_per_rev)]
    counts_per_rev: Option<u32>,
    /// Write the recording to FILE, with the time of the latest edge; - is standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub(super) fn run(options: &Decode) -> Result<(), Failure> {
    let capture = Capture::new(
        &options.columns,
        options.lines.clone().or_else(|| options.hall.clone()),
        options.row_rate,
        rate(options.rate)?,
    )?;
    let log = Log::open(&options.capture)?;
    let bar = working("decoding");
    let decoded = capture.decode(log.reader()?, log.name());
    bar.finish_and_clear();
    let recording = decoded?;
    let stated = options.counts_per_rev.map(counts_per_rev_line);
    let mut text = stated.unwrap_or_default().into_bytes();
    text.extend(recording.to_csv());
    write_whole(&options.out, &text)?;
    let name = log.name();
    for line in &recording.notes {
        note(format_args!("{name}: {line}"));
    }
    Ok(())
}
