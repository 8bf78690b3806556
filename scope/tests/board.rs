//! The server with a board at a port that does not answer, belongs to another program, or falls silent.

mod common;

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::process::{Command as Process, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use common::devtools::Browser;
use common::{Client, Server};
use drive::port::TAKEN;
use drivers::link::{Frame, Hello, LONGEST, Message, PROTOCOL};
use drivers::{Command, NO_ESTIMATOR, Parser};
use haptic_control::{Mode, Request};
use serde_json::json;

/// A port at which `serve` has the connection.
fn port(serve: impl FnOnce(TcpStream) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = format!("tcp:{}", listener.local_addr().expect("an address"));
    thread::spawn(move || serve(listener.accept().expect("a client").0));
    port
}

/// A board that a test plays, and its port.
fn played(shared: Shared) -> (Arc<Shared>, String) {
    let shared = Arc::new(shared);
    let of_board = Arc::clone(&shared);
    let port = port(move |stream| play(stream, &of_board));
    (shared, port)
}

/// The server with a board at this port, to its end.
fn run(port: &str, timeout: &str) -> Output {
    let mut process = Process::new(env!("CARGO_BIN_EXE_scope"));
    process.args(["--no-open", "--timeout", timeout, "--board", port]);
    process.output().expect("the server ends")
}

#[test]
fn port_without_an_answer_is_told_before_a_page_is_served() {
    let silent = port(|mut stream| {
        let _ = stream.read_to_end(&mut Vec::new());
    });
    let taken = port(|mut stream| {
        stream.write_all(TAKEN).expect("a client");
        stream.shutdown(Shutdown::Write).expect("a client");
        let _ = stream.read_to_end(&mut Vec::new());
    });
    for (port, timeout, said) in [
        (
            silent,
            "0.5",
            "the board sends nothing; check the port, the power and that the image has the link",
        ),
        // The answer comes late on a busy computer.
        (taken, "60", "another program has this port; end it first"),
    ] {
        let output = run(&port, timeout);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(output.stdout.is_empty(), "{output:?}");
        let text = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(text, format!("error: {port}: {said}\n"));
    }
}

/// What a board of this test has got, and whether it sends.
#[derive(Default)]
struct Shared {
    is_frozen: AtomicBool,
    /// Whether the board closes its end.
    hangs_up: AtomicBool,
    /// Whether another image speaks a later protocol.
    is_updated: AtomicBool,
    /// Whether the order to disarm ends the scene.
    obeys: bool,
    commands: Mutex<Vec<Command>>,
}

/// Sends the identity and a frame of a running scene again and again, but while it is frozen.
fn play(mut stream: TcpStream, shared: &Shared) {
    let mut hello = Hello {
        protocol: PROTOCOL,
        rate: 10_000,
        ..Hello::default()
    };
    let mut frame = Frame {
        state: Mode::Running as u8,
        estimator: NO_ESTIMATOR,
        ..Frame::default()
    };
    let mut parser = Parser::default();
    let wait = Some(Duration::from_millis(5));
    stream.set_read_timeout(wait).expect("a socket");
    loop {
        let mut bytes = [0; 256];
        match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => {
                let commands = bytes[..count].iter().filter_map(|byte| parser.take(*byte));
                let commands: Vec<_> = commands.collect();
                if shared.obeys && commands.contains(&Command::Request(Request::Disarm)) {
                    frame.state = Mode::Boot as u8;
                }
                shared.commands.lock().expect("a list").extend(commands);
            }
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => return,
        }
        if shared.hangs_up.load(Ordering::Relaxed) {
            return;
        }
        if shared.is_frozen.load(Ordering::Relaxed) {
            continue;
        }
        if shared.is_updated.load(Ordering::Relaxed) {
            hello.protocol = PROTOCOL + 1;
        }
        frame.seq += 1;
        frame.tick += 10;
        for message in [Message::from(hello), frame.into()] {
            let mut buffer = [0; LONGEST];
            let bytes = message.encode(&mut buffer).expect("a message");
            if stream.write_all(bytes).is_err() {
                return;
            }
        }
    }
}

