//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use clap::Parser;
use drive::patience::{USUAL, patience};
use recordings::arguments::{DeviceFile, RecordingOptions};
use terminal::explain;
use terminal::failure::Failure;
use terminal::output::{note, print_bytes};
use terminal::parse::parsed;
use terminal::wording::WIDTH;

use crate::hub::{Event, Hub};
use crate::order::Order;
use crate::server::Server;
use crate::source::{Emulated, RealBoard, Recorded, Source};
use crate::stream::{Stream, mcap_file};
use crate::token::random;

/// Serves a page on which the device runs live: the flash image on an emulated board in real time, a
/// board over its link, or a recording.
///
/// The page is at the loopback interface alone. Ctrl-C ends the server and disarms the board.
#[derive(Debug, Parser)]
#[command(
    name = "cargo scope",
    bin_name = "cargo scope",
    version,
    max_term_width = WIDTH,
    after_help = "Exit status: 0; 1 if the server fails, or the board is not disarmed at the end; 2 if the input \
cannot be used, or the board does not answer or is lost.\n\nExamples:
  cargo scope
  cargo scope --recording run.csv
  cargo scope --board /dev/ttyACM0 --record run.mcap"
)]
struct Arguments {
    /// TCP port of the page at 127.0.0.1, 0 for a free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
    /// ELF file of the flash image for the emulated board [default: the image is built]
    #[arg(long, value_name = "ELF", conflicts_with_all = ["recording", "board"])]
    image: Option<PathBuf>,
    #[command(flatten)]
    device: DeviceFile,
    /// Play a recording instead: CSV as for cargo sim replay; - is standard input
    #[arg(long, value_name = "FILE.csv", conflicts_with = "board")]
    recording: Option<PathBuf>,
    #[command(flatten)]
    read: RecordingOptions,
    /// Show and command a board instead: a serial port, or tcp:HOST:PORT
    #[arg(long, value_name = "PORT")]
    board: Option<String>,
    /// Longest wait for an answer of the board, and longest silence of it, 0.1 to 60 s [default: 2]
    #[arg(long, value_name = "S", requires = "board", value_parser = patience)]
    timeout: Option<f64>,
    /// Write all rows from the start to the end of the server to FILE, which is complete after Ctrl-C
    #[arg(long, value_name = "FILE.mcap", value_parser = mcap_file, conflicts_with = "recording")]
    record: Option<PathBuf>,
}

/// Runs the command line.
///
/// # Errors
/// [`Failure::Input`] if the input cannot be used or a board is lost, [`Failure::Check`] if the server fails.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = match parsed::<Arguments>(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return explain(&error, "cargo scope"),
    };
    if arguments.recording.is_none() {
        arguments.read.check_unused("--recording FILE.csv")?;
    }
    let device = arguments.device.load()?;
    // A port that is taken is told before an image is built.
    let server = Server::bind(arguments.port)?;
    let source: Box<dyn Source> = match (arguments.recording, arguments.board) {
        (Some(path), _) => Box::new(Recorded::read(&path, &arguments.read, &arguments.device)?),
        (None, Some(port)) => {
            let usual = || patience(USUAL);
            let patience = arguments.timeout.map_or_else(usual, Ok)?;
            let patience = Duration::from_secs_f64(patience);
            Box::new(RealBoard::open(&port, device, patience)?)
        }
        (None, None) => {
            if arguments.image.is_none() {
                note("building the flash image, which takes a minute the first time");
            }
            Box::new(Emulated::new(arguments.image, device)?)
        }
    };
    serve(server, source, arguments.record, !arguments.no_open)
}

fn serve(
    server: Server,
    source: Box<dyn Source>,
    record: Option<PathBuf>,
    opens: bool,
) -> Result<(), Failure> {
    let (hub, orders) = Hub::new(random()?, source.facts());
    let stopping = Arc::clone(&hub);
    ctrlc::set_handler(move || stopping.stop.store(true, Ordering::Relaxed))
        .map_err(|error| Failure::Check(format!("Ctrl-C: {error}")))?;
    let stream = record.map(|path| Stream::start(path, &hub)).transpose()?;
    let url = server.url();
    print_bytes(format!("{url}\n").as_bytes())?;
    if opens {
        open(&url);
    }
    let source = begin(source, Arc::clone(&hub), orders)?;
    let served = server.serve(&hub);
    hub.stop.store(true, Ordering::Relaxed);
    let ended = source.join().unwrap_or_else(|_| Err(panicked()));
    hub.tell(Event::End);
    let streamed = stream.map_or(Ok(()), Stream::finish);
    let rescued = hub.rescue();
    ended.and(served).and(streamed).and(rescued)
}

/// Runs a source on a thread of its own. The end of the source ends the server.
fn begin(
    source: Box<dyn Source>,
    hub: Arc<Hub>,
    orders: Receiver<Order>,
) -> Result<JoinHandle<Result<(), Failure>>, Failure> {
    let named = thread::Builder::new().name("source".to_owned());
    let spawned = named.spawn(move || {
        let end = SourceEnd(Arc::clone(&hub));
        let ended = source.run(hub, orders);
        if let Err(failure) = &ended {
            end.0.ended(failure);
        }
        ended
    });
    spawned.map_err(|error| Failure::Check(format!("a thread: {error}")))
}

fn panicked() -> Failure {
    Failure::Check("the source panicked".to_owned())
}

/// The end of a source, by a panic too: it is told and ends the server.
struct SourceEnd(Arc<Hub>);

impl Drop for SourceEnd {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.ended(&panicked());
        }
        self.0.stop.store(true, Ordering::Relaxed);
    }
}

/// Opens the page in a browser, if the system has a program for it.
fn open(url: &str) {
    let program = if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let mut command = Command::new(program);
    command
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if let Ok(mut child) = command.spawn() {
        // Its end is waited for, so that it leaves no process behind.
        thread::spawn(move || drop(child.wait()));
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    struct Panics;

    impl Source for Panics {
        fn facts(&self) -> Value {
            Value::Null
        }

        fn run(self: Box<Self>, _: Arc<Hub>, _: Receiver<Order>) -> Result<(), Failure> {
            panic!("as a test");
        }
    }

    #[test]
    fn source_that_panics_is_told_and_ends_the_server() {
        let (hub, orders) = Hub::new("token".to_owned(), Value::Null);
        let mut events = hub.listen();
        let source = begin(Box::new(Panics), Arc::clone(&hub), orders).expect("a thread");
        assert!(source.join().is_err());
        assert!(hub.stops());
        let Ok(Event::Text(told)) = events.try_recv() else {
            panic!("an event");
        };
        let told: Value = serde_json::from_str(&told).expect("JSON");
        assert_eq!(
            (&told["type"], &told["why"]),
            (&"ended".into(), &"the source panicked".into())
        );
    }
}
