//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, CommandFactory as _, Parser, Subcommand};
use drivers::{Command, Setting};
use firmware_app::large;
use haptic_control::SceneKind;
use terminal::explain;
use terminal::failure::Failure;
use terminal::output::{note, print_bytes};
use terminal::wording::WIDTH;

use crate::board::{Answer, Board};
use crate::bring_up;
use crate::calibrate;
use crate::identity;
use crate::named::{self, Tuning};
use crate::patience::{USUAL, patience};
use crate::port::{Port, list};
use crate::record::Recorder;
use crate::session::{self, Plan};
use crate::settings::{self, Assignment, assignment};
use crate::timed::{Change, Timed, timed};
use crate::watch::state;

/// Commands a board over its link, and shows and records its telemetry.
///
/// A command that arms the board keeps it alive and disarms it at its end: after --seconds, at Ctrl-C,
/// and after an error. If the tool is killed, the board switches the scene off by itself.
#[derive(Debug, Parser)]
#[command(
    name = "cargo drive",
    bin_name = "cargo drive",
    version,
    max_term_width = WIDTH,
    after_help = "Exit status: 0; 1 if the board refuses or stops; 2 if the input cannot be used, or \
the board does not answer or speaks another protocol.\n\nExamples:
  cargo drive info
  cargo drive select wall --tune stiffness=0.2 --record wall.csv
  cargo drive --port tcp:127.0.0.1:9090 watch --seconds 5"
)]
struct Arguments {
    /// Serial port, for example /dev/ttyACM0, or tcp:HOST:PORT of an emulated board or a debug server
    /// [default: the only serial port]
    #[arg(long, global = true, value_name = "PORT")]
    port: Option<String>,
    /// Longest wait for an answer of the board, and longest silence of it, 0.1 to 60 s
    #[arg(long, global = true, value_name = "S", default_value = USUAL, allow_negative_numbers = true, value_parser = patience)]
    timeout: f64,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Print the serial ports of this machine
    #[command(after_help = "Example:\n  cargo drive list")]
    List,
    /// Print the identity of the board: protocol, version, features, device
    #[command(after_help = "Example:\n  cargo drive info --port /dev/ttyACM0")]
    Info,
    /// Enable the amplifiers without a scene; disarm at the end
    #[command(after_help = "Example:\n  cargo drive arm --seconds 3")]
    Arm(Hold),
    /// Disable the amplifiers and clear the cause of a stop
    #[command(after_help = "Example:\n  cargo drive disarm")]
    Disarm,
    /// Arm and render a scene; disarm at the end
    #[command(after_help = "Examples:
  cargo drive select wall
  cargo drive select wall --tune stiffness=0.2 --tune stiffness=0.1@2 --seconds 4")]
    Select {
        #[arg(value_name = "SCENE", value_parser = named::scene, help = scenes())]
        scene: SceneKind,
        /// Set a parameter of the scene, S seconds after the scene begins; repeatable
        #[arg(long, value_name = "NAME=VALUE[@S]", value_parser = timed)]
        tune: Vec<Timed>,
        /// Put an estimator in charge of the large motor's velocity, S seconds after the scene begins; repeatable
        #[arg(long, value_name = "NAME[@S]", value_parser = timed)]
        estimator: Vec<Timed>,
        #[command(flatten)]
        hold: Hold,
    },
    /// Set a parameter of a scene until the next reset; arms nothing
    #[command(after_help = format!(
        "Scenes and their parameters:\n{}\nExample:\n  cargo drive tune wall stiffness 0.2",
        named::parameters()
    ))]
    Tune {
        /// Scene of the list below
        #[arg(value_name = "SCENE", value_parser = named::scene)]
        scene: SceneKind,
        /// Parameter of the scene, of the list below
        #[arg(value_name = "PARAMETER")]
        parameter: String,
        /// Value; units and bounds are in docs/telemetry.md
        #[arg(value_name = "VALUE", allow_negative_numbers = true)]
        value: f32,
    },
    /// Arm and render a constant torque on the handle, N·m; disarm at the end
    #[command(after_help = "Example:\n  cargo drive torque 0.01 --seconds 2")]
    Torque {
        /// Torque, N·m
        #[arg(value_name = "VALUE", allow_negative_numbers = true)]
        value: f32,
        #[command(flatten)]
        hold: Hold,
    },
    /// Put an estimator in charge of the large motor's velocity until the next reset
    #[command(after_help = "Example:\n  cargo drive estimator kalman-triple-steady")]
    Estimator {
        #[arg(value_name = "NAME", value_parser = named::estimator, help = estimators())]
        number: u8,
    },
    /// Keep a board alive that another program has armed; disarm at the end
    #[command(after_help = "Example:\n  cargo drive keep-alive --seconds 10")]
    KeepAlive(Hold),
    /// Show the settings of the board; change some until the next reset, or store them
    #[command(after_help = "Examples:
  cargo drive settings
  cargo drive settings current-scale=0.5
  cargo drive settings zero-large=2051.5 gain-large=1.01 --store")]
    Settings {
        /// New values, in the setting's unit; they act at once
        #[arg(value_name = "NAME=VALUE", value_parser = assignment)]
        assignments: Vec<Assignment>,
        /// Store the settings in the board's flash; the amplifiers have to be disabled
        #[arg(long)]
        store: bool,
    },
    /// Check a new board and its motors step by step, and verify the signs of encoders and currents: scenes
    /// in closed loop are refused before. Moves the motors, at most with 0.3 A and 0.15 A
    #[command(
        after_help = "Examples:\n  cargo drive bring-up --turns\n  cargo drive bring-up --store"
    )]
    BringUp {
        /// Turn both shafts by hand at first, to measure the counts of a turn; the image has the feature
        /// index-pulse
        #[arg(long)]
        turns: bool,
        /// Store the settings in the board's flash if all checks pass
        #[arg(long)]
        store: bool,
    },
    /// Find zero and gain of both current outputs by measured currents, and set them; the image has the
    /// feature current-monitor. Moves the motors, at most with 0.3 A and 0.15 A
    #[command(after_help = "Examples:\n  cargo drive calibrate\n  cargo drive calibrate --store")]
    Calibrate {
        /// Store the settings in the board's flash if both motors pass
        #[arg(long)]
        store: bool,
    },
    /// Record the telemetry as CSV, as cargo sim record does; arms nothing
    #[command(after_help = "Example:\n  cargo drive record --seconds 5 --out run.csv")]
    Record {
        /// Write the recording to FILE when it ends; - is standard output
        #[arg(long, value_name = "FILE.csv")]
        out: PathBuf,
        /// Record for S seconds of the board's time [default: until Ctrl-C]
        #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
        seconds: Option<f64>,
    },
    /// Print the telemetry as lines with units; arms nothing
    #[command(after_help = "Example:\n  cargo drive watch --every 0.5")]
    Watch {
        /// Print a line every S seconds of the board's time
        #[arg(long, value_name = "S", default_value = "0.1", allow_negative_numbers = true, value_parser = seconds)]
        every: f64,
        /// Watch for S seconds of the board's time [default: until Ctrl-C]
        #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
        seconds: Option<f64>,
    },
}

