//! The command line.

mod checks;
#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use drive::named::scenes;
use drive::port::TCP;
use drivers::Settings;
use experiments::closed_loop::Hand;
use haptic_control::SceneKind;
use indicatif::{ProgressBar, ProgressStyle};
use simulation::device::Device;
use terminal::failure::Failure;
use terminal::output::{note, print_bytes, write_whole};
use terminal::parse::parsed;
use terminal::wording::WIDTH;

use self::checks::{has_stdout, in_bounds, in_place, in_time, taken};
use crate::bridge::{Bridge, LAG_S, Pace};
use crate::budget;
use crate::command::Command;
use crate::fault::Fault;
use crate::image::{HOW_TO_BUILD, Image};
use crate::run::{DacError, Setup, on_board};
use crate::scene;
use crate::summary::summary;

/// Path of the image that the documented build command writes.
const IMAGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../target/thumbv7em-none-eabihf/firmware/firmware"
);

/// Runs the firmware image on an emulated board in closed loop with the simulated device. Prints the
/// log of the image, the cost of its control task, and the parasitic force on the hand.
///
/// Exit status: 0; 1 if the control task never ran, the image used hardware that the emulator does not
/// model or refused a command, or the firmware started again while it was recorded; 2 if the input cannot
/// be used.
#[derive(Debug, Parser)]
#[command(
    name = "cargo board",
    bin_name = "cargo board",
    version,
    max_term_width = WIDTH,
    after_help = after_help()
)]
struct Arguments {
    /// Scene to select, of the list below
    #[arg(long, value_name = "NAME", default_value = "free-air", value_parser = scene::named)]
    scene: SceneKind,
    /// Set a parameter of the scene, of the list below, at S seconds, for example stiffness=0.2@1.5, or the
    /// set-point of scene torque: torque=0.01@1; repeatable
    #[arg(long, value_name = "NAME=VALUE@S", value_parser = timed::<String>)]
    tune: Vec<(f64, String)>,
    /// Select the large motor's estimator by its number, 0 to 255, at S seconds, for example 1@1.5;
    /// repeatable
    #[arg(long, value_name = "NUMBER@S", value_parser = timed::<Number>)]
    estimator: Vec<(f64, Number)>,
    /// Hand on the handle: moving; pushing (into the wall and back); still; tracking (chirps and
    /// reversals); pressing (once with 10 N); none (a free handle) [default: moving; none with --blank]
    #[arg(long, value_name = "NAME", value_parser = holder)]
    hand: Option<HandChoice>,
    /// Virtual duration, above 0, at most 3600 s [default: 3; 3600 with --link]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Seed of the hand's motion and of the encoders' phases
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Offset of both DAC outputs, -100 to 100 codes
    #[arg(long, value_name = "CODES", default_value_t = 0,
        value_parser = clap::value_parser!(i16).range(-100..=100))]
    dac_offset: i16,
    /// Erased flash, as before the bring-up: current limits at 10 %, no scene in closed loop [default: the
    /// settings of a board after its bring-up]
    #[arg(long)]
    blank: bool,
    /// Inject a fault of the list below at S seconds, for example stuck-a@0.5; repeatable
    #[arg(long, value_name = "NAME@S", value_parser = timed::<Fault>)]
    fault: Vec<(f64, Fault)>,
    /// Device file of the simulated device, as host-sim identify writes it [default: the default
    /// device]
    #[arg(long, value_name = "FILE.toml")]
    device: Option<PathBuf>,
    /// ELF file of the image [default: the file that the build command below writes]
    #[arg(long, value_name = "ELF")]
    image: Option<PathBuf>,
    /// Write the image's telemetry as a recording for cargo sim replay; - is standard output, and the log and
    /// the scores go to standard error
    #[arg(long, value_name = "FILE.csv")]
    record: Option<PathBuf>,
    /// Write the bytes of RTT channel 0, for cargo sim record --image
    #[arg(long, value_name = "FILE")]
    rtt: Option<PathBuf>,
    /// Write every access to peripherals, exception and access of the debug probe, for
    /// tests/second-core
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Serve the board's serial port over TCP at this port of 127.0.0.1, 0 for a free one, in real
    /// time; print the address. The client commands the board. One client at a time
    #[arg(long, value_name = "PORT", conflicts_with_all = ["scene", "tune", "estimator", "record", "rtt", "trace", "budget"])]
    link: Option<u16>,
    /// Print only the cost of a control tick in every scene, each run for --seconds, at most 1 s:
    /// instructions, estimated cycles, the control rate at which the ticks use half of the
    /// processor's time, lines of 16 bytes of flash that a tick executes, and estimated cycles in which
    /// it waits for them, which are not in the estimated cycles
    #[arg(long, conflicts_with_all = ["device", "scene", "hand", "fault", "record", "rtt", "trace", "tune", "estimator", "dac_offset", "blank"])]
    budget: bool,
}

/// Longest run, s.
const LONGEST_S: f64 = 3600.0;

impl Arguments {
    /// Virtual duration, s.
    fn seconds(&self) -> f64 {
        let usual = if self.link.is_some() { LONGEST_S } else { 3.0 };
        self.seconds.unwrap_or(usual)
    }

