//! Units at the end of a column's name: `time_ms`, `angle [deg]`, `Time (us)`, `theta/deg`.

use crate::recording::options::units::{Quantity, Unit, is_separator, quotient};

/// Units that no quantity of a recording has, for the endings that are no part of a name.
const FOREIGN: [&str; 32] = [
    "hz", "mhz", "ghz", "inch", "ft", "mv", "uv", "kv", "gon", "grad", "grads", "gradian",
    "gradians", "arcmin", "arcsec", "mnm", "ncm", "ozin", "kgcm", "minutes", "minute", "mins",
    "hour", "hours", "hr", "hrs", "day", "days", "lsb", "percent", "pct", "mdps",
];

/// Prefixes of [`BASES`].
const PREFIXES: [&str; 15] = [
    "p", "n", "u", "\u{b5}", "\u{3bc}", "m", "c", "d", "k", "nano", "micro", "milli", "centi",
    "deci", "kilo",
];

/// Units that a prefix makes to another one.
const BASES: [&str; 27] = [
    "rad",
    "radian",
    "radians",
    "deg",
    "degree",
    "degrees",
    "\u{b0}",
    "rev",
    "revs",
    "revolutions",
    "turn",
    "turns",
    "s",
    "sec",
    "second",
    "seconds",
    "a",
    "amp",
    "amps",
    "ampere",
    "amperes",
    "m",
    "meter",
    "meters",
    "hz",
    "counts",
    "nm",
];

/// The end of a time in minutes. In another column it is a minimum.
const MINUTES: &str = "min";

/// What the end of a column's name says about its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ending<'a> {
    Nothing,
    Unit(&'static Unit),
    /// It looks like a unit, and is none of the quantity.
    Unknown(&'a str),
}

impl Ending<'_> {
    /// What the name `column` says about the unit of `quantity`.
    pub(crate) fn of(quantity: Quantity, column: &str) -> Ending<'_> {
        let column = column.trim();
        let Some((before, inside)) = bracketed(column) else {
            return plain(quantity, column);
        };
        let is_index = inside.chars().all(|c| c.is_ascii_digit());
        match (quantity.unit(inside), plain(quantity, before)) {
            (Some(unit), _) => Ending::Unit(unit),
            (None, Ending::Nothing) if !is_index => Ending::Unknown(inside),
            (None, before) => before,
        }
    }
}

/// The text before the brackets at the end of `column`, and the text in them.
pub(crate) fn bracketed(column: &str) -> Option<(&str, &str)> {
    let (text, open) = match column.strip_suffix(']') {
        Some(text) => (text, '['),
        None => (column.strip_suffix(')')?, '('),
    };
    let (before, inside) = text.rsplit_once(open)?;
    Some((before.trim_end(), inside.trim()))
}

/// The longest end of a name without brackets that is a unit.
fn plain(quantity: Quantity, column: &str) -> Ending<'_> {
    let after = column
        .match_indices(is_separator)
        .map(|(at, separator)| &column[at + separator.len()..]);
    let ends: Vec<_> = std::iter::once(column).chain(after).collect();
    if let Some(unit) = ends.iter().find_map(|end| quantity.unit(end)) {
        return Ending::Unit(unit);
    }
    let is_time = matches!(quantity, Quantity::Time | Quantity::Edge);
    let is_minutes = |end: &str| is_time && end.to_lowercase() == MINUTES;
    let mut ends = ends.into_iter();
    match ends.find(|end| is_other_unit(end) || is_minutes(end)) {
        Some(end) => Ending::Unknown(end),
        None => Ending::Nothing,
    }
}

/// Units of one letter or sign, which end no name.
const SINGLE: [&str; 10] = ["v", "w", "n", "k", "c", "m", "g", "%", "-", "h"];

/// Whether a whole field is a unit of any quantity.
pub(super) fn is_any_unit(field: &str) -> bool {
    let lower = field.to_lowercase();
    Quantity::of_unit(field).is_some() || is_other_unit(field) || SINGLE.contains(&lower.as_str())
}

/// Whether `end` is a unit of some quantity. A single letter is also a name: motor A, axis s.
fn is_other_unit(end: &str) -> bool {
    let is_unit = |end: &str| {
        end.chars().count() > 1
            && (Quantity::of_unit(end).is_some() || FOREIGN.contains(&end) || is_prefixed(end))
    };
    let end = end.to_lowercase();
    // A quotient: of a unit and a time.
    let quotient = quotient(&end);
    let above = quotient.split_once('/').map(|(above, _)| above);
    is_unit(&end) || above.is_some_and(is_unit)
}

