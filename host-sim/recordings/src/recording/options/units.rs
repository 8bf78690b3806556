//! Units of a recording's columns, and their conversion.

use std::f64::consts::TAU;

use simulation::trace::EDGE_CLOCK_HZ;

/// Number of values of a counter of 32 bits.
pub(crate) const WRAP: f64 = 4_294_967_296.0;

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Time,
    Position,
    Current,
    /// Time of an edge.
    Edge,
    /// Number of a boundary between counts.
    Boundary,
    Velocity,
}

/// Conversion of a number to the unit that [`crate::recording::Recording`] has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scale {
    /// Divided by this number. A division by a power of ten rounds once.
    Over(f64),
    /// Multiplied by this number.
    Times(f64),
    /// Whole counts.
    Counts,
    /// Position with this many units a revolution.
    PerRev(f64),
    /// Torque, N.m: divided by the torque constant.
    Torque,
}

impl Scale {
    /// `number` in the unit of the recording; `torque_constant` converts torques. Positions are read as
    /// counts, and stay.
    pub(crate) fn of(self, number: f64, torque_constant: f64) -> f64 {
        match self {
            Self::Over(by) => number / by,
            Self::Times(by) => number * by,
            Self::Torque => number / torque_constant,
            Self::Counts | Self::PerRev(_) => number,
        }
    }
}

/// A unit: its names, the first of which is shown, and its scale.
#[derive(Debug, PartialEq)]
pub(crate) struct Unit {
    names: &'static [&'static str],
    pub(crate) scale: Scale,
}

impl Unit {
    pub(crate) const fn name(&self) -> &'static str {
        self.names[0]
    }

    /// The text before this unit at the end of `column`: nothing, or a text with a separator at its end.
    pub(crate) fn before<'a>(&self, column: &'a str) -> Option<&'a str> {
        let mut before = self.names.iter().filter_map(|name| {
            let at = column.len().checked_sub(name.len())?;
            let (before, end) = column.split_at_checked(at)?;
            end.eq_ignore_ascii_case(name).then_some(before)
        });
        before.find(|before| before.is_empty() || before.ends_with(is_separator))
    }

    /// Number of units of time in a second; 1 for another quantity.
    pub(crate) const fn per_s(&self) -> f64 {
        match self.scale {
            Scale::Over(by) => by,
            _ => 1.0,
        }
    }
}

/// Whether a character separates the parts of a name.
pub(crate) fn is_separator(c: char) -> bool {
    matches!(c, '_' | ' ' | '.' | '/' | '-')
}

const fn unit(names: &'static [&'static str], scale: Scale) -> Unit {
    Unit { names, scale }
}

const SECONDS: &[&str] = &["s", "sec", "secs", "second", "seconds"];
const MILLISECONDS: &[&str] = &[
    "ms",
    "msec",
    "msecs",
    "millis",
    "millisec",
    "millisecond",
    "milliseconds",
];
const MICROSECONDS: &[&str] = &[
    "us",
    "usec",
    "usecs",
    "micros",
    "microsec",
    "microsecond",
    "microseconds",
    "µs",
    "μs",
];
const NANOSECONDS: &[&str] = &[
    "ns",
    "nsec",
    "nsecs",
    "nanos",
    "nanosec",
    "nanosecond",
    "nanoseconds",
];

const TIME: &[Unit] = &[
    unit(SECONDS, Scale::Over(1.0)),
    unit(MILLISECONDS, Scale::Over(1e3)),
    unit(MICROSECONDS, Scale::Over(1e6)),
    unit(NANOSECONDS, Scale::Over(1e9)),
];

/// The unit of the times of Windows, which count from 1601 on.
pub(crate) const FILETIME: Unit = unit(&["100ns"], Scale::Over(1e7));