/// Options of the commands that hold the board armed.
#[derive(Debug, Args)]
struct Hold {
    /// End after S seconds of the board's time; those of a scene count from its begin [default: at
    /// Ctrl-C]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    seconds: Option<f64>,
    /// Print a line of telemetry every S seconds of the board's time
    #[arg(long, value_name = "S", default_value = "0.5", allow_negative_numbers = true, value_parser = seconds)]
    every: f64,
    /// Write a recording to FILE at the end
    #[arg(long, value_name = "FILE.csv")]
    record: Option<PathBuf>,
}

impl Hold {
    fn plan(self, answer: &Answer) -> Plan {
        Plan {
            scene: None,
            changes: Vec::new(),
            seconds: self.seconds,
            every: Some(self.every),
            recorder: self.record.map(|out| Recorder::new(&answer.hello, out)),
            keeps_alive: true,
        }
    }
}

/// Help on a scene.
fn scenes() -> String {
    format!("Scene: {}", SceneKind::ALL.map(SceneKind::name).join(", "))
}

/// Help on an estimator.
fn estimators() -> String {
    format!(
        "Name of the estimator, of an image that has both: {}",
        large::NAMES.join(", ")
    )
}

/// A duration above 0.
fn seconds(text: &str) -> Result<f64, String> {
    let seconds: Option<f64> = text.parse().ok();
    let seconds = seconds.filter(|seconds| *seconds > 0.0 && *seconds <= 1e5);
    seconds.ok_or_else(|| "must be above 0 s, at most 100000 s".to_owned())
}

/// Runs the command line `arguments`, whose first element is the program's name.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments: Vec<_> = arguments.into_iter().collect();
    match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => act(arguments),
        Err(error) => explain(&error, &asked(&arguments)),
    }
}

/// The program, with the command among the arguments, whose help has the usage.
fn asked(arguments: &[OsString]) -> String {
    let commands = Arguments::command();
    let command = |argument: &OsString| commands.find_subcommand(argument);
    match arguments.iter().skip(1).find_map(command) {
        Some(command) => format!("cargo drive {}", command.get_name()),
        None => "cargo drive".to_owned(),
    }
}

