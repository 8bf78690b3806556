//! Z-width: which virtual walls and dampings stay passive and free of limit cycles.
//!
//! For an estimator, a rate and an encoder, the largest stiffness at each of several dampings and
//! the largest damping of a viscous field, found in simulation by [`criterion`] and bisection.

pub mod criterion;
pub mod probe;
pub mod rows;
pub mod table;

use rayon::prelude::*;

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use probe::{Finding, Probe};
use simulation::device::Device;
use terminal::failure::Failure;

/// Smallest and largest stiffness that is tried, N.m/rad. A softer wall presses a fingertip with
/// less than 0.1 N; there a coarse encoder shows its counts one by one, whatever the wall is.
pub const STIFFNESS: (f64, f64) = (0.04, 81.92);
/// Smallest and largest damping that is tried, N.m.s/rad.
pub const DAMPING: (f64, f64) = (1e-5, 0.08192);
/// Dampings of the walls, as parts of the largest one.
pub const PARTS: [f64; 5] = [0.0, 0.125, 0.25, 0.5, 0.75];
/// The bound and the first value that failed differ by no more than this factor.
pub const RESOLUTION: f64 = 1.03;

/// What a boundary is found for.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Estimator of the large motor's velocity.
    pub large: &'static Kind,
    /// Estimator of the handle's velocity.
    pub handle: &'static Kind,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Lines of the large encoder; a quarter of its counts a revolution.
    pub lines: u32,
}

/// What all cases have in common.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The device, but for the lines of its large encoder.
    pub device: Device,
    /// Parameters of the estimators.
    pub parameters: Parameters,
    /// Seed of the encoders' phases and the disc.
    pub seed: u64,
}

/// The largest value that was found good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// That value; 0 if the smallest one that is tried fails.
    pub value: f64,
    /// What fails beyond it; `None` if the largest one that is tried is good.
    pub beyond: Option<Finding>,
}

/// The boundary of one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Damping (N.m.s/rad) and the largest stiffness (N.m/rad) at that damping; dampings rise.
    pub walls: Vec<(f64, Bound)>,
    /// Largest damping without a wall, N.m.s/rad.
    pub viscous: Bound,
}

impl Boundary {
    /// The stiffest wall and its damping, N.m/rad and N.m.s/rad.
    #[must_use]
    pub fn stiffest(&self) -> Option<(f64, Bound)> {
        // Of equals, the one with the least damping.
        let walls = self.walls.iter().rev().copied();
        walls.max_by(|a, b| a.1.value.total_cmp(&b.1.value))
    }
}

/// How many bounds a case takes, at most.
pub const BOUNDS_A_CASE: usize = PARTS.len() + 1;

/// The boundaries of all cases, in their order; `done` is called as each of their
/// [`BOUNDS_A_CASE`] bounds is found.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn boundaries(
    cases: &[Case],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Result<Vec<Boundary>, Failure> {
    let probes: Vec<Probe> = cases
        .iter()
        .map(|case| probe(case, settings))
        .collect::<Result<_, _>>()?;
    let viscous: Vec<Bound> = probes
        .par_iter()
        .map(|probe| {
            let bound = bound(DAMPING, |b| probe.fault(0.0, b));
            done();
            bound
        })
        .collect::<Result<_, _>>()?;
    let walls: Vec<(usize, f64)> = (0..cases.len())
        .flat_map(|i| PARTS.map(|part| (i, part)))
        .collect();
    let stiffnesses: Vec<Option<(f64, Bound)>> = walls
        .par_iter()
        .map(|&(i, part)| {
            let damping = part * viscous[i].value;
            // Without a largest damping there is but one wall, the one that has none.
            let wall = if part > 0.0 && damping == 0.0 {
                Ok(None)
            } else {
                bound(STIFFNESS, |k| probes[i].fault(k, damping)).map(|k| Some((damping, k)))
            };
            done();
            wall
        })
        .collect::<Result<_, _>>()?;
    let walls = stiffnesses.chunks(PARTS.len());
    Ok(walls
        .zip(viscous)
        .map(|(walls, viscous)| Boundary {
            walls: walls.iter().copied().flatten().collect(),
            viscous,
        })
        .collect())
}

/// The probe of one case.
///
/// # Errors
/// As [`Probe::new`].
pub fn probe(case: &Case, settings: &Settings) -> Result<Probe, Failure> {
    let mut device = settings.device.clone();
    device.stages.large.counts_per_rev = case.lines.saturating_mul(4);
    Probe::new(
        device,
        case.rate_hz,
        settings.seed,
        [case.large, case.handle],
        &settings.parameters,
    )
}

/// The largest value from `low` to `high` below which nothing fails: doubled from `low` until
/// something does, then bisected on a logarithmic scale. So a range of good values beyond the
/// first bad one is not mistaken for the bound, if the bad range is wider than a factor of 2.
///
/// # Errors
/// Those of `fault`.
pub fn bound(
    (low, high): (f64, f64),
    fault: impl Fn(f64) -> Result<Option<Finding>, Failure>,
) -> Result<Bound, Failure> {
    let mut good = 0.0;
    let mut bad = low;
    let mut beyond = loop {
        match fault(bad)? {
            Some(finding) => break finding,
            None => good = bad,
        }
        if good >= high {
            return Ok(Bound {
                value: good,
                beyond: None,
            });
        }
        bad = (2.0 * good).min(high);
    };
    while good > 0.0 && bad > RESOLUTION * good {
        let middle = (good * bad).sqrt();
        match fault(middle)? {
            Some(finding) => (bad, beyond) = (middle, finding),
            None => good = middle,
        }
    }
    Ok(Bound {
        value: good,
        beyond: Some(beyond),
    })
}

#[cfg(test)]
mod tests {
    use super::criterion::Fault;
    use super::probe::Touch;
    use super::*;

    fn found(limit: f64) -> Bound {
        bound((0.01, 100.0), |x| {
            Ok((x > limit).then_some(Finding {
                touch: Touch::Hand,
                fault: Fault::Energy,
            }))
        })
        .unwrap()
    }

    #[test]
    fn a_bound_is_good_and_within_the_resolution() {
        for limit in [0.0101, 0.3, 7.0, 99.0] {
            let value = found(limit).value;
            assert!(
                value <= limit && limit < RESOLUTION * value,
                "{limit}: {value}"
            );
        }
    }

    #[test]
    fn nothing_good_is_zero_and_nothing_bad_is_the_cap() {
        assert_eq!(found(0.001).value, 0.0);
        assert!(found(0.001).beyond.is_some());
        let all = found(1e9);
        assert_eq!((all.value, all.beyond), (100.0, None));
    }
}