const POSITION: &[Unit] = &[
    unit(
        &[
            "counts",
            "count",
            "cts",
            "ticks",
            "pulses",
            "steps",
            "increments",
            "qc",
        ],
        Scale::Counts,
    ),
    unit(&["deg", "degree", "degrees", "°"], Scale::PerRev(360.0)),
    unit(&["rad", "radian", "radians"], Scale::PerRev(TAU)),
    unit(
        &["rev", "revs", "revolutions", "turn", "turns"],
        Scale::PerRev(1.0),
    ),
    unit(&["mdeg", "millidegrees"], Scale::PerRev(360e3)),
    unit(&["mrad", "milliradians"], Scale::PerRev(1e3 * TAU)),
    unit(&["arcmin", "arcminutes"], Scale::PerRev(360.0 * 60.0)),
    unit(&["arcsec", "arcseconds"], Scale::PerRev(360.0 * 3600.0)),
];

const CURRENT: &[Unit] = &[
    unit(&["A", "amp", "amps", "ampere"], Scale::Over(1.0)),
    unit(&["mA", "milliamps"], Scale::Over(1e3)),
    unit(&["N.m", "Nm", "N*m", "N·m"], Scale::Torque),
];

const EDGE: &[Unit] = &[
    unit(&["ticks"], Scale::Over(1.0)),
    unit(SECONDS, Scale::Times(EDGE_CLOCK_HZ)),
    unit(MILLISECONDS, Scale::Times(EDGE_CLOCK_HZ / 1e3)),
    unit(MICROSECONDS, Scale::Times(EDGE_CLOCK_HZ / 1e6)),
    unit(NANOSECONDS, Scale::Times(EDGE_CLOCK_HZ / 1e9)),
];

const BOUNDARY: &[Unit] = &[unit(&["counts", "count"], Scale::Counts)];

const VELOCITY: &[Unit] = &[
    unit(&["rad/s", "rads", "radps"], Scale::Over(1.0)),
    unit(&["deg/s", "dps", "degps", "°/s"], Scale::Times(TAU / 360.0)),
    unit(&["rev/s", "rps"], Scale::Times(TAU)),
    unit(
        &["rpm", "rev/min", "1/min", "r/min", "U/min"],
        Scale::Times(TAU / 60.0),
    ),
];

impl Quantity {
    pub(crate) const ALL: [Self; 6] = [
        Self::Time,
        Self::Position,
        Self::Current,
        Self::Edge,
        Self::Boundary,
        Self::Velocity,
    ];

    /// The units of this quantity; the first is that of the columns of a recording.
    pub(crate) const fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => TIME,
            Self::Position => POSITION,
            Self::Current => CURRENT,
            Self::Edge => EDGE,
            Self::Boundary => BOUNDARY,
            Self::Velocity => VELOCITY,
        }
    }

    /// Units that messages do not propose.
    const fn rare(self) -> &'static [Unit] {
        match self {
            Self::Time => &[FILETIME],
            _ => &[],
        }
    }

    /// The unit called `name`, in upper or lower case; `rad_s`, `rad per s` and `rad s^-1` are `rad/s`.
    pub(crate) fn unit(self, name: &str) -> Option<&'static Unit> {
        let name = quotient(&name.trim().to_lowercase());
        let called = |unit: &&Unit| unit.names.iter().any(|known| known.to_lowercase() == name);
        self.units().iter().chain(self.rare()).find(called)
    }

    /// The quantity that `name` is a unit of: the first one of several.
    pub(crate) fn of_unit(name: &str) -> Option<Self> {
        let known = |quantity: &Self| quantity.unit(name).is_some();
        Self::ALL.into_iter().find(known)
    }

    /// Names of the units, for messages.
    pub(crate) fn list(self) -> String {
        let names: Vec<_> = self.units().iter().map(Unit::name).collect();
        names.join(", ")
    }
}

