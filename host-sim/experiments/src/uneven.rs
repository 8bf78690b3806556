//! The estimators that run on a recording: rows may come at uneven times, or at a rate for which not
//! every estimator is made, or of an encoder for which the presets give none there.

use catalogue::estimators::{Kind, Lack};
use catalogue::parameters::Parameters;
use recordings::recording::Recording;
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

use crate::designed::{designed, with_friction};
use crate::rates::{EVERY_HZ, nearest, refuses};

/// A recording, and what estimators are built with.
#[derive(Clone)]
pub struct Recorded<'a> {
    /// Its file, in messages.
    pub path: &'a str,
    /// Its columns and its rate.
    pub trace: &'a Trace,
    /// Its uneven steps, if there are any.
    pub unevenness: Option<String>,
    /// Its device.
    pub device: &'a Device,
    /// Parameters of the estimators.
    pub parameters: &'a Parameters,
}

impl<'a> Recorded<'a> {
    /// The recording of the file `path`.
    #[must_use]
    pub fn new(
        path: &'a str,
        recording: &'a Recording,
        device: &'a Device,
        parameters: &'a Parameters,
    ) -> Self {
        Self {
            path,
            trace: &recording.trace,
            unevenness: recording.unevenness(),
            device,
            parameters,
        }
    }
}

/// The estimators that run on a recording, as far as its clock is concerned.
pub struct Chosen {
    /// The estimators that run.
    pub kinds: Vec<&'static Kind>,
    left_out: LeftOut,
}

impl Chosen {
    /// Chooses from `kinds` for a recording.
    ///
    /// # Errors
    /// [`Failure::Input`] if an estimator that the user named assumes a constant period, or is not made
    /// for the rate.
    pub fn new(
        kinds: &[&'static Kind],
        are_named: bool,
        recorded: &Recorded,
    ) -> Result<Self, Failure> {
        let trace = recorded.trace;
        let (uneven, others): (Vec<&'static Kind>, Vec<&'static Kind>) =
            (kinds.iter()).partition(|kind| kind.lack(trace) == Some(Lack::ConstantPeriod));
        let (off_rate, kinds): (Vec<&'static Kind>, Vec<&'static Kind>) = (others.into_iter())
            .partition(|kind| refuses(kind, trace.rate_hz, recorded.device, recorded.parameters));
        let place = with_friction(recorded.device, trace.rate_hz);
        let (able, undesigned) = designed(&kinds, recorded.parameters, &[place]);
        let left_out = LeftOut {
            uneven: names(&uneven),
            off_rate: names(&off_rate),
            undesigned,
        };
        if are_named {
            left_out.check(recorded)?;
        }
        // The design of an estimator that the user named fails later, as an error.
        let kinds = if are_named { kinds } else { able };
        Ok(Self { kinds, left_out })
    }

    /// What is said about a rate or uneven steps that not every estimator takes.
    #[must_use]
    pub fn notes(&self, recorded: &Recorded) -> Vec<String> {
        self.left_out.notes(recorded)
    }
}

/// Names of the estimators that are left out, with commas between them.
struct LeftOut {
    /// Those that assume a constant period, on a recording that has none.
    uneven: String,
    /// Those that are not made for its rate.
    off_rate: String,
    /// Lines on those that the presets give no values for.
    undesigned: Vec<String>,
}

fn names(kinds: &[&Kind]) -> String {
    let names: Vec<_> = kinds.iter().map(|kind| kind.name).collect();
    names.join(", ")
}

impl LeftOut {
    /// Checks that no estimator is left out.
    fn check(&self, recorded: &Recorded) -> Result<(), Failure> {
        let (path, rate_hz) = (recorded.path, recorded.trace.rate_hz);
        if !self.uneven.is_empty() {
            let able: Vec<_> = Kind::all()
                .iter()
                .filter(|kind| kind.varying_period)
                .collect();
            return Err(Failure::Input(format!(
                "{path}: {}; {} needs a constant period: add --resample {rate_hz:.0}, or name one of {}, \
                 which use the true steps",
                recorded.unevenness.as_deref().unwrap_or("t is uneven"),
                self.uneven,
                names(&able)
            )));
        }
        if !self.off_rate.is_empty() {
            let [low, high] = EVERY_HZ;
            return Err(Failure::Input(format!(
                "{path}: {} rows/s; {} needs {low} to {high}: add --resample {}",
                rows_per_s(rate_hz),
                self.off_rate,
                nearest(rate_hz)
            )));
        }
        Ok(())
    }

    fn notes(&self, recorded: &Recorded) -> Vec<String> {
        let trace = recorded.trace;
        let rate_hz = trace.rate_hz;
        let unevenness = recorded.unevenness.as_deref();
        let uneven = unevenness.map(|unevenness| self.uneven_note(trace, unevenness));
        let off_rate = (!self.off_rate.is_empty()).then(|| {
            let [low, high] = EVERY_HZ;
            format!(
                "{} rows/s; estimators that need {low} to {high} left out: {}; --resample {} makes rows at \
                 such a rate, and all estimators run",
                rows_per_s(rate_hz),
                self.off_rate,
                nearest(rate_hz)
            )
        });
        let undesigned = self.undesigned.iter().cloned();
        uneven
            .into_iter()
            .chain(off_rate)
            .chain(undesigned)
            .collect()
    }

    fn uneven_note(&self, trace: &Trace, unevenness: &str) -> String {
        let rate = trace.rate_hz;
        if trace.periods.is_none() {
            return format!(
                "{unevenness}: the few digits of t explain them, or they are few; the estimators assume a constant step \
                 of 1/{rate} s; --resample {rate:.0} makes the rows even"
            );
        }
        let left_out = match self.uneven.as_str() {
            "" => String::new(),
            names => format!(
                "; estimators that assume a constant period left out: {names}; --resample {rate:.0} makes the \
                 rows even, and all estimators run"
            ),
        };
        format!("{unevenness}; the estimators use the true steps{left_out}")
    }
}

/// A rate with the digits that a user reads.
fn rows_per_s(rate_hz: f64) -> f64 {
    (rate_hz * 1e3).round() / 1e3
}
