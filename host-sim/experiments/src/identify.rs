//! Identification of the device's constants from recordings under excitation.
//!
//! The equation of motion is multiplied by a smooth test function and integrated by parts over each
//! of many windows. The result is linear in `Kt/J`, `b/J` and `friction/J` and contains counts but no
//! derivative of them; `docs/theory/identification.md` has the derivation.

mod device_file;
mod equations;
mod fit;
mod gathered;
mod handle;
mod model;
mod motion;
mod quantity;
mod ratio;
mod table;
mod test_function;

use recordings::recording::Recording;
use simulation::device::Device;
use terminal::failure::Failure;

use equations::TURNS;
use gathered::Gathered;

pub use device_file::updated;
pub use fit::Estimate;
pub use model::{ModelComparison, SPAN_S};
pub use quantity::{Known, Quantity, Unit};
pub use ratio::Ratio;
pub use table::{json, text};

/// Result of the identification.
#[derive(Clone, Debug)]
pub struct Identification {
    /// All quantities for which the recordings have the columns, with the reason of each rejection.
    pub quantities: Vec<Quantity>,
    /// What counts and current determine without any known constant.
    pub ratios: Vec<Ratio>,
    /// Assumptions, one sentence each.
    pub assumed: Vec<String>,
    /// Number of used windows, and number of all windows.
    pub windows: (usize, usize),
    /// RMS of the torque on the large shaft that the model does not contain, relative to the motor's.
    pub unexplained: f64,
    /// Measured and modelled velocity of each recording.
    pub comparisons: Vec<ModelComparison>,
    /// Whether the values are compared with the default device, because no device file is given.
    pub is_default: bool,
}

/// Largest allowed share of the motor's torque that the model does not contain.
const MOST_UNEXPLAINED: f64 = 0.10;

/// Identifies a device from its recordings, each with its name for messages. `clamped` states that
/// the handle was clamped in recordings without `counts_small`. `current_options` are the parts of `--column`
/// that name the current of each recording, for messages.
///
/// # Errors
/// [`Failure::Input`] if the recordings are not sufficient: what is missing, and how to record it.
pub fn identify(
    recordings: &[(String, Recording)],
    current_options: &[Option<String>],
    device: &Device,
    known: Known,
    clamped: bool,
) -> Result<Identification, Failure> {
    let mut gathered = Gathered::default();
    for (index, (name, recording)) in recordings.iter().enumerate() {
        // Without the current the handle does not matter.
        let trace = &recording.trace;
        if trace.current.is_some() && trace.counts_small.is_none() && !clamped {
            return Err(unseen(name, device));
        }
        let current_option = current_options.get(index).and_then(Option::as_deref);
        let place = (index, recordings.len());
        gathered.add(name, recording, place, current_option, device)?;
    }
    let fit = gathered.fit(device).map_err(|why| {
        let name = recordings.first().map_or("", |(name, _)| name);
        Failure::Input(format!("{name}: {why}"))
    })?;
    let mut quantities = quantity::of_large(&fit, device, known, gathered.largest_current);
    for quantity in &mut quantities {
        if let Some(reason) = gathered.rejects(quantity.key) {
            quantity.reject(reason);
        }
    }
    // The handle's constants are scaled by the large shaft's damping, and doubted with it.
    let turns = gathered.travel[1] > TURNS;
    let handle = handle::quantities(&gathered.free, turns, &fit, device, known);
    quantities.extend(handle.into_iter().flatten());
    if let Some(why) = gathered.doubts(&fit) {
        for quantity in &mut quantities {
            quantity.doubt(&why);
        }
    }
    if !quantities.iter().any(Quantity::is_told) {
        let widths: Vec<_> = quantities.iter().map(Quantity::short).collect();
        return Err(Failure::Input(format!(
            "{}: no constant is identified within 2 % ({}); record the whole scene excite, or several \
             recordings",
            recordings[0].0,
            widths.join(", ")
        )));
    }
    let mut assumed = assumptions(known, gathered.unseen);
    assumed.append(&mut gathered.without_handle);
    Ok(Identification {
        quantities,
        ratios: ratio::all(&fit, gathered.turns_one_way()),
        assumed,
        windows: (gathered.large.usable.len(), gathered.large.windows),
        unexplained: fit.unexplained / fit.driven,
        comparisons: model::compare(recordings, device, &fit),
        is_default: false,
    })
}

/// Error for a recording without the handle's counts. The handle yields under a hand of stiffness K,
/// with `b w_S = (b^2 / K) dw_L/dt`, which reduces the identified inertia by `b^2 / K`.
fn unseen(name: &str, device: &Device) -> Failure {
    let b = device.stages.damping;
    let part = b * b / device.hand.stiffness_nm_per_rad / device.stages.large.inertia;
    Failure::Input(format!(
        "{name}: line 1: no column counts_small; the motion of a handle in a hand of {} N.m/rad would \
         make the identified inertia {:.0} % too small; record the column, or clamp the handle and \
         give --clamped, also for a motor without a handle",
        device.hand.stiffness_nm_per_rad,
        100.0 * part
    ))
}

/// The assumption on the encoders without a device file. `large` and `small` tell whether the counts of each
/// encoder are assumed; `None` if neither is.
#[must_use]
pub fn default_counts(device: &Device, large: bool, small: bool) -> Option<String> {
    let (stages, of) = (
        device.stages,
        "of the default device, because no --device is given",
    );
    let large = large.then(|| format!("large.counts_per_rev = {}", stages.large.counts_per_rev));
    let small = small.then(|| format!("small.counts_per_rev = {}", stages.small.counts_per_rev));
    match (large, small) {
        (Some(large), Some(small)) => Some(format!(
            "{large} and {small} {of}; with other encoders every value is wrong"
        )),
        (one, other) => {
            let key = one.or(other)?;
            Some(format!(
                "{key} {of}; with another encoder every value is wrong"
            ))
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn step_that_is_too_long_or_too_short_breaks_the_rows() {
        assert_eq!(breaks(&[0.0, 1.0, 2.05, 3.0], 1.0), [0, 0, 0, 0]);
        assert_eq!(
            breaks(&[0.0, 1.0, 2.5, 3.5, 4.2, 5.2], 1.0),
            [0, 0, 1, 1, 2, 2]
        );
    }
}
