//! What a user says about a recording: its columns, their units, the encoder and the clock.

pub(super) mod stated;
pub(super) mod units;

use simulation::device::Device;
use terminal::failure::Failure;

use super::times::steps::SLOWEST_HZ;
use units::{Quantity, Unit};

/// A column of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    T,
    CountsLarge,
    CountsSmall,
    Current,
    CurrentSmall,
    CurrentMeasured,
    CurrentSmallMeasured,
    EdgeTick,
    EdgeBound,
    TrueOmega,
}

/// Names of the columns of measured currents: large and small motor.
pub(crate) const MEASURED: [&str; 2] = ["current_measured", "current_small_measured"];

impl Column {
    /// Every column that is read; other columns of a file are ignored.
    pub(super) const ALL: [Self; 10] = [
        Self::T,
        Self::CountsLarge,
        Self::CountsSmall,
        Self::Current,
        Self::CurrentSmall,
        Self::CurrentMeasured,
        Self::CurrentSmallMeasured,
        Self::EdgeTick,
        Self::EdgeBound,
        Self::TrueOmega,
    ];

    /// The counts of the large motor's encoder and of the small motor's.
    pub(super) const COUNTS: [Self; 2] = [Self::CountsLarge, Self::CountsSmall];

    /// Its name in a header.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::T => "t",
            Self::CountsLarge => "counts_large",
            Self::CountsSmall => "counts_small",
            Self::Current => "current",
            Self::CurrentSmall => "current_small",
            Self::CurrentMeasured => MEASURED[0],
            Self::CurrentSmallMeasured => MEASURED[1],
            Self::EdgeTick => "edge_tick",
            Self::EdgeBound => "edge_bound",
            Self::TrueOmega => "true_omega",
        }
    }

    /// The column of the commands that this one of measured currents replaces.
    pub(super) const fn command(self) -> Option<Self> {
        match self {
            Self::CurrentMeasured => Some(Self::Current),
            Self::CurrentSmallMeasured => Some(Self::CurrentSmall),
            _ => None,
        }
    }

    pub(super) const fn quantity(self) -> Quantity {
        match self {
            Self::T => Quantity::Time,
            Self::CountsLarge | Self::CountsSmall => Quantity::Position,
            Self::Current
            | Self::CurrentSmall
            | Self::CurrentMeasured
            | Self::CurrentSmallMeasured => Quantity::Current,
            Self::EdgeTick => Quantity::Edge,
            Self::EdgeBound => Quantity::Boundary,
            Self::TrueOmega => Quantity::Velocity,
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|column| column.name() == name)
    }
}

/// A column of a recording, and the user's column that it is read from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mapping {
    pub(super) column: Column,
    /// Name in the header, or the number of the column, from 1.
    pub(super) theirs: String,
    /// The unit that the user gave.
    pub(super) unit: Option<&'static Unit>,
    /// For whole seconds, name and unit of the column with the part of a second.
    pub(super) part: Option<(String, &'static Unit)>,
}

impl Mapping {
    /// Whether the column is called by its number.
    pub(super) fn is_number(&self) -> bool {
        self.theirs.parse::<usize>().is_ok()
    }
}

/// How a recording is read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    pub(super) columns: Vec<Mapping>,
    /// Counts per revolution of the large motor's encoder and of the small motor's.
    pub(super) counts_per_rev: [u32; 2],
    /// How a user gives each of them.
    pub(super) counts_given: [String; 2],
    /// Whether a user gives options.
    pub(super) takes_options: bool,
    /// Torque constants of the large and of the small motor, N.m/A.
    pub(super) torque_constant: [f64; 2],
    /// Limit of the large motor's current, A.
    pub(super) current_limit: f64,
    /// Modulus of the raw counts of each encoder.
    pub(super) modulus: [Option<u32>; 2],
    /// Rate of the rows, for a recording without a column of time.
    pub(super) row_rate_hz: Option<f64>,
    /// Whether rows with stale readings of the large motor's encoder are left out.
    pub(crate) drop_stale: bool,
}

impl ReadOptions {
    /// Options for recordings of `device` that have the columns and units of this project.
    #[must_use]
    pub fn of(device: &Device) -> Self {
        let stages = &device.stages;
        let in_file = |motor: &str| format!("as {motor}.counts_per_rev in the file of --device");
        Self {
            columns: Vec::new(),
            counts_per_rev: [stages.large.counts_per_rev, stages.small.counts_per_rev],
            counts_given: [
                format!("with --counts-per-rev, or {}", in_file("large")),
                in_file("small"),
            ],
            takes_options: true,
            torque_constant: [stages.large.torque_constant, stages.small.torque_constant],
            current_limit: stages.large.current_limit,
            modulus: [None; 2],
            row_rate_hz: None,
            drop_stale: false,
        }
    }

