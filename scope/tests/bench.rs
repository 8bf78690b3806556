//! Settings and guided procedures over the server, on its own emulated board and on one behind a link.

mod common;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use common::{ATTEMPTS, Client, Server, is_stalled};
use drivers::{Setting, Settings};
use experiments::closed_loop::Hand;
use serde_json::{Value, json};
use virtual_board::bridge::Bridge;
use virtual_board::image::Image;
use virtual_board::run::{DacError, Setup};

/// A client that commands and lives, of a server whose board sends frames.
fn commanding(server: &Server) -> Client {
    let mut client = server.joined();
    assert_eq!(client.role()["commands"], true);
    client.lives = true;
    client.status("the board sends frames", |status| status["mode"] == "boot");
    client
}

/// The value of a setting in a status.
fn setting(status: &Value, setting: Setting) -> f64 {
    let value = &status["settings"][usize::from(setting.number())];
    value.as_f64().expect("a value")
}

/// Asks until the board's value of a setting is as wanted.
fn until(client: &mut Client, wanted: Setting, is_it: impl Fn(f64) -> bool) -> Value {
    client.wait(wanted.facts().name, |client, message| {
        if message["type"] != "status" {
            return None;
        }
        client.order(&json!({"do": "settings"}));
        let is_known = message["settings"].is_array();
        (is_known && is_it(setting(message, wanted))).then(|| message.clone())
    })
}

/// Orders a procedure and returns the status that is as `wanted`. One that a stalled machine ended, or whose
/// order found no room, is ordered again.
fn guided(client: &mut Client, name: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    for _ in 0..ATTEMPTS {
        let before = client.status("a status", |_| true);
        client.order(&json!({"do": "guide", "name": name}));
        // Orders that found no room are counted.
        client.status("the procedure begins", |status| {
            status["guide"] != before["guide"] || status["counts"] != before["counts"]
        });
        let status = client.status("the procedure is as wanted, or ends", |status| {
            wanted(status) || status["guide"]["runs"] != true
        });
        if wanted(&status) {
            return status;
        }
        let guide = &status["guide"];
        let failure = &guide["failure"];
        assert!(failure.is_null() || is_stalled(failure), "{guide}");
        eprintln!("{name} again: {failure}");
    }
    panic!("{ATTEMPTS} attempts at {name}");
}

/// Lines of a procedure that has ended without a failure.
fn completed(client: &mut Client, name: &str) -> Vec<String> {
    let status = guided(client, name, |status| {
        let guide = &status["guide"];
        guide["name"] == name && guide["runs"] == false && guide["failure"].is_null()
    });
    let lines = status["guide"]["lines"].as_array().expect("lines");
    lines
        .iter()
        .map(|line| line.as_str().expect("a line").to_owned())
        .collect()
}

#[test]
fn settings_are_shown_set_and_stored_and_a_frozen_page_ends_a_procedure() {
    let server = Server::emulated();
    let mut page = commanding(&server);
    let scale = Setting::CurrentScale;
    let status = until(&mut page, scale, |value| value == 1.0);
    let number = Setting::ALL.len();
    assert_eq!(status["settings"].as_array().map(Vec::len), Some(number));
    let set = |page: &mut Client, value: f64| {
        page.order(&json!({"do": "set", "setting": scale.number(), "value": value}));
    };
    set(&mut page, 0.5);
    until(&mut page, scale, |value| value == 0.5);
    set(&mut page, 1.5);
    let why = page.wait("a refusal", |_, message| {
        (message["type"] == "refused").then(|| message["why"].to_string())
    });
    assert!(why.contains("current-scale must be from 0 to 1"), "{why}");
    page.order(&json!({"do": "set", "setting": Setting::Estimator.number(), "value": 77}));
    let why = page.wait("a refusal", |_, message| {
        (message["type"] == "refused").then(|| message["why"].to_string())
    });
    assert!(why.contains("the image has no estimator 77"), "{why}");
    page.order(&json!({"do": "store"}));
    let status = page.status("an outcome", |status| !status["stored"].is_null());
    assert_eq!(status["stored"]["words"], "settings stored");
    // The value is still that of before the refused one.
    until(&mut page, scale, |value| value == 0.5);

    // The image measures no currents.
    page.order(&json!({"do": "guide", "name": "calibrate"}));
    let status = page.status("a refusal", |status| {
        status["guide"]["name"] == "calibrate" && status["guide"]["runs"] == false
    });
    let why = status["guide"]["failure"].to_string();
    assert!(why.contains("current-monitor"), "{why}");
    let lines = completed(&mut page, "bring-up");
    let passed = lines.iter().filter(|line| line.starts_with("pass")).count();
    assert!(passed >= 5, "{lines:?}");

    // The page freezes while a procedure has the amplifiers enabled, and keeps them alive.
    guided(&mut page, "bring-up", |status| {
        status["guide"]["runs"] == true && status["on"] == true
    });
    page.lives = false;
    let mut other = server.joined();
    let status = other.status("it ends", |status| status["guide"]["runs"] == false);
    assert!(status["guide"]["failure"].is_string(), "{status}");
    let status = other.status("the board is disarmed", |status| status["on"] == false);
    assert_eq!(status["cause"], "none", "by an order, not by a silence");
}

