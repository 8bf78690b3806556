//! The command line.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Parser;
use host_sim::closed_loop::Hand;
use host_sim::failure::Failure;
use host_sim::output::{print_bytes, write_whole};
use host_sim::telemetry::NOBODY;
use indicatif::{ProgressBar, ProgressStyle};

use crate::budget;
use crate::command::Command;
use crate::fault::Fault;
use crate::image::Image;
use crate::run::{Outcome, Setup, on_board};
use crate::scene::ImageScene;
use crate::score::Range;

/// Where cargo puts the image.
const IMAGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../target/thumbv7em-none-eabihf/release/firmware"
);

/// Before this the image boots and arms itself, s.
const SETTLED_S: f64 = 0.4;

/// Runs the flash image on an emulated board, in closed loop with the simulated device, and prints
/// what the image said, what its control task cost and what the hand felt.
#[derive(Debug, Parser)]
#[command(name = "cargo board", bin_name = "cargo board", version, after_help = after_help())]
struct Arguments {
    /// Scene that the image is told to render
    #[arg(long, default_value = "free-air", value_parser = str::parse::<ImageScene>)]
    scene: ImageScene,
    /// Sets a parameter of the scene, at an instant, as stiffness=0.2@1.5; torque=0.01@1 is the
    /// set-point of the scene torque; may be given more than once
    #[arg(long, value_name = "NAME=VALUE@S", value_parser = tune)]
    tune: Vec<(f64, String)>,
    /// Puts an estimator in charge of the large motor, by its number, at an instant, as 1@1.5; may
    /// be given more than once
    #[arg(long, value_name = "NUMBER@S", value_parser = estimator)]
    estimator: Vec<(f64, u8)>,
    /// Who holds the handle: moving, pushing, still, or tracking chirps and reversals
    #[arg(long, default_value = "moving", value_parser = hand)]
    hand: Hand,
    /// Virtual seconds
    #[arg(long, default_value_t = 3.0)]
    seconds: f64,
    /// Seed of the hand's motion and the encoders' phases
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// A fault, listed below, and when it happens; may be given more than once
    #[arg(long, value_name = "NAME@S", value_parser = fault)]
    fault: Vec<(f64, Fault)>,
    /// ELF file to run instead of the one cargo has built
    #[arg(long)]
    image: Option<PathBuf>,
    /// Writes the image's frames as a recording for `host-sim replay`
    #[arg(long, value_name = "FILE.csv")]
    record: Option<PathBuf>,
    /// Writes the bytes that the probe took from RTT channel 0, for `host-sim record --image`
    #[arg(long, value_name = "FILE")]
    rtt: Option<PathBuf>,
    /// Prints the budget of every scene instead, each run for --seconds at most 1: instructions,
    /// estimated cycles, the control rate that leaves half of the core
    #[arg(long, conflicts_with_all = ["scene", "hand", "fault", "record", "rtt", "tune", "estimator"])]
    budget: bool,
}

/// The faults, and examples.
fn after_help() -> String {
    let mut text = "Faults:\n".to_owned();
    for fault in Fault::all() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<19}{}", fault.as_str(), fault.description());
    }
    text + "\nBuild the image first:\n  \
        cargo build --release --package firmware --target thumbv7em-none-eabihf\n\n\
        Examples:\n  \
        cargo board --scene wall --hand pushing --record wall.csv\n  \
        cargo board --fault swapped@0.5 --seconds 1\n  \
        cargo board --budget"
}

fn hand(name: &str) -> Result<Hand, String> {
    match name {
        "moving" => Ok(Hand::Moving),
        "pushing" => Ok(Hand::Pushing),
        "still" => Ok(Hand::Still),
        "tracking" => Ok(Hand::Tracking),
        _ => Err(format!(
            "no hand '{name}'; there are moving, pushing, still, tracking"
        )),
    }
}

fn tune(text: &str) -> Result<(f64, String), String> {
    let (what, at) = text
        .rsplit_once('@')
        .ok_or("a parameter needs its instant, as stiffness=0.2@1.5")?;
    let at: f64 = at.parse().map_err(|_| format!("'{at}' is no time in s"))?;
    Ok((at, what.to_owned()))
}

fn estimator(text: &str) -> Result<(f64, u8), String> {
    let (number, at) = text
        .split_once('@')
        .ok_or("an estimator needs its instant, as 1@1.5")?;
    let number = number
        .parse()
        .map_err(|_| format!("'{number}' is no number of an estimator, 0 to 255"))?;
    let at: f64 = at.parse().map_err(|_| format!("'{at}' is no time in s"))?;
    Ok((at, number))
}

