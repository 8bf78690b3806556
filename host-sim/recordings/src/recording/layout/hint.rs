//! Options that would read a log without a needed column.

mod choice;
mod guess;
mod languages;
mod numbered;

use device_files::to_digits;

use super::endings::Ending;
use super::formats::Ambiguous;
use super::header::short;
use super::search::is_number;
use super::{Keyed, Layout, Places, has, is_duration, is_joint};
use crate::recording::options::Column;
use crate::recording::records::labelled::is_labelled;
use crate::recording::text::separator::Separator;
pub(crate) use guess::{current, guessed_unit, theirs};
use guess::{is_unfit, parts, positions, times};
use numbered::has_no_time;

/// Positions that a message lists.
const LISTED: usize = 4;

/// Columns without names beyond which each line is taken for a signal.
const WIDE: usize = 100;

/// The option `--column`, with names and units.
pub(crate) fn option(layout: &Layout, places: &Places) -> String {
    if layout.names.is_empty() {
        return "the file has no rows; write t,counts_large in its first line, and a row below for each sample".to_owned();
    }
    if layout.names.iter().all(String::is_empty) && layout.searched.is_some() {
        return "remove lines above the header".to_owned();
    }
    if layout.names.iter().all(String::is_empty) {
        return "the file has no names of columns; write t,counts_large in its first line"
            .to_owned();
    }
    if !layout.has_header() {
        let names = match layout.misfit {
            Some(_) => "write one name for each column, or ",
            None => "",
        };
        let wanted = if layout.has_rate {
            "give the number of the column"
        } else if layout.names.len() == 1 {
            "give the number of the column and the rate of the rows"
        } else if has_no_time(layout) {
            "no column rises in all of the first rows, as a time does; give the number of the position and the rate of the \
             rows"
        } else {
            "give the numbers of the columns"
        };
        return format!("{names}{wanted}, for example {}", numbered::option(layout));
    }
    let choices = [
        choice::of_times(layout, places),
        choice::of_positions(layout, places),
    ];
    let choices: Vec<_> = choices.into_iter().flatten().collect();
    let name = match choices[..] {
        [] => "name the columns and units".to_owned(),
        _ => format!("{}; name one", choices.join(", and ")),
    };
    format!(
        "{name}, for example --column {}{}",
        parts(layout),
        only_indirect(layout).unwrap_or_default()
    )
}

/// The name of a position that is not measured at the shaft, where there is no other one.
fn only_indirect(layout: &Layout) -> Option<String> {
    let mut like = layout.names.iter().filter(|name| has(name, &positions()));
    let first = like
        .clone()
        .find(|name| is_unfit(Column::CountsLarge, name))?;
    let is_only = like.all(|name| is_unfit(Column::CountsLarge, name));
    (is_only && !layout.names.iter().any(|name| is_joint(name))).then(|| {
        format!(
            ": by its name '{}' is a rate, a target, an error, a difference or an electrical angle",
            short(first)
        )
    })
}

/// What a log needs whose header has no column of time, by its names.
pub(crate) fn without_time(layout: &Layout) -> &'static str {
    let is_time = |(place, name): (usize, &String)| {
        let could_be = has(name, &times())
            || name.to_lowercase() == "t"
            || matches!(layout.ending(Column::T.quantity(), place), Ending::Unit(_));
        (could_be && !is_duration(name)) || layout.moments.contains(&place)
    };
    let can_do_without = layout.has_header() && !layout.has_rate && !layout.names.is_empty();
    match can_do_without && !layout.names.iter().enumerate().any(is_time) {
        true => ", or give the rate of the rows with --row-rate HZ in the place of a time",
        false => "",
    }
}

/// A reason for a missing column that is better than its name.
pub(crate) fn reason(layout: &Layout, places: &Places) -> Option<String> {
    let ambiguous = ambiguous(layout, places);
    keyed(layout)
        .or_else(|| labelled(layout))
        .or_else(|| frames(layout))
        .or(ambiguous)
        .or_else(|| on_its_side(layout))
        .or_else(|| captured(layout))
        .or_else(|| levels(layout))
        .or_else(|| barred(layout))
        .or_else(|| untimed(layout))
}

/// Rows of several motors.
fn keyed(layout: &Layout) -> Option<String> {
    let Keyed { columns, keys } = layout.keyed.as_ref()?;
    let mut listed: Vec<_> = keys.iter().take(LISTED).map(|key| short(key)).collect();
    if keys.len() > LISTED {
        listed.push("...".to_owned());
    }
    Some(format!(
        "each row is of one of several motors: '{}' is {}; name the columns of one motor, for example --column {}",
        short(&columns.join(".")),
        listed.join("; "),
        parts(layout)
    ))
}

/// Rows of which some fields have their names in them.
fn labelled(layout: &Layout) -> Option<String> {
    let fields = layout.separator.split(&layout.first_row);
    let numbers = fields
        .iter()
        .filter(|field| is_number(field, layout.separator));
    let field = fields.iter().find(|field| is_labelled(field));
    let field = field.filter(|_| numbers.count() < 2)?;
    Some(format!(
        "the row has '{}', a name and a number in one field, and other fields without a name; write the numbers \
         alone, separated by commas, and the names in a line above them, for example t,counts_large",
        short(field)
    ))
}