const DISARM: Command = Command::Request(Request::Disarm);

/// A board that is played, and its server.
fn served(obeys: bool) -> (Arc<Shared>, Server) {
    let (shared, port) = played(Shared {
        obeys,
        ..Shared::default()
    });
    let server = Server::start(&["--board", &port, "--timeout", "60"]);
    (shared, server)
}

/// The same with a page that commands it, after the server has disarmed it.
fn disarmed() -> (Arc<Shared>, Server, Client) {
    let (shared, server) = served(true);
    let mut page = server.joined();
    page.lives = true;
    page.status("disarmed", |status| status["mode"] == "boot");
    (shared, server, page)
}

#[test]
fn board_that_runs_a_scene_already_is_disarmed() {
    let (shared, ..) = disarmed();
    let commands = shared.commands.lock().expect("a list");
    let others = commands.iter().find(|it| **it != Command::Identify);
    assert_eq!(others, Some(&DISARM), "{commands:?}");
}

/// The first order may be lost on its way.
#[test]
fn board_that_stays_enabled_is_disarmed_again() {
    let (shared, server) = served(false);
    server.client().wait("orders to disarm", |_, _| {
        let commands = shared.commands.lock().expect("a list");
        let orders = commands.iter().filter(|it| **it == DISARM);
        (orders.count() >= 3).then_some(())
    });
}

#[test]
fn page_that_has_gone_disarms_the_board() {
    let (shared, server, mut page) = disarmed();
    // The orders of the server, which found the board enabled, are past where none comes for half a second.
    let mut quiet = (0, Instant::now());
    page.wait("no further order", |_, _| {
        let commands = shared.commands.lock().expect("a list");
        let orders = commands.iter().filter(|it| **it == DISARM).count();
        if orders != quiet.0 {
            quiet = (orders, Instant::now());
        }
        (quiet.1.elapsed() > Duration::from_millis(500)).then_some(())
    });
    shared.commands.lock().expect("a list").clear();
    drop(page);
    server.client().wait("an order to disarm", |_, _| {
        let commands = shared.commands.lock().expect("a list");
        commands.contains(&DISARM).then_some(())
    });
}

/// Its messages would be misunderstood.
#[test]
fn board_that_is_given_an_image_of_another_protocol_ends_the_server() {
    let (shared, mut server) = served(true);
    let mut page = server.client();
    page.status("frames", |status| !status["mode"].is_null());
    shared.is_updated.store(true, Ordering::Relaxed);
    let why = page.wait("an end", |_, message| {
        (message["type"] == "ended").then(|| message["why"].to_string())
    });
    assert!(why.contains("protocol"), "{why}");
    let status = server.child.wait().expect("an end");
    assert_eq!(status.code(), Some(2));
}

