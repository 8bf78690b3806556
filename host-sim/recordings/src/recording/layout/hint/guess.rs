//! Columns that are probably the time, the position and the current, and their units.

use super::super::endings::Ending;
use super::super::formats::Format;
use super::super::header::short;
use super::super::{
    Layout, POSITIONS, Places, TIMES, has, is_coordinate, is_derived, is_duration, is_indirect,
    is_joint,
};
use super::languages;
use crate::recording::options::Column;
use crate::recording::options::units::{Quantity, Unit};
use crate::recording::times::clock::FASTEST_HZ;
use crate::recording::times::steps::SLOWEST_HZ;

/// Characters of the longest name that a hint repeats; a longer one is called by its number.
const LONGEST: usize = 80;

/// The largest number of an angle that is taken for one in radians, three revolutions.
const RADIANS: f64 = 20.0;

/// The largest number of an angle that is taken for one in whole degrees.
const DEGREES: f64 = 360.0;

/// Parts of the names of what may be a position, and a time: more than say what they are.
pub(super) fn positions() -> Vec<&'static str> {
    [POSITIONS, &["count"]].concat()
}

pub(super) fn times() -> Vec<&'static str> {
    [TIMES, &["sec", "ms"]].concat()
}

/// A part of `--column`.
struct Guess {
    text: String,
    /// Its unit if neither the name nor the numbers tell it.
    guessed: Option<&'static str>,
    /// What to say of a name with a unit that is none of the quantity.
    foreign: Option<String>,
}

/// The value of `--column` for the time and the position, with the units that no name states.
pub(super) fn parts(layout: &Layout) -> String {
    let time = || guess(layout, Column::T, &times(), "TIME");
    let parts = [
        (!layout.has_rate).then(time).flatten(),
        guess(layout, Column::CountsLarge, &positions(), "POSITION"),
    ];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    let guessed: Vec<_> = parts.iter().filter_map(|part| part.guessed).collect();
    let guessed = guesses(&guessed);
    let foreign: Vec<_> = parts
        .iter()
        .filter_map(|part| part.foreign.clone())
        .collect();
    let foreign = match foreign[..] {
        [] => String::new(),
        _ => format!(
            ", where {}: write the unit of the numbers in the place of UNIT, or convert them to one",
            foreign.join(", and ")
        ),
    };
    let texts: Vec<_> = parts.into_iter().map(|part| part.text).collect();
    format!("'{}'{guessed}{foreign}", texts.join(","))
}

/// What to say of units that are guesses.
fn guesses(guessed: &[&str]) -> String {
    match guessed {
        [] => String::new(),
        [_] => format!(", where {} is a guess", units(guessed)),
        _ => format!(", where {} are guesses", units(guessed)),
    }
}

/// Units, of which there is one at least, with their noun.
pub(super) fn units(all: &[&str]) -> String {
    let noun = if all.len() == 1 { "unit" } else { "units" };
    format!("the {noun} {}", all.join(" and "))
}

/// Whether by its `name` a quantity is another one than `column`, whose words it has.
pub(super) fn is_unfit(column: Column, name: &str) -> bool {
    match column {
        Column::T => is_duration(name),
        Column::CountsLarge => is_derived(name) || is_indirect(name),
        _ => false,
    }
}

/// Whether the name at `place` ends with a unit that is none of `quantity` in any language.
pub(super) fn is_foreign(layout: &Layout, quantity: Quantity, place: usize) -> bool {
    matches!(layout.ending(quantity, place), Ending::Unknown(_))
        && in_language(layout, quantity, place).is_none()
}

/// The unit at `place` that the end of the name is in another language.
fn in_language(layout: &Layout, quantity: Quantity, place: usize) -> Option<&'static str> {
    let is_open = !matches!(layout.ending(quantity, place), Ending::Unit(_));
    let unit = languages::unit(&layout.names[place]);
    unit.filter(|_| is_open && quantity == Quantity::Position)
}

/// Whether several columns are called `name`.
pub(super) fn is_repeated(layout: &Layout, name: &str) -> bool {
    layout.names.iter().filter(|known| *known == name).count() > 1
}

