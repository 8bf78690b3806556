//! Identification: what the device is, from a recording of it under excitation.
//!
//! The equation of motion times a smooth test function, integrated by parts over each of many
//! windows, is linear in `Kt/J`, `b/J` and `friction/J` and needs counts only, never a derivative
//! of them; `docs/theory/identification.md` has the derivation.

mod device_file;
mod equations;
mod fit;
mod handle;
mod model;
mod motion;
mod quantity;
mod table;
mod test_function;

use recordings::recording::Recording;
use simulation::device::Device;
use terminal::failure::Failure;

use equations::{Equations, Shaft, TURNS};
use fit::{Equation, Fit};
use motion::Motion;

pub use device_file::updated;
pub use fit::Estimate;
pub use model::{Beside, SPAN_S};
pub use quantity::{Known, Quantity, Unit};
pub use table::{json, text};

/// What came of it.
#[derive(Clone, Debug)]
pub struct Identification {
    /// Every quantity that the columns speak of, whether it can be told or not.
    pub quantities: Vec<Quantity>,
    /// What was taken for granted, a sentence each.
    pub assumed: Vec<String>,
    /// Windows used, and windows there are.
    pub windows: (usize, usize),
    /// Torque on the large shaft that the model does not explain, as part of the motor's, RMS.
    pub unexplained: f64,
    /// The identified motor run beside each recording.
    pub beside: Vec<Beside>,
}

/// Part of the motor's torque that may stay unexplained.
const MOST_UNEXPLAINED: f64 = 0.10;
/// Length of a window, s.
const WINDOW_S: f64 = 0.04;
/// Uneven steps in a window, on average, from which the clock is to blame for a lack of windows.
const UNEVEN_WINDOWS: f64 = 0.5;
/// Slowest rate at which a row is taken for a control tick, so that the lag means something, Hz.
const LAG_RATE_HZ: f64 = 5000.0;

/// Identifies from recordings of one device, each with its name in messages. `clamped` says that the
/// handle was, in those that do not show where it was.
///
/// # Errors
/// [`Failure::Input`] where the recordings cannot tell: what is missing, and how to record it.
pub fn identify(
    recordings: &[(String, Recording)],
    device: &Device,
    known: Known,
    clamped: bool,
) -> Result<Identification, Failure> {
    let mut gathered = Gathered::default();
    for (index, (name, recording)) in recordings.iter().enumerate() {
        if recording.trace.counts_small.is_none() && !clamped {
            return Err(unseen(name, device));
        }
        gathered.add(name, recording, (index, recordings.len()), device)?;
    }
    let fit = gathered.fit(device).map_err(|why| {
        let name = recordings.first().map_or("", |(name, _)| name);
        Failure::Input(format!("{name}: {why}"))
    })?;
    let mut quantities = quantity::of_large(&fit, device, known, gathered.largest_current);
    for quantity in &mut quantities {
        if let Some(why) = gathered.hides(quantity.key) {
            quantity.untold = Some(why);
        }
    }
    if quantities.iter().all(|quantity| quantity.untold.is_some()) {
        let widths: Vec<_> = quantities.iter().map(Quantity::short).collect();
        return Err(Failure::Input(format!(
            "{}: cannot tell anything within 2 % ({}); record all of scene excite, or several times",
            recordings[0].0,
            widths.join(", ")
        )));
    }
    let turns = gathered.travel[1] > TURNS;
    let handle = handle::quantities(&gathered.free, turns, &fit, device, known);
    quantities.extend(handle.into_iter().flatten());
    let mut assumed = assumptions(known, gathered.unseen);
    assumed.append(&mut gathered.silent);
    Ok(Identification {
        quantities,
        assumed,
        windows: (gathered.large.usable.len(), gathered.large.windows),
        unexplained: fit.unexplained / fit.driven,
        beside: model::beside(recordings, device, &fit),
    })
}

/// The equations of all recordings, and what else they show.
#[derive(Default)]
struct Gathered {
    large: Equations,
    /// The handle's, where nobody holds it.
    free: Vec<Equation>,
    /// Why a recording says nothing of the handle.
    silent: Vec<String>,
    /// The longest travel of each shaft, rad.
    travel: [f64; 2],
    largest_current: f64,
    slowest_hz: Option<f64>,
    /// Whether there is a recording without the handle's counts.
    unseen: bool,
    /// How uneven the first clock is that leaves few windows without uneven steps.
    uneven: Option<String>,
}

