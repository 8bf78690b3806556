//! Identification of the device's constants from recordings under excitation.
//!
//! The equation of motion is multiplied by a smooth test function and integrated by parts over each
//! of many windows. The result is linear in `Kt/J`, `b/J` and `friction/J` and contains counts but no
//! derivative of them; `docs/theory/identification.md` has the derivation.

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
pub use model::{ModelComparison, SPAN_S};
pub use quantity::{Known, Quantity, Unit};
pub use table::{json, text};

/// Result of the identification.
#[derive(Clone, Debug)]
pub struct Identification {
    /// All quantities for which the recordings have the columns, with the reason of each rejection.
    pub quantities: Vec<Quantity>,
    /// Assumptions, one sentence each.
    pub assumed: Vec<String>,
    /// Number of used windows, and number of all windows.
    pub windows: (usize, usize),
    /// RMS of the torque on the large shaft that the model does not contain, relative to the motor's.
    pub unexplained: f64,
    /// Measured and modelled velocity of each recording.
    pub comparisons: Vec<ModelComparison>,
}

/// Largest allowed share of the motor's torque that the model does not contain.
const MOST_UNEXPLAINED: f64 = 0.10;
/// Length of a window, s.
const WINDOW_S: f64 = 0.04;
/// Mean number of uneven steps per window from which the error of too few windows names the clock.
const UNEVEN_WINDOWS: f64 = 0.5;
/// Slowest rate at which a row is assumed to be a control tick, Hz; below it the lag is rejected.
const LAG_RATE_HZ: f64 = 5000.0;

/// Identifies a device from its recordings, each with its name for messages. `clamped` states that
/// the handle was clamped in recordings without `counts_small`.
///
/// # Errors
/// [`Failure::Input`] if the recordings are not sufficient: what is missing, and how to record it.
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
        if let Some(reason) = gathered.rejects(quantity.key) {
            quantity.rejected = Some(reason);
        }
    }
    if quantities
        .iter()
        .all(|quantity| quantity.rejected.is_some())
    {
        let widths: Vec<_> = quantities.iter().map(Quantity::short).collect();
        return Err(Failure::Input(format!(
            "{}: no constant is identified within 2 % ({}); record the whole scene excite, or several \
             recordings",
            recordings[0].0,
            widths.join(", ")
        )));
    }
    let turns = gathered.travel[1] > TURNS;
    let handle = handle::quantities(&gathered.free, turns, &fit, device, known);
    quantities.extend(handle.into_iter().flatten());
    let mut assumed = assumptions(known, gathered.unseen);
    assumed.append(&mut gathered.without_handle);
    Ok(Identification {
        quantities,
        assumed,
        windows: (gathered.large.usable.len(), gathered.large.windows),
        unexplained: fit.unexplained / fit.driven,
        comparisons: model::compare(recordings, device, &fit),
    })
}

/// The equations of all recordings, and properties of the recordings for messages.
#[derive(Default)]
struct Gathered {
    large: Equations,
    /// Equations of a free handle.
    free: Vec<Equation>,
    /// Reasons for which recordings do not identify the handle.
    without_handle: Vec<String>,
    /// The longest travel of each shaft, rad.
    travel: [f64; 2],
    largest_current: f64,
    slowest_hz: Option<f64>,
    /// Whether a recording has no counts of the handle.
    unseen: bool,
    /// Description of the first clock that leaves too few windows without uneven steps.
    uneven: Option<String>,
}

