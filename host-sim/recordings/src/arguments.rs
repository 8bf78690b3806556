//! Options of the commands that read recordings.

use std::path::{Path, PathBuf};

use clap::Args;
use simulation::device::{Device, parsed_counts_per_rev};
use terminal::failure::Failure;

use crate::log::{Log, file_name};
use crate::recording::stale::{FAST, LONGEST};
use crate::recording::{
    Quantity, ReadOptions, Recording, Survey, current_option, stated_counts_per_rev,
};

/// A line on counts per revolution of `source` that are `used` where a recording has `stated` others.
#[must_use]
pub fn differing_counts(used: u32, source: &str, stated: u32) -> String {
    format!("{used} counts/rev of {source} are used; the recording states {stated}")
}

/// The device file of a command.
#[derive(Clone, Debug, Default, Args)]
pub struct DeviceFile {
    /// Device file; a key that is not in the file keeps its default [see host-sim device]
    #[arg(long, value_name = "FILE.toml")]
    device: Option<PathBuf>,
}

/// The encoder of a recording: a group of its own, because `export --c` takes it without a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Args)]
pub struct EncoderOptions {
    /// Counts per revolution of the encoder: four times its lines [default: those in the device file,
    /// or as the recording states them]
    #[arg(long, value_name = "N", value_parser = parsed_counts_per_rev)]
    pub counts_per_rev: Option<u32>,
}

/// The columns of a recording, and its encoder and clock.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct ColumnOptions {
    /// The values of `--column`.
    #[arg(long = "column", value_name = "OURS=THEIRS[:UNIT]", help = column_help())]
    pub columns: Vec<String>,
    /// Counts of a revolution of an absolute encoder, at which the column counts_large wraps;
    /// counts_small=M for the other encoder; repeatable
    #[arg(long, value_name = "M")]
    pub modulus: Vec<String>,
    /// Rate of the rows, for a recording without a column of time, or whose times jitter
    #[arg(long, value_name = "HZ")]
    pub row_rate: Option<f64>,
    /// Leave out stale readings.
    #[arg(long, help = drop_stale_help())]
    pub drop_stale: bool,
}

/// How a recording is read.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct RecordingOptions {
    /// Its columns.
    #[command(flatten)]
    pub columns: ColumnOptions,
    /// Replace the rows by rows at a constant rate: counts are interpolated and rounded
    #[arg(long, value_name = "HZ")]
    pub resample: Option<f64>,
    /// The encoder.
    #[command(flatten)]
    pub encoder: EncoderOptions,
}

/// A recording with the columns of the board and its device.
#[derive(Clone, Debug)]
pub struct Whole {
    /// The recording, with the board's columns if it is from one. Its notes are those of the reader.
    pub recording: Recording,
    /// The device, with the counts per revolution that the recording states.
    pub device: Device,
    /// A line on the counts per revolution, if the recording states them.
    pub stated: Vec<String>,
}

/// The device of a device file, before its recordings are read.
#[derive(Clone, Debug)]
pub struct Loaded {
    device: Device,
    /// Name of the file, if it states the counts per revolution.
    counts_of: Option<String>,
}

/// The device of recordings.
#[derive(Clone, Debug)]
pub struct Counted {
    /// The device, with the counts per revolution of the recordings.
    pub device: Device,
    /// Whether the recordings state these counts, and nothing else does.
    pub is_stated: bool,
    /// A line for each recording that states its counts per revolution.
    pub lines: Vec<String>,
}

/// Help text of `--column`.
fn column_help() -> String {
    let quantities = [
        Quantity::Time,
        Quantity::Position,
        Quantity::Current,
        Quantity::Velocity,
    ];
    format!(
        "Read a column from the user's column of another name, with its unit: t=time_ms:ms, \
         counts_large=angle:deg. The end of the name may be the unit (time_ms); a number is the number of the \
         column. Units: {}. Repeatable",
        quantities.map(Quantity::list).join("; ")
    )
}

/// Help text of `--drop-stale`.
fn drop_stale_help() -> String {
    format!(
        "Leave out rows in which counts_large stays though the shaft turned by {FAST} counts or more in both rows before: \
         stale readings, as where a bus lost a message. At most {LONGEST} in turn: a shaft that stays for longer rests"
    )
}

impl ColumnOptions {
    /// What the options say about the log of `device`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the option.
    pub fn options(&self, device: &Device) -> Result<ReadOptions, Failure> {
        let mut options = ReadOptions::of(device);
        for text in &self.columns {
            options.add_columns(text)?;
        }
        for text in &self.modulus {
            options.set_modulus(text)?;
        }
        if let Some(hz) = self.row_rate {
            options.set_row_rate(hz)?;
        }
        options.drop_stale = self.drop_stale;
        Ok(options)
    }
}

impl RecordingOptions {
    /// The device of a file with the counts per revolution of the recordings.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the recording.
    pub fn counted(&self, loaded: Loaded, logs: &[Log]) -> Result<Counted, Failure> {
        let mut device = loaded.device;
        let known = match self.encoder.counts_per_rev {
            Some(given) => {
                device.stages.large.counts_per_rev = given;
                Some("the options")
            }
            None => loaded.counts_of.as_deref(),
        };
        Counted::new(device, known, logs)
    }