/// Lines of so many numbers that each is a signal.
fn on_its_side(layout: &Layout) -> Option<String> {
    let columns = layout.names.len();
    let of = match layout.separator {
        Separator::Comma => ", delimiter=','",
        Separator::Semicolon => ", delimiter=';'",
        // What separates without an option.
        Separator::Tab | Separator::Whitespace => "",
    };
    (!layout.has_header() && columns > WIDE).then(|| {
        format!(
            "there are no names but {columns} columns: if each line is a signal, exchange lines and columns, for example \
             with numpy.savetxt('log.csv', numpy.loadtxt(FILE{of}).T, delimiter=','); else give the numbers of \
             the columns, for example {}",
            numbered::option(layout)
        )
    })
}

/// Frames of a CAN bus as candump of can-utils prints them: `181#50FAFFFF`.
fn frames(layout: &Layout) -> Option<String> {
    let is_frame = |field: &&String| {
        let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_hexdigit());
        let frame = field.split_once('#');
        frame.is_some_and(|(id, data)| [3, 8].contains(&id.len()) && digits(id) && digits(data))
    };
    let first = layout.separator.split(&layout.first_row);
    let frame = layout.names.iter().chain(&first).find(is_frame)?;
    Some(format!(
        "the rows are frames of a CAN bus, as '{}'; decode them, for example with cantools and the DBC file of the bus, \
         and write t,counts_large in the first line",
        short(frame)
    ))
}

/// Rows without a time whose rate is stated.
fn untimed(layout: &Layout) -> Option<String> {
    let hz = to_digits(layout.row_rate_hz?, 6);
    Some(format!(
        "no column t: the rows have no time, and the header states {hz} rows a second; give this rate with \
         --row-rate {hz}"
    ))
}

/// Fields between bars.
pub(crate) fn barred(layout: &Layout) -> Option<String> {
    let is_barred = match layout.names.as_slice() {
        [line] => line.contains('|'),
        names => names.iter().any(|name| name == "|"),
    };
    is_barred
        .then(|| "'|' separates no fields; write commas, semicolons, tabs or spaces".to_owned())
}

/// Several positions in a known log.
fn ambiguous(layout: &Layout, places: &Places) -> Option<String> {
    let found =
        Ambiguous::of(&layout.names).filter(|_| places.get(Column::CountsLarge).is_none())?;
    let names = found
        .positions
        .iter()
        .map(|&place| short(&layout.names[place]));
    let mut names: Vec<_> = names.take(LISTED).collect();
    if found.positions.len() > LISTED {
        names.push("...".to_owned());
    }
    let moves = |place: &&usize| !layout.is_at_rest(**place);
    let example = found.positions.iter().find(moves);
    let example = example.or(found.positions.first()).copied()?;
    let time = match places.get(Column::T) {
        Some(_) => String::new(),
        None => format!(
            "t={}:{},",
            theirs(layout, found.time.place),
            found.time.unit
        ),
    };
    Some(format!(
        "{} positions fit a log of {}: {}; name one, for example --column '{time}counts_large={}:{}'",
        found.positions.len(),
        found.format.name,
        names.join("; "),
        theirs(layout, example),
        found.unit
    ))
}

/// Columns that a logic analyser calls by their numbers. SerialPlot calls any columns so.
fn captured(layout: &Layout) -> Option<String> {
    let has_levels = |place: usize| {
        let seen = layout.seen.get(place);
        seen.is_none_or(|seen| seen.largest <= 1.0 && !seen.is_fractional)
    };
    let is_line = |name: &str| {
        let name = name.trim().to_lowercase();
        let number = ["channel", "dio", "d"].into_iter();
        let mut number = number.filter_map(|word| name.strip_prefix(word));
        let is_number = |text: &str| text.trim().parse::<u8>().is_ok();
        name == "logic" || number.any(is_number)
    };
    let lines = (layout.names.iter().enumerate())
        .filter(|(place, name)| is_line(name) && has_levels(*place));
    (lines.count() >= 2).then(|| {
        "the columns look like lines of a logic analyser; make a recording of an encoder's lines with \
         host-sim decode"
            .to_owned()
    })
}

/// Columns that are 0 or 1 where no other one has the name of a position.
fn levels(layout: &Layout) -> Option<String> {
    let places = &layout.two_levels;
    let mut others = (layout.names.iter().enumerate()).filter(|(place, _)| !places.contains(place));
    if places.len() < 2 || others.any(|(_, name)| has(name, &positions())) {
        return None;
    }
    let names = places.iter().map(|place| short(&layout.names[*place]));
    Some(format!(
        "the columns {} are 0 or 1 in the first rows; if they are the lines of an encoder, make a recording of \
         them with host-sim decode",
        names.collect::<Vec<_>>().join(", ")
    ))
}

#[cfg(test)]
mod tests;