    /// The hand. A board before its bring-up has a handle that is left free.
    fn hand(&self, device: &Device) -> Hand {
        match self.hand {
            Some(HandChoice::Hand(hand)) => hand,
            Some(HandChoice::Pressing) => scene::press(self.scene, device),
            None if self.blank => Hand::Gone(0.0),
            None => Hand::Moving,
        }
    }
}

/// The lists of scenes and faults, the build command, and examples.
fn after_help() -> String {
    let mut text = format!("Scenes and their parameters:\n{}\nFaults:\n", scenes());
    for fault in Fault::all() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<23}{}", fault.as_str(), fault.description());
    }
    format!(
        "{text}\nBuild the image first:\n  {HOW_TO_BUILD}\n\n\
        Examples:\n  \
        cargo board --scene wall --hand pushing --record wall.csv\n  \
        cargo board --fault swapped@0.5 --seconds 1\n  \
        cargo board --link 0\n  \
        cargo board --budget"
    )
}

/// Hand on the handle. The depth of a press depends on the scene.
#[derive(Clone, Copy, Debug)]
enum HandChoice {
    Hand(Hand),
    Pressing,
}

fn holder(name: &str) -> Result<HandChoice, String> {
    Ok(match name {
        "moving" => HandChoice::Hand(Hand::Moving),
        "pushing" => HandChoice::Hand(Hand::Pushing),
        "still" => HandChoice::Hand(Hand::Still),
        "tracking" => HandChoice::Hand(Hand::Tracking),
        "pressing" => HandChoice::Pressing,
        "none" => HandChoice::Hand(Hand::Gone(0.0)),
        _ => {
            return Err(format!(
                "no hand '{name}'; choose moving, pushing, still, tracking, pressing or none"
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
        number.map_err(|_| format!("'{text}' is not the number of an estimator; give 0 to 255"))
    }
}

/// Parses `VALUE@S` to the time in s and the value.
fn timed<T: std::str::FromStr<Err: std::fmt::Display>>(text: &str) -> Result<(f64, T), String> {
    let (what, at) = text
        .rsplit_once('@')
        .ok_or("no time; append @ and the time in seconds, for example @1.5")?;
    let what = what.parse().map_err(|error: T::Err| error.to_string())?;
    match at.parse() {
        Ok(at) if (0.0..=3600.0).contains(&at) => Ok((at, what)),
        _ => Err(format!("'{at}' is not a time; give 0 to 3600 s")),
    }
}

/// Runs the command line `arguments`, the program's name first.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = match parsed::<Arguments>(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return terminal::explain(&error, "cargo board"),
    };
    let seconds = arguments.seconds();
    if !(seconds > 0.0 && seconds <= LONGEST_S) {
        let message = format!("--seconds {seconds}: must be above 0 and at most {LONGEST_S} s");
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
    in_place(&arguments, &path)?;
    let image = Image::read(&path)?;
    in_bounds(&arguments, &image)?;
    if arguments.budget {
        let table = budget::table(&image, seconds.min(1.0), arguments.seed)?;
        return print_bytes(table.as_bytes());
    }
    let device = arguments
        .device
        .as_deref()
        .map_or_else(|| Ok(Device::default()), Device::read_to_simulate)?;
    let setup = Setup {
        hand: arguments.hand(&device),
        device,
        seed: arguments.seed,
        seconds,
        faults: arguments.fault.clone(),
        commands,
        dac_errors: [DacError::offset(f64::from(arguments.dac_offset)); 2],
        trace: arguments.trace.is_some(),
        settings: (!arguments.blank).then_some(Settings::COMMISSIONED),
        ..Setup::default()
    };
    if let Some(port) = arguments.link {
        return serve(port, &image, setup);
    }
    let outcome = on_board(&image, &setup, bar(setup.seconds))?;
    let text = summary(scene, &setup, &outcome);
    match has_stdout(&arguments) {
        true => note(text.trim_end()),
        false => print_bytes(text.as_bytes())?,
    }
    let recorded = arguments.record.as_deref();
    let recorded = recorded.map_or(Ok(()), |path| outcome.record(path));
    if let Some(path) = &arguments.rtt {
        write_whole(path, &outcome.rtt)?;
    }
    if let Some(path) = &arguments.trace {
        write_whole(path, &outcome.trace)?;
    }
    if outcome.ticks.is_empty() {
        return Err(Failure::Check("the control task never ran".to_owned()));
    }
    outcome.check()?;
    taken(&arguments, &outcome)?;
    recorded
}

/// Serves the serial port to clients, which command the board.
fn serve(port: u16, image: &Image, setup: Setup) -> Result<(), Failure> {
    let bridge = Bridge::bind(port).map_err(Failure::Input)?;
    let address = bridge.address();
    print_bytes(format!("serial port of the board at {TCP}{address}\n").as_bytes())?;
    let setup = Setup {
        commands: Vec::new(),
        keep_alive: false,
        ..setup
    };
    let (Pace { seconds, lag_s }, _) = bridge.run(image, &setup, Arc::default())?;
    let lag = if lag_s < LAG_S {
        "in real time".to_owned()
    } else {
        format!("up to {lag_s:.3} s behind real time: this computer is busy or too slow")
    };
    print_bytes(format!("{seconds:.3} s of virtual time, {lag}\n").as_bytes())
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