#[test]
fn page_of_a_silent_board_says_so_and_has_no_controls() {
    let (shared, port) = played(Shared::default());
    let server = Server::start(&["--board", &port, "--timeout", "2"]);
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let tab = browser.open(&server.url(), 1300, 900);
    let free =
        "$('mode').textContent === 'running' && $('notice').hidden && !$('commands').disabled";
    browser.wait(&tab, free);
    shared.is_frozen.store(true, Ordering::Relaxed);
    browser.wait(
        &tab,
        "$('mode').textContent === 'no answer' && $('notice').textContent.includes('sends nothing') \
         && !$('notice').hidden && $('commands').disabled && $('bench').disabled",
    );
    shared.is_frozen.store(false, Ordering::Relaxed);
    browser.wait(&tab, free);
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn board_that_falls_silent_is_told_and_gets_no_command_but_disarm() {
    let (shared, port) = played(Shared {
        obeys: true,
        ..Shared::default()
    });
    let mut server = Server::start(&["--board", &port, "--timeout", "2"]);
    let mut page = server.joined();
    page.lives = true;
    // The board was enabled before this server, whose only order to disarm is that until now.
    page.status("disarmed", |status| {
        status["mode"] == "boot" && status["silent"].is_null()
    });
    let list = || shared.commands.lock().expect("a list");
    list().clear();
    shared.is_frozen.store(true, Ordering::Relaxed);
    let status = page.status("a silence", |status| !status["silent"].is_null());
    let said = format!("{port}: the board sends nothing; check the port");
    assert!(status["silent"].to_string().contains(&said), "{status}");
    page.order(&json!({"do": "arm"}));
    page.order(&json!({"do": "disarm"}));
    // The order of the server and that of the page. What the server sent before may come to the board after the page
    // has been told of the silence.
    let [arm, disarm] = [Request::Arm, Request::Disarm].map(Command::Request);
    let got = page.wait("both orders to disarm, and nothing else since", |_, _| {
        let got = list().clone();
        got.ends_with(&[disarm; 2]).then_some(got)
    });
    assert!(!got.contains(&arm), "{got:?}");

    shared.is_frozen.store(false, Ordering::Relaxed);
    page.status("it sends again", |status| status["silent"].is_null());
    shared.is_frozen.store(true, Ordering::Relaxed);
    // No frame of a disarmed board is on its way any more: the disarm is not confirmed.
    page.status("a silence again", |status| !status["silent"].is_null());
    assert!(!server.interrupt());
}

/// The server ends then: the page must not show the last state as that of now.
#[test]
fn page_of_a_lost_board_says_so() {
    let (shared, port) = played(Shared::default());
    let server = Server::start(&["--board", &port, "--timeout", "60"]);
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let tab = browser.open(&server.url(), 1300, 900);
    browser.wait(
        &tab,
        "$('mode').textContent === 'running' && scope.link.isOpen",
    );
    shared.hangs_up.store(true, Ordering::Relaxed);
    let said = format!("{port}: connection lost: ");
    browser.wait(
        &tab,
        &format!(
            "$('mode').textContent === 'no connection' && $('mode').classList.contains('safe') && $('pace').hidden \
             && $('notice').textContent.startsWith('{said}') && $('commands').disabled && !scope.link.isOpen"
        ),
    );
}

/// What a board does not report has no empty plot and no empty line.
#[test]
fn page_of_a_board_shows_what_the_board_reports_and_says_what_it_does_not() {
    let (_, port) = played(Shared::default());
    let server = Server::start(&["--board", &port, "--timeout", "60"]);
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let tab = browser.open(&server.url(), 1300, 900);
    browser.wait(&tab, "scope.frames > 2");
    let shown = browser.value(
        &tab,
        "scope.plots.plots.map(({ plot, spec }) => [spec.id, ...plot.series.slice(1).map((s) => s.label)])",
    );
    let expected = json!([
        ["velocity", "finite-difference", "in charge"],
        ["torque", "wanted"],
        ["current", "large commanded", "small commanded"],
        ["cost", "cycles"]
    ]);
    assert_eq!(shown, expected);
    let said = browser.value(&tab, "$('felt-words').textContent");
    assert_eq!(
        said,
        "A board does not report the force at the fingertip. The torque that its scene wants has a plot."
    );
    let hidden = "$('force').getClientRects().length + $('meter').getClientRects().length";
    assert_eq!(browser.value(&tab, hidden), 0);
    // No label of the legend is hidden as that of the interval.
    let labels = "$('plot-velocity').querySelectorAll('.u-series').length - [...$('plot-velocity').querySelectorAll('.u-series')].filter((e) => e.getClientRects().length).length";
    assert_eq!(browser.value(&tab, labels), 0);
    assert_eq!(browser.complaints, [""; 0]);
}