/// The name of a quotient of units with one `/`, and `s` and `min` below it.
pub(crate) fn quotient(name: &str) -> String {
    for (over, unit) in [("sec", "s"), ("s", "s"), ("min", "min")] {
        for sign in ["^-1", "-1", "⁻¹", "**-1"] {
            let Some(above) = name.strip_suffix(&format!("{over}{sign}")) else {
                continue;
            };
            let above = above.trim_end_matches([' ', '*', '·', '.', '_']);
            let above = if above.is_empty() { "1" } else { above };
            return format!("{above}/{unit}");
        }
        for sign in ["_per_", " per ", "_", "/", " / "] {
            if let Some(above) = name.strip_suffix(&format!("{sign}{over}")) {
                return format!("{above}/{unit}");
            }
        }
    }
    name.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{ReadOptions, Recording};

    #[test]
    fn units_are_found_by_name() {
        let shown = |unit: Option<&Unit>| unit.map(Unit::name);
        assert_eq!(shown(Quantity::Time.unit("MS")), Some("ms"));
        assert_eq!(shown(Quantity::Time.unit("millisec")), Some("ms"));
        assert_eq!(shown(Quantity::Position.unit("Steps")), Some("counts"));
        assert_eq!(shown(Quantity::Current.unit("N.m")), Some("N.m"));
        assert_eq!(shown(Quantity::Time.unit("deg")), None);
        for (name, unit) in [
            ("rad_s", "rad/s"),
            ("deg_per_sec", "deg/s"),
            ("rad s^-1", "rad/s"),
            ("rad·s⁻¹", "rad/s"),
            ("min^-1", "rpm"),
            ("1/min", "rpm"),
            ("dps", "deg/s"),
            ("rev / s", "rev/s"),
        ] {
            assert_eq!(shown(Quantity::Velocity.unit(name)), Some(unit), "{name}");
        }
    }

    #[test]
    fn no_unit_of_a_quantity_has_the_name_of_another() {
        for quantity in Quantity::ALL {
            for unit in quantity.units() {
                for name in unit.names {
                    assert_eq!(quantity.unit(name), Some(unit), "{name}");
                }
            }
        }
    }

    /// A quarter of a turn, half an ampere, and half a turn a second.
    #[test]
    fn numbers_are_converted_from_every_unit() {
        let half_ampere = ReadOptions::default()
            .torque_constant
            .map(|constant| 0.5 * constant);
        for (column, unit, number, value) in [
            ("counts_large", "counts", 1024.0, 1024.0),
            ("counts_large", "deg", 90.0, 1024.0),
            ("counts_large", "rad", TAU / 4.0, 1024.0),
            ("counts_large", "rev", 0.25, 1024.0),
            ("counts_large", "mdeg", 90e3, 1024.0),
            ("counts_large", "mrad", 1e3 * TAU / 4.0, 1024.0),
            ("counts_large", "arcmin", 5400.0, 1024.0),
            ("counts_large", "arcsec", 324e3, 1024.0),
            ("current", "A", 0.5, 0.5),
            ("current", "mA", 500.0, 0.5),
            ("current", "N.m", half_ampere[0], 0.5),
            ("current_small", "mA", 500.0, 0.5),
            ("current_small", "N.m", half_ampere[1], 0.5),
            ("true_omega", "rad/s", TAU / 2.0, TAU / 2.0),
            ("true_omega", "deg/s", 180.0, TAU / 2.0),
            ("true_omega", "rev/s", 0.5, TAU / 2.0),
            ("true_omega", "rpm", 30.0, TAU / 2.0),
        ] {
            let counts = if column == "counts_large" {
                "other"
            } else {
                "counts_large"
            };
            let text = format!("t,{counts},x\n0,0,0\n0.001,1,{number}\n");
            let mut options = ReadOptions::default();
            options.add_columns(&format!("{column}=x:{unit}")).unwrap();
            let recording = Recording::parse_as(text.as_bytes(), "r.csv", &options).unwrap();
            let trace = recording.trace;
            let found = match column {
                "counts_large" => f64::from(trace.counts_large[1]),
                "current" => trace.current.unwrap()[1],
                "current_small" => recording.current_small.unwrap()[1],
                _ => trace.true_omega.unwrap()[1],
            };
            assert!((found - value).abs() < 1e-12, "{column} {unit}: {found}");
        }
    }
}