fn act(arguments: Arguments) -> Result<(), Failure> {
    let Arguments {
        port,
        timeout,
        action,
    } = arguments;
    let open = || -> Result<Board, Failure> {
        let port = Port::open(port.as_deref())?;
        Ok(Board::new(port, Duration::from_secs_f64(timeout)))
    };
    match action {
        Action::List => print_ports(),
        Action::Info => {
            let answer = open()?.identify()?;
            print_bytes(identity::text(&answer).as_bytes())
        }
        Action::Disarm => {
            // Every protocol has this command, so that nothing is asked before it.
            let frame = open()?.disarm()?;
            note(format_args!("disarmed: {}", state(&frame)));
            Ok(())
        }
        Action::Arm(hold) => {
            let mut board = open()?;
            let answer = board.compatible()?;
            session::armed(&mut board, &answer, hold.plan(&answer))
        }
        Action::KeepAlive(hold) => {
            let mut board = open()?;
            let answer = board.compatible()?;
            session::kept_alive(&mut board, &answer, hold.plan(&answer))
        }
        Action::Select {
            scene,
            tune,
            estimator,
            hold,
        } => {
            let mut changes = Vec::new();
            for timed in &tune {
                changes.push((timed.at_s, timed.tuning(scene)?));
            }
            for timed in &estimator {
                changes.push((timed.at_s, timed.estimator()?));
            }
            render(open()?, scene, changes, hold)
        }
        Action::Torque { value, hold } => {
            let torque = Tuning::new(SceneKind::Torque, "torque", value)?;
            let changes = vec![(0.0, Change::Tuning(torque))];
            render(open()?, SceneKind::Torque, changes, hold)
        }
        Action::Tune {
            scene,
            parameter,
            value,
        } => {
            let tuning = Tuning::new(scene, &parameter, value)?;
            if tuning.scene() == SceneKind::Torque {
                // The set-point is zero each time its scene is selected.
                return Err(Failure::Input(format!(
                    "{tuning}: lasts only while the scene runs; use cargo drive torque VALUE"
                )));
            }
            let mut board = open()?;
            tuning.check(&board.compatible()?.hello)?;
            board.change(tuning.command(), &tuning.to_string())?;
            note(format_args!("{tuning}, until the next reset"));
            Ok(())
        }
        Action::Estimator { number } => {
            let mut board = open()?;
            board.compatible()?;
            let name = format!("estimator {}", large::NAMES[usize::from(number)]);
            board.change(Command::Estimator(number), &name)?;
            note(format_args!("{name}, until the next reset"));
            Ok(())
        }
        Action::Settings { assignments, store } => {
            let mut board = open()?;
            let hello = board.compatible()?.hello;
            for it in &assignments {
                if it.setting == Setting::Estimator {
                    named::numbered(it.value as u8, &hello)
                        .map_err(|error| format!("estimator={}: {error}", it.value))?;
                }
            }
            settings::change(&mut board, &assignments)?;
            print_bytes(settings::table(&mut board)?.as_bytes())?;
            if store {
                return settings::store(&mut board);
            }
            if !assignments.is_empty() {
                note("until the next reset; --store keeps them");
            }
            Ok(())
        }
        Action::BringUp { turns, store } => bring_up::run(&mut open()?, turns, store),
        Action::Calibrate { store } => calibrate::run(&mut open()?, store),
        Action::Record { out, seconds } => {
            let mut board = open()?;
            let answer = board.compatible()?;
            let recorder = Some(Recorder::new(&answer.hello, out));
            let plan = shown(None, seconds, recorder);
            session::unarmed(&mut board, &answer, plan)
        }
        Action::Watch { every, seconds } => {
            let mut board = open()?;
            let answer = board.compatible()?;
            session::unarmed(&mut board, &answer, shown(Some(every), seconds, None))
        }
    }
}

/// Arms the board and renders a scene.
fn render(
    mut board: Board,
    scene: SceneKind,
    changes: Vec<(f64, Change)>,
    hold: Hold,
) -> Result<(), Failure> {
    let answer = board.compatible()?;
    for (_, change) in &changes {
        if let Change::Tuning(tuning) = change {
            tuning.check(&answer.hello)?;
        }
    }
    let plan = Plan {
        scene: Some(scene),
        changes,
        ..hold.plan(&answer)
    };
    session::armed(&mut board, &answer, plan)
}

/// A plan that sends nothing.
fn shown(every: Option<f64>, seconds: Option<f64>, recorder: Option<Recorder>) -> Plan {
    Plan {
        scene: None,
        changes: Vec::new(),
        seconds,
        every,
        recorder,
        keeps_alive: false,
    }
}

fn print_ports() -> Result<(), Failure> {
    let ports = list()?;
    if ports.is_empty() {
        note("no serial port; connect the board");
    }
    let lines: String = ports
        .iter()
        .map(|port| format!("{}\n", port.display()))
        .collect();
    print_bytes(lines.as_bytes())
}
