//! What a board does, and the tool that is run against it.

use std::net::{TcpListener, TcpStream};
use std::process::{Command as Process, Output};
use std::sync::mpsc::{self, Receiver};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use drivers::link::{Features, Hello, Label, PROTOCOL, Rejected};
use drivers::{Command, Settings};
use haptic_control::{Mode, Stop};
use tuned::{DEVICE_FINGERPRINT, PRESETS_FINGERPRINT};

use crate::player::play;

/// A message of the answer to the question for the identity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Identity,
    Counts,
}

/// What the board does.
#[derive(Clone)]
pub(super) struct Script {
    /// Identity.
    pub(super) hello: Hello,
    /// Bytes after the fields of the identity, as a later protocol may have them.
    pub(super) appended: Vec<u8>,
    /// What the board sends again and again instead of all messages.
    pub(super) instead: Option<Vec<u8>>,
    /// Bytes before each message, which are no message.
    pub(super) noise: Vec<u8>,
    /// State to which the command `arm` leads.
    pub(super) armed: Mode,
    /// State at the begin.
    pub(super) begin: Mode,
    /// State and cause that the board takes so many frames after the command `select`.
    pub(super) stop: Option<(u32, Mode, Stop)>,
    /// Which command `select` this is, from 1.
    pub(super) stops_at: u32,
    /// Frames from the command `select` until the scene runs; `None`: it never does.
    pub(super) starts_after: Option<u32>,
    /// From so many frames after the command `select` on, no frame comes for so long.
    pub(super) pause: Option<(u32, Duration)>,
    /// So many frames are sent from the first of this command on; then the board closes its end.
    pub(super) hang_up: Option<(Command, u32)>,
    /// So many frames after the first of this command the firmware starts again.
    pub(super) starts_again: Option<(Command, u32)>,
    /// Commands that the board has rejected before the tool came.
    pub(super) rejected: Rejected,
    /// Frames that are lost: first and last, by their number from the first question on.
    pub(super) lost: Option<(u32, u32)>,
    /// Whether each answer is sent at the next question only.
    pub(super) answers_late: bool,
    /// Message that is lost of the answer to the question of this number, from 1.
    pub(super) loses: Option<(u32, Part)>,
    /// Whether the board refuses values as out of bounds.
    pub(super) refuses: bool,
    /// Offset, A, and slope of the measured currents of both motors over their commands, by an image with
    /// `current-monitor`, whose shafts rest; `None`: an image without.
    pub(super) measures: Option<[(f32, f32); 2]>,
    /// Counts from each index pulse of the large and of the handle encoder to the next one, of an image with
    /// `index-pulse` that tells a pulse of both every 100 frames; `None`: an image without.
    pub(super) turns: Option<[u32; 2]>,
    /// Voltage beside each frame, V, by an image with `supply-monitor`; `None`: an image without.
    pub(super) supply: Option<f32>,
    /// Frames from the command `select` on after which the commands of such a board are zero.
    pub(super) strokes_end_after: Option<u32>,
    /// Settings at the begin.
    pub(super) settings: Settings,
    /// Frames from the first command `disarm` until the board follows such commands; `None`: it never does.
    pub(super) disarms_after: Option<u32>,
    /// Commands with a value that arrive damaged: first and last, by their number from 1.
    pub(super) damages: (u32, u32),
    /// Whether noise reaches the command channel, which the board tells every 100 frames.
    pub(super) garbles: bool,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            hello: Hello {
                protocol: PROTOCOL,
                version: Label::new("0.1.0"),
                commit: Label::new("a1b2c3d"),
                features: Features::from_flags(&[false, true, true]),
                rate: 10_000,
                device: DEVICE_FINGERPRINT.0,
                presets: PRESETS_FINGERPRINT.0,
                cause: 8,
                brown_out_reset: true,
            },
            appended: Vec::new(),
            instead: None,
            noise: Vec::new(),
            armed: Mode::Armed,
            begin: Mode::Boot,
            stop: None,
            stops_at: 1,
            starts_after: Some(0),
            pause: None,
            hang_up: None,
            starts_again: None,
            rejected: Rejected {
                garbage: 7,
                unknown: 1,
                ..Rejected::default()
            },
            lost: None,
            answers_late: false,
            loses: None,
            refuses: false,
            measures: None,
            turns: None,
            supply: None,
            strokes_end_after: None,
            settings: Settings::COMMISSIONED,
            disarms_after: Some(0),
            damages: (0, 0),
            garbles: false,
        }
    }
}

/// A board that plays a script for one connection.
pub(super) struct Board {
    port: String,
    seen: Receiver<Command>,
    thread: JoinHandle<()>,
}

impl Board {
    /// A board at a free port.
    pub(super) fn new(script: Script) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let (report, seen) = mpsc::channel();
        let thread = thread::spawn(move || {
            let (stream, _) = listener.accept().unwrap();
            play(stream, &script, &report);
        });
        Self { port, seen, thread }
    }

    /// The tool with these arguments and the port of the board, to be started. It has patience with a busy
    /// computer, unless the arguments say how much.
    pub(super) fn tool(&self, arguments: &[&str]) -> Process {
        let mut process = tool(arguments);
        process.args(["--port", &self.port]);
        if !arguments.contains(&"--timeout") {
            process.args(["--timeout", "30"]);
        }
        process
    }

    /// Runs the tool to its end: its output and the commands that the board got.
    pub(super) fn run(self, arguments: &[&str]) -> (Output, Vec<Command>) {
        let output = self.tool(arguments).output().unwrap();
        (output, self.commands())
    }

    /// Waits until the board gets a command.
    pub(super) fn wait_for(&self, command: Command) {
        while self.seen.recv().expect("the command") != command {}
    }

    /// The commands that the board got until the connection ended, in order.
    pub(super) fn commands(self) -> Vec<Command> {
        // A board to which the tool did not connect waits no longer.
        let _ = TcpStream::connect(self.port.trim_start_matches("tcp:"));
        self.thread.join().unwrap();
        self.seen.iter().collect()
    }
}

/// The tool with these arguments.
pub(super) fn tool(arguments: &[&str]) -> Process {
    let mut process = Process::new(env!("CARGO_BIN_EXE_drive"));
    process.args(arguments);
    process
}

/// The one line of an error on standard error.
pub(super) fn error(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    let lines: Vec<_> = text.lines().collect();
    let [line] = lines[..] else {
        panic!("one line: {text}");
    };
    let said = line.strip_prefix("error: ");
    said.unwrap_or_else(|| panic!("no error: {line}"))
        .to_owned()
}
