//! The device: masses, motors, encoders, coupler and hand, read from TOML, in SI units.
//!
//! Damping, handle diameter, threshold and Weber fraction are the paper's Table I. Inertias,
//! torque constants, friction, ripple, amplifier and hand are *assumed*: catalogue values good to
//! about 15 %, to be replaced by a data sheet or by identification.

use std::ops::RangeInclusive;
use std::path::Path;

use haptic_control::DualStage;
use serde::{Deserialize, Serialize};

use crate::read::{Step, at_line, one_line};

mod check;
mod range;
mod rates;
mod sections;

/// Longest step of the plant, s. It must be short against every time constant of a device.
pub const LONGEST_STEP_S: f64 = 10e-6;

/// Counts per revolution that an encoder may have: in a device, a recording or an option of a command.
pub const COUNTS_PER_REV: RangeInclusive<u32> = 16..=4_000_000;

/// What counts per revolution must be: the range in words and, for a number beyond one of its ends, the remedy.
#[must_use]
pub fn counts_per_rev_rule(number: Option<i128>) -> String {
    let (least, most) = (*COUNTS_PER_REV.start(), *COUNTS_PER_REV.end());
    let remedy = match number {
        Some(number) if number > most.into() => {
            "; of a finer encoder, divide the counts and this number by a power of two"
        }
        Some(number) if number < least.into() => "; a line of a quadrature encoder is four counts",
        _ => "",
    };
    format!("from {least} to {most} counts per revolution{remedy}")
}

/// The counts per revolution that `text` states.
///
/// # Errors
/// The rule that the text breaks.
pub fn parsed_counts_per_rev(text: &str) -> Result<u32, String> {
    let is_whole = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    // A number of any length is above the range.
    let number = (text.parse().ok()).or(is_whole.then_some(i128::MAX));
    let counts = number.and_then(|number: i128| u32::try_from(number).ok());
    counts
        .filter(|counts| COUNTS_PER_REV.contains(counts))
        .ok_or_else(|| {
            let whole = if number.is_some() {
                ""
            } else {
                "a whole number "
            };
            format!("must be {whole}{}", counts_per_rev_rule(number))
        })
}

/// The device: constants for the design of controllers and estimators, and constants that only a
/// simulation needs. `Device::default()` is the default device; a TOML file can override any value.
///
/// ```
/// use device_files::device::Device;
/// let device = Device::from_toml_str("[large]\ncounts_per_rev = 2000").unwrap();
/// assert_eq!(device.stages.large.counts_per_rev, 2000);
/// assert_eq!(device.stages.small.counts_per_rev, 20_000);
/// let error = Device::from_toml_str("[large]\ninertia_kg_m2 = -1").unwrap_err();
/// assert_eq!(error, "line 2, large.inertia_kg_m2 = -1: must be above 0 kg.m2");
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "sections::File", into = "sections::File")]
pub struct Device {
    /// Both motors with their encoders and amplifiers, and the coupler.
    pub stages: DualStage,
    /// Ripple of the large motor.
    pub large_ripple: Ripple,
    /// Ripple of the small motor.
    pub small_ripple: Ripple,
    /// Share of the coupler's damping lost after 60 s of scenario `heating`, 0 to 1.
    pub fall_at_60_s: f64,
    /// The hand that holds the handle.
    pub hand: Hand,
    /// The handle.
    pub handle: Handle,
    /// The haptic interval: differences of force that a hand does not feel.
    pub interval: Interval,
    /// Errors of the large encoder's disc.
    pub disc: Disc,
    /// Reference encoder on the large motor, for evaluation only.
    pub reference: Reference,
}

/// Ripple: periodic variation of friction and torque constant with a motor's angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// Relative amplitude of the Coulomb friction's variation, one period per revolution, 0 to 1.
    pub friction: f64,
    /// Relative amplitude of the torque constant's variation, `per_rev` periods per revolution, 0 to
    /// 1.
    pub torque: f64,
    /// Periods of the torque ripple per revolution.
    pub per_rev: f64,
}

/// The hand: a spring and a damper between the handle and the intended motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Hand {
    /// Stiffness, N.m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping, N.m.s/rad.
    pub damping_nms_per_rad: f64,
}

/// The handle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Handle {
    /// Diameter at the fingertip, m.
    pub diameter_m: f64,
}

/// Differences of force that a hand does not notice: a threshold plus a fraction of the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Interval {
    /// Threshold at zero force (F_shd), N.
    pub threshold_n: f64,
    /// Weber fraction (k), 0 to 1.
    pub weber: f64,
}