    /// These options where a user gives the counts per revolution of the large motor's encoder in another
    /// way, `how`, as messages are to say.
    #[must_use]
    pub fn with_counts_given(mut self, how: &str) -> Self {
        how.clone_into(&mut self.counts_given[0]);
        self
    }

    /// These options where a list has the counts per revolution, and nobody gives options.
    #[must_use]
    pub fn of_list(self, list: &str) -> Self {
        Self {
            takes_options: false,
            ..self.with_counts_given(&format!("in {list}"))
        }
    }

    /// Adds the columns that `text` names: `t=time_ms:ms,counts_large=angle:deg`.
    ///
    /// # Errors
    /// [`Failure::Input`] with the part that is wrong and what would be right.
    pub fn add_columns(&mut self, text: &str) -> Result<(), Failure> {
        for part in parts(text) {
            let (ours, theirs) = part.split_once('=').unwrap_or((part, ""));
            let column = Column::named(ours.trim()).ok_or_else(|| {
                let names = Column::ALL.map(Column::name).join(", ");
                Failure::Input(format!(
                    "--column {part}: '{ours}' is no column of a recording, which has {names}; write for \
                     example t=time_ms"
                ))
            })?;
            if self.columns.iter().any(|known| known.column == column) {
                let name = column.name();
                return Err(Failure::Input(format!(
                    "--column {part}: {name} is given twice; keep one"
                )));
            }
            let (theirs, second) = match column {
                Column::T => split_second(theirs),
                _ => (theirs, None),
            };
            let (theirs, unit) = split_unit(column.quantity(), theirs.trim());
            if theirs.is_empty() {
                return Err(Failure::Input(format!(
                    "--column {part}: no column after '='; write for example {ours}={}",
                    example(column)
                )));
            }
            self.columns.push(Mapping {
                column,
                theirs: theirs.to_owned(),
                unit,
                part: second.map(|(name, unit)| (name.to_owned(), unit)),
            });
        }
        Ok(())
    }

    /// Sets the rate of the rows, for recordings without a column of time.
    ///
    /// # Errors
    /// [`Failure::Input`] if the rate is not positive and finite.
    pub(crate) fn set_row_rate(&mut self, hz: f64) -> Result<(), Failure> {
        if !(hz > 0.0 && hz.is_finite()) {
            return Err(Failure::Input(format!(
                "--row-rate {hz}: the rate of the rows must be positive and finite (Hz)"
            )));
        }
        if hz < SLOWEST_HZ {
            return Err(Failure::Input(format!(
                "--row-rate {hz}: the rate of the rows must be at least {SLOWEST_HZ} Hz"
            )));
        }
        self.row_rate_hz = Some(hz);
        Ok(())
    }

    /// Sets the modulus of the raw counts of an encoder: `4096`, or `counts_small=4096`.
    ///
    /// # Errors
    /// [`Failure::Input`] if the text is no modulus from 2 to 2^31.
    pub fn set_modulus(&mut self, text: &str) -> Result<(), Failure> {
        let (encoder, number) = match text.split_once('=') {
            None => (0, text),
            Some(("counts_large", number)) => (0, number),
            Some(("counts_small", number)) => (1, number),
            Some((name, _)) => {
                return Err(Failure::Input(format!(
                    "--modulus {text}: '{name}' is no column of counts; write counts_large or counts_small"
                )));
            }
        };
        match number.trim().parse() {
            Ok(_) if self.modulus[encoder].is_some() => Err(Failure::Input(format!(
                "--modulus {text}: the modulus of this column is given twice; keep one"
            ))),
            Ok(modulus @ 2..=0x8000_0000) => {
                self.modulus[encoder] = Some(modulus);
                Ok(())
            }
            _ => Err(Failure::Input(format!(
                "--modulus {text}: '{number}' is no number of counts from 2 to 2^31, for example 4096; a counter \
                 of 32 bits needs no modulus"
            ))),
        }
    }

    /// The user's mapping of `column`.
    pub(super) fn mapping(&self, column: Column) -> Option<&Mapping> {
        self.columns.iter().find(|known| known.column == column)
    }
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self::of(&Device::default())
    }
}

