//! Columns with the numbers of motors: each row is of one of them.

use std::collections::BTreeSet;

/// Endings of the names of columns with a number that identifies something.
const IDENTIFIES: [&str; 6] = ["id", "nr", "no", "num", "number", "index"];

/// What has such a number, alone as a name or before one of these endings.
const MOTORS: [&str; 9] = [
    "motor", "axis", "joint", "servo", "node", "drive", "actuator", "wheel", "slave",
];

/// Parts of a line that may have such a name.
pub(super) const WORDS: [&str; 5] = ["id", "servo", "drive", "actuator", "slave"];

/// What has a number before one of these endings alone.
const DEVICES: [&str; 4] = ["can", "device", "module", "dev"];

/// Most motors of one table.
const MOST: usize = 32;

/// Least part of the rows that are of another motor than the row before. In other columns, as that of a state, the
/// number stays.
const CHANGES: f64 = 0.5;

/// Fewest rows that tell.
const FEWEST: usize = 8;

/// Whether a column with this name, in lower case, may have the numbers of motors.
pub(super) fn is_called_so(name: &str) -> bool {
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).collect();
    let stem = IDENTIFIES.iter().find_map(|end| plain.strip_suffix(end));
    MOTORS.contains(&plain.as_str())
        || plain == "id"
        || stem.is_some_and(|stem| MOTORS.contains(&stem) || DEVICES.contains(&stem))
}

/// Whether a field is a number of a motor: a whole one, also as 1.0 or 0x141.
pub(super) fn is_id(field: &str) -> bool {
    let hex = field.strip_prefix("0x").or(field.strip_prefix("0X"));
    let is_whole =
        |number: f64| number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    match hex {
        Some(digits) => u32::from_str_radix(digits, 16).is_ok(),
        None => field.parse().is_ok_and(is_whole),
    }
}

/// Whether `keys` of the first rows are those of several motors that alternate.
pub(super) fn alternate(keys: &[String]) -> bool {
    let changes = keys.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let motors = keys.iter().collect::<BTreeSet<_>>().len();
    keys.len() >= FEWEST
        && (2..=MOST).contains(&motors)
        // Each occurs several times: a number of the row is none of a motor.
        && 2 * motors <= keys.len()
        && changes as f64 >= CHANGES * (keys.len() - 1) as f64
}