/// Errors of the large encoder's disc, in counts. Their sum is below 0.45, so that boundaries keep
/// their order. The errors of the boundaries are drawn from the run's seed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Disc {
    /// Largest error of the four phases of a line (duty and quadrature), counts.
    pub phase_counts: f64,
    /// Amplitude of the error with one period per revolution (eccentricity), counts.
    pub line_counts: f64,
    /// Largest random error of a single boundary (uniform), counts.
    pub random_counts: f64,
}

/// The reference encoder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Reference {
    /// Counts per revolution: four times the number of lines.
    pub counts_per_rev: u32,
}

/// Assumed, the same for both motors.
impl Default for Ripple {
    fn default() -> Self {
        Self {
            friction: 0.10,
            torque: 0.015,
            per_rev: 26.0,
        }
    }
}

impl Default for Device {
    fn default() -> Self {
        Self {
            stages: DualStage::DEFAULT,
            large_ripple: Ripple::default(),
            small_ripple: Ripple::default(),
            fall_at_60_s: 0.30,
            hand: Hand::default(),
            handle: Handle::default(),
            interval: Interval::default(),
            disc: Disc::default(),
            reference: Reference::default(),
        }
    }
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            stiffness_nm_per_rad: 0.5,
            damping_nms_per_rad: 3e-3,
        }
    }
}

impl Default for Handle {
    fn default() -> Self {
        Self { diameter_m: 0.070 }
    }
}

impl Default for Interval {
    fn default() -> Self {
        Self {
            threshold_n: 0.010,
            weber: 0.05,
        }
    }
}

impl Default for Reference {
    fn default() -> Self {
        Self {
            counts_per_rev: 20_000,
        }
    }
}

impl Device {
    /// Reads a device from TOML text. A missing key has its default.
    ///
    /// # Errors
    /// One line that names the line and the key, or the invalid value, and the valid ones.
    pub fn from_toml_str(text: &str) -> Result<Self, String> {
        Self::checked(text, Self::check_values)
    }

    /// As [`Self::from_toml_str`], for a device that is simulated.
    ///
    /// # Errors
    /// As [`Self::from_toml_str`], and for a device whose time constants are too short for the plant's step.
    pub fn from_toml_str_to_simulate(text: &str) -> Result<Self, String> {
        Self::checked(text, Self::validate)
    }

    fn checked(text: &str, check: fn(&Self) -> Result<(), String>) -> Result<Self, String> {
        let device: Self = toml::from_str(text).map_err(|error| one_line(text, &error))?;
        check(&device).map_err(|error| {
            let key = error.split([' ', ':']).next().unwrap_or("");
            at_line(
                text,
                &key.split('.').map(Step::Key).collect::<Vec<_>>(),
                &error,
            )
        })?;
        Ok(device)
    }

    /// Reads a device file.
    ///
    /// # Errors
    /// As [`Self::from_toml_str`], with the file's name first; also for a path that is not a file.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = crate::text(path)?;
        Self::from_toml_str(&text).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// Reads the file of a device that is simulated.
    ///
    /// # Errors
    /// As [`Self::from_toml_str_to_simulate`], with the file's name first.
    pub fn read_to_simulate(path: &Path) -> Result<Self, String> {
        let text = crate::text(path)?;
        Self::from_toml_str_to_simulate(&text)
            .map_err(|error| format!("{}: {error}", path.display()))
    }

    /// Whether the text of a device file states the counts per revolution of the large encoder.
    #[must_use]
    pub fn states_counts(text: &str) -> bool {
        let table = text.parse::<toml::Table>();
        let large = table.ok().and_then(|mut table| table.remove("large"));
        large.is_some_and(|large| large.get("counts_per_rev").is_some())
    }

    /// Checks that every value is possible.
    ///
    /// # Errors
    /// One line, for example `large.inertia_kg_m2 = -1: must be above 0 kg.m2`.
    pub fn check_values(&self) -> Result<(), String> {
        check::check_values(self)
    }

    /// Checks that the device can be simulated: every value is possible, and the plant's step is short enough.
    ///
    /// # Errors
    /// As [`Self::check_values`], or one line that names the key which makes a time constant too short.
    pub fn validate(&self) -> Result<(), String> {
        self.check_values()?;
        rates::check_rates(self)
    }

    /// The device without the Coulomb friction of both motors, but with torque ripple.
    #[must_use]
    pub fn frictionless(&self) -> Self {
        let mut device = self.clone();
        for (motor, ripple) in [
            (&mut device.stages.large, &mut device.large_ripple),
            (&mut device.stages.small, &mut device.small_ripple),
        ] {
            motor.coulomb_friction = 0.0;
            ripple.friction = 0.0;
        }
        device
    }
}