    /// Checks that no option is given, for a command without a recording, which `give` tells to give.
    ///
    /// # Errors
    /// [`Failure::Input`] with all the options.
    pub fn check_unused(&self, give: &str) -> Result<(), Failure> {
        if *self == Self::default() {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "--column, --modulus, --row-rate, --drop-stale, --resample and --counts-per-rev read a recording: give \
             {give}"
        )))
    }

    /// Reads the recording `log` of `device`. Its notes are those of the reader.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file, its line and its column, or the option.
    pub fn read(&self, log: &Log, device: &Device) -> Result<Recording, Failure> {
        let options = self.columns.options(device)?;
        let recording = Recording::parse_as(log.reader()?, log.name(), &options)?;
        self.finished(recording, &options, log)
    }

    /// `recording` as it was read from `log` with `options`, with unwrapped counts and at the rate that is wanted.
    fn finished(
        &self,
        mut recording: Recording,
        options: &ReadOptions,
        log: &Log,
    ) -> Result<Recording, Failure> {
        let unwrapped = recording.unwrap_counts(options);
        recording.notes.extend(unwrapped);
        if let Some(hz) = self.resample {
            recording.notes.extend(recording.unevenness());
            recording.resample(hz, log.name())?;
        }
        Ok(recording)
    }

    /// The part of `--column` that names the motor current, as [`current_option`].
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file, or the option.
    pub fn current_option(&self, log: &Log, device: &Device) -> Result<Option<String>, Failure> {
        current_option(log.reader()?, log.name(), &self.columns.options(device)?)
    }

    /// Reads a whole recording with the columns that the board has, for the device of `file`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file, its line and its column, or the option.
    pub fn whole(&self, log: &Log, file: &DeviceFile) -> Result<Whole, Failure> {
        let Counted { device, lines, .. } =
            self.counted(file.loaded()?, std::slice::from_ref(log))?;
        let options = self.columns.options(&device)?;
        let recording = Recording::parse_with_board(log.reader()?, log.name(), &options)?;
        let recording = self.finished(recording, &options, log)?;
        recording.check_times(log.name())?;
        Ok(Whole {
            recording,
            device,
            stated: lines,
        })
    }

    /// Reads all rows of the recording `log` of `device` without keeping them, and returns how to
    /// read them again.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file, its line and its column, or the option.
    pub fn survey(&self, log: &Log, device: &Device) -> Result<(ReadOptions, Survey), Failure> {
        let options = self.columns.options(device)?;
        let survey = Survey::new(log.reader()?, log.name(), &options, self.resample)?;
        Ok((options, survey))
    }
}

impl Counted {
    /// `device` for recordings. `known` names the option or the file that gives its counts per revolution;
    /// without it the device has those that the recordings state.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the recording whose counts differ from those of the first one, or
    /// that does not state them.
    pub fn new(mut device: Device, known: Option<&str>, logs: &[Log]) -> Result<Self, Failure> {
        let counts = &mut device.stages.large.counts_per_rev;
        let assumed = *counts;
        let mut unstated: Option<&str> = None;
        let mut lines = Vec::new();
        let mut first: Option<&str> = None;
        for log in logs {
            let Some(stated) = stated_counts_per_rev(&log.head()?, log.name())? else {
                unstated = unstated.or(Some(log.name()));
                continue;
            };
            let name = log.name();
            match (known, first) {
                (Some(_), _) if stated == *counts => {}
                (Some(source), _) => lines.push(format!(
                    "{name}: {}",
                    differing_counts(*counts, source, stated)
                )),
                (None, Some(first)) if stated != *counts => {
                    return Err(Failure::Input(format!(
                        "{}: states {stated} counts/rev and {first} {counts}; give recordings of one \
                         encoder, or the counts with --counts-per-rev",
                        log.name()
                    )));
                }
                (None, _) => {
                    *counts = stated;
                    first = first.or(Some(log.name()));
                    lines.push(format!("{name}: {stated} counts/rev, as the file states"));
                }
            }
        }
        match (first, unstated) {
            (Some(first), Some(other)) if *counts != assumed => Err(Failure::Input(format!(
                "{first}: states {counts} counts/rev and {other} none; give the counts of both with \
                 --counts-per-rev"
            ))),
            _ => Ok(Self {
                is_stated: first.is_some(),
                device,
                lines,
            }),
        }
    }
}

impl DeviceFile {
    /// The text of the device file; empty if no file is given.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file.
    pub fn text(&self) -> Result<String, Failure> {
        let Some(path) = &self.device else {
            return Ok(String::new());
        };
        device_files::utf8(path).map_err(Failure::Input)
    }

    /// The device of the file; the default device if no file is given.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file and the key.
    pub fn load(&self) -> Result<Device, Failure> {
        self.device(&self.text()?, Device::from_toml_str)
    }

    /// As [`Self::load`], for a command that simulates the device.
    ///
    /// # Errors
    /// As [`Self::load`], and for a device that the plant's step is too long for.
    pub fn load_to_simulate(&self) -> Result<Device, Failure> {
        self.device(&self.text()?, Device::from_toml_str_to_simulate)
    }

    /// As [`Self::load`], for recordings, which may state their counts per revolution.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn loaded(&self) -> Result<Loaded, Failure> {
        let text = self.text()?;
        Ok(Loaded {
            device: self.device(&text, Device::from_toml_str)?,
            counts_of: Device::states_counts(&text).then(|| self.name()),
        })
    }

    /// The device of the file's text.
    fn device(
        &self,
        text: &str,
        read: fn(&str) -> Result<Device, String>,
    ) -> Result<Device, Failure> {
        let name = self.device.as_deref().unwrap_or(Path::new(""));
        read(text).map_err(|error| Failure::Input(format!("{}: {error}", name.display())))
    }

    /// Whether a file was given.
    #[must_use]
    pub fn is_given(&self) -> bool {
        self.device.is_some()
    }

    /// Name of the device in reports: the file's name, or "default device".
    #[must_use]
    pub fn name(&self) -> String {
        self.device
            .as_deref()
            .map_or_else(|| "default device".to_owned(), file_name)
    }
}
