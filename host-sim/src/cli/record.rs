//! `host-sim record`.

use std::path::{Path, PathBuf};

use clap::Args;

use recordings::record::{choose, csv, report};
use recordings::telemetry::Telemetry;
use terminal::failure::Failure;
use terminal::output::{note, write_whole};

use recordings::log::{called, read};

#[derive(Debug, Args)]
pub(super) struct Record {
    /// Log that cargo firmware prints, or with --image the raw bytes of RTT channel 0; - is
    /// standard input
    #[arg(value_name = "STREAM", default_value = "-")]
    pub(super) stream: PathBuf,
    /// Firmware image that sent the raw bytes; needs cargo record instead of cargo sim record
    #[arg(long, value_name = "ELF")]
    pub(super) image: Option<PathBuf>,
    /// Control rate, 1 to 1e6 Hz [default: from the boot line of the stream]
    #[arg(long, value_name = "HZ")]
    pub(super) rate: Option<f64>,
    /// Number of the firmware's start to record, 1 is the first in the stream [default: the start
    /// with the most frames]
    #[arg(long, value_name = "N")]
    pub(super) run: Option<usize>,
    /// Write the recording to FILE; - is standard output [default: -]
    #[arg(long, value_name = "FILE.csv")]
    pub(super) out: Option<PathBuf>,
}

pub(super) fn run(options: &Record) -> Result<(), Failure> {
    let name = called(&options.stream);
    let failure = |said: &str| Failure::Input(format!("{name}: {said}"));
    let bytes = read(&options.stream)?;
    let telemetry = match &options.image {
        None => Telemetry::text(&bytes),
        Some(path) => {
            let elf = std::fs::read(path).map_err(|error| {
                let path = path.display();
                Failure::Input(format!("{path}: cannot read: {error}; give the ELF file"))
            })?;
            decode(&elf, &bytes)
                .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?
        }
    };
    if telemetry.frames.is_empty() {
        let hint = match options.image {
            None => "a log of cargo firmware is expected; give --image for raw RTT bytes",
            Some(_) => "raw RTT bytes of --image are expected; leave out --image for a log",
        };
        return Err(failure(&format!("no telemetry frame; {hint}")));
    }
    let runs = telemetry.runs();
    let run = choose(&runs, options.run).map_err(|error| failure(&error.to_string()))?;
    let rate_hz = match (options.rate, run.rate_hz()) {
        (Some(given), Some(said)) if given != said => {
            let said = format!("its boot line says rate={said}; leave out --rate {given}");
            return Err(failure(&said));
        }
        (Some(rate), _) | (None, Some(rate)) => rate,
        (None, None) => {
            let said =
                "it begins after the boot line; give the control rate, for example --rate 10000";
            return Err(failure(said));
        }
    };
    if !(1.0..=1e6).contains(&rate_hz) {
        return Err(failure(&format!(
            "a control rate of {rate_hz} Hz; give 1 to 1e6"
        )));
    }
    let text = csv(run, rate_hz, |_| None);
    let out = options.out.as_deref().unwrap_or(Path::new("-"));
    write_whole(out, text.as_bytes())?;
    for line in report(&telemetry, &runs, run, " (--run N selects another)") {
        note(format_args!("{name}: {line}"));
    }
    Ok(())
}

#[cfg(feature = "rtt")]
fn decode(elf: &[u8], bytes: &[u8]) -> Result<Telemetry, String> {
    rtt::decode(elf, bytes)
}

#[cfg(not(feature = "rtt"))]
fn decode(_: &[u8], _: &[u8]) -> Result<Telemetry, String> {
    Err("raw bytes need a build with the decoder: cargo record instead of cargo sim record".into())
}
