//! Columns of which one is meant.

use device_files::to_digits;

use super::super::endings::Ending;
use super::super::header::short;
use super::super::{Layout, Places, has, is_joint};
use super::LISTED;
use super::guess::{is_foreign, is_repeated, is_unfit, positions, times};
use crate::recording::options::Column;
use crate::recording::options::units::Quantity;

/// The times of which one is meant, by their names, with their rates; `None` for less than two.
pub(super) fn of_times(layout: &Layout, places: &Places) -> Option<String> {
    let words = times();
    let seen = |place: usize| layout.seen.get(place);
    let is_like = |place: &usize| {
        let name = &layout.names[*place];
        has(name, &words)
            && !is_unfit(Column::T, name)
            // Each signal may have its own time.
            && !is_repeated(layout, name)
            && seen(*place).is_some_and(|seen| seen.step.is_some())
    };
    let like: Vec<_> = (0..layout.names.len()).filter(is_like).collect();
    let is_part = |part: &usize| like.iter().any(|whole| layout.is_part_of(*part, *whole));
    let all: Vec<_> = like.iter().filter(|place| !is_part(place)).collect();
    let called = |place: &&usize| {
        let name = short(&layout.names[**place]);
        let unit = match layout.ending(Quantity::Time, **place) {
            Ending::Unit(unit) => unit,
            _ => return name,
        };
        let step = seen(**place).and_then(|seen| seen.step);
        step.map_or(name.clone(), |step| {
            format!(
                "{name} ({} rows a second)",
                to_digits(unit.per_s() / step, 3)
            )
        })
    };
    let is_open = places.get(Column::T).is_none() && !layout.has_rate;
    (is_open && all.len() > 1).then(|| {
        let listed: Vec<_> = all.iter().take(LISTED).map(called).collect();
        format!("{} times fit: {}", all.len(), listed.join("; "))
    })
}

/// The positions of which one is meant, by their names: how many, and the first of them; `None` for less than two.
pub(super) fn of_positions(layout: &Layout, places: &Places) -> Option<String> {
    let words = positions();
    let is_like = |place: &usize| {
        let name = &layout.names[*place];
        (has(name, &words) || is_joint(name))
            && !is_unfit(Column::CountsLarge, name)
            && !is_foreign(layout, Quantity::Position, *place)
    };
    let all: Vec<_> = (0..layout.names.len()).filter(is_like).collect();
    if all.len() < 2 || places.get(Column::CountsLarge).is_some() {
        return None;
    }
    let called = |place: &usize| {
        let name = &layout.names[*place];
        match is_repeated(layout, name) {
            true => format!("{} in column {}", short(name), place + 1),
            false => short(name),
        }
    };
    let mut listed: Vec<_> = all.iter().take(LISTED).map(called).collect();
    if all.len() > LISTED {
        listed.push("...".to_owned());
    }
    Some(format!(
        "{} positions fit: {}",
        all.len(),
        listed.join("; ")
    ))
}
