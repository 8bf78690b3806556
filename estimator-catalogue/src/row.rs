//! The row of an estimator: the facts that need no type.

use core::fmt;

use estimator_core::Signals;

use crate::parameter::Parameter;

/// The row of an estimator without its type and its design, which only the macro has.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Name of the row in the macro: a Rust identifier.
    pub id: &'static str,
    /// Summary, in one line.
    pub summary: &'static str,
    /// Signals that the estimator reads.
    pub needs: Signals,
    /// Whether the type takes a varying period: see [`VaryingPeriod`](estimator_core::VaryingPeriod).
    pub varying_period: bool,
    /// Quantities that the estimator reports besides the velocity.
    pub reports: Reports,
    /// The type, as the macro has it.
    pub rust_type: &'static str,
    /// The design, as the macro has it: see [`estimators!`](crate::estimators).
    pub rust_design: &'static str,
    /// Law by which the output comes to rest after any motion.
    pub settling: Settling,
    /// Colour in figures. Estimators of one family share a colour.
    pub colour: Colour,
    /// Dash of the lines in figures.
    pub dash: Dash,
    /// Parameters, in the order of tables.
    pub parameters: &'static [Parameter],
    /// Designs that the bench image measures.
    pub variants: &'static [Variant],
    /// Goals of run time.
    pub goals: &'static [Goal],
}

/// Quantities that an estimator reports besides the velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reports {
    /// No other quantity.
    Nothing,
    /// The standard deviation of the velocity.
    Deviation,
    /// The standard deviation, and the acceleration of its model.
    Acceleration,
    /// The standard deviation, and the coupler's damping that the estimator learns.
    Damping,
    /// The standard deviation; parameter `literal` delays the current by a tick.
    LateCurrent,
}

/// Law by which the output comes to rest after the last change of the count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settling {
    /// At the next tick.
    AtOnce,
    /// With the pole of parameter `cutoff_hz`.
    OnePole,
    /// With this number of poles at parameter `bandwidth_hz`.
    EqualPoles(u8),
    /// When the window contains only the resting count. The window has as many intervals as the
    /// capacity of the variant.
    Window,
    /// With the three poles of the steady filter on the triple integrator.
    TripleIntegrator,
    /// With the two poles of the steady filter on the motor model.
    MotorModel,
    /// As this number of counts over the time since the last edge.
    CountsOverTime(f64),
    /// When the disturbance torque has decayed.
    Disturbance,
    /// When the disturbance torque has decayed, with the truncated-Gaussian update.
    DisturbanceTruncated,
    /// When the disturbance torque, which includes all other torques, has decayed, and then as one
    /// count over the time since the last edge.
    DisturbanceAlone,
    /// Within this time, s, which was measured and not derived. The sign of an error switches the law,
    /// which amplifies rounding.
    Switching(f64),
    /// To a limit cycle of 2.5 times the change of velocity that parameter `acceleration` allows in a
    /// tick, within this time, s, which was measured and not derived. The sign of an error switches the
    /// law.
    Chattering(f64),
    /// Within this time, s, which was measured and not derived. An estimator whose law is not in
    /// this list has this variant.
    Within(f64),
}

impl Settling {
    /// Whether the estimator has a window.
    #[must_use]
    pub const fn is_window(self) -> bool {
        matches!(self, Self::Window)
    }
}

/// An RGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

/// Colours of Okabe and Ito, of Tol, and darker ones. A colour with a dash differs from every other
/// pair for normal, protanopic and deuteranopic vision.
impl Colour {
    /// Grey.
    pub const GREY: Self = Self(0x8c, 0x8c, 0x8c);
    /// Orange.
    pub const ORANGE: Self = Self(0xe6, 0x9f, 0x00);
    /// Sky blue.
    pub const SKY: Self = Self(0x56, 0xb4, 0xe9);
    /// Blue.
    pub const BLUE: Self = Self(0x00, 0x72, 0xb2);
    /// Green.
    pub const GREEN: Self = Self(0x00, 0x9e, 0x73);
    /// Vermilion.
    pub const VERMILION: Self = Self(0xd5, 0x5e, 0x00);
    /// Pink.
    pub const PINK: Self = Self(0xcc, 0x79, 0xa7);
    /// Olive.
    pub const OLIVE: Self = Self(0x99, 0x99, 0x33);
    /// Purple.
    pub const PURPLE: Self = Self(0x5d, 0x3a, 0x9b);
    /// Navy.
    pub const NAVY: Self = Self(0x1a, 0x1a, 0x6e);
    /// Crimson.
    pub const CRIMSON: Self = Self(0xc0, 0x00, 0x3a);
    /// Pine green.
    pub const PINE: Self = Self(0x00, 0x4d, 0x40);
    /// Maroon.
    pub const MAROON: Self = Self(0x60, 0x00, 0x00);
    /// Brown.
    pub const BROWN: Self = Self(0x7a, 0x52, 0x30);
}

/// Pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// A solid line.
    Solid,
    /// Long strokes.
    Dashed,
    /// Dots.
    Dotted,
    /// Strokes and dots.
    Mixed,
}

/// A design that the bench image measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Module of the design in the image.
    pub id: &'static str,
    /// Control rate of the tuned parameters, Hz; 0 for a design that suits every rate.
    pub rate_hz: f64,
    /// Length of the window or of the gain table; 0 if the design has neither.
    pub capacity: usize,
}

/// The type of a row in C. A row with a window or a gain table has a type per length.
///
/// ```
/// use estimator_catalogue::{CType, ROWS};
/// let types = |name: &str| -> Vec<String> {
///     let row = ROWS.iter().find(|row| row.name == name).unwrap();
///     CType::of(row).map(|c| c.to_string()).collect()
/// };
/// assert_eq!(types("foaw-end-fit"), ["foaw_end_fit_15", "foaw_end_fit_64"]);
/// // The designs for its two rates have no length.
/// assert_eq!(types("pll"), ["pll"]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CType {
    /// The row.
    pub row: &'static Row,
    /// Length of the window or of the gain table; 0 if the design has neither.
    pub capacity: usize,
}

impl CType {
    /// The types of a row, by increasing length: the lengths of its variants.
    pub fn of(row: &'static Row) -> impl Iterator<Item = Self> {
        let lengths = row.variants.iter().map(|variant| variant.capacity);
        let first = lengths.clone();
        let repeated = move |k: usize, capacity| first.clone().take(k).any(|one| one == capacity);
        lengths
            .enumerate()
            .filter(move |(k, capacity)| !repeated(*k, *capacity))
            .map(move |(_, capacity)| Self { row, capacity })
    }
}

/// The name between `limpid_` and the suffixes of types and functions.
impl fmt::Display for CType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row.id)?;
        match self.capacity {
            0 => Ok(()),
            n => write!(f, "_{n}"),
        }
    }
}

/// Goals of run time for the variants of one capacity: instructions per update at `opt-level` 3 on
/// a Cortex-M4F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Capacity of the variants; 0 for all variants.
    pub capacity: usize,
    /// Largest mean over the traces.
    pub mean: f64,
    /// Largest number of instructions of one update; infinite without a goal.
    pub longest: f64,
}
