//! The step of a column of positions: what its changes are multiples of.

use std::collections::BTreeMap;

/// Most changes that are kept. Of more, every second one is left out.
const KEPT: usize = 2048;

/// Fewest changes that determine a step.
const FEWEST: usize = 30;

/// Largest distance of a change from a multiple of the step, in steps: what the digits of an angle round.
const OFF: f64 = 0.02;

/// The same if the changes are not varied: those of a shaft that rests and turns at a speed may be equal.
const EQUAL: f64 = 0.005;

/// Least share of the changes that are multiples. The others are bad rows and wraps of an angle.
const SHARE: f64 = 0.98;

/// The step is at least the smallest change over this number.
const PARTS: u32 = 4;

/// Least share of the rows without a change of a slow shaft. Its changes are steps.
const SLOW: f64 = 0.1;

/// Least share of the changes of a faster shaft that are another number of steps than most. Fewer are a constant
/// speed.
const VARIED: f64 = 0.1;

/// Ratio from which a change is larger than the smallest one, and least share of such changes that are many.
const LARGER: f64 = 1.5;
const MANY_LARGER: f64 = 0.3;

/// Changes of a column of positions, in memory that does not grow with its rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    changes: Vec<f64>,
    /// Number of all changes; those that are kept have a multiple of 2^`halvings` before them.
    changed: usize,
    halvings: u32,
    unchanged: usize,
}

impl Grid {
    /// Adds the change from a row to the next.
    pub(super) fn add(&mut self, change: f64) {
        if change == 0.0 {
            self.unchanged += 1;
            return;
        }
        if self.changes.len() == KEPT {
            let mut is_kept = false;
            self.changes.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.halvings += 1;
        }
        if self.changed.is_multiple_of(1 << self.halvings) {
            self.changes.push(change.abs());
        }
        self.changed += 1;
    }

    /// Number of rows with a change.
    pub(super) fn changes(&self) -> usize {
        self.changed
    }

    /// The smallest change; `None` without changes.
    pub(super) fn least(&self) -> Option<f64> {
        self.changes.iter().copied().reduce(f64::min)
    }

    /// Whether a good part of the changes are larger than the smallest one.
    pub(super) fn is_varied(&self) -> bool {
        let least = self.least().unwrap_or(f64::INFINITY);
        let larger = self
            .changes
            .iter()
            .filter(|change| **change > LARGER * least);
        share(larger.count(), self.changes.len()) >= MANY_LARGER
    }

