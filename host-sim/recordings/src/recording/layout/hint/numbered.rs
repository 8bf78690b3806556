//! The time and the position among columns without names.

use super::super::Layout;
use super::super::search::number;
use super::super::seen::{self, Seen};
use super::guess::{guessed_unit, units};
use crate::recording::options::units::Quantity;

/// Whether the first rows of columns without names tell that none is a time.
pub(super) fn has_no_time(layout: &Layout) -> bool {
    layout.since_1970.is_empty() && layout.moments.is_empty() && seen::has_no_time(&layout.seen)
}

/// The options for columns without names: the time, or the rate of the rows unless it is stated, and the position.
pub(super) fn option(layout: &Layout) -> String {
    let time = time(layout);
    let place = position(layout, time.as_ref().map(|time| time.place));
    let unit = guessed_unit(layout, Quantity::Position, place);
    let time = time.filter(|_| !layout.has_rate);
    let rate = match time.is_none() && !layout.has_rate {
        true => "--row-rate 1000 ",
        false => "",
    };
    let guessed = time.iter().filter_map(|time| time.guessed);
    let guessed: Vec<_> = guessed.chain([unit]).collect();
    let time = time.map(|time| format!("t={},", time.text));
    format!(
        "{rate}--column {}counts_large={}:{unit}, where the columns and {} are guesses",
        time.unwrap_or_default(),
        place + 1,
        units(&guessed)
    )
}

/// A time without a name, as `--column` calls it.
struct Time {
    /// The last of its columns.
    place: usize,
    text: String,
    /// Its unit if the numbers do not tell it.
    guessed: Option<&'static str>,
}

/// The time among columns without names: one since 1970 in the first row, or the column that rises most evenly; the
/// first one in a text of a row or two.
fn time(layout: &Layout) -> Option<Time> {
    if layout.names.len() < 2 || has_no_time(layout) {
        return None;
    }
    let has_integer = |place| has_number(layout, place) && !layout.is_fractional(place);
    let (place, text, guessed) = match layout.since_1970.first() {
        Some((place, "s")) if [*place, place + 1].into_iter().all(has_integer) => {
            let text = format!("{}:s+{}:ns", place + 1, place + 2);
            (place + 1, text, Some("ns"))
        }
        Some((place, unit)) => (*place, format!("{}:{unit}", place + 1), None),
        // A date has no unit.
        None if layout.moments.contains(&0) => (0, "1".to_owned(), None),
        None => {
            let place = seen::time(&layout.seen).unwrap_or(0);
            let unit = guessed_unit(layout, Quantity::Time, place);
            (place, format!("{}:{unit}", place + 1), Some(unit))
        }
    };
    Some(Time {
        place,
        text,
        guessed,
    })
}

/// The position among columns without names: the next number behind that of the `time` that changes and does not count
/// the rows.
fn position(layout: &Layout, time: Option<usize>) -> usize {
    let next = time.map_or(0, |time| time + 1);
    let columns = layout.names.len();
    let others = (next..columns).chain(0..next.min(columns));
    let others = others.filter(|place| Some(*place) != time && has_number(layout, *place));
    let others: Vec<_> = others.collect();
    let is_motion = |place: &&usize| {
        let counts_rows = layout.seen.get(**place).is_some_and(Seen::is_counting);
        !layout.is_at_rest(**place) && !counts_rows
    };
    let place = others.iter().find(is_motion).or(others.first());
    place.copied().unwrap_or(next)
}

/// Whether the first row without a header has a number at `place`.
fn has_number(layout: &Layout, place: usize) -> bool {
    let fields = layout.separator.split(&layout.first_row);
    let field = fields.get(place);
    field.is_some_and(|field| number(field, layout.separator).is_some())
}
