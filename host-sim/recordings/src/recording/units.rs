//! Units of a recording's columns, and their conversion.

use std::f64::consts::TAU;

use simulation::trace::EDGE_CLOCK_HZ;

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Position,
    Current,
    /// Time of an edge.
    Edge,
    /// Number of a boundary between counts.
    Boundary,
    Velocity,
}

/// Conversion of a number to the unit that [`super::Recording`] has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
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

/// A unit: its names, the first of which is shown, and its scale.
#[derive(Debug, PartialEq)]
pub(super) struct Unit {
    names: &'static [&'static str],
    pub(super) scale: Scale,
}

impl Unit {
    pub(super) const fn name(&self) -> &'static str {
        self.names[0]
    }
}

const fn unit(names: &'static [&'static str], scale: Scale) -> Unit {
    Unit { names, scale }
}

const TIME: &[Unit] = &[
    unit(&["s", "sec", "second", "seconds"], Scale::Over(1.0)),
    unit(&["ms", "msec", "millis", "milliseconds"], Scale::Over(1e3)),
    unit(
        &["us", "usec", "micros", "microseconds", "µs", "μs"],
        Scale::Over(1e6),
    ),
    unit(&["ns", "nsec", "nanos", "nanoseconds"], Scale::Over(1e9)),
];

const POSITION: &[Unit] = &[
    unit(&["counts", "count", "ticks"], Scale::Counts),
    unit(&["deg", "degree", "degrees"], Scale::PerRev(360.0)),
    unit(&["rad", "radian", "radians"], Scale::PerRev(TAU)),
    unit(
        &["rev", "revs", "revolutions", "turn", "turns"],
        Scale::PerRev(1.0),
    ),
];

const CURRENT: &[Unit] = &[
    unit(&["A", "amp", "amps", "ampere"], Scale::Over(1.0)),
    unit(&["mA", "milliamps"], Scale::Over(1e3)),
    unit(&["N.m", "Nm", "N*m"], Scale::Torque),
];

const EDGE: &[Unit] = &[
    unit(&["ticks"], Scale::Over(1.0)),
    unit(&["s"], Scale::Times(EDGE_CLOCK_HZ)),
    unit(&["ms"], Scale::Times(EDGE_CLOCK_HZ / 1e3)),
    unit(&["us"], Scale::Times(EDGE_CLOCK_HZ / 1e6)),
    unit(&["ns"], Scale::Times(EDGE_CLOCK_HZ / 1e9)),
];

const BOUNDARY: &[Unit] = &[unit(&["counts", "count"], Scale::Counts)];

const VELOCITY: &[Unit] = &[
    unit(&["rad/s"], Scale::Over(1.0)),
    unit(&["deg/s"], Scale::Times(TAU / 360.0)),
    unit(&["rev/s"], Scale::Times(TAU)),
    unit(&["rpm", "rev/min"], Scale::Times(TAU / 60.0)),
];

impl Quantity {
    /// The units of this quantity; the first is that of the columns of a recording.
    pub(super) const fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => TIME,
            Self::Position => POSITION,
            Self::Current => CURRENT,
            Self::Edge => EDGE,
            Self::Boundary => BOUNDARY,
            Self::Velocity => VELOCITY,
        }
    }

    /// The unit called `name`, in upper or lower case.
    pub(super) fn unit(self, name: &str) -> Option<&'static Unit> {
        let name = name.to_lowercase();
        let called = |unit: &&Unit| unit.names.iter().any(|known| known.to_lowercase() == name);
        self.units().iter().find(called)
    }

    /// The unit at the end of a column's name: `time_ms`, `angle [deg]`, `Time (us)`.
    pub(super) fn suffix(self, column: &str) -> Option<&'static Unit> {
        let column = column.trim_end_matches([')', ']']);
        let (_, last) = column.rsplit_once(['_', ' ', '(', '[', '.'])?;
        self.unit(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_by_name_and_at_the_end_of_a_column() {
        let shown = |unit: Option<&Unit>| unit.map(Unit::name);
        assert_eq!(shown(Quantity::Time.unit("MS")), Some("ms"));
        assert_eq!(shown(Quantity::Current.unit("N.m")), Some("N.m"));
        assert_eq!(shown(Quantity::Time.unit("deg")), None);
        for (quantity, column, unit) in [
            (Quantity::Time, "time_ms", Some("ms")),
            (Quantity::Time, "Time (us)", Some("us")),
            (Quantity::Time, "time [µs]", Some("us")),
            (Quantity::Time, "ms", None),
            (Quantity::Time, "time", None),
            (Quantity::Position, "joint angle [deg]", Some("deg")),
            (Quantity::Position, "pos_turns", Some("rev")),
            (Quantity::Position, "time_ms", None),
            (Quantity::Current, "i_mA", Some("mA")),
            (Quantity::Current, "torque_Nm", Some("N.m")),
        ] {
            assert_eq!(shown(quantity.suffix(column)), unit, "{column}");
        }
    }

    #[test]
    fn no_unit_of_a_quantity_has_the_name_of_another() {
        for quantity in [
            Quantity::Time,
            Quantity::Position,
            Quantity::Current,
            Quantity::Edge,
            Quantity::Boundary,
            Quantity::Velocity,
        ] {
            for unit in quantity.units() {
                for name in unit.names {
                    assert_eq!(quantity.unit(name), Some(unit), "{name}");
                }
            }
        }
    }
}
