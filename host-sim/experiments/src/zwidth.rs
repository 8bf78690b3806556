//! Z-width: the virtual walls and dampings that are passive and free of limit cycles.
//!
//! For an estimator, a rate and an encoder, a bisection over simulations finds the largest
//! stiffness at each of several dampings and the largest damping of a viscous field. [`criterion`]
//! decides whether a simulation passes.

pub mod contact;
pub mod criterion;
mod plan;
pub mod rows;
pub mod table;

use serde::{Deserialize, Serialize};

use crate::parallel::in_order;
use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use contact::{ContactTest, Finding};
pub use plan::{HANDLE, Plan};
use simulation::device::Device;
use terminal::failure::Failure;

/// Smallest and largest stiffness of the search, N.m/rad. A softer wall has a force below 0.1 N at
/// the fingertip, where single counts of a coarse encoder dominate.
pub const STIFFNESS: (f64, f64) = (0.04, 81.92);
/// Smallest and largest damping of the search, N.m.s/rad.
pub const DAMPING: (f64, f64) = (1e-5, 0.08192);
/// Dampings of the walls, as fractions of the largest damping without a wall.
pub const PARTS: [f64; 5] = [0.0, 0.125, 0.25, 0.5, 0.75];
/// Largest ratio of the first failing value to the bound.
pub(crate) const RESOLUTION: f64 = 1.03;

/// Estimators, control rate and large encoder of one loop, for which a boundary is searched.
#[derive(Clone, Copy, Debug)]
pub struct LoopSetup {
    /// Estimator of the large motor's velocity.
    pub large: &'static Kind,
    /// Estimator of the handle's velocity.
    pub handle: &'static Kind,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Lines of the large encoder, a quarter of its counts per revolution.
    pub lines: u32,
    /// Whether the loop has the true velocities of both motors in the place of the estimates.
    pub exact: bool,
}

/// Name of a loop with the true velocities of both motors.
pub const EXACT: &str = "exact velocity";

impl LoopSetup {
    /// Names of the estimators of the large motor's velocity and of the handle's, or [`EXACT`].
    #[must_use]
    pub fn names(&self) -> [&'static str; 2] {
        if self.exact {
            [EXACT; 2]
        } else {
            [self.large.name, self.handle.name]
        }
    }
}

/// Settings that all loops share.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// The device; the lines of its large encoder are replaced.
    pub device: Device,
    /// Parameters of the estimators.
    pub parameters: Parameters,
    /// Seed of the encoders' phases and the disc.
    pub seed: u64,
}

/// The largest value that passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    /// The value; 0 if the smallest value of the search fails.
    pub value: f64,
    /// The failure beyond it; `None` if the largest value of the search passes.
    pub beyond: Option<Finding>,
}

/// The boundary of one loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Boundary {
    /// Damping (N.m.s/rad) and largest stiffness (N.m/rad) at that damping, in order of damping.
    pub walls: Vec<(f64, Bound)>,
    /// Largest damping without a wall, N.m.s/rad.
    pub viscous: Bound,
}

impl Boundary {
    /// The stiffest wall and its damping, N.m/rad and N.m.s/rad.
    #[must_use]
    pub fn stiffest(&self) -> Option<(f64, Bound)> {
        // Of equal stiffnesses the one with the smallest damping.
        let walls = self.walls.iter().rev().copied();
        walls.max_by(|a, b| a.1.value.total_cmp(&b.1.value))
    }
}

/// Largest number of bounds of a case.
pub const BOUNDS_A_CASE: usize = PARTS.len() + 1;