impl Gathered {
    /// Adds a recording; `place` is its index and the number of recordings.
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
                "{name}: line 1: no column current; torques cannot be identified from counts alone: \
                 record scene excite with the large motor's current"
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
            None => Err("no column current_small"),
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
                self.without_handle
                    .push(format!("{name}: the handle is not identified: {why}"));
            }
        }
        Ok(())
    }

    /// Fits the large shaft's equation.
    ///
    /// # Errors
    /// One line on currents, windows, or a model that does not fit.
    fn fit(&self, device: &Device) -> Result<Fit, String> {
        if self.largest_current == 0.0 {
            return Err("column current is zero throughout; record scene excite".to_owned());
        }
        let Some(fit) = Fit::new(&self.large.usable) else {
            return Err(match &self.uneven {
                Some(uneven) => format!(
                    "{uneven}; only {} of {} windows of 40 ms have even steps and turn one way; if only \
                     column t is uneven, give --row-rate HZ, else --resample HZ",
                    self.large.usable.len(),
                    self.large.windows
                ),
                None => format!(
                    "the large motor turns one way throughout only {} of {} windows of 40 ms; record \
                     the whole scene excite, with the handle held",
                    self.large.usable.len(),
                    self.large.windows
                ),
            });
        };
        let unexplained = fit.unexplained / fit.driven;
        // NaN is an error too.
        if unexplained.is_nan() || unexplained >= MOST_UNEXPLAINED {
            return Err(format!(
                "the model leaves {:.0} % of the motor's torque unexplained (limit {:.0} %); check that \
                 column current is in A, that large.counts_per_rev = {} is correct, and that {}",
                100.0 * unexplained,
                100.0 * MOST_UNEXPLAINED,
                device.stages.large.counts_per_rev,
                match self.unseen {
                    true => "the handle was clamped",
                    false => "nothing else touched the shafts",
                }
            ));
        }
        let drive = fit.estimate(|ratios, _| ratios[0]);
        if drive.value < -drive.half {
            return Err(
                "positive current turns the large motor backward; swap two phases of the motor or \
                 the phases of its encoder"
                    .to_owned(),
            );
        }
        Ok(fit)
    }

    /// Reason for which the recordings cannot identify this key, whatever its interval.
    fn rejects(&self, key: &str) -> Option<String> {
        let usable = self.large.usable.len();
        let rarer_way = self.large.forward.min(usable - self.large.forward);
        match (key, self.slowest_hz) {
            (quantity::BANDWIDTH, Some(rate_hz)) if rate_hz < LAG_RATE_HZ => Some(format!(
                "rows {} ms apart may be frames of a faster control loop; record every control tick",
                1000.0 / rate_hz
            )),
            (quantity::FRICTION, _) if 20 * rarer_way < usable => {
                Some("the large motor turns one way only; record both directions".to_owned())
            }
            (quantity::FRICTION, _) if self.travel[0] < TURNS => {
                Some("friction varies over a turn; record at least three turns".to_owned())
            }
            _ => None,
        }
    }
}

/// Error for a recording without the handle's counts. The handle yields under a hand of stiffness K,
/// with `b w_S = (b^2 / K) dw_L/dt`, which reduces the identified inertia by `b^2 / K`.
fn unseen(name: &str, device: &Device) -> Failure {
    let b = device.stages.damping;
    let part = b * b / device.hand.stiffness_nm_per_rad / device.stages.large.inertia;
    Failure::Input(format!(
        "{name}: line 1: no column counts_small; the motion of a handle in a hand of {} N.m/rad would \
         make the identified inertia {:.0} % too small; record the column, or clamp the handle and \
         give --clamped",
        device.hand.stiffness_nm_per_rad,
        100.0 * part
    ))
}

/// The assumption on the encoders without a device file.
#[must_use]
pub fn default_counts(device: &Device) -> String {
    format!(
        "large.counts_per_rev = {} and small.counts_per_rev = {} of the default device, because no \
         --device is given; with other encoders every value is wrong",
        device.stages.large.counts_per_rev, device.stages.small.counts_per_rev
    )
}

fn assumptions(known: Known, held: bool) -> Vec<String> {
    let mut assumed = vec![format!(
        "{known} is exact: counts and current give ratios only, so its relative error is in all values"
    )];
    if held {
        assumed.push("the handle was clamped, because there is no column counts_small".to_owned());
    }
    assumed.push("the damping includes viscous friction of the large motor's bearings".to_owned());
    assumed
}

/// Number of steps before each sample that differ from the median length.
fn breaks(t: &[f64], period_s: f64) -> Vec<usize> {
    let mut number = 0;
    let first = std::iter::once(0);
    let steps = t.windows(2).map(|pair| pair[1] - pair[0]);
    first
        .chain(steps.map(|step| {
            number += usize::from((step - period_s).abs() > 0.1 * period_s);
            number
        }))
        .collect()
}
