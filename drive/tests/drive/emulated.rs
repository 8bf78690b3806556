//! The tool's binary against the emulated board, which runs the flash image and has its serial port at
//! TCP.

use std::fs;
use std::io::Read as _;
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::process::{Command as Process, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use drivers::Settings;
use drivers::link::{Message, PROTOCOL, Parser};
use experiments::closed_loop::Hand;
use haptic_control::{Mode, SimulatedHand, Stop};
use recordings::recording::Recording;
use tuned::DEVICE_FINGERPRINT;
use virtual_board::bridge::Bridge;
use virtual_board::fault::Fault;
use virtual_board::flash::Sectors;
use virtual_board::image::Image;
use virtual_board::run::{DacError, RATE_HZ, Setup, on_board};

/// The feature of an image that `calibrate` asks for.
const MONITORS: &str = "current-monitor";

/// Runs the tool. Other boards run beside this one, so that the computer is busy and a board may be slow.
fn tool(address: SocketAddr, arguments: &[&str]) -> Output {
    let port = format!("tcp:{address}");
    Process::new(env!("CARGO_BIN_EXE_drive"))
        .args(arguments)
        .args(["--port", &port, "--timeout", "60"])
        .output()
        .unwrap()
}

/// A board that runs until it is ended.
pub(crate) struct EmulatedBoard {
    stop: Arc<AtomicBool>,
    runs: JoinHandle<Sectors>,
}

impl EmulatedBoard {
    /// Starts a board that is commanded over the port whose address is returned.
    pub(crate) fn start(setup: Setup) -> (SocketAddr, Self) {
        Self::with("", setup)
    }

    /// Starts a board whose image has these features.
    pub(crate) fn with(features: &str, setup: Setup) -> (SocketAddr, Self) {
        let image = Image::build(features).unwrap();
        let bridge = Bridge::bind(0).unwrap();
        let address = bridge.address();
        let setup = Setup {
            // Until the tool is through.
            seconds: 3600.0,
            commands: Vec::new(),
            keep_alive: false,
            ..setup
        };
        let stop = Arc::new(AtomicBool::new(false));
        let until = Arc::clone(&stop);
        let runs = std::thread::spawn(move || bridge.run(&image, &setup, until).unwrap().1);
        let board = Self { stop, runs };
        (address, board)
    }

    /// Ends the board; returns what its flash holds.
    pub(crate) fn end(self) -> Sectors {
        self.stop.store(true, Ordering::Relaxed);
        self.runs.join().unwrap()
    }
}

/// State in a frame that the board sends from now on.
pub(crate) fn state_now(address: SocketAddr) -> Option<Mode> {
    let mut client = TcpStream::connect(address).unwrap();
    let (mut parser, mut state) = (Parser::default(), None);
    let mut byte = [0];
    while state.is_none() {
        client.read_exact(&mut byte).expect("a frame");
        parser.take(byte[0], |message| {
            if let Message::Frame(frame) = message {
                state = Some(frame.state);
            }
        });
    }
    state.and_then(Mode::from_code)
}

/// Times of the rows of the running scene, s.
fn running(path: &Path) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let state = lines
        .next()
        .unwrap()
        .split(',')
        .position(|it| it == "state");
    let states = lines.map(|row| row.split(',').nth(state.unwrap()).unwrap());
    let recording = Recording::read(path).unwrap();
    let is_running = |state: &str| state.parse() == Ok(Mode::Running as u8);
    let rows = recording.t.into_iter().zip(states);
    rows.filter(|(_, state)| is_running(state))
        .map(|(t, _)| t)
        .collect()
}