/// A board behind a TCP port, whose outputs have an offset and a gain.
struct Board {
    port: String,
    stop: Arc<AtomicBool>,
    runs: JoinHandle<()>,
}

impl Board {
    fn start(features: &str, errors: [DacError; 2]) -> Self {
        let image = Image::build(features).expect("the firmware builds");
        let bridge = Bridge::bind(0).expect("a port");
        let port = format!("tcp:{}", bridge.address());
        let setup = Setup {
            hand: Hand::Gone(0.0),
            seconds: 3600.0,
            commands: Vec::new(),
            keep_alive: false,
            settings: Some(Settings::COMMISSIONED),
            dac_errors: errors,
            ..Setup::default()
        };
        let stop = Arc::new(AtomicBool::new(false));
        let until = Arc::clone(&stop);
        let runs = std::thread::spawn(move || {
            bridge.run(&image, &setup, until).expect("a run");
        });
        Self { port, stop, runs }
    }

    fn end(self) {
        self.stop.store(true, Ordering::Relaxed);
        self.runs.join().expect("the board ends without a fault");
    }
}

#[test]
fn board_behind_a_link_is_commanded_calibrated_and_disarmed_at_the_end() {
    let error = |offset, gain| DacError { offset, gain };
    let board = Board::start("current-monitor", [error(6.0, 1.0), error(-4.0, 1.0)]);
    let mut server = Server::start(&["--board", &board.port, "--timeout", "60"]);
    let mut page = commanding(&server);
    let lines = completed(&mut page, "calibrate");
    let passed = lines.iter().filter(|line| line.starts_with("pass")).count();
    assert_eq!(passed, 2, "{lines:?}");
    // The calibration of the emulated board is within 0.3 codes.
    let status = until(&mut page, Setting::ZeroLarge, |value| value != 2048.0);
    for (zero, wanted) in [(Setting::ZeroLarge, 2042.0), (Setting::ZeroSmall, 2052.0)] {
        let off = setting(&status, zero) - wanted;
        assert!(off.abs() < 0.3, "{off} codes");
    }

    page.order(&json!({"do": "arm"}));
    page.status("armed", |status| status["mode"] == "armed");
    page.order(&json!({"do": "scene", "number": 1}));
    page.status("running", |status| status["mode"] == "running");
    let before = page.rows;
    page.wait("rows", |page, _| (page.rows > before + 500).then_some(()));
    assert_eq!((page.value("drops"), page.lost), (0.0, 0.0));
    // What only a simulation knows is not there.
    assert!(page.value("true_omega").is_nan() && page.value("force").is_nan());
    assert!(page.value("velocity_large").is_finite() && page.value("cycles") > 0.0);

    // The server ends by itself: the next one finds a board that was disarmed and has no cause of a stop.
    assert!(server.interrupt());
    drop(server);
    let server = Server::start(&["--board", &board.port, "--timeout", "60"]);
    let mut page = commanding(&server);
    let status = page.status("a status", |status| status["mode"] == "boot");
    assert_eq!(status["cause"], "none", "by an order, not by a silence");
    drop((page, server));
    board.end();
}
