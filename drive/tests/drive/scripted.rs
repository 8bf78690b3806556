//! A board that a script plays: it answers commands, sends a frame per millisecond of its own time,
//! and has no control and no time limits.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::{Command as Process, Output};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use drivers::link::{Features, Frame, Hello, LONGEST, Label, Message, PROTOCOL, Rejected};
use drivers::{Command, Parser};
use haptic_control::{Mode, Request, Stop};
use tuned::{DEVICE_FINGERPRINT, PRESETS_FINGERPRINT};

/// Frames that the board sends at a time.
const BURST: u32 = 10;

/// What the board does.
#[derive(Clone)]
pub(super) struct Script {
    /// Identity.
    pub(super) hello: Hello,
    /// Whether the board sends anything.
    pub(super) speaks: bool,
    /// Bytes before each message, which are no message.
    pub(super) noise: Vec<u8>,
    /// State to which the command `arm` leads.
    pub(super) armed: Mode,
    /// State at the begin.
    pub(super) begin: Mode,
    /// State and cause that the board takes so many frames after the command `select`.
    pub(super) stop: Option<(u32, Mode, Stop)>,
    /// The connection ends so many frames after its begin.
    pub(super) hang_up: Option<u32>,
    /// Whether the board refuses values as out of bounds.
    pub(super) refuses: bool,
    /// Whether the board takes the command `disarm`.
    pub(super) disarms: bool,
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
            speaks: true,
            noise: Vec::new(),
            armed: Mode::Armed,
            begin: Mode::Boot,
            stop: None,
            hang_up: None,
            refuses: false,
            disarms: true,
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

    /// The tool with these arguments and the port of the board, to be started.
    pub(super) fn tool(&self, arguments: &[&str]) -> Process {
        let mut process = tool(arguments);
        process.args(["--port", &self.port]);
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

/// The frame of this number: its values follow from the number.
pub(super) fn frame(seq: u32, state: Mode, cause: Stop) -> Frame {
    Frame {
        seq,
        tick: 10 * seq,
        counts_large: 3 * seq,
        counts_small: 0_u32.wrapping_sub(seq),
        current: 0.5,
        current_small: -0.25,
        torque: 0.01,
        velocity_large: 1.5,
        velocity_small: -2.5,
        state: state as u8,
        cause: cause as u8,
        sigma_large: 0.125,
        estimator: 0,
        overruns: 0,
        drops: 0,
        rtt_drops: 0,
        cycles: 900,
    }
}

fn play(mut stream: TcpStream, script: &Script, report: &Sender<Command>) {
    stream
        .set_read_timeout(Some(Duration::from_millis(2)))
        .unwrap();
    let mut parser = Parser::default();
    let (mut state, mut cause) = (script.begin, Stop::None);
    let mut rejected = Rejected {
        garbage: 7,
        not_finite: 0,
        out_of_bounds: 0,
        unknown: 1,
    };
    let mut selected = None;
    // The board has run for some time.
    let (begin, mut seq) = (50, 50);
    loop {
        let mut bytes = [0; 256];
        let count = match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(_) => return,
        };
        let mut answer = Vec::new();
        let mut send = |message: Message| {
            let mut buffer = [0; LONGEST];
            answer.extend(&script.noise);
            answer.extend(message.encode(&mut buffer).unwrap());
        };
        for command in bytes[..count].iter().filter_map(|byte| parser.take(*byte)) {
            // A test that has ended looks at no command.
            let _ = report.send(command);
            match command {
                Command::Identify => {
                    send(script.hello.into());
                    send(rejected.into());
                }
                Command::Request(Request::Arm) => state = script.armed,
                Command::Request(Request::Disarm) if script.disarms => state = Mode::Boot,
                Command::Request(Request::Select(_)) => {
                    (state, selected) = (Mode::Running, Some(seq));
                }
                Command::Tune { .. } | Command::Torque(_) | Command::Estimator(_) => {
                    rejected.out_of_bounds += u32::from(script.refuses);
                }
                Command::Request(_) => {}
            }
        }
        for _ in 0..BURST {
            if let (Some((after, mode, stop)), Some(select)) = (script.stop, selected)
                && seq == select + after
            {
                (state, cause) = (mode, stop);
            }
            send(frame(seq, state, cause).into());
            seq += 1;
        }
        if script.speaks && stream.write_all(&answer).is_err() {
            return;
        }
        if script.hang_up.is_some_and(|frames| seq - begin >= frames) {
            return;
        }
    }
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