    /// The step, in the unit of the changes; `None` if they are no multiples of one, or too few to tell.
    pub(super) fn step(&self) -> Option<f64> {
        if self.changes.len() < FEWEST {
            return None;
        }
        let mut changes = self.changes.clone();
        changes.sort_by(f64::total_cmp);
        let rows = self.changed + self.unchanged;
        let is_slow = share(self.unchanged, rows) >= SLOW;
        (1..=PARTS).find_map(|parts| {
            let begin = changes[0] / f64::from(parts);
            let varied = fitted(&changes, begin, OFF, VARIED);
            varied.or_else(|| {
                is_slow
                    .then(|| fitted(&changes, begin, EQUAL, 0.0))
                    .flatten()
            })
        })
    }
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

/// The step near `begin` of which the `changes`, from the smallest on, are multiples to `off` steps. At least the
/// share `varied` of them are another number of steps than most.
fn fitted(changes: &[f64], begin: f64, off: f64, varied: f64) -> Option<f64> {
    let (mut sum, mut steps) = (0.0, 0.0);
    let mut step = begin;
    let mut numbers = BTreeMap::<u64, usize>::new();
    for change in changes {
        let number = (change / step).round();
        if (change / step - number).abs() <= off {
            // Larger changes determine the step to more digits.
            sum += change;
            steps += number;
            step = sum / steps;
            *numbers.entry(number as u64).or_default() += 1;
        }
    }
    let fitting: usize = numbers.values().sum();
    let most = numbers.values().max().copied().unwrap_or_default();
    let is_varied = share(fitting - most, changes.len()) >= varied;
    (is_varied && share(fitting, changes.len()) >= SHARE).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes of a swing whose position is rounded down to multiples of `step`, and written with `digits`.
    fn swing(step: f64, amplitude: f64, rows: u32, digits: usize) -> Grid {
        let mut grid = Grid::default();
        let mut last = 0.0;
        for k in 0..rows {
            let exact = amplitude * (f64::from(k) * 0.01).sin();
            let written = format!("{:.digits$}", (exact / step).floor() * step);
            let position: f64 = written.parse().unwrap();
            if k > 0 {
                grid.add(position - last);
            }
            last = position;
        }
        grid
    }

    #[test]
    fn step_of_a_rounded_motion_is_found() {
        for (step, digits) in [
            (191.0 / 65535.0, 17),
            (1.0, 0),
            (8.0, 0),
            (0.0015339, 6),
            (360.0 / 4096.0, 3),
        ] {
            for steps in [20.0, 700.0, 4000.0] {
                let found = swing(step, steps * step, 3000, digits).step();
                // All changes are one step, which the digits blur.
                let is_blurred = (steps, digits) == (20.0, 3);
                assert_eq!(found.is_none(), is_blurred, "{step} {steps}");
                let off = found.map_or(0.0, |found| found / step - 1.0);
                assert!(off.abs() < 2e-3, "{step} {steps}: {found:?}");
            }
        }
        // A few bad rows and wraps change nothing.
        let mut grid = swing(8.0, 5600.0, 3000, 0);
        for _ in 0..20 {
            grid.changes.push(4091.0);
        }
        assert_eq!(grid.step(), Some(8.0));
    }

    #[test]
    fn other_changes_have_no_step() {
        let mut noise = 1_u32;
        let mut random = Grid::default();
        for _ in 0..3000 {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            random.add(f64::from(noise) - f64::from(u32::MAX / 2));
        }
        assert_eq!(random.step(), None);
        // Few digits hide the step.
        assert_eq!(swing(360.0 / 4096.0, 30.0, 3000, 2).step(), None);
        // A constant speed, also of large changes, with a few missing rows.
        for speed in [8.0, 39.788, 1000.3] {
            let mut constant = Grid::default();
            for k in 0..500 {
                let missing = if k % 25 == 0 { 3.0 } else { 1.0 };
                let end = (f64::from(k) + missing) * speed;
                constant.add(end.floor() - (f64::from(k) * speed).floor());
            }
            assert_eq!(constant.step(), None, "{speed}");
        }
        assert_eq!(swing(8.0, 8.0 * 14.0, 320, 0).step(), None, "too few");
        assert_eq!(Grid::default().step(), None);
    }

    #[test]
    fn a_slow_shaft_changes_by_one_step() {
        let mut grid = Grid::default();
        for k in 0..400 {
            grid.add(if k % 10 == 0 { 0.0 } else { -8.0 });
        }
        assert_eq!(grid.step(), Some(8.0));
        (0..5).for_each(|_| grid.add(8.0));
        assert_eq!(grid.step(), None);
    }

    #[test]
    fn every_change_may_be_several_steps() {
        let mut grid = Grid::default();
        (0..400).for_each(|k| grid.add(8.0 * f64::from(3 + k % 3)));
        assert_eq!(grid.step(), Some(8.0));
    }

    #[test]
    fn thirty_changes_determine_a_step() {
        let mut grid = Grid::default();
        for k in 0..29 {
            grid.add(f64::from(1 + k % 3));
        }
        assert_eq!(grid.step(), None);
        grid.add(1.0);
        assert_eq!(grid.step(), Some(1.0));
    }

    #[test]
    fn step_is_that_of_all_changes() {
        // Changes by a multiple of 4 at the begin alone, and later ones by any number.
        let mut grid = Grid::default();
        (0..3000).for_each(|k| grid.add(f64::from(4 * (1 + k % 3))));
        assert_eq!(grid.step(), Some(4.0));
        (0..3000).for_each(|k| grid.add(f64::from(1 + k % 7)));
        assert_eq!(grid.step(), Some(1.0));
    }

    #[test]
    fn memory_is_bounded() {
        let mut grid = Grid::default();
        (0..=5000).for_each(|k| grid.add(f64::from(k)));
        // Every fourth one.
        assert_eq!((grid.changes.len(), grid.unchanged), (1250, 1));
        assert_eq!(grid.changes[..3], [1.0, 5.0, 9.0]);
        assert_eq!((grid.changed, grid.changes[1249]), (5000, 4997.0));
    }
}
