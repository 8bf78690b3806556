//! The arguments of the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use firmware_app::large;
use haptic_control::SceneKind;
use terminal::wording::WIDTH;

use crate::named;
use crate::patience::{USUAL, patience};
use crate::settings::{Assignment, assignment};
use crate::timed::{Timed, timed};

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
pub(super) struct Arguments {
    /// Serial port, for example /dev/ttyACM0, or tcp:HOST:PORT of an emulated board or a debug server
    /// [default: the only serial port]
    #[arg(long, global = true, value_name = "PORT")]
    pub(super) port: Option<String>,
    /// Longest wait for an answer of the board, and longest silence of it, 0.1 to 60 s
    #[arg(long, global = true, value_name = "S", default_value = USUAL, value_parser = patience)]
    pub(super) timeout: f64,
    #[command(subcommand)]
    pub(super) action: Action,
}

#[derive(Debug, Subcommand)]
pub(super) enum Action {
    /// Print the serial ports of this machine
    #[command(after_help = "Example:\n  cargo drive list")]
    List(NoBoard),
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
        /// New values, in the setting's unit; they act at once, but for estimator, which acts after a start of the
        /// board that has it stored
        #[arg(value_name = "NAME=VALUE", value_parser = assignment)]
        assignments: Vec<Assignment>,
        /// Store the settings in the board's flash; the amplifiers have to be disabled
        #[arg(long)]
        store: bool,
    },
    /// Check a new board and its motors step by step, and verify the signs of encoders and currents: scenes
    /// in closed loop are refused before. Moves the motors, at most with 0.3 A and 0.15 A. After a failed
    /// check or an early end the signs are not verified, even if they were, until the next reset
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
        #[arg(long, value_name = "S", value_parser = seconds)]
        seconds: Option<f64>,
    },
    /// Print the telemetry as lines with units; arms nothing
    #[command(after_help = "Example:\n  cargo drive watch --every 0.5")]
    Watch {
        /// Print a line every S seconds of the board's time
        #[arg(long, value_name = "S", default_value = "0.1", value_parser = seconds)]
        every: f64,
        /// Watch for S seconds of the board's time [default: until Ctrl-C]
        #[arg(long, value_name = "S", value_parser = seconds)]
        seconds: Option<f64>,
    },
}

/// The options of a board, which a command without a board does not show.
#[derive(Debug, Args)]
pub(super) struct NoBoard {
    #[arg(long, hide = true)]
    pub(super) port: Option<String>,
    #[arg(long, hide = true, value_parser = patience)]
    pub(super) timeout: Option<f64>,
}

/// Options of the commands that hold the board armed.
#[derive(Debug, Args)]
pub(super) struct Hold {
    /// End after S seconds of the board's time; those of a scene count from its begin [default: at
    /// Ctrl-C]
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub(super) seconds: Option<f64>,
    /// Print a line of telemetry every S seconds of the board's time
    #[arg(long, value_name = "S", default_value = "0.5", value_parser = seconds)]
    pub(super) every: f64,
    /// Write a recording to FILE at the end; - is standard output, and the lines go to standard error
    #[arg(long, value_name = "FILE.csv")]
    pub(super) record: Option<PathBuf>,
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

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;
    use haptic_control::Excite;

    use super::*;

    #[test]
    fn durations_and_waits_have_their_ranges() {
        for text in ["0", "-1", "100001", "inf", "nan", "x"] {
            assert!(seconds(text).is_err(), "{text}");
        }
        assert_eq!(seconds("1e-3"), Ok(1e-3));
        assert_eq!(seconds("100000"), Ok(1e5));
        for text in ["0.09", "61", "nan", "x"] {
            assert!(patience(text).is_err(), "{text}");
        }
        assert_eq!(patience("0.1"), Ok(0.1));
        assert_eq!(patience("60"), Ok(60.0));
    }

    #[test]
    fn help_and_page_have_the_currents_of_the_strokes() {
        let strokes = Excite::STROKES;
        let currents = format!("{} A and {} A", strokes.large.get(), strokes.small.get());
        let command = Arguments::command();
        for name in ["bring-up", "calibrate"] {
            let help = command.find_subcommand(name).and_then(|it| it.get_about());
            let help = help.expect("a help text").to_string();
            let said = format!("Moves the motors, at most with {currents}");
            assert!(help.contains(&said), "{help}");
        }
        let page = include_str!("../../../docs/board.md");
        assert!(page.contains(&format!(
            "in the strokes of the scene `excite`, at most {currents}"
        )));
    }
}
