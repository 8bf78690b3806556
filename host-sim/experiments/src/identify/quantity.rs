//! Conversion of the identified ratios to the quantities of the device file.

use std::f64::consts::TAU;
use std::fmt;

use super::equations::{FRICTION as FRICTION_COLUMN, SLIP};
use super::fit::{Estimate, Fit};
use simulation::device::Device;

/// Keys of the device file.
pub(super) const INERTIA: &str = "large.inertia_kg_m2";
pub(super) const TORQUE_CONSTANT: &str = "large.torque_constant_nm_per_a";
pub(super) const FRICTION: &str = "large.coulomb_nm";
pub(super) const DAMPING: &str = "coupler.damping_nms_per_rad";
pub(super) const BANDWIDTH: &str = "amplifier.bandwidth_hz";

/// The constant whose value is given, because counts and current determine ratios only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// Torque constant of the large motor, N.m/A.
    TorqueConstant(f64),
    /// Inertia of the large motor, kg.m2.
    Inertia(f64),
    /// Damping of the coupler, N.m.s/rad.
    Damping(f64),
}

impl Known {
    /// Parses `KEY=VALUE` with a key of the device file.
    ///
    /// # Errors
    /// One line that names the possible keys, or the value.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (key, value) = text
            .split_once('=')
            .ok_or_else(|| format!("--known {text}: must be KEY=VALUE"))?;
        let make = match key.trim() {
            TORQUE_CONSTANT => Self::TorqueConstant,
            INERTIA => Self::Inertia,
            DAMPING => Self::Damping,
            _ => {
                return Err(format!(
                    "--known {text}: no key {key}; must be {TORQUE_CONSTANT}, {INERTIA} or {DAMPING}"
                ));
            }
        };
        match value.trim().parse() {
            Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(make(value)),
            _ => Err(format!("--known {text}: must be a number above 0")),
        }
    }

    /// Checks the range of the value on `device`, whose own values are in range.
    ///
    /// # Errors
    /// One line with the key and the range.
    pub fn check(self, device: &Device) -> Result<(), String> {
        let mut device = device.clone();
        let (key, value) = self.entry();
        match self {
            Self::TorqueConstant(_) => device.stages.large.torque_constant = value,
            Self::Inertia(_) => device.stages.large.inertia = value,
            Self::Damping(_) => device.stages.damping = value,
        }
        match device.check_values() {
            Err(error) if error.starts_with(key) => Err(format!("--known {error}")),
            _ => Ok(()),
        }
    }

    /// Inertia of the large motor from `[Kt/J, b/J, friction/J]`.
    pub(super) fn inertia(self, ratios: &[f64]) -> f64 {
        match self {
            Self::TorqueConstant(value) => value / ratios[0],
            Self::Inertia(value) => value,
            Self::Damping(value) => value / ratios[SLIP],
        }
    }

    /// Key in the device file, and value.
    pub(super) fn entry(self) -> (&'static str, f64) {
        match self {
            Self::TorqueConstant(value) => (TORQUE_CONSTANT, value),
            Self::Inertia(value) => (INERTIA, value),
            Self::Damping(value) => (DAMPING, value),
        }
    }
}

impl fmt::Display for Known {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, value) = self.entry();
        write!(f, "{key} = {value}")
    }
}

/// One identified quantity.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Key of the device file.
    pub key: &'static str,
    /// Value and interval in SI units, as in the device file.
    pub estimate: Estimate,
    /// Value in the device file.
    pub file: f64,
    /// Unit for tables.
    pub unit: Unit,
    /// Reason for which the value is rejected; `None` for an identified value.
    pub rejected: Option<String>,
    /// Whether the reason is the width of the interval, or doubt about the model, alone.
    pub vague: bool,
}

/// Largest half-width of the 95 % interval of an identified value, relative to the value: 3 % are
/// then three standard deviations.
const IDENTIFIED: f64 = 0.02;

/// Largest half-width of the 95 % interval of a value that is shown, relative to the value.
const TOLD: f64 = 0.5;

/// Unit for tables, with its relation to the unit of the device file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Name of the unit.
    pub name: &'static str,
    /// Factor from the SI unit.
    pub per_si: f64,
    /// Unit of the device file, SI.
    pub si: &'static str,
}

impl Unit {
    const fn new(name: &'static str, per_si: f64, si: &'static str) -> Self {
        Self { name, per_si, si }
    }
}

pub(super) const GRAM_CM2: Unit = Unit::new("g.cm2", 1e7, "kg.m2");
pub(super) const MILLI_NM: Unit = Unit::new("mN.m", 1e3, "N.m");
pub(super) const MILLI_NM_PER_A: Unit = Unit::new("mN.m/A", 1e3, "N.m/A");
const MILLI_NMS: Unit = Unit::new("mN.m.s/rad", 1e3, "N.m.s/rad");
const HERTZ: Unit = Unit::new("Hz", 1.0, "Hz");

