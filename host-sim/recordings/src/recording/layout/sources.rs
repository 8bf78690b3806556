//! The note on the columns and units that a recording was read from.

use super::header::short;
use super::{Layout, Place, Places};
use crate::recording::options::units::Scale;
use crate::recording::options::{Column, ReadOptions};

/// The columns and units that the recording is read from; `None` if all are its own by name.
pub(crate) fn sources(options: &ReadOptions, places: &Places, layout: &Layout) -> Option<String> {
    let is_own = places.format.is_none_or(|format| format.own);
    let uses_device = |place: &Place| matches!(place.unit.scale, Scale::PerRev(_) | Scale::Torque);
    let is_own = is_own && options.columns.is_empty() && !places.by_names;
    if is_own && !places.all().iter().any(uses_device) {
        return None;
    }
    let [counts_large, counts_small] = options.counts_per_rev;
    let [kt_large, kt_small] = options.torque_constant;
    let small = |column| {
        matches!(
            column,
            Column::CountsSmall | Column::CurrentSmall | Column::CurrentSmallMeasured
        )
    };
    let part = |place: &Place| {
        let counts = if small(place.column) {
            counts_small
        } else {
            counts_large
        };
        let kt = if small(place.column) {
            kt_small
        } else {
            kt_large
        };
        let with = match place.unit.scale {
            Scale::PerRev(_) => format!(" with {counts} counts/rev"),
            Scale::Torque => format!(" with {kt} N.m/A"),
            _ => String::new(),
        };
        let (name, unit) = (place.column.name(), place.unit.name());
        let theirs = |place: usize| match layout.has_header() {
            true => {
                let name = &layout.names[place];
                let is_one = layout.names.iter().filter(|other| *other == name).count() == 1;
                let number = match is_one {
                    true => String::new(),
                    false => format!(", column {}", place + 1),
                };
                format!("'{}'{number}", name.escape_debug())
            }
            false => format!("column {}", place + 1),
        };
        let part = place.part.map_or_else(String::new, |part| {
            format!(" and {} ({})", theirs(part.place), part.unit.name())
        });
        format!("{name} from {} ({unit}{with}){part}", theirs(place.place))
    };
    let parts: Vec<_> = places.all().iter().map(part).collect();
    let foreign = places.format.filter(|format| !format.own);
    let log = match foreign {
        Some(format) => format!("read as a log of {}: ", format.name),
        None if places.by_names => "read by the names of its columns: ".to_owned(),
        None => String::new(),
    };
    let others = match places.by_names {
        true => "; others are named with --column",
        false => "",
    };
    let first = match layout.has_header() {
        true => String::new(),
        false => format!(
            "; without a header, line {} is the first row: '{}'",
            layout.skip + 1,
            short(&layout.first_row)
        ),
    };
    Some(format!("{log}{}{first}{others}", parts.join(", ")))
}