fn fault(text: &str) -> Result<(f64, Fault), String> {
    let (name, at) = text
        .split_once('@')
        .ok_or("a fault needs its instant, as stuck-a@1.5")?;
    let fault = name.parse()?;
    match at.parse::<f64>() {
        Ok(at) if (0.0..=3600.0).contains(&at) => Ok((at, fault)),
        _ => Err(format!("'{at}' is no time in s, 0 to 3600")),
    }
}

/// Runs the command line `arguments`, the program's name first.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return host_sim::cli::explain(&error, "cargo board"),
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
    let mut commands = vec![(0.05, scene.select()), (0.1, Command::Arm)];
    for (at, what) in &arguments.tune {
        commands.push((*at, scene.tune(what)?));
    }
    let choices = arguments.estimator.iter();
    commands.extend(choices.map(|(at, number)| (*at, Command::Estimator(*number))));
    let image = Image::read(&path)?;
    if arguments.budget {
        let table = budget::table(&image, arguments.seconds.min(1.0), arguments.seed)?;
        return print_bytes(table.as_bytes());
    }
    let late = arguments
        .fault
        .iter()
        .find(|(at, _)| *at > arguments.seconds);
    if let Some((at, fault)) = late {
        let name = fault.as_str();
        let end = arguments.seconds;
        let message = format!("--fault {name}@{at}: the run ends at {end} s; give --seconds more");
        return Err(Failure::Input(message));
    }
    let setup = Setup {
        hand: arguments.hand,
        seed: arguments.seed,
        seconds: arguments.seconds,
        faults: arguments.fault.clone(),
        commands,
        ..Setup::default()
    };
    let outcome = on_board(&image, &setup, bar(setup.seconds))?;
    print_bytes(summary(&arguments, &setup, &outcome).as_bytes())?;
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

fn summary(arguments: &Arguments, setup: &Setup, outcome: &Outcome) -> String {
    let mut out = String::new();
    let mut line = |name: &str, text: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{name:<22}{text}");
    };
    let speed = setup.seconds / outcome.wall.as_secs_f64();
    line(
        "run",
        format!(
            "{} s of {}, seed {}, {speed:.1} virtual s a second",
            setup.seconds, arguments.scene, setup.seed
        ),
    );
    for complaint in &outcome.complaints {
        line("WIRING", complaint.clone());
    }
    for said in &outcome.telemetry.log {
        line("image", said.clone());
    }
    for restart in &outcome.restarts {
        line(
            "RESTART",
            format!("{:.4} s, {}", restart.at_s, restart.cause),
        );
    }
    let range = |range: Option<Range>, unit: &str| {
        range.map_or("none".to_owned(), |r| {
            format!("{} to {}, mean {:.1} {unit}", r.min, r.max, r.mean)
        })
    };
    let cost = outcome.instructions();
    line("control tick", range(cost, "instructions"));
    if let Some(cost) = cost {
        line("share of the period", budget::share(cost));
    }
    line("control period", range(outcome.periods(), "ns"));
    let malformed = outcome.telemetry.malformed.len();
    let frames = &outcome.telemetry.frames;
    line("frames", format!("{}, {malformed} malformed", frames.len()));
    if let Some(last) = frames.last() {
        line("state", format!("{}, cause {}", last.state, last.cause));
        if let (Some(estimator), Some(sl)) = (last.estimator, last.sl) {
            let name = match estimator {
                NOBODY => "none in charge".to_owned(),
                number => format!("number {number}, good to {sl:.3} rad/s by itself"),
            };
            line("estimator", name);
        }
        line(
            "overruns, drops",
            format!("{}, {}", last.overruns, last.drops),
        );
    }
    if let Some(learned) = frames.iter().rev().find_map(|frame| frame.beside.learned) {
        line(
            "learned",
            format!(
                "damping {:+.3}, friction {:+.3}, torque constant {:+.3}",
                learned.damping, learned.friction, learned.torque_constant
            ),
        );
    }
    for (at_ns, [large, small]) in outcome.enables.iter().skip(1) {
        let name = |on: &bool| if *on { "on" } else { "off" };
        let at = *at_ns as f64 * 1e-9;
        line(
            "amplifiers",
            format!("{at:.5} s: large {}, small {}", name(large), name(small)),
        );
    }
    let diameter = setup.device.handle.diameter_m;
    match outcome.parasitic(SETTLED_S, diameter) {
        Some(force) => line(
            "parasitic force",
            format!("{:.2} mN rms, {:.2} mN at most", force.rms_mn, force.max_mn),
        ),
        None => line("parasitic force", "no frame to judge by".to_owned()),
    }
    out
}
