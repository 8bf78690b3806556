//! The command line.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Parser;
use experiments::closed_loop::Hand;
use haptic_control::SceneKind;
use indicatif::{ProgressBar, ProgressStyle};
use simulation::device::Device;
use terminal::failure::Failure;
use terminal::output::{print_bytes, write_whole};

use crate::budget;
use crate::command::Command;
use crate::fault::Fault;
use crate::image::{HOW_TO_BUILD, Image};
use crate::run::{Setup, on_board};
use crate::scene;
use crate::summary::summary;

/// Where cargo puts the image.
const IMAGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../target/thumbv7em-none-eabihf/firmware/firmware"
);

/// Runs the firmware image on an emulated board, in closed loop with the simulated device, and
/// prints what the image logged, what its control task costs, and the force that the hand feels and
/// the scene does not ask for. Exit status: 0; 1 if the control task never ran or if the image did
/// what the emulator does not model; 2 if the input cannot be used.
#[derive(Debug, Parser)]
#[command(name = "cargo board", bin_name = "cargo board", version, after_help = after_help())]
struct Arguments {
    /// Scene that the image is told to render
    #[arg(long, default_value = "free-air", value_parser = scene::named)]
    scene: SceneKind,
    /// Sets a parameter of the scene at S seconds, as stiffness=0.2@1.5; the set-point of the scene
    /// torque is torque=0.01@1; may be given more than once
    #[arg(long, value_name = "NAME=VALUE@S", value_parser = timed::<String>)]
    tune: Vec<(f64, String)>,
    /// Gives the large motor another estimator, by its number, at S seconds, as 1@1.5; may be given
    /// more than once
    #[arg(long, value_name = "NUMBER@S", value_parser = timed::<Number>)]
    estimator: Vec<(f64, Number)>,
    /// Hand on the handle: moving; pushing, into the wall and back; still; tracking, chirps and
    /// reversals; pressing, once with 10 N
    #[arg(long, default_value = "moving", value_parser = holder)]
    hand: Holder,
    /// Virtual seconds, more than 0, at most 3600
    #[arg(long, default_value_t = 3.0)]
    seconds: f64,
    /// Seed of the hand's motion and the encoders' phases
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Codes that both DAC outputs are too high by, -100 to 100
    #[arg(long, value_name = "CODES", default_value_t = 0, allow_negative_numbers = true,
        value_parser = clap::value_parser!(i16).range(-100..=100))]
    dac_offset: i16,
    /// A fault of the list below that begins at S seconds, as stuck-a@0.5; may be given more than
    /// once
    #[arg(long, value_name = "NAME@S", value_parser = timed::<Fault>)]
    fault: Vec<(f64, Fault)>,
    /// Device file, as host-sim identify writes it: the device that the image drives
    #[arg(long, value_name = "FILE.toml")]
    device: Option<PathBuf>,
    /// ELF file of the image [default: the one that the command below builds]
    #[arg(long)]
    image: Option<PathBuf>,
    /// Writes the image's telemetry as a recording for `cargo sim replay`
    #[arg(long, value_name = "FILE.csv")]
    record: Option<PathBuf>,
    /// Writes the bytes that the debug probe took from RTT channel 0, for `cargo sim record --image`
    #[arg(long, value_name = "FILE")]
    rtt: Option<PathBuf>,
    /// Prints what a control tick costs in every scene instead, each run for --seconds, at most 1:
    /// instructions, estimated cycles, and the control rate at which ticks take half of the core
    #[arg(long, conflicts_with_all = ["device", "scene", "hand", "fault", "record", "rtt", "tune", "estimator", "dac_offset"])]
    budget: bool,
}

/// The faults, and examples.
fn after_help() -> String {
    let mut text = "Faults:\n".to_owned();
    for fault in Fault::all() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<23}{}", fault.as_str(), fault.description());
    }
    format!(
        "{text}\nBuild the image first:\n  {HOW_TO_BUILD}\n\n\
        Examples:\n  \
        cargo board --scene wall --hand pushing --record wall.csv\n  \
        cargo board --fault swapped@0.5 --seconds 1\n  \
        cargo board --budget"
    )
}

/// A hand on the handle; how far a press goes depends on the scene.
#[derive(Clone, Copy, Debug)]
enum Holder {
    Hand(Hand),
    Pressing,
}

