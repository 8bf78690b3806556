//! `host-sim export`.

use std::path::{Path, PathBuf};

use clap::Args;

use catalogue::estimators::Setup;
use catalogue::parameters::PlantKind;
use estimator_core::Hertz;
use experiments::rates::EVERY_HZ;
use experiments::real::wanted::in_range;
use experiments::replay;
use recordings::arguments::{DeviceFile, RecordingOptions, Whole};
use recordings::recording::Recording;
use scoring::evaluation::Estimate;
use simulation::device::Device;
use simulation::trace::EDGE_CLOCK_HZ;
use terminal::failure::Failure;
use terminal::output::{note, write_whole};

use super::arguments::{ParameterOptions, kinds};
use super::replay::About;
use experiments::uneven::{Chosen, Recorded};
use recordings::log::Log;

#[derive(Debug, Args)]
pub(super) struct Export {
    /// Recording: CSV as for host-sim replay; - is standard input
    #[arg(value_name = "RECORDING.csv", required_unless_present_any = FOR_C)]
    recording: Option<PathBuf>,
    /// Estimator whose velocity the file has, see host-sim estimators; repeatable [default: all whose
    /// needed columns are present]. For C: the estimator whose parameters are written
    #[arg(long = "estimator", value_name = "NAME")]
    estimators: Vec<String>,
    #[command(flatten)]
    read: RecordingOptions,
    #[command(flatten)]
    device: DeviceFile,
    #[command(flatten)]
    parameters: ParameterOptions,
    /// Write the file to FILE; - is standard output
    #[arg(long, value_name = "FILE.mcap", required_unless_present_any = FOR_C)]
    mcap: Option<PathBuf>,
    /// Write the parameters of --estimator as a C constant for limpid.h, no recording is read
    #[arg(long, requires = "estimators", conflicts_with_all =
        ["recording", "mcap", "columns", "modulus", "row_rate", "drop_stale", "resample"])]
    c: bool,
    #[command(flatten)]
    design: Design,
}

/// Options that are given for C alone. Those without `--c` have an error of their own, [`Design::of_c`]: the parser
/// would ask for the arguments of both kinds of file.
const FOR_C: [&str; 5] = ["c", "rate", "edge_clock", "constant", "out"];

/// Default of `--rate`, Hz.
const RATE_HZ: f64 = 1e3;

/// What the parameters of --c are for.
#[derive(Debug, Args)]
struct Design {
    #[arg(long, value_name = "HZ", help = rate_help())]
    rate: Option<f64>,
    #[arg(long, value_name = "HZ", help = edge_clock_help())]
    edge_clock: Option<f64>,
    /// For C: name of the constant; the counts per revolution and the rate are NAME_COUNTS_PER_REV and
    /// NAME_RATE_HZ in capitals [default: limpid_ESTIMATOR_parameters, LIMPID_ESTIMATOR_RATE_HZ]
    #[arg(long, value_name = "NAME", value_parser = identifier)]
    constant: Option<String>,
    /// For C: write the header to FILE; - is standard output [default: -]
    #[arg(long, value_name = "FILE.h")]
    out: Option<PathBuf>,
}

