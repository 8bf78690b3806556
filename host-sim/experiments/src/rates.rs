//! The rates of recordings: which estimators run at them, and recordings of one rate.

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use simulation::device::Device;
use simulation::simulate::RATES_HZ;
use terminal::failure::Failure;

/// Lowest and highest rate for which every estimator is made, Hz: those of control.
pub const EVERY_HZ: [f64; 2] = [RATES_HZ.0, RATES_HZ.1];

/// Largest relative difference between the rates of recordings that count as one rate.
const SAME: f64 = 0.01;

/// The rate nearest to `rate_hz` for which every estimator is made, Hz.
#[must_use]
pub fn nearest(rate_hz: f64) -> f64 {
    let [low, high] = EVERY_HZ;
    rate_hz.clamp(low, high)
}

/// Whether an estimator refuses the rate of a recording: it cannot be built, and could with the same
/// parameters at the rate [`nearest`] to it. A rate that none can have is refused elsewhere.
#[must_use]
pub fn refuses(kind: &Kind, rate_hz: f64, device: &Device, parameters: &Parameters) -> bool {
    let builds = |rate_hz: f64| {
        let setup = Setup::of(device, rate_hz);
        let values = parameters.values(kind, &setup, PlantKind::Friction);
        kind.build(&setup, &values).is_ok()
    };
    let nearest = nearest(rate_hz);
    rate_hz > 0.0
        && rate_hz.is_finite()
        && nearest != rate_hz
        && !builds(rate_hz)
        && builds(nearest)
}

/// Checks that recordings, each with its name and its rate in Hz, have one rate.
///
/// # Errors
/// [`Failure::Input`] that names the first recording of another rate.
pub(crate) fn check_same<'a>(
    logs: impl IntoIterator<Item = (&'a str, f64)>,
) -> Result<(), Failure> {
    let mut logs = logs.into_iter();
    let Some((first, rate_hz)) = logs.next() else {
        return Ok(());
    };
    match logs.find(|(_, other)| (other / rate_hz - 1.0).abs() > SAME) {
        None => Ok(()),
        Some((name, other)) => Err(Failure::Input(format!(
            "{name}: its rate is {other} Hz and that of {first} {rate_hz} Hz; give --resample, or run each \
             rate on its own"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimators_refuse_a_rate_only_outside_the_rates_of_every_one() {
        let refused = |rate_hz: f64| -> Vec<&str> {
            let (device, parameters) = (Device::default(), Parameters::default());
            let kinds = Kind::all().iter();
            let kinds = kinds.filter(|kind| refuses(kind, rate_hz, &device, &parameters));
            kinds.map(|kind| kind.name).collect()
        };
        for rate_hz in [EVERY_HZ[0], EVERY_HZ[1], 0.0, f64::NAN, f64::INFINITY] {
            assert!(refused(rate_hz).is_empty(), "{rate_hz}");
        }
        for rate_hz in [10.0, 50.0, 2e6] {
            let refused = refused(rate_hz);
            assert!(refused.contains(&"imm"), "{rate_hz}: {refused:?}");
            assert!(
                !refused.contains(&"finite-difference"),
                "{rate_hz}: {refused:?}"
            );
        }
    }

    #[test]
    fn parameter_of_the_user_is_no_refused_rate() {
        let mut parameters = Parameters::default();
        parameters.set("pll.bandwidth_hz=1e4").unwrap();
        let kind = Kind::named("pll").unwrap();
        assert!(!refuses(kind, 1e3, &Device::default(), &parameters));
    }

    #[test]
    fn recording_of_another_rate_is_named() {
        assert!(check_same([("a", 1e3), ("b", 1.005e3)]).is_ok());
        let error = check_same([("a", 1e3), ("b", 1e3), ("c", 1e5)]).unwrap_err();
        let said = "c: its rate is 100000 Hz and that of a 1000 Hz; give --resample,";
        assert!(error.to_string().starts_with(said), "{error}");
    }
}
