//! The estimators that the shipped presets give for a device at a rate: for a fine encoder at a low rate
//! not every design is possible in single precision.

use catalogue::estimators::{Kind, Setup, fewer_counts};
use catalogue::parameters::{Parameters, PlantKind};
use simulation::device::Device;

/// What an estimator is designed for, and the plant of its presets.
pub type Place = (Setup, PlantKind);

/// A device with friction, as every real one, at a rate.
#[must_use]
pub fn with_friction(device: &Device, rate_hz: f64) -> Place {
    (Setup::of(device, rate_hz), PlantKind::Friction)
}

/// Those of `kinds` that can be built at all of `places`, and a line for each reason for which others are left
/// out. An estimator with parameters that a user chose is not left out: its error is the user's.
#[must_use]
pub fn designed(
    kinds: &[&'static Kind],
    parameters: &Parameters,
    places: &[Place],
) -> (Vec<&'static Kind>, Vec<String>) {
    let mut able = Vec::new();
    let mut left_out: Vec<(String, Vec<&str>, Option<Coarser>)> = Vec::new();
    for &kind in kinds {
        let why = places
            .iter()
            .find_map(|place| refusal(kind, parameters, place));
        let Some((why, coarser)) = why else {
            able.push(kind);
            continue;
        };
        match left_out.iter_mut().find(|(known, ..)| *known == why) {
            Some((_, names, all)) => {
                names.push(kind.name);
                let fewest = |(a, b): (Coarser, Coarser)| if a.1 < b.1 { a } else { b };
                *all = all.zip(coarser).map(fewest);
            }
            None => left_out.push((why, vec![kind.name], coarser)),
        }
    }
    let line = |(why, names, coarser): (String, Vec<&str>, Option<Coarser>)| {
        let remedy = coarser.map_or_else(String::new, |(setup, counts)| {
            format!("; {}", fewer_counts(&setup, counts))
        });
        format!("estimators left out: {}: {why}{remedy}", names.join(", "))
    };
    (able, left_out.into_iter().map(line).collect())
}

/// What an estimator is not designed for, and the most counts per revolution with which it is.
type Coarser = (Setup, u32);

/// Why the shipped parameters give no estimator, and with how many counts they do; `None` if they give one, or if the
/// parameters are others.
fn refusal(
    kind: &Kind,
    parameters: &Parameters,
    (setup, plant): &Place,
) -> Option<(String, Option<Coarser>)> {
    let values = parameters.values(kind, setup, *plant);
    let why = kind.refusal(setup, &values)?;
    let are_shipped = Parameters::default().values(kind, setup, *plant) == values;
    let counts = setup.stages.large.counts_per_rev;
    are_shipped.then(|| {
        let why = format!("with {counts} counts/rev {why}");
        let coarser = kind.coarser(setup, &values);
        (why, coarser.map(|counts| (*setup, counts)))
    })
}

/// A line on tuned values that scaling to one of `places` takes to an end of their range, where they are not the best
/// values; `None` if there are none.
#[must_use]
pub fn at_range_ends(
    kinds: &[&'static Kind],
    parameters: &Parameters,
    places: &[Place],
) -> Option<String> {
    let (mut rates, mut names) = (Vec::new(), Vec::new());
    for (setup, plant) in places {
        for kind in kinds {
            for parameter in parameters.at_range_ends(kind, setup, *plant) {
                rates.push(setup.rate.0);
                let name = format!("{}.{parameter}", kind.name);
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
    }
    let counts = places.first()?.0.stages.large.counts_per_rev;
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    let rates: Vec<_> = rates.iter().map(|hz| format!("{hz} Hz")).collect();
    (!names.is_empty()).then(|| {
        format!(
            "presets that are scaled to large.counts_per_rev = {counts} at {} leave their range, and have its end, which \
             is not tuned: {}; tune them with host-sim tune --device, or give --set",
            rates.join(" and "),
            names.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(counts_per_rev: u32, rate_hz: f64) -> Place {
        let mut device = Device::default();
        device.stages.large.counts_per_rev = counts_per_rev;
        with_friction(&device, rate_hz)
    }

    #[test]
    fn estimators_without_a_design_are_left_out_with_the_reason() {
        let kinds: Vec<_> = Kind::all().iter().collect();
        let parameters = Parameters::default();
        let (able, lines) = designed(
            &kinds,
            &parameters,
            &[place(4096, 1e3), place(1 << 20, 1e3)],
        );
        assert_eq!((able.len(), lines.len()), (kinds.len(), 0), "{lines:?}");
        let (able, lines) = designed(
            &kinds,
            &parameters,
            &[place(4096, 1e3), place(1 << 20, 200.0)],
        );
        let said = "estimators left out: kalman-triple, kalman-motor: with 1048576 counts/rev at 200 Hz: \
                    process_noise must be at most 2^18 on the diagonal";
        assert!(lines.len() == 1 && lines[0].starts_with(said), "{lines:?}");
        // Each halving of the counts takes a quarter of the process noise.
        let counts: u32 = lines[0]
            .rsplit_once("--counts-per-rev ")
            .and_then(|(_, rest)| rest.split(' ').next()?.parse().ok())
            .unwrap();
        let remedy = format!(
            "with {counts} counts/rev it is possible, for a log by host-sim coarsen --fine-counts-per-rev 1048576 \
             --counts-per-rev {counts} --rate 200"
        );
        assert!(lines[0].ends_with(&remedy), "{lines:?}");
        for (counts, lines) in [(counts, 0), (2 * counts, 1)] {
            let found = designed(&kinds, &parameters, &[place(counts, 200.0)]).1;
            assert_eq!(found.len(), lines, "{counts}: {found:?}");
        }
        assert_eq!(able.len(), kinds.len() - 2);
        assert!(
            able.iter()
                .all(|kind| !["kalman-triple", "kalman-motor"].contains(&kind.name))
        );
    }

    #[test]
    fn estimator_with_parameters_of_the_user_is_kept() {
        let kind = Kind::named("kalman-triple").unwrap();
        let mut parameters = Parameters::default();
        parameters.set("kalman-triple.jerk=1e9").unwrap();
        let (setup, plant) = place(1 << 20, 200.0);
        let values = parameters.values(kind, &setup, plant);
        assert!(kind.build(&setup, &values).is_err());
        let (able, lines) = designed(&[kind], &parameters, &[(setup, plant)]);
        assert_eq!((able.len(), lines.len()), (1, 0), "{lines:?}");
    }

    #[test]
    fn values_at_the_end_of_their_range_are_named_with_counts_and_rate() {
        let kinds: Vec<_> = Kind::all().iter().collect();
        let parameters = Parameters::default();
        let line = |counts: u32, rate_hz: f64| {
            at_range_ends(&kinds, &parameters, &[place(counts, rate_hz)])
        };
        for rate_hz in [1e3, 2e3, 10e3, 11.6e3] {
            assert_eq!(line(4096, rate_hz), None);
        }
        let said = line(16, 10e3).unwrap();
        assert!(
            said.starts_with(
                "presets that are scaled to large.counts_per_rev = 16 at 10000 Hz leave their range"
            ) && said.contains("foaw-best-fit.n"),
            "{said}"
        );
    }
}
