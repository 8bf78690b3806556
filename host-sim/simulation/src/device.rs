//! The device: masses, motors, encoders, coupler and hand, read from TOML, in SI units.
//!
//! Damping, handle diameter, threshold and Weber fraction are the paper's Table I. Inertias,
//! torque constants, friction, ripple, amplifier and hand are *assumed*: catalogue values good to
//! about 15 %, to be replaced by a data sheet or by identification.

use serde::{Deserialize, Deserializer, Serialize};

mod check;

/// The whole device. `Device::default()` is the design's; a TOML file overrides any of it.
///
/// ```
/// use simulation::device::Device;
/// let device = Device::from_toml_str("[large]\ncounts_per_rev = 2000").unwrap();
/// assert_eq!(device.large.counts_per_rev, 2000);
/// assert_eq!(device.small.counts_per_rev, 20_000);
/// let error = Device::from_toml_str("[large]\ninertia_kg_m2 = -1").unwrap_err();
/// assert_eq!(error, "large.inertia_kg_m2 = -1: must be above 0 kg.m2");
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Device {
    /// Large motor (continuous stage) with its disc and its half of the coupler.
    #[serde(deserialize_with = "large_from_toml")]
    pub large: Motor,
    /// Small motor (transient stage) with the other half and the handle.
    #[serde(deserialize_with = "small_from_toml")]
    pub small: Motor,
    /// Eddy-current coupler between the two.
    pub coupler: Coupler,
    /// Both current amplifiers.
    pub amplifier: Amplifier,
    /// The hand that holds the handle.
    pub hand: Hand,
    /// The handle.
    pub handle: Handle,
    /// The interval of differences that a hand does not feel.
    pub interval: Interval,
    /// Errors of the large encoder's disc.
    pub disc: Disc,
    /// Reference encoder on the large motor, for evaluation only.
    pub reference: Reference,
}

/// A motor, everything that turns with it, and its encoder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Motor {
    /// Inertia of everything on the shaft, kg.m2.
    pub inertia_kg_m2: f64,
    /// Torque constant, N.m/A.
    pub torque_constant_nm_per_a: f64,
    /// Coulomb friction, N.m; what holds the shaft at rest is the same.
    pub coulomb_nm: f64,
    /// Part of the Coulomb friction that swings once a revolution, 0 to 1.
    pub coulomb_ripple: f64,
    /// Part of the torque constant that swings `ripple_per_rev` times a revolution, 0 to 1.
    pub torque_ripple: f64,
    /// Periods of the torque ripple a revolution.
    pub ripple_per_rev: f64,
    /// Encoder counts a revolution: four times its lines.
    pub counts_per_rev: u32,
    /// Amplifier's current limit, A.
    pub current_limit_a: f64,
}

/// The eddy-current coupler: torque is damping times slip velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Coupler {
    /// Damping b when cold, N.m.s/rad.
    pub damping_nms_per_rad: f64,
    /// Part of the damping lost after 60 s of scenario `heating`, 0 to 1.
    pub fall_at_60_s: f64,
}

/// The current amplifiers: a first-order lag each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Amplifier {
    /// Bandwidth (-3 dB), Hz.
    pub bandwidth_hz: f64,
}

/// The hand: a spring and a damper to the motion that it intends.
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

/// Differences of force that pass unnoticed: a threshold plus a fraction of the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Interval {
    /// Threshold at zero force (F_shd), N.
    pub threshold_n: f64,
    /// Weber fraction (k), 0 to 1.
    pub weber: f64,
}

/// Errors of the large encoder's disc, in counts; their sum is below 0.45, so that boundaries
/// keep their order. The disc itself is drawn from the run's seed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Disc {
    /// Largest error of the four phases of a line (duty and quadrature), counts.
    pub phase_counts: f64,
    /// Amplitude of the once-a-turn error (eccentricity), counts.
    pub line_counts: f64,
    /// Largest random error of a single boundary (uniform), counts.
    pub random_counts: f64,
}

/// The reference encoder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Reference {
    /// Counts a revolution: four times its lines.
    pub counts_per_rev: u32,
}