impl Design {
    /// Refuses the options without `--c`.
    fn of_c(&self) -> Result<(), Failure> {
        let given = [
            ("--rate", self.rate.is_some()),
            ("--edge-clock", self.edge_clock.is_some()),
            ("--constant", self.constant.is_some()),
            ("--out", self.out.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((option, _)) => Err(Failure::Input(format!(
                "{option} is for the parameters in C; add --c, or leave it out: MCAP is written with --mcap FILE.mcap \
                 at the rate of the recording"
            ))),
        }
    }
}

/// Help text of `--rate`.
fn rate_help() -> String {
    let [lowest, highest] = EVERY_HZ;
    format!("For C: control rate, {lowest} to {highest} Hz [default: {RATE_HZ}]")
}

/// Help text of `--edge-clock`.
fn edge_clock_help() -> String {
    format!("For C: clock that stamps edges, Hz [default: {EDGE_CLOCK_HZ}]")
}

pub(super) fn run(options: &Export) -> Result<(), Failure> {
    if options.c {
        return header(options);
    }
    options.design.of_c()?;
    match (&options.recording, &options.mcap) {
        (Some(recording), Some(file)) => write_mcap(options, recording, file),
        // The parser asks for both.
        _ => Err(Failure::Input(
            "a recording and --mcap are needed".to_owned(),
        )),
    }
}

/// The parameters of one estimator in C.
fn header(options: &Export) -> Result<(), Failure> {
    let [kind] = kinds(&options.estimators)?[..] else {
        let message = "--c: one --estimator at a time, for each has a file of its own";
        return Err(Failure::Input(message.to_owned()));
    };
    let Design {
        rate,
        edge_clock,
        constant,
        out,
    } = &options.design;
    let rate = in_range("--rate", rate.unwrap_or(RATE_HZ), EVERY_HZ, "Hz")?;
    let edge_clock = edge_clock.unwrap_or(EDGE_CLOCK_HZ);
    // Also for an estimator that reads no stamps.
    if !(edge_clock > 0.0 && edge_clock.is_finite()) {
        return Err(Failure::Input(format!(
            "--edge-clock {edge_clock}: must be a number above 0, in Hz"
        )));
    }
    let mut device = options.device.load()?;
    if let Some(counts) = options.read.encoder.counts_per_rev {
        device.stages.large.counts_per_rev = counts;
    }
    let setup = Setup::of(&device, rate);
    let values = options
        .parameters
        .load(&[kind])?
        .values(kind, &setup, PlantKind::Friction);
    let header = kind.c(&setup, Hertz(edge_clock), &values, constant.as_deref())?;
    let out = out.as_deref().unwrap_or(Path::new("-"));
    write_whole(out, header.as_bytes())
}

/// Keywords of C23 and C++23 that begin with a letter, and the name that both give a meaning.
const RESERVED: &str = "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t \
    char8_t class co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue \
    decltype default delete do double dynamic_cast else enum explicit export extern false float for friend goto if \
    inline int long main mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public \
    register reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct \
    switch template this thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using \
    virtual void volatile wchar_t while xor xor_eq";

/// A name in C that is none of the language and none of limpid.h.
fn identifier(text: &str) -> Result<String, String> {
    let is_ours = text.to_ascii_lowercase().starts_with("limpid_");
    if is_ours || RESERVED.split_ascii_whitespace().any(|word| word == text) {
        return Err(format!(
            "{} has a meaning in {} already; take another name",
            text,
            if is_ours { "limpid.h" } else { "C or C++" }
        ));
    }
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    match text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(is_part) {
        true => Ok(text.to_owned()),
        false => Err("a name in C begins with a letter, and has letters, digits and _".to_owned()),
    }
}

fn write_mcap(options: &Export, recording: &Path, file: &Path) -> Result<(), Failure> {
    let kinds = kinds(&options.estimators)?;
    let parameters = options.parameters.load(&kinds)?;
    let log = Log::open(recording)?;
    let name = log.name();
    let Whole {
        recording,
        device,
        stated,
    } = options.read.whole(&log, &options.device)?;
    let recorded = Recorded::new(log.name(), &recording, &device, &parameters);
    let chosen = Chosen::new(&kinds, !options.estimators.is_empty(), &recorded)?;
    let replayed = replay::replay(
        &recording,
        name,
        &chosen.kinds,
        &device,
        &parameters,
        &|| (),
    )?;
    let bytes = mcap(&recording, &device, &replayed.estimates).map_err(Failure::Input)?;
    write_whole(file, &bytes)?;
    let about = About {
        notes: recording.notes.clone(),
        clock: chosen.notes(&recorded),
        left_out: &replayed.left_out,
        mismatched_presets: &replayed.mismatched_presets,
    };
    stated.iter().for_each(note);
    about.note(name);
    Ok(())
}

#[cfg(feature = "mcap")]
fn mcap(recording: &Recording, device: &Device, estimates: &[Estimate]) -> Result<Vec<u8>, String> {
    let names: Vec<_> = estimates
        .iter()
        .map(|estimate| estimate.estimator)
        .collect();
    let rows = channels::rows(recording, device, estimates);
    channels::mcap(rows.iter().map(Vec::as_slice), &names)
}

#[cfg(not(feature = "mcap"))]
fn mcap(_: &Recording, _: &Device, _: &[Estimate]) -> Result<Vec<u8>, String> {
    Err("MCAP needs a build with its writer: cargo export instead of cargo sim export".to_owned())
}