fn is_prefixed(end: &str) -> bool {
    let bases = PREFIXES
        .iter()
        .filter_map(|prefix| end.strip_prefix(prefix));
    bases.into_iter().any(|base| BASES.contains(&base))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_is_the_end_of_a_name() {
        for (quantity, column, unit) in [
            (Quantity::Time, "time_ms", "ms"),
            (Quantity::Time, "Time (us)", "us"),
            (Quantity::Time, "time [µs]", "us"),
            (Quantity::Time, "time/ms", "ms"),
            (Quantity::Time, "ms", "ms"),
            (Quantity::Position, "joint angle [deg]", "deg"),
            (Quantity::Position, "pos_turns", "rev"),
            (Quantity::Position, "theta/deg", "deg"),
            (Quantity::Position, "angle_mrad", "mrad"),
            (Quantity::Position, "angle_mdeg", "mdeg"),
            (Quantity::Position, "Winkel [°]", "deg"),
            (Quantity::Position, "pos_deg (filtered)", "deg"),
            (Quantity::Position, "pos_deg[0]", "deg"),
            (Quantity::Current, "i_mA", "mA"),
            (Quantity::Current, "torque_Nm", "N.m"),
            (Quantity::Current, "torque [N.m]", "N.m"),
            (Quantity::Velocity, "omega_deg_s", "deg/s"),
            (Quantity::Velocity, "gyro_dps", "deg/s"),
            (Quantity::Velocity, "speed/rpm", "rpm"),
            (Quantity::Velocity, "n [1/min]", "rpm"),
            (Quantity::Velocity, "omega [rad s^-1]", "rad/s"),
            (Quantity::Velocity, "omega / (rad/s)", "rad/s"),
            (Quantity::Edge, "edge_us", "us"),
        ] {
            match Ending::of(quantity, column) {
                Ending::Unit(found) => assert_eq!(found.name(), unit, "{column}"),
                other => panic!("{column}: {other:?}"),
            }
        }
    }

    #[test]
    fn end_that_is_another_unit_is_unknown() {
        for (quantity, column, end) in [
            (Quantity::Position, "angle [grad]", "grad"),
            (Quantity::Position, "pos_mm", "mm"),
            (Quantity::Position, "angle_ms", "ms"),
            (Quantity::Time, "t (h)", "h"),
            (Quantity::Velocity, "omega [mrad/s]", "mrad/s"),
            (Quantity::Velocity, "vel_deg", "deg"),
            (Quantity::Position, "pos_urad", "urad"),
            (Quantity::Position, "pos_cdeg", "cdeg"),
            (Quantity::Position, "pos_ddeg", "ddeg"),
            (Quantity::Position, "pos_mrev", "mrev"),
            (Quantity::Position, "urad", "urad"),
            (Quantity::Position, "pos_um", "um"),
            (Quantity::Position, "pos_deg_s", "deg_s"),
            (Quantity::Time, "time_cs", "cs"),
            (Quantity::Time, "time_ps", "ps"),
            (Quantity::Time, "minutes", "minutes"),
            (Quantity::Time, "t_min", "min"),
            (Quantity::Time, "min", "min"),
            (Quantity::Time, "t [min]", "min"),
            (Quantity::Time, "t (min)", "min"),
            (Quantity::Time, "ticks", "ticks"),
            (Quantity::Edge, "edge_min", "min"),
            (Quantity::Current, "iq_cA", "cA"),
            (Quantity::Current, "iq_nA", "nA"),
            (Quantity::Velocity, "omega_mrad_s", "mrad_s"),
            (Quantity::Velocity, "omega_counts_per_s", "counts_per_s"),
        ] {
            assert_eq!(Ending::of(quantity, column), Ending::Unknown(end));
        }
        for (quantity, column) in [
            (Quantity::Position, "motor_A"),
            (Quantity::Position, "pos[0]"),
            (Quantity::Position, "/a/position"),
            (Quantity::Time, "time"),
            (Quantity::Position, "pos_min"),
            (Quantity::Position, "A"),
            (Quantity::Position, "motor_s"),
            (Quantity::Position, "pos_raw"),
            (Quantity::Position, "pos_m_s"),
            (Quantity::Current, "i_d"),
            (Quantity::Current, "current_rms"),
        ] {
            assert_eq!(Ending::of(quantity, column), Ending::Nothing, "{column}");
        }
    }
}