impl Motor {
    /// The default large motor: DCX35L GB KL 36 V, 1024 lines (inertia, constants: assumed).
    #[must_use]
    pub const fn large() -> Self {
        Self {
            inertia_kg_m2: 115e-7,
            torque_constant_nm_per_a: 46.8e-3,
            coulomb_nm: 4.0e-3,
            coulomb_ripple: 0.10,
            torque_ripple: 0.015,
            ripple_per_rev: 26.0,
            counts_per_rev: 4096,
            current_limit_a: 6.0,
        }
    }

    /// The default small motor: DCX22S GB KL 36 V, 5000 lines (inertia, constants: assumed).
    #[must_use]
    pub const fn small() -> Self {
        Self {
            inertia_kg_m2: 50e-7,
            torque_constant_nm_per_a: 27.5e-3,
            coulomb_nm: 0.8e-3,
            counts_per_rev: 20_000,
            current_limit_a: 1.5,
            ..Self::large()
        }
    }

    /// The same motor without Coulomb friction; its torque ripple stays.
    #[must_use]
    pub const fn frictionless(self) -> Self {
        Self {
            coulomb_nm: 0.0,
            coulomb_ripple: 0.0,
            ..self
        }
    }
}

impl Default for Device {
    fn default() -> Self {
        Self {
            large: Motor::large(),
            small: Motor::small(),
            coupler: Coupler::default(),
            amplifier: Amplifier::default(),
            hand: Hand::default(),
            handle: Handle::default(),
            interval: Interval::default(),
            disc: Disc::default(),
            reference: Reference::default(),
        }
    }
}

impl Default for Coupler {
    fn default() -> Self {
        Self {
            damping_nms_per_rad: 0.96e-3,
            fall_at_60_s: 0.30,
        }
    }
}

impl Default for Amplifier {
    fn default() -> Self {
        Self {
            bandwidth_hz: 2000.0,
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
    /// Reads a device from TOML text: what the text leaves out keeps its default.
    ///
    /// # Errors
    /// One line that names the line and the key, or the impossible value, and what would be right.
    pub fn from_toml_str(text: &str) -> Result<Self, String> {
        let device: Self = toml::from_str(text).map_err(|error| check::one_line(text, &error))?;
        device.validate()?;
        Ok(device)
    }

    /// Refuses values that no device can have, or that the plant's step cannot follow.
    ///
    /// # Errors
    /// One line, for example `large.inertia_kg_m2 = -1: must be above 0 kg.m2`.
    pub fn validate(&self) -> Result<(), String> {
        check::validate(self)
    }

    /// The same device without the Coulomb friction of both motors; torque ripple stays.
    #[must_use]
    pub fn frictionless(&self) -> Self {
        Self {
            large: self.large.frictionless(),
            small: self.small.frictionless(),
            ..self.clone()
        }
    }
}

/// A motor's section in a file: each key optional, because the two motors' defaults differ.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a section with a motor's keys")]
struct MotorSection {
    inertia_kg_m2: Option<f64>,
    torque_constant_nm_per_a: Option<f64>,
    coulomb_nm: Option<f64>,
    coulomb_ripple: Option<f64>,
    torque_ripple: Option<f64>,
    ripple_per_rev: Option<f64>,
    counts_per_rev: Option<u32>,
    current_limit_a: Option<f64>,
}

impl MotorSection {
    fn over(self, base: Motor) -> Motor {
        Motor {
            inertia_kg_m2: self.inertia_kg_m2.unwrap_or(base.inertia_kg_m2),
            torque_constant_nm_per_a: self
                .torque_constant_nm_per_a
                .unwrap_or(base.torque_constant_nm_per_a),
            coulomb_nm: self.coulomb_nm.unwrap_or(base.coulomb_nm),
            coulomb_ripple: self.coulomb_ripple.unwrap_or(base.coulomb_ripple),
            torque_ripple: self.torque_ripple.unwrap_or(base.torque_ripple),
            ripple_per_rev: self.ripple_per_rev.unwrap_or(base.ripple_per_rev),
            counts_per_rev: self.counts_per_rev.unwrap_or(base.counts_per_rev),
            current_limit_a: self.current_limit_a.unwrap_or(base.current_limit_a),
        }
    }
}

fn large_from_toml<'de, D: Deserializer<'de>>(from: D) -> Result<Motor, D::Error> {
    Ok(MotorSection::deserialize(from)?.over(Motor::large()))
}

fn small_from_toml<'de, D: Deserializer<'de>>(from: D) -> Result<Motor, D::Error> {
    Ok(MotorSection::deserialize(from)?.over(Motor::small()))
}