/// The part of `--column` without a unit that names the column of the motor current, or the part for a
/// column that probably has it; `None` if there is no such column.
pub(crate) fn current(places: &Places, layout: &Layout) -> Option<String> {
    let read = [Column::CurrentMeasured, Column::Current].map(|column| places.get(column));
    if let Some(at) = read.into_iter().flatten().next() {
        return Some(format!("{}={}", at.column.name(), theirs(layout, at.place)));
    }
    let words = ["current", "iq", "i_q", "amp", "torque", "effort"];
    let part = guess(layout, Column::Current, &words, "")?.text;
    (!part.starts_with("current=:")).then_some(part)
}

/// The place of the column that probably is `column`, whose name has one of the `words`.
fn probable(layout: &Layout, column: Column, words: &[&str]) -> Option<usize> {
    let (ours, quantity) = (column.name(), column.quantity());
    let names = &layout.names;
    let fits = |place: &usize| !is_unfit(column, &names[*place]);
    let is_like = |place: &usize| has(&names[*place], words) && fits(place);
    let is_joint =
        |place: &usize| column == Column::CountsLarge && fits(place) && is_joint(&names[*place]);
    let has_unit =
        |place: &usize| fits(place) && matches!(layout.ending(quantity, *place), Ending::Unit(_));
    let more = match column {
        Column::T => languages::TIMES,
        Column::CountsLarge => languages::POSITIONS,
        _ => &[],
    };
    let is_translated = |place: &usize| {
        let name = languages::plain(&names[*place]);
        fits(place) && more.iter().any(|word| name.contains(word))
    };
    // A coordinate of a point, or what rests, is a position if there is no other one.
    let is_doubtful = |place: &usize| {
        column == Column::CountsLarge
            && (is_coordinate(&names[*place]) || layout.is_at_rest(*place))
    };
    let all = || 0..names.len();
    let moments = || {
        let moments = layout.moments.iter().copied();
        moments.filter(|_| column == Column::T)
    };
    all()
        .find(|place| names[*place] == ours)
        .or_else(|| all().find(|place| names[*place].to_lowercase() == ours))
        .or_else(|| moments().find(is_like))
        .or_else(|| moments().next())
        .or_else(|| {
            let mut own =
                all().filter(|place| is_like(place) && !is_foreign(layout, quantity, *place));
            let first = own.clone().find(|place| !is_doubtful(place));
            first.or_else(|| own.next())
        })
        .or_else(|| all().find(is_like))
        .or_else(|| all().find(is_joint))
        .or_else(|| all().find(has_unit))
        .or_else(|| all().find(is_translated))
        .or_else(|| beside_time(layout, column).filter(fits))
}

/// The column beside that of the time, if there is no third one.
fn beside_time(layout: &Layout, column: Column) -> Option<usize> {
    let is_position = column == Column::CountsLarge && layout.names.len() == 2;
    let time = is_position.then(|| probable(layout, Column::T, &times()))??;
    Some(1 - time)
}

/// The part of `--column` for `column`, whose name probably has one of the `words`; `None` if the
/// column has its own name.
fn guess(layout: &Layout, column: Column, words: &[&str], unknown: &str) -> Option<Guess> {
    let (ours, quantity) = (column.name(), column.quantity());
    let Some(place) = probable(layout, column, words) else {
        return Some(Guess {
            text: format!("{ours}={unknown}:{}", example(quantity)),
            guessed: None,
            foreign: None,
        });
    };
    let name = &layout.names[place];
    if name == ours && !is_repeated(layout, name) {
        return None;
    }
    let is_moment = column == Column::T && layout.moments.contains(&place);
    let since_1970 = || {
        let mut known = layout.since_1970.iter();
        let known = known.find(|(at, _)| quantity == Quantity::Time && *at == place);
        known.map(|(_, unit)| *unit)
    };
    let known = || known_unit(layout, quantity, place).or_else(since_1970);
    let (unit, guessed, foreign) = match layout.ending(quantity, place) {
        Ending::Unit(_) => (None, None, None),
        // A date has no unit, and the one that its name states is not read.
        Ending::Unknown(_) if is_moment => (Some(example(quantity)), None, None),
        Ending::Nothing if is_moment => (None, None, None),
        Ending::Unknown(end) => match in_language(layout, quantity, place) {
            Some(unit) => (Some(unit), Some(unit), None),
            None if column == Column::Current => (None, None, None),
            // Only its owner can say what the numbers are.
            None => (Some("UNIT"), None, Some(foreign(column, end))),
        },
        Ending::Nothing => match known() {
            Some(unit) => (Some(unit), None, None),
            None => {
                let unit = guessed_unit(layout, quantity, place);
                (Some(unit), Some(unit), None)
            }
        },
    };
    let unit = unit.map_or_else(String::new, |unit| format!(":{unit}"));
    let theirs = match is_repeated(layout, name) && !is_beside(layout, column, place) {
        true => (place + 1).to_string(),
        false => theirs(layout, place),
    };
    Some(Guess {
        text: format!("{ours}={theirs}{unit}"),
        guessed,
        foreign,
    })
}

