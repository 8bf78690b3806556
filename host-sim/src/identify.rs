//! Identification: what the device is, from a recording of it under excitation.
//!
//! The equation of motion times a smooth test function, integrated by parts over each of many
//! windows, is linear in `Kt/J`, `b/J` and `friction/J` and needs counts only, never a derivative
//! of them; `docs/theory.md` has the whole of it.

mod device_file;
mod equations;
mod fit;
mod handle;
mod motion;
mod quantity;
mod table;
mod test_function;

use crate::device::Device;
use crate::failure::Failure;
use crate::recording::Recording;

use equations::{Equations, Shaft, TURNS};
use fit::Fit;
use motion::Motion;

pub use device_file::updated;
pub use fit::Estimate;
pub use quantity::{Known, Quantity};
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
}

/// Part of the motor's torque that may stay unexplained.
const MOST_UNEXPLAINED: f64 = 0.10;
/// Slowest rate at which a row is taken for a control tick, so that the lag means something, Hz.
const LAG_RATE_HZ: f64 = 5000.0;

/// Identifies from recordings of one device, each with its name in messages.
///
/// # Errors
/// [`Failure::Input`] where the recordings cannot tell: what is missing, and how to record it.
pub fn identify(
    recordings: &[(String, Recording)],
    device: &Device,
    known: Known,
) -> Result<Identification, Failure> {
    let mut large = Equations::default();
    let mut free = Vec::new();
    let mut assumed = Vec::new();
    let (mut held, mut largest_current) = (false, 0.0_f64);
    // The longest travel of each shaft.
    let mut travel = [0.0_f64; 2];
    for (index, (name, recording)) in recordings.iter().enumerate() {
        let trace = &recording.trace;
        let period_s = trace.period_s();
        let Some(current) = &trace.current else {
            return Err(Failure::Input(format!(
                "{name}: line 1: no column current; counts alone tell no torque: record scene \
                 excite with the large motor's current"
            )));
        };
        largest_current = current.iter().fold(largest_current, |m, i| m.max(i.abs()));
        let breaks = breaks(&recording.t, period_s);
        let motion = |counts: &[u32], counts_per_rev| Motion::new(counts, counts_per_rev, period_s);
        let own = motion(&trace.counts_large, device.large.counts_per_rev);
        let handle = trace.counts_small.as_ref();
        let handle = handle.map(|counts| motion(counts, device.small.counts_per_rev));
        held |= handle.is_none();
        let shaft = Shaft {
            period_s,
            own: &own,
            other: handle.as_ref(),
            current,
            ripple_per_rev: device.large.ripple_per_rev,
            breaks: &breaks,
            hand: false,
        };
        large.add(&shaft, index, recordings.len());
        travel[0] = travel[0].max(own.travel());
        let Some(handle) = &handle else {
            continue;
        };
        let silent = match &recording.current_small {
            None => Err("has no column current_small"),
            Some(current) => {
                let mut small = Equations::default();
                let shaft = Shaft {
                    own: handle,
                    other: Some(&own),
                    current,
                    ripple_per_rev: device.small.ripple_per_rev,
                    hand: true,
                    ..shaft
                };
                small.add(&shaft, index, recordings.len());
                handle::free(small).map(|equations| {
                    free.extend(equations);
                    travel[1] = travel[1].max(handle.travel());
                })
            }
        };
        if let Err(why) = silent {
            assumed.push(format!("{name}: nothing said of the handle, which {why}"));
        }
    }
    let name = &recordings[0].0;
    let refuse = |what: String| Err(Failure::Input(format!("{name}: {what}")));
    if largest_current == 0.0 {
        return refuse("column current is zero throughout; record scene excite".to_owned());
    }
    let Some(fit) = Fit::new(&large.usable) else {
        return refuse(format!(
            "the large motor turns one way for 40 ms on end in only {} of {} windows; record all \
             of scene excite, with the handle held",
            large.usable.len(),
            large.windows
        ));
    };
    let unexplained = fit.unexplained / fit.driven;
    if fit.coefficients[0] < 0.0 {
        return refuse(
            "positive current turns the large motor backward; swap its phases or its encoder's"
                .to_owned(),
        );
    }
    if !(unexplained < MOST_UNEXPLAINED) {
        return refuse(format!(
            "{:.0} % of the motor's torque goes where the model knows nothing; is column current \
             in A, large.counts_per_rev = {} right, {}?",
            100.0 * unexplained,
            device.large.counts_per_rev,
            match held {
                true => "and was the handle held fast (or record counts_small)",
                false => "and nothing touching the disc",
            }
        ));
    }
    let both_ways = large.forward.min(large.usable.len() - large.forward);
    let mut quantities = quantity::of_large(&fit, device, known, largest_current);
    let rate_hz = recordings.iter().map(|(_, r)| r.trace.rate_hz);
    let slowest = rate_hz.fold(f64::INFINITY, f64::min);
    for quantity in &mut quantities {
        if quantity.key == quantity::BANDWIDTH && slowest < LAG_RATE_HZ {
            quantity.untold = Some(format!(
                "rows {slowest} Hz apart may be frames of a faster loop; record every control tick"
            ));
        }
        if quantity.key == quantity::FRICTION && 20 * both_ways < large.usable.len() {
            quantity.untold = Some("turns one way only; record both".to_owned());
        }
        if quantity.key == quantity::FRICTION && travel[0] < TURNS {
            quantity.untold = Some("varies over a turn, and it made fewer than three".to_owned());
        }
    }
    if quantities.iter().all(|quantity| quantity.untold.is_some()) {
        let widths: Vec<_> = quantities.iter().map(Quantity::short).collect();
        return refuse(format!(
            "cannot tell anything within 2 % ({}); record all of scene excite, or several times",
            widths.join(", ")
        ));
    }
    assumed.splice(0..0, assumptions(known, held));
    let handle = handle::quantities(&free, travel[1] > TURNS, &fit, device, known);
    quantities.extend(handle.into_iter().flatten());
    Ok(Identification {
        quantities,
        assumed,
        windows: (large.usable.len(), large.windows),
        unexplained,
    })
}

fn assumptions(known: Known, held: bool) -> Vec<String> {
    let mut assumed = vec![format!(
        "{known} taken as exact: counts and current tell ratios only, so its error is everybody's"
    )];
    if held {
        assumed.push("no column counts_small: the handle taken as held fast".to_owned());
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