fn holder(name: &str) -> Result<Holder, String> {
    Ok(match name {
        "moving" => Holder::Hand(Hand::Moving),
        "pushing" => Holder::Hand(Hand::Pushing),
        "still" => Holder::Hand(Hand::Still),
        "tracking" => Holder::Hand(Hand::Tracking),
        "pressing" => Holder::Pressing,
        _ => {
            return Err(format!(
                "no hand '{name}'; there are moving, pushing, still, tracking, pressing"
            ));
        }
    })
}

/// Number of an estimator.
#[derive(Clone, Copy, Debug)]
struct Number(u8);

impl std::str::FromStr for Number {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.parse().map(Self);
        number.map_err(|_| format!("'{text}' is no number of an estimator, 0 to 255"))
    }
}

/// What is to happen, and when, s.
fn timed<T: std::str::FromStr<Err: std::fmt::Display>>(text: &str) -> Result<(f64, T), String> {
    let (what, at) = text
        .rsplit_once('@')
        .ok_or("the instant is missing: @ and seconds at the end, as @1.5")?;
    let what = what.parse().map_err(|error: T::Err| error.to_string())?;
    match at.parse() {
        Ok(at) if (0.0..=3600.0).contains(&at) => Ok((at, what)),
        _ => Err(format!("'{at}' is no instant in seconds, 0 to 3600")),
    }
}

/// Runs the command line `arguments`, the program's name first.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return terminal::explain(&error, "cargo board"),
    };
    if !(arguments.seconds > 0.0 && arguments.seconds <= 3600.0) {
        let message = format!(
            "--seconds {}: give more than 0, at most 3600",
            arguments.seconds
        );
        return Err(Failure::Input(message));
    }
    let path = arguments
        .image
        .clone()
        .unwrap_or_else(|| PathBuf::from(IMAGE));
    let scene = arguments.scene;
    let mut commands = vec![(0.05, Command::Scene(scene)), (0.1, Command::Arm)];
    for (at, what) in &arguments.tune {
        commands.push((*at, scene::tune(scene, what)?));
    }
    let choices = arguments.estimator.iter();
    commands.extend(choices.map(|(at, number)| (*at, Command::Estimator(number.0))));
    if !arguments.budget {
        in_time(&arguments)?;
    }
    let image = Image::read(&path)?;
    if arguments.budget {
        let table = budget::table(&image, arguments.seconds.min(1.0), arguments.seed)?;
        return print_bytes(table.as_bytes());
    }
    let device = arguments
        .device
        .as_deref()
        .map_or_else(|| Ok(Device::default()), Device::read)?;
    let setup = Setup {
        hand: match arguments.hand {
            Holder::Hand(hand) => hand,
            Holder::Pressing => scene::press(scene, &device),
        },
        device,
        seed: arguments.seed,
        seconds: arguments.seconds,
        faults: arguments.fault.clone(),
        commands,
        dac_offset: arguments.dac_offset,
        ..Setup::default()
    };
    let outcome = on_board(&image, &setup, bar(setup.seconds))?;
    print_bytes(summary(scene, &setup, &outcome).as_bytes())?;
    if let Some(path) = &arguments.record {
        write_whole(path, outcome.csv()?.as_bytes())?;
    }
    if let Some(path) = &arguments.rtt {
        write_whole(path, &outcome.rtt)?;
    }
    if outcome.ticks.is_empty() {
        return Err(Failure::Check("the control task never ran".to_owned()));
    }
    outcome.check()
}

/// Refuses what would happen behind the end of the run.
fn in_time(arguments: &Arguments) -> Result<(), Failure> {
    let end = arguments.seconds;
    let faults = arguments.fault.iter();
    let faults = faults.map(|(at, fault)| ("fault", *at, fault.as_str().to_owned()));
    let tunes = arguments.tune.iter();
    let tunes = tunes.map(|(at, what)| ("tune", *at, what.clone()));
    let estimators = arguments.estimator.iter();
    let estimators = estimators.map(|(at, number)| ("estimator", *at, number.0.to_string()));
    let late = faults
        .chain(tunes)
        .chain(estimators)
        .find(|(_, at, _)| *at > end);
    late.map_or(Ok(()), |(option, at, what)| {
        let what = format!("--{option} {what}@{at}: the run ends at {end} s");
        Err(Failure::Input(format!("{what}; give --seconds more")))
    })
}

/// A progress bar over virtual time; it shows only on a terminal.
fn bar(seconds: f64) -> impl FnMut(f64) + Send + 'static {
    let bar = ProgressBar::new((seconds * 1e3) as u64);
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} ms of virtual time, {eta}");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    move |t| {
        bar.set_position((t * 1e3) as u64);
        if t >= seconds {
            bar.finish_and_clear();
        }
    }
}
