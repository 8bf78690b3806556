//! What the numbers of the first rows tell about a column that no name explains.

use super::Layout;
use super::search::{number, rows};

/// Least share of the rows in which a column of times rises. In others it may stay.
const RISES: f64 = 0.9;

/// Fewest rows that tell.
const FEWEST: usize = 3;

/// Largest unevenness of a step, over the steps, of a time that is written beside numbers of rows.
const EXACT: f64 = 1e-6;

/// The numbers of a column in the first rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    pub(crate) first: Option<f64>,
    /// How many rows have a number.
    pub(crate) rows: usize,
    /// The largest number without its sign.
    pub(crate) largest: f64,
    /// Whether a number has a fraction.
    pub(crate) is_fractional: bool,
    /// Whether all numbers are one: that of a device, or what was not used.
    pub(crate) is_constant: bool,
    /// The median of the steps of a column that rises as a time does.
    pub(crate) step: Option<f64>,
    /// Mean distance of the steps from the median, over it.
    unevenness: f64,
}

impl Seen {
    /// The numbers of the columns of `layout` in the rows among `lines`.
    pub(super) fn of(layout: &Layout, lines: &[&str]) -> Vec<Self> {
        let rows = rows(layout, lines);
        let column = |place: usize| {
            let fields = rows.iter().filter_map(|row| row.get(place));
            let numbers = fields.filter_map(|field| number(field, layout.separator));
            Self::of_numbers(&numbers.collect::<Vec<_>>())
        };
        (0..layout.names.len()).map(column).collect()
    }

    pub(crate) fn of_numbers(numbers: &[f64]) -> Self {
        let seen = Self {
            first: numbers.first().copied(),
            rows: numbers.len(),
            largest: numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs())),
            is_fractional: numbers.iter().any(|x| x.fract() != 0.0),
            is_constant: numbers.windows(2).all(|pair| pair[0] == pair[1]),
            ..Self::default()
        };
        let steps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
        let mut rising: Vec<_> = steps.clone().filter(|step| *step > 0.0).collect();
        let falls = steps.clone().any(|step| step < 0.0 || step.is_nan());
        let share = rising.len() as f64 / steps.len() as f64;
        if falls || numbers.len() < FEWEST || share < RISES {
            return seen;
        }
        rising.sort_by(f64::total_cmp);
        let median = rising[rising.len() / 2];
        let off: f64 = steps.map(|step| (step - median).abs()).sum();
        Self {
            step: Some(median),
            unevenness: off / median / (numbers.len() - 1) as f64,
            ..seen
        }
    }

    /// Whether the numbers are those of the rows, from any number on.
    pub(crate) fn is_counting(&self) -> bool {
        self.step == Some(1.0) && self.unevenness == 0.0
    }

    /// Whether the numbers are those of the rows, from 0 on.
    fn is_index(&self) -> bool {
        self.first == Some(0.0) && self.is_counting()
    }

    /// Whether the numbers rise in even steps that are no whole numbers.
    fn is_exact(&self) -> bool {
        self.step.is_some() && self.is_fractional && self.unevenness < EXACT
    }
}

/// The column among the `seen` ones that most probably is a time: it rises, with the most even steps. Beside it, numbers
/// of the rows are none.
pub(super) fn time(seen: &[Seen]) -> Option<usize> {
    let rising = (0..seen.len()).filter(|place| seen[*place].step.is_some());
    let time = rising.min_by(|a, b| seen[*a].unevenness.total_cmp(&seen[*b].unevenness))?;
    let mut others = (0..seen.len()).filter(|place| seen[*place].is_exact());
    match seen[time].is_index() {
        true => others.next().or(Some(time)),
        false => Some(time),
    }
}

/// Whether there are rows enough to tell that no column is a time.
pub(super) fn has_no_time(seen: &[Seen]) -> bool {
    seen.iter().any(|seen| seen.rows >= FEWEST) && seen.iter().all(|seen| seen.step.is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn column_that_rises_is_a_time() {
        let seen = Seen::of_numbers(&[0.5, 1.5, 2.5, 3.0]);
        assert_eq!((seen.largest, seen.step), (3.0, Some(1.0)));
        for numbers in [&[0.0, 2.0, 1.0, 3.0][..], &[1.0, 1.0, 1.0], &[1.0, 2.0]] {
            assert_eq!(Seen::of_numbers(numbers).step, None, "{numbers:?}");
        }
        // One of eleven steps is 0.
        let staying = [0.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
        assert_eq!(Seen::of_numbers(&staying).step, Some(1.0));
        assert_eq!(Seen::of_numbers(&staying[..6]).step, None);
    }

    #[test]
    fn most_even_steps_are_those_of_a_time() {
        let position: Vec<_> = (0..50).map(|k| f64::from(k).powi(2)).collect();
        let jittered: Vec<_> = (0..50).map(|k| f64::from(10 * k + k % 3)).collect();
        let falling: Vec<_> = (0..50).map(|k| f64::from(-k)).collect();
        let seen = [falling, position, jittered].map(|numbers| Seen::of_numbers(&numbers));
        assert_eq!(time(&seen), Some(2));
        assert_eq!(time(&seen[..2]), Some(1));
        assert_eq!(time(&seen[..1]), None);
    }
}