/// The parts of a list: a comma ends a part if the name of a column and `=` follow it, because the
/// user's names may contain commas.
fn parts(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut begin = 0;
    for (comma, _) in text.match_indices(',') {
        let rest = text[comma + 1..].trim_start();
        let name = rest.split_once('=').map(|(name, _)| name.trim());
        if name.is_some_and(|name| !name.contains(',') && Column::named(name).is_some()) {
            parts.push(&text[begin..comma]);
            begin = comma + 1;
        }
    }
    parts.push(&text[begin..]);
    parts
}

/// Splits `angle:deg` into name and unit. A part after the last colon that is no unit of `quantity`
/// belongs to the name.
fn split_unit(quantity: Quantity, text: &str) -> (&str, Option<&'static Unit>) {
    let split = text.rsplit_once(':');
    match split.map(|(name, unit)| (name, quantity.unit(unit))) {
        Some((name, Some(unit))) => (name, Some(unit)),
        _ => (text, None),
    }
}

/// Splits `1:s+2:ns` into the column of whole seconds and that of the part of a second, with its unit. Without
/// these two units it is one name.
fn split_second(text: &str) -> (&str, Option<(&str, &'static Unit)>) {
    let split = || {
        let (whole, part) = text.rsplit_once('+')?;
        let (name, unit) = split_unit(Quantity::Time, part.trim());
        let is_whole = split_unit(Quantity::Time, whole.trim()).1?.per_s() == 1.0;
        let unit = unit.filter(|unit| is_whole && unit.per_s() > 1.0)?;
        Some((whole, (name, unit)))
    };
    split().map_or((text, None), |(whole, part)| (whole, Some(part)))
}

fn example(column: Column) -> &'static str {
    match column.quantity() {
        Quantity::Time => "time_ms:ms",
        Quantity::Position => "angle:deg",
        Quantity::Current => "iq:mA",
        Quantity::Edge => "edge_us:us",
        Quantity::Boundary => "boundary",
        Quantity::Velocity => "speed:rpm",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mapped(text: &str) -> Vec<(&'static str, String, Option<&'static str>)> {
        let mut options = ReadOptions::default();
        options.add_columns(text).unwrap();
        let shown = |mapping: Mapping| {
            let unit = mapping.unit.map(Unit::name);
            (mapping.column.name(), mapping.theirs, unit)
        };
        options.columns.into_iter().map(shown).collect()
    }

    #[test]
    fn columns_are_given_by_name_with_a_unit() {
        let deg = ("counts_large", "angle".to_owned(), Some("deg"));
        assert_eq!(
            mapped("t=time_ms,counts_large=angle:deg"),
            [("t", "time_ms".to_owned(), None), deg]
        );
        // A colon, an equals sign and a comma in the user's name.
        assert_eq!(
            mapped("counts_large=a:b=c, d:rad,t=x::ns"),
            [
                ("counts_large", "a:b=c, d".to_owned(), Some("rad")),
                ("t", "x:".to_owned(), Some("ns"))
            ]
        );
    }

    #[test]
    fn names_may_contain_commas_and_equals_signs() {
        let name = ("counts_large", "a,b=c".to_owned(), Some("deg"));
        assert_eq!(mapped("counts_large=a,b=c:deg"), [name]);
    }

    #[test]
    fn invalid_options_are_refused_with_the_reason() {
        for (text, said) in [
            (
                "time=t",
                "'time' is no column of a recording, which has t, ",
            ),
            ("t", "no column after '='; write for example t=time_ms:ms"),
            ("t=a,t=b", "t is given twice"),
        ] {
            let error = ReadOptions::default().add_columns(text).unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
        for text in ["0", "1", "2147483649", "x", "-5", "angle=7"] {
            let error = ReadOptions::default().set_modulus(text).unwrap_err();
            assert!(error.to_string().starts_with("--modulus "), "{error}");
        }
        for hz in [0.0, -1.0, 4.9, f64::NAN, f64::INFINITY] {
            assert!(ReadOptions::default().set_row_rate(hz).is_err(), "{hz}");
        }
        let mut options = ReadOptions::default();
        options.set_modulus("2147483648").unwrap();
        options.set_modulus("counts_small=360").unwrap();
        assert_eq!(options.modulus, [Some(1 << 31), Some(360)]);
        let twice = options.set_modulus("200").unwrap_err().to_string();
        assert!(twice.contains("--modulus 200: the modulus of this column is given twice"));
    }
}
