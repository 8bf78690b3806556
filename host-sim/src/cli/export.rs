//! `host-sim export`.

use std::path::PathBuf;

use clap::Args;

use experiments::replay;
use recordings::arguments::{DeviceFile, RecordingOptions, Whole};
use recordings::recording::{BoardColumns, Recording};
use scoring::evaluation::Estimate;
use simulation::device::Device;
use terminal::failure::Failure;
use terminal::output::{note, write_whole};

use super::arguments::{ParameterOptions, kinds};
use super::replay::About;
use super::uneven::Chosen;
use recordings::log::{Log, short_name};

#[derive(Debug, Args)]
pub(super) struct Export {
    /// Recording: CSV as for host-sim replay; - is standard input
    #[arg(value_name = "RECORDING.csv")]
    recording: PathBuf,
    /// Estimator whose velocity the file has, see host-sim estimators; repeatable [default: all whose
    /// needed columns are present]
    #[arg(long = "estimator", value_name = "NAME")]
    estimators: Vec<String>,
    #[command(flatten)]
    read: RecordingOptions,
    #[command(flatten)]
    device: DeviceFile,
    #[command(flatten)]
    parameters: ParameterOptions,
    /// Write the file to FILE; - is standard output
    #[arg(long, value_name = "FILE.mcap")]
    mcap: PathBuf,
}

pub(super) fn run(options: &Export) -> Result<(), Failure> {
    let kinds = kinds(&options.estimators)?;
    let parameters = options.parameters.load()?;
    let name = short_name(&options.recording);
    let log = Log::open(&options.recording)?;
    let path = log.name();
    let Whole {
        recording,
        board,
        device,
        stated,
    } = options.read.whole(&log, &options.device)?;
    let uneven = recording.unevenness();
    let chosen = Chosen::new(
        &kinds,
        !options.estimators.is_empty(),
        &recording.trace,
        path,
        uneven.as_deref(),
    )?;
    let replayed = replay::replay(
        &recording,
        &name,
        &chosen.kinds,
        &device,
        &parameters,
        || (),
    )?;
    let bytes = mcap(&recording, &board, &device, &replayed.estimates).map_err(Failure::Input)?;
    write_whole(&options.mcap, &bytes)?;
    let about = About {
        notes: recording.notes.clone(),
        uneven: uneven.map(|uneven| chosen.note(&recording.trace, &uneven)),
        left_out: &replayed.left_out,
        mismatched_presets: &replayed.mismatched_presets,
    };
    stated.iter().for_each(note);
    about.note(&name);
    Ok(())
}

#[cfg(feature = "mcap")]
fn mcap(
    recording: &Recording,
    board: &BoardColumns,
    device: &Device,
    estimates: &[Estimate],
) -> Result<Vec<u8>, String> {
    let names: Vec<_> = estimates
        .iter()
        .map(|estimate| estimate.estimator)
        .collect();
    let rows = channels::rows(recording, board, device, estimates);
    channels::mcap(rows.iter().map(Vec::as_slice), &names)
}

#[cfg(not(feature = "mcap"))]
fn mcap(_: &Recording, _: &BoardColumns, _: &Device, _: &[Estimate]) -> Result<Vec<u8>, String> {
    Err("MCAP needs a build with its writer: cargo export instead of cargo sim export".to_owned())
}