/// What is said of the end of a name, a unit that is none of `column`.
fn foreign(column: Column, end: &str) -> String {
    format!(
        "'{}' is no unit of {} ({})",
        short(end),
        column.name(),
        column.quantity().list()
    )
}

/// Whether the time at `place`, whose name several columns have, is read by its name: one that is before the position.
fn is_beside(layout: &Layout, column: Column, place: usize) -> bool {
    let position = || probable(layout, Column::CountsLarge, &positions());
    let is_named = |at: &usize| layout.names[*at] != Column::CountsLarge.name();
    column == Column::T && position().filter(is_named).is_some_and(|at| at > place)
}

/// A unit for the column at `place`, of which no name and no number tells it.
pub(crate) fn guessed_unit(layout: &Layout, quantity: Quantity, place: usize) -> &'static str {
    let by_numbers = || match quantity {
        Quantity::Time => time_unit(layout.seen.get(place)?.step?),
        Quantity::Position => angle_unit(layout, place),
        _ => None,
    };
    in_language(layout, quantity, place)
        .or_else(by_numbers)
        .unwrap_or(example(quantity))
}

/// The largest unit in which times `step` apart are those of a recording.
fn time_unit(step: f64) -> Option<&'static str> {
    let mut units = Quantity::Time.units().iter();
    let fits = |unit: &&Unit| {
        let per_s = unit.per_s();
        per_s >= 1.0 && (SLOWEST_HZ..=FASTEST_HZ).contains(&(per_s / step))
    };
    units.find(fits).map(Unit::name)
}

/// The unit of an angle by its numbers: fractions, and whole numbers up to a turn with the name of an angle. `None` for
/// a count.
fn angle_unit(layout: &Layout, place: usize) -> Option<&'static str> {
    let name = &layout.names[place];
    let is_fractional = layout.is_fractional(place);
    let largest = layout.seen.get(place).map_or(0.0, |seen| seen.largest);
    match is_fractional {
        true if has(name, &["turn", "odrive"]) => Some("rev"),
        true if largest > RADIANS => Some("deg"),
        true => Some("rad"),
        false => {
            let is_within_a_turn = (RADIANS..=DEGREES).contains(&largest);
            (has(name, &["angle", "theta"]) && is_within_a_turn).then_some("deg")
        }
    }
}

/// The unit of a position that has the name of one of a known log.
fn known_unit(layout: &Layout, quantity: Quantity, place: usize) -> Option<&'static str> {
    let own = |name: &String| {
        let keys = layout.keyed.iter().flat_map(|keyed| &keyed.keys);
        let mut own = keys.filter_map(|key| name.strip_prefix(key.as_str())?.strip_prefix('.'));
        own.next().unwrap_or(name).to_owned()
    };
    let names: Vec<_> = layout.names.iter().map(own).collect();
    Format::position_unit(&names, place).filter(|_| quantity == Quantity::Position)
}

/// What an option calls the column at `place`: its name, or its number where the name is too long or
/// needs more than quotes in a shell.
pub(crate) fn theirs(layout: &Layout, place: usize) -> String {
    let name = &layout.names[place];
    let is_plain = |c: char| !c.is_control() && c != '\'' && c != '\u{fffd}';
    match name.chars().count() <= LONGEST && name.chars().all(is_plain) {
        true => name.clone(),
        false => (place + 1).to_string(),
    }
}

/// A unit for an example.
pub(crate) const fn example(quantity: Quantity) -> &'static str {
    quantity.units()[0].name()
}