#[test]
fn emulated_board_is_identified_renders_a_wall_and_is_left_disarmed() {
    let (address, board) = EmulatedBoard::start(Setup {
        hand: SimulatedHand::HoldStill.into(),
        ..Setup::default()
    });

    let output = tool(address, &["info"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    for said in [
        format!("protocol           {PROTOCOL}\n"),
        format!("firmware           {}, commit ", env!("CARGO_PKG_VERSION")),
        format!("control rate       {RATE_HZ} Hz\n"),
        format!("device             {DEVICE_FINGERPRINT}\n"),
        "rejected commands  0 not finite, 0 out of bounds, 0 unknown, 0 before bring-up, 0 bytes of garbage\n"
            .to_owned(),
    ] {
        assert!(text.contains(&said), "{said}: {text}");
    }

    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("drive-emulated-wall.csv");
    let path = out.to_str().unwrap();
    let arguments = [
        "select",
        "wall",
        "--tune",
        "stiffness=0.1@0.1",
        "--seconds",
        "0.3",
    ];
    let output = tool(address, &[&arguments[..], &["--record", path]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(
        text.starts_with("disarmed: state boot, cause none\n"),
        "{text}"
    );
    assert!(
        text.contains(" frames recorded, 0 missing at 0 places\n"),
        "{text}"
    );
    let times = running(&out);
    // A frame per millisecond.
    assert_eq!(times.len(), 301);
    assert!((times[300] - times[0] - 0.3).abs() < 1e-9);
    assert_eq!(state_now(address), Some(Mode::Boot));
    board.end();
}

/// A board whose flash is blank, with a free handle.
pub(crate) fn blank(fault: Option<Fault>) -> Setup {
    Setup {
        hand: Hand::Gone(0.0),
        settings: None,
        faults: fault.map(|fault| (0.001, fault)).into_iter().collect(),
        ..Setup::default()
    }
}

/// Standard output and exit status of the tool.
pub(crate) fn said(address: SocketAddr, arguments: &[&str]) -> (String, Option<i32>) {
    let output = tool(address, arguments);
    let text = String::from_utf8(output.stdout).unwrap();
    (text, output.status.code())
}

#[test]
fn stored_settings_are_there_when_the_board_is_started_again() {
    let (address, board) = EmulatedBoard::start(blank(None));
    let (text, status) = said(address, &["settings", "serial=77", "--store"]);
    assert_eq!(status, Some(0), "{text}");
    let (_, status) = said(address, &["settings", "serial=78"]);
    assert_eq!(status, Some(0));
    let flash = Some(board.end());
    let (address, board) = EmulatedBoard::start(Setup {
        flash,
        ..blank(None)
    });
    assert_eq!(setting(address, "serial"), 77.0);
    board.end();
}

/// The time of the board begins with the tool, and the current monitors are not settled yet.
#[test]
fn first_command_arms_a_board_with_current_monitors() {
    for arguments in [
        &["arm", "--seconds", "0.2"][..],
        &["select", "free-air", "--seconds", "0.2"],
    ] {
        let (address, board) = EmulatedBoard::with(MONITORS, with_dac_errors([(0.0, 1.0); 2]));
        let output = tool(address, arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        board.end();
    }
}

/// Random bytes at the debug probe are counted as those of the port are. They end no session, and its changes, which
/// may have been damaged, are sent again.
#[test]
fn flood_at_the_debug_probe_ends_no_session() {
    let (address, board) = EmulatedBoard::start(Setup {
        hand: SimulatedHand::HoldStill.into(),
        faults: vec![(0.001, Fault::CommandFlood)],
        ..Setup::default()
    });
    let tune = ["select", "wall", "--tune", "stiffness=0.1@0.1"];
    // A board that lags behind real time catches up while the tool waits for this computer.
    let output = tool(address, &[&tune[..], &["--seconds", "8"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    let said = "wall stiffness 0.1 N\u{b7}m/rad: sent 4 times, and each time bytes that are no command reached";
    assert!(text.contains(said), "{text}");
    board.end();
}

/// The value of a setting in the table of the tool.
fn setting(address: SocketAddr, name: &str) -> f64 {
    let (text, _) = said(address, &["settings"]);
    let line = text.lines().find(|line| line.starts_with(name));
    let value = line.and_then(|line| line.split_whitespace().nth(1));
    value.expect("the setting").parse().unwrap()
}

/// A board that has passed its bring-up, with offset and gain of the large and of the small motor's output.
fn with_dac_errors(errors: [(f64, f64); 2]) -> Setup {
    Setup {
        settings: Some(Settings::COMMISSIONED),
        dac_errors: errors.map(|(offset, gain)| DacError { offset, gain }),
        ..blank(None)
    }
}

/// RMS of the parasitic force that a moving hand feels in free air, mN, on a board that starts with this
/// flash.
fn parasitic_mn(errors: [(f64, f64); 2], flash: Option<Sectors>) -> f64 {
    /// Before this the board is armed and settles, s.
    const SETTLED_S: f64 = 0.4;
    let setup = Setup {
        hand: Hand::Moving,
        flash,
        seconds: 2.4,
        ..with_dac_errors(errors)
    };
    let run = on_board(&Image::build(MONITORS).unwrap(), &setup, |_| ()).unwrap();
    run.check().unwrap();
    let last = run.telemetry.frames.last().unwrap();
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    let parasitic = run.parasitic(SETTLED_S, setup.device.handle.diameter_m);
    parasitic.unwrap().rms_mn
}

/// Zero and gain that `calibrate` has left are those of the errors. The zeros of the monitors are 11 and -7
/// codes off, and their noise is 2 codes.
fn assert_calibrated(address: SocketAddr, errors: [(f64, f64); 2]) {
    for ((offset, gain), motor) in errors.into_iter().zip(["large", "small"]) {
        let off = setting(address, &format!("zero-{motor}")) - (2048.0 - offset);
        assert!(off.abs() < 0.3, "{motor}: {off} codes");
        let ratio = setting(address, &format!("gain-{motor}")) / gain;
        assert!((ratio - 1.0).abs() < 5e-3, "{motor}: {ratio}");
    }
}

/// A board with offset and gain that are worse than the datasheet allows is calibrated over its port, starts
/// again with what its flash holds then, and renders free air as a board without these errors does.
#[test]
fn calibrate_leaves_less_than_1_mn_of_15_codes_after_the_next_start() {
    const NONE: [(f64, f64); 2] = [(0.0, 1.0); 2];
    let perfect = parasitic_mn(NONE, None);
    for (offset, gains) in [(15.0, [0.96, 1.04]), (-15.0, [1.04, 0.96])] {
        let errors = gains.map(|gain| (offset, gain));
        let (address, board) = EmulatedBoard::with(MONITORS, with_dac_errors(errors));
        let (text, status) = said(address, &["calibrate", "--store"]);
        assert_eq!(status, Some(0), "{text}");
        assert_calibrated(address, errors);
        if offset > 0.0 {
            // Calibrated once more, nothing is left to correct.
            let (text, status) = said(address, &["calibrate"]);
            assert_eq!(status, Some(0), "{text}");
            let small = text.matches("slope 1.00").count() + text.matches("slope 0.99").count();
            assert_eq!(small, 2, "{text}");
        }
        let flash = board.end();
        assert!(flash.settings().is_some_and(|it| it.are_signs_verified()));
        let [before, after] = [None, Some(flash)].map(|flash| parasitic_mn(errors, flash));
        println!(
            "{offset} codes: {before:.2} mN RMS before, {after:.2} mN after; {perfect:.2} mN without errors"
        );
        assert!((after - perfect).abs() < 1.0);
        // Otherwise the bound above says nothing.
        assert!((before - perfect).abs() > 1.0);
    }
}

#[test]
fn calibrate_changes_nothing_with_an_open_lead_or_without_monitors() {
    let (address, board) = EmulatedBoard::with(MONITORS, blank(Some(Fault::OpenLead)));
    let (text, status) = said(address, &["calibrate"]);
    assert_eq!(status, Some(1), "{text}");
    assert!(
        text.contains("FAIL  large motor") && text.contains("leads"),
        "{text}"
    );
    assert_eq!(setting(address, "zero-large"), 2048.0);
    assert_eq!(state_now(address), Some(Mode::Boot));
    board.end();
    let (address, board) = EmulatedBoard::start(blank(None));
    let output = tool(address, &["calibrate"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("current-monitor"), "{text}");
    board.end();
}
