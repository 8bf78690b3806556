//! Estimators on recordings whose rows come at uneven times.

use catalogue::estimators::{Kind, Lack};
use simulation::trace::Trace;
use terminal::failure::Failure;

/// The estimators that run on a recording, as far as its clock is concerned.
pub struct Chosen {
    /// The estimators that run.
    pub kinds: Vec<&'static Kind>,
    /// Those that assume a constant period, on a recording that has none.
    left_out: Vec<&'static str>,
}

impl Chosen {
    /// Chooses from `kinds` for the recording in the file `path` with the columns of `trace`.
    /// `unevenness` describes its uneven steps.
    ///
    /// # Errors
    /// [`Failure::Input`] if an estimator that the user named assumes a constant period.
    pub fn new(
        kinds: &[&'static Kind],
        are_named: bool,
        trace: &Trace,
        path: &str,
        unevenness: Option<&str>,
    ) -> Result<Self, Failure> {
        let assumes = |kind: &&&Kind| kind.lack(trace) == Some(Lack::ConstantPeriod);
        let (steady, others): (Vec<&'static Kind>, Vec<&'static Kind>) =
            kinds.iter().partition(|kind| assumes(kind));
        let left_out: Vec<_> = steady.iter().map(|kind| kind.name).collect();
        if are_named && !left_out.is_empty() {
            let able = Kind::all().iter().filter(|kind| kind.varying_period);
            let able: Vec<_> = able.map(|kind| kind.name).collect();
            return Err(Failure::Input(format!(
                "{path}: {}; {} needs a constant period: add --resample {:.0}, or name one of {}, which \
                 use the true steps",
                unevenness.unwrap_or("t is uneven"),
                left_out.join(", "),
                trace.rate_hz,
                able.join(", ")
            )));
        }
        Ok(Self {
            kinds: others,
            left_out,
        })
    }

    /// What is said about a recording with uneven steps.
    #[must_use]
    pub fn note(&self, trace: &Trace, unevenness: &str) -> String {
        let rate = trace.rate_hz;
        if trace.periods.is_none() {
            return format!(
                "{unevenness}, which the few digits of t explain; the estimators assume a constant step \
                 of 1/{rate} s; --resample {rate:.0} makes the rows even"
            );
        }
        let left_out = match self.left_out.as_slice() {
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
