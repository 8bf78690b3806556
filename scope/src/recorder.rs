//! Recordings that a page makes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use drivers::link::{Hello, Message};
use recordings::record::{choose, csv};
use recordings::telemetry::Telemetry;

use terminal::failure::Failure;
use terminal::output::{note, write_whole};

/// Kinds of files of a recording.
const FILES: [&str; 2] = ["csv", "mcap"];

/// Held while the names of files are chosen and the files are written.
static NAMES: Mutex<()> = Mutex::new(());

/// Longest recording, rows: two minutes, so that its memory is bounded.
pub(crate) const LONGEST: usize = 120_000;

/// A recording in the making.
pub(crate) struct Recorder {
    telemetry: Telemetry,
    rate_hz: f64,
    truths: HashMap<u32, f64>,
    rows: Vec<Box<[f64]>>,
}

/// A finished recording.
pub(crate) struct Finished {
    recorder: Recorder,
    /// Whether a page has taken it.
    is_taken: AtomicBool,
}

impl Recorder {
    /// A recording of an image, from the next frame on.
    pub(crate) fn new(hello: &Hello) -> Self {
        let mut telemetry = Telemetry::default();
        telemetry.add(Message::Hello(*hello));
        Self {
            telemetry,
            rate_hz: f64::from(hello.rate),
            truths: HashMap::new(),
            rows: Vec::new(),
        }
    }

    /// Takes a message.
    pub(crate) fn take(&mut self, message: Message) {
        self.telemetry.add(message);
    }

    /// Takes the row of frame number `seq`, with the true velocity of the large motor if it is known.
    pub(crate) fn row(&mut self, seq: u32, row: &[f64], true_omega: f64) {
        if true_omega.is_finite() {
            self.truths.insert(seq, true_omega);
        }
        self.rows.push(row.into());
    }

    /// Number of rows so far.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether the recording is as long as one may be.
    pub(crate) fn is_full(&self) -> bool {
        self.len() >= LONGEST
    }

    pub(crate) fn finish(self) -> Finished {
        Finished {
            recorder: self,
            is_taken: AtomicBool::new(false),
        }
    }
}

impl Finished {
    /// A page has taken the recording.
    pub(crate) fn take(&self) {
        self.is_taken.store(true, Ordering::Relaxed);
    }

    /// Writes the recording, if no page has taken it, as CSV and MCAP to new files in the current folder.
    ///
    /// # Errors
    /// [`Failure`] if they cannot be written.
    pub(crate) fn rescue(&self, estimators: &[&str]) -> Result<(), Failure> {
        // A recording of one frame is none.
        let Some(csv) = self
            .csv()
            .ok()
            .filter(|_| !self.is_taken.load(Ordering::Relaxed))
        else {
            return Ok(());
        };
        // Two recordings at a time would choose one name.
        let _names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        let name = (1..).map(|number| format!("scope-{number}")).find(|name| {
            FILES
                .iter()
                .all(|kind| !Path::new(&format!("{name}.{kind}")).exists())
        });
        let name = name.unwrap_or_default();
        let [csv_file, mcap_file] = FILES.map(|kind| PathBuf::from(format!("{name}.{kind}")));
        write_whole(&csv_file, csv.as_bytes())?;
        write_whole(&mcap_file, &self.mcap(estimators)?)?;
        note(format_args!(
            "the recording that no page has taken is in {} and {}",
            csv_file.display(),
            mcap_file.display()
        ));
        Ok(())
    }

    /// The recording as CSV that `cargo sim replay` reads: its longest run, if the board started again.
    ///
    /// # Errors
    /// One line if there are fewer than two frames.
    pub(crate) fn csv(&self) -> Result<String, String> {
        let runs = self.recorder.telemetry.runs();
        if runs.is_empty() {
            return Err("the recording has no frame; record for longer".to_owned());
        }
        let run = choose(&runs, None).map_err(|failure| failure.to_string())?;
        let truth =
            |frame: &recordings::telemetry::Frame| self.recorder.truths.get(&frame.seq).copied();
        Ok(csv(run, self.recorder.rate_hz, truth))
    }

    /// All rows as MCAP.
    ///
    /// # Errors
    /// One line if the file cannot be made.
    pub(crate) fn mcap(&self, estimators: &[&str]) -> Result<Vec<u8>, String> {
        channels::mcap(self.recorder.rows.iter().map(AsRef::as_ref), estimators)
    }
}