impl Gathered {
    /// Adds a recording, which is the first of these two numbers among the second.
    fn add(
        &mut self,
        name: &str,
        recording: &Recording,
        place: (usize, usize),
        device: &Device,
    ) -> Result<(), Failure> {
        let trace = &recording.trace;
        let period_s = trace.period_s();
        let Some(current) = &trace.current else {
            return Err(Failure::Input(format!(
                "{name}: line 1: no column current; counts alone tell no torque: record scene \
                 excite with the large motor's current"
            )));
        };
        let motion = |counts: &[u32], counts_per_rev| Motion::new(counts, counts_per_rev, period_s);
        let own = motion(&trace.counts_large, device.stages.large.counts_per_rev);
        let handle = trace.counts_small.as_ref();
        let handle = handle.map(|counts| motion(counts, device.stages.small.counts_per_rev));
        let breaks = breaks(&recording.t, period_s);
        if recording.uneven_share() * WINDOW_S > UNEVEN_WINDOWS * period_s {
            self.uneven = self.uneven.take().or_else(|| recording.unevenness());
        }
        let shaft = Shaft {
            period_s,
            own: &own,
            other: handle.as_ref(),
            current,
            ripple_per_rev: device.large_ripple.per_rev,
            breaks: &breaks,
            hand: false,
        };
        self.large.add(&shaft, place.0, place.1);
        self.travel[0] = self.travel[0].max(own.travel());
        let largest = current.iter().fold(0.0_f64, |m, i| m.max(i.abs()));
        self.largest_current = self.largest_current.max(largest);
        let slowest = self.slowest_hz.unwrap_or(trace.rate_hz);
        self.slowest_hz = Some(slowest.min(trace.rate_hz));
        let Some(handle) = &handle else {
            self.unseen = true;
            return Ok(());
        };
        let free = match &recording.current_small {
            None => Err("has no column current_small"),
            Some(current) => {
                let mut small = Equations::default();
                let shaft = Shaft {
                    own: handle,
                    other: Some(&own),
                    current,
                    ripple_per_rev: device.small_ripple.per_rev,
                    hand: true,
                    ..shaft
                };
                small.add(&shaft, place.0, place.1);
                handle::free(small)
            }
        };
        match free {
            Ok(equations) => {
                self.free.extend(equations);
                self.travel[1] = self.travel[1].max(handle.travel());
            }
            Err(why) => {
                let silent = format!("{name}: nothing said of the handle, which {why}");
                self.silent.push(silent);
            }
        }
        Ok(())
    }

    /// Fits the large shaft's equation, or says why that means nothing.
    fn fit(&self, device: &Device) -> Result<Fit, String> {
        if self.largest_current == 0.0 {
            return Err("column current is zero throughout; record scene excite".to_owned());
        }
        let Some(fit) = Fit::new(&self.large.usable) else {
            return Err(match &self.uneven {
                Some(uneven) => format!(
                    "{uneven}, so that only {} of {} windows of 40 ms are free of uneven steps and turn \
                     one way; where the rows are even and only t is not, write t as row / rate, else \
                     record with a timer",
                    self.large.usable.len(),
                    self.large.windows
                ),
                None => format!(
                    "the large motor turns one way for 40 ms on end in only {} of {} windows; record \
                     all of scene excite, with the handle held",
                    self.large.usable.len(),
                    self.large.windows
                ),
            });
        };
        let unexplained = fit.unexplained / fit.driven;
        // Not a number is not explained either.
        if unexplained.is_nan() || unexplained >= MOST_UNEXPLAINED {
            return Err(format!(
                "{:.0} % of the motor's torque goes where the model knows nothing; is column \
                 current in A, large.counts_per_rev = {} right, {}?",
                100.0 * unexplained,
                device.stages.large.counts_per_rev,
                match self.unseen {
                    true => "and was the handle clamped",
                    false => "and did nothing else touch the shafts",
                }
            ));
        }
        let drive = fit.estimate(|ratios, _| ratios[0]);
        if drive.value < -drive.half {
            return Err(
                "positive current turns the large motor backward; swap its phases or its \
                 encoder's"
                    .to_owned(),
            );
        }
        Ok(fit)
    }

    /// Why this key cannot be told, however narrow its interval.
    fn hides(&self, key: &str) -> Option<String> {
        let usable = self.large.usable.len();
        let rarer_way = self.large.forward.min(usable - self.large.forward);
        match (key, self.slowest_hz) {
            (quantity::BANDWIDTH, Some(rate_hz)) if rate_hz < LAG_RATE_HZ => Some(format!(
                "rows {} ms apart may be frames of a faster loop; record every control tick",
                1000.0 / rate_hz
            )),
            (quantity::FRICTION, _) if 20 * rarer_way < usable => {
                Some("turns one way only; record both".to_owned())
            }
            (quantity::FRICTION, _) if self.travel[0] < TURNS => {
                Some("varies over a turn, and it made fewer than three".to_owned())
            }
            _ => None,
        }
    }
}

/// A hand gives way: with `b w_S = (b^2 / K) dw_L/dt` it takes `b^2 / K` off the inertia, and no
/// column of the large motor tells that apart.
fn unseen(name: &str, device: &Device) -> Failure {
    let b = device.stages.damping;
    let part = b * b / device.hand.stiffness_nm_per_rad / device.stages.large.inertia;
    Failure::Input(format!(
        "{name}: line 1: no column counts_small, and a hand of {} N.m/rad that gives way unseen takes \
         {:.0} % off the inertia; record it, or clamp the handle and say --clamped",
        device.hand.stiffness_nm_per_rad,
        100.0 * part
    ))
}

/// What is assumed of the encoders where no device file says what they are.
#[must_use]
pub fn default_counts(device: &Device) -> String {
    format!(
        "large.counts_per_rev = {} and small.counts_per_rev = {}, those of the default device, because \
         no --device is given; with other encoders every value is wrong",
        device.stages.large.counts_per_rev, device.stages.small.counts_per_rev
    )
}

fn assumptions(known: Known, held: bool) -> Vec<String> {
    let mut assumed = vec![format!(
        "{known} taken as exact: counts and current tell ratios only, so its error is everybody's"
    )];
    if held {
        assumed.push("no column counts_small: the handle taken as clamped".to_owned());
    }
    assumed.push("viscous friction of the large motor's bearings counts as damping".to_owned());
    assumed
}

/// Steps before each sample that are not of the median length.
fn breaks(t: &[f64], period_s: f64) -> Vec<usize> {
    let mut seen = 0;
    let first = std::iter::once(0);
    let steps = t.windows(2).map(|pair| pair[1] - pair[0]);
    first
        .chain(steps.map(|step| {
            seen += usize::from((step - period_s).abs() > 0.1 * period_s);
            seen
        }))
        .collect()
}