impl Quantity {
    /// A quantity, rejected with `remedy` if its interval is wider than [`IDENTIFIED`] relative to the
    /// larger of its value and `least`.
    pub(super) fn new(
        key: &'static str,
        unit: Unit,
        file: f64,
        estimate: Estimate,
        least: f64,
        remedy: &str,
    ) -> Self {
        let width = estimate.half / estimate.value.abs().max(least);
        let remedy = match estimate.by_counts {
            true => {
                "the encoders are too coarse for it: clamp the handle, or give its encoder more counts"
            }
            false => remedy,
        };
        let vague = (width.is_nan() || width > IDENTIFIED).then(|| match 100.0 * width {
            percent if percent < 1000.0 => {
                format!("an interval of +-{percent:.1} % is too wide; {remedy}")
            }
            _ => format!("no effect in the recording; {remedy}"),
        });
        // The estimate of a small friction can be negative, that of other quantities cannot.
        let negative = least == 0.0 && estimate.value <= 0.0;
        Self {
            key,
            estimate,
            file,
            unit,
            vague: vague.is_some(),
            rejected: vague.or(negative.then(|| {
                "the estimate is negative; check that the recording is of scene excite".to_owned()
            })),
        }
    }

    /// Rejects the value for a reason other than the width of its interval.
    pub(super) fn reject(&mut self, reason: String) {
        self.rejected = Some(reason);
        self.vague = false;
    }

    /// Rejects a value for a reason that is more important than the width of its interval. The value
    /// is still shown.
    pub(super) fn doubt(&mut self, reason: &str) {
        if self.rejected.is_none() || self.vague {
            self.rejected = Some(reason.to_owned());
            self.vague = true;
        }
    }

    /// Whether the value tells something: it is identified, or its interval is not wider than half of
    /// it.
    #[must_use]
    pub fn is_told(&self) -> bool {
        let Estimate { value, half, .. } = self.estimate;
        self.rejected.is_none() || self.vague && half < TOLD * value.abs()
    }

    /// Half-width of the interval as text, in % of the value if it is below 10 %.
    pub(super) fn half_text(&self) -> String {
        let Estimate { value, half, .. } = self.estimate;
        if half < 0.1 * value.abs() {
            return format!("+-{} %", two_digits(100.0 * half / value.abs()));
        }
        format!(
            "+-{} {}",
            two_digits(self.unit.per_si * half),
            self.unit.name
        )
    }

    /// Key and half-width, for a message of one line.
    pub(super) fn short(&self) -> String {
        let percent = 100.0 * self.estimate.half / self.estimate.value.abs();
        match percent.is_finite() {
            true => format!("{} +-{percent:.0} %", self.key),
            false => format!("{} undetermined", self.key),
        }
    }

    /// Ratio to the device file's value, and whether that value is inside the interval.
    #[must_use]
    pub fn health(&self) -> (f64, bool) {
        let away = self.estimate.value - self.file;
        (
            self.estimate.value / self.file,
            away.abs() <= self.estimate.half,
        )
    }
}

/// The quantities of the large shaft's equation.
pub(super) fn of_large(fit: &Fit, device: &Device, known: Known, current: f64) -> Vec<Quantity> {
    let scaled = |k: usize| fit.estimate(|ratios, _| ratios[k] * known.inertia(ratios));
    let torque = scaled(0).value * current;
    let rows = [
        (
            TORQUE_CONSTANT,
            MILLI_NM_PER_A,
            device.stages.large.torque_constant,
            scaled(0),
            0.0,
            "record steps of current",
        ),
        (
            INERTIA,
            GRAM_CM2,
            device.stages.large.inertia,
            fit.estimate(|ratios, _| known.inertia(ratios)),
            0.0,
            "record steps of current",
        ),
        (
            DAMPING,
            MILLI_NMS,
            device.stages.damping,
            scaled(SLIP),
            0.0,
            "record slip of 10 rad/s and more, at several speeds",
        ),
        (
            FRICTION,
            MILLI_NM,
            device.stages.large.coulomb_friction,
            scaled(FRICTION_COLUMN),
            0.1 * torque,
            "record slow and fast motion in both directions",
        ),
        (
            BANDWIDTH,
            HERTZ,
            device.stages.amplifier_bandwidth.0,
            fit.estimate(|_, lag_s| 1.0 / (TAU * lag_s)),
            0.0,
            "record steps of current for a longer time",
        ),
    ];
    rows.into_iter()
        .filter(|row| row.0 != known.entry().0)
        .map(|(key, unit, file, estimate, least, remedy)| {
            Quantity::new(key, unit, file, estimate, least, remedy)
        })
        .collect()
}

/// Two significant digits.
fn two_digits(x: f64) -> String {
    let places = (1.0 - x.abs().log10().floor()).clamp(0.0, 9.0);
    format!("{x:.0$}", places as usize)
}
