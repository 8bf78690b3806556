//! The estimators that run on a recording: rows may come at uneven times, or at a rate for which not
//! every estimator is made.

use catalogue::estimators::{Kind, Lack};
use catalogue::parameters::Parameters;
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

use crate::rates::{EVERY_HZ, nearest, refuses};

/// A recording, and what estimators are built with.
#[derive(Clone, Copy)]
pub struct Recorded<'a> {
    /// Its file, in messages.
    pub path: &'a str,
    /// Its columns and its rate.
    pub trace: &'a Trace,
    /// Its uneven steps, if there are any.
    pub unevenness: Option<&'a str>,
    /// Its device.
    pub device: &'a Device,
    /// Parameters of the estimators.
    pub parameters: &'a Parameters,
}

/// The estimators that run on a recording, as far as its clock is concerned.
pub struct Chosen {
    /// The estimators that run.
    pub kinds: Vec<&'static Kind>,
    /// Those that assume a constant period, on a recording that has none.
    uneven: Vec<&'static str>,
    /// Those that are not made for its rate.
    off_rate: Vec<&'static str>,
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
        let names = |kinds: Vec<&'static Kind>| kinds.iter().map(|kind| kind.name).collect();
        let chosen = Self {
            kinds,
            uneven: names(uneven),
            off_rate: names(off_rate),
        };
        match are_named {
            true => chosen.without_loss(recorded),
            false => Ok(chosen),
        }
    }

    /// The same, if no estimator is left out.
    fn without_loss(self, recorded: &Recorded) -> Result<Self, Failure> {
        let (path, rate_hz) = (recorded.path, recorded.trace.rate_hz);
        if !self.uneven.is_empty() {
            let able = Kind::all().iter().filter(|kind| kind.varying_period);
            let able: Vec<_> = able.map(|kind| kind.name).collect();
            return Err(Failure::Input(format!(
                "{path}: {}; {} needs a constant period: add --resample {rate_hz:.0}, or name one of {}, \
                 which use the true steps",
                recorded.unevenness.unwrap_or("t is uneven"),
                self.uneven.join(", "),
                able.join(", ")
            )));
        }
        if !self.off_rate.is_empty() {
            let [low, high] = EVERY_HZ;
            return Err(Failure::Input(format!(
                "{path}: {} rows/s; {} needs {low} to {high}: add --resample {}",
                rows_per_s(rate_hz),
                self.off_rate.join(", "),
                nearest(rate_hz)
            )));
        }
        Ok(self)
    }

    /// What is said about a recording with a rate or with uneven steps, `unevenness`, that not every
    /// estimator takes.
    #[must_use]
    pub fn notes(&self, trace: &Trace, unevenness: Option<&str>) -> Vec<String> {
        let uneven = unevenness.map(|unevenness| self.uneven_note(trace, unevenness));
        let rate_hz = trace.rate_hz;
        let off_rate = (!self.off_rate.is_empty()).then(|| {
            let [low, high] = EVERY_HZ;
            format!(
                "{} rows/s; estimators that need {low} to {high} left out: {}; --resample {} makes rows at \
                 such a rate, and all estimators run",
                rows_per_s(rate_hz),
                self.off_rate.join(", "),
                nearest(rate_hz)
            )
        });
        uneven.into_iter().chain(off_rate).collect()
    }

    /// What is said about uneven steps.
    fn uneven_note(&self, trace: &Trace, unevenness: &str) -> String {
        let rate = trace.rate_hz;
        if trace.periods.is_none() {
            return format!(
                "{unevenness}, which the few digits of t explain; the estimators assume a constant step \
                 of 1/{rate} s; --resample {rate:.0} makes the rows even"
            );
        }
        let left_out = match self.uneven.as_slice() {
            [] => String::new(),
            names => format!(
                "; estimators that assume a constant period left out: {}; --resample {rate:.0} makes the \
                 rows even, and all estimators run",
                names.join(", ")
            ),
        };
        format!("{unevenness}; the estimators use the true steps{left_out}")
    }
}

/// A rate with the digits that a user reads.
fn rows_per_s(rate_hz: f64) -> f64 {
    (rate_hz * 1e3).round() / 1e3
}