/// The boundaries of all loops `cases`, in their order. `done` is called after each of the
/// [`BOUNDS_A_CASE`] bounds of a loop.
///
/// # Errors
/// [`Failure::Input`] of the first loop in this order that cannot be run.
pub fn boundaries(
    cases: &[LoopSetup],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Boundary>, Failure> {
    let tests: Vec<ContactTest> = cases
        .iter()
        .map(|case| contact_test(case, settings))
        .collect::<Result<_, _>>()?;
    let viscous: Vec<Bound> = in_order(&tests, |contact_test| {
        let bound = bound(DAMPING, |b| contact_test.violation(0.0, b));
        done();
        bound
    })?;
    let walls: Vec<(usize, f64)> = (0..cases.len())
        .flat_map(|i| PARTS.map(|part| (i, part)))
        .collect();
    let stiffnesses: Vec<Option<(f64, Bound)>> = in_order(&walls, |&(i, part)| {
        let damping = part * viscous[i].value;
        // If the largest damping is zero, only the wall without damping is searched.
        let wall = if part > 0.0 && damping == 0.0 {
            Ok(None)
        } else {
            bound(STIFFNESS, |k| tests[i].violation(k, damping)).map(|k| Some((damping, k)))
        };
        done();
        wall
    })?;
    let walls = stiffnesses.chunks(PARTS.len());
    Ok(walls
        .zip(viscous)
        .map(|(walls, viscous)| Boundary {
            walls: walls.iter().copied().flatten().collect(),
            viscous,
        })
        .collect())
}

/// The test of one loop, which decides whether a wall or a viscous field passes.
///
/// # Errors
/// As [`ContactTest::new`].
pub fn contact_test(case: &LoopSetup, settings: &Settings) -> Result<ContactTest, Failure> {
    let device = with_lines(&settings.device, case.lines);
    ContactTest::new(device, settings.seed, case, &settings.parameters)
}

/// `device` with an encoder of `lines` lines on its large motor.
#[must_use]
pub fn with_lines(device: &Device, lines: u32) -> Device {
    let mut device = device.clone();
    device.stages.large.counts_per_rev = lines.saturating_mul(4);
    device
}

/// The largest value from `low` to `high` below which no value fails. The value is doubled from
/// `low` until one fails, then bisected on a logarithmic scale. Passing values beyond a failing
/// range do not count, if the failing range is wider than a factor of 2.
///
/// # Errors
/// The errors of `violation`.
pub fn bound(
    (low, high): (f64, f64),
    violation: impl Fn(f64) -> Result<Option<Finding>, Failure>,
) -> Result<Bound, Failure> {
    let mut good = 0.0;
    let mut bad = low;
    let mut beyond = loop {
        match violation(bad)? {
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
        match violation(middle)? {
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
    use super::contact::Contact;
    use super::criterion::Violation;
    use super::*;

    fn found(limit: f64) -> Bound {
        bound((0.01, 100.0), |x| {
            Ok((x > limit).then_some(Finding {
                contact: Contact::Hand,
                violation: Violation::Energy,
            }))
        })
        .unwrap()
    }

    fn boundary() -> (LoopSetup, Boundary) {
        let fails = Some(Finding {
            contact: Contact::Throw,
            violation: Violation::Stopped,
        });
        let wall = |value, beyond| Bound { value, beyond };
        let kind = |name| Kind::named(name).unwrap();
        let case = LoopSetup {
            large: kind("kalman-motor"),
            handle: kind("pll"),
            rate_hz: 2000.0,
            lines: 256,
            exact: false,
        };
        let walls = vec![
            (0.0, wall(1.5, fails)),
            (2e-3, wall(3.25, fails)),
            (4e-3, wall(3.25, fails)),
            (6e-3, wall(0.5, fails)),
        ];
        let viscous = wall(8e-3, None);
        (case, Boundary { walls, viscous })
    }

    #[test]
    fn stiffest_wall_is_that_with_the_smallest_damping() {
        let (damping, wall) = boundary().1.stiffest().unwrap();
        assert_eq!((damping, wall.value), (2e-3, 3.25));
    }

    #[test]
    fn rows_have_stiffness_and_damping_in_their_columns() {
        let (case, boundary) = boundary();
        let rows = rows::rows(&[case], &[boundary], 7);
        let of: Vec<_> = (rows.iter())
            .map(|row| (row.bound, row.stiffness_nm_per_rad, row.damping_nms_per_rad))
            .collect();
        let expected = [
            ("stiffness", 1.5, 0.0),
            ("stiffness", 3.25, 2e-3),
            ("stiffness", 3.25, 4e-3),
            ("stiffness", 0.5, 6e-3),
            ("damping", 0.0, 8e-3),
        ];
        assert_eq!(of, expected);
        let [first, .., last] = &rows[..] else {
            panic!("rows");
        };
        assert_eq!(
            (first.estimator, first.handle_estimator),
            ("kalman-motor", "pll")
        );
        assert_eq!((first.fault, first.touch), (Some("stopped"), Some("throw")));
        assert!(!first.at_cap && last.at_cap && last.fault.is_none() && last.touch.is_none());
    }

    #[test]
    fn table_has_the_damping_in_thousandths_and_a_bound_that_is_the_end_of_the_search() {
        let (case, boundary) = boundary();
        let text = table::table(&[case], &[boundary], 1000);
        let line = text.lines().last().unwrap();
        let cells: Vec<_> = line.split_whitespace().collect();
        let expected = "kalman-motor 1.50 throw: stopped 3.25 2.00 >= 8.00 -";
        assert_eq!(cells.join(" "), expected, "{text}");
    }

    #[test]
    fn bound_passes_and_is_within_the_resolution() {
        for limit in [0.0101, 0.3, 7.0, 99.0] {
            let value = found(limit).value;
            assert!(
                value <= limit && limit < RESOLUTION * value,
                "{limit}: {value}"
            );
        }
    }

    #[test]
    fn bound_is_zero_if_all_values_fail_and_the_largest_if_none_fails() {
        assert_eq!(found(0.001).value, 0.0);
        assert!(found(0.001).beyond.is_some());
        let all = found(1e9);
        assert_eq!((all.value, all.beyond), (100.0, None));
    }
}
