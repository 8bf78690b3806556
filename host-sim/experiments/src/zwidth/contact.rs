//! Test of one wall or viscous field by three kinds of contact.

use std::fmt;

use haptic_control::{AnyScene, LoopPoles, Radians, Viscous, Wall};

use serde::{Deserialize, Serialize};

use super::LoopSetup;
use super::criterion::{ContactTick, Evaluator, Violation};
use crate::closed_loop::{Conditions, Exact, FeedbackEncoder, Hand, Loop, Press, estimator};
use catalogue::estimators::Estimator;
use catalogue::parameters::Parameters;
use simulation::device::Device;
use terminal::failure::Failure;

/// Position of the wall, rad from the start.
const WALL: f64 = 0.1;

/// Intended motion of the hand, to 0.08 rad inside the wall: at most 40 mN.m, 1.1 N at the
/// fingertip of the default device. The hand reaches the wall with 2.2 rad/s.
const PRESS: Press = Press {
    angle: WALL + 0.08,
    moving_s: 0.15,
    rest_s: 0.45,
};
/// Time after which a resting hand must not feel an oscillation, s.
const SETTLED_S: f64 = 0.30;
/// Duration of a run, s.
const SECONDS: f64 = 0.85;

/// Stiffness and damping of a light grip, relative to the device's hand.
const LIGHT: f64 = 0.1;
/// Initial velocity of a thrown handle, rad/s: 70 mm/s at the rim.
const THROW: f64 = 2.0;

/// Kind of contact with the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Contact {
    /// A hand with a tenth of the stiffness and damping presses and releases.
    LightGrip,
    /// The device's hand presses and releases.
    Hand,
    /// The handle is thrown at the scene, without a hand.
    Throw,
}

impl Contact {
    /// All kinds in the order of the tests, the one with most failures first.
    const ALL: [Self; 3] = [Self::LightGrip, Self::Throw, Self::Hand];

    /// Name in tables and files.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::LightGrip => "light grip",
            Self::Hand => "hand",
            Self::Throw => "throw",
        }
    }
}

/// A violation of the criterion and the contact in which it occurred.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// Kind of contact.
    pub contact: Contact,
    /// Violated part of the criterion.
    pub violation: Violation,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.contact.as_str(), self.violation.as_str())
    }
}

/// Device and estimators, prepared for any wall or viscous field.
pub struct ContactTest {
    device: Device,
    rate_hz: f64,
    seed: u64,
    large: Estimator,
    handle: Estimator,
    exact: Exact,
}

impl ContactTest {
    /// Prepares the device for a loop, with the parameters of its estimators.
    ///
    /// # Errors
    /// As [`estimator`].
    pub fn new(
        device: Device,
        seed: u64,
        case: &LoopSetup,
        parameters: &Parameters,
    ) -> Result<Self, Failure> {
        device.validate()?;
        let rate_hz = case.rate_hz;
        let build = |kind, counts| estimator(kind, &device, counts, rate_hz, parameters);
        Ok(Self {
            large: build(case.large, device.stages.large.counts_per_rev)?,
            handle: build(case.handle, device.stages.small.counts_per_rev)?,
            exact: match case.exact {
                true => Exact::Both,
                false => Exact::Neither,
            },
            device,
            rate_hz,
            seed,
        })
    }

    /// Tests a wall of this stiffness (N.m/rad) and damping (N.m.s/rad), or a viscous field if the
    /// stiffness is zero; `None` if it passes.
    ///
    /// # Errors
    /// One line on a loop that cannot be designed.
    pub fn violation(&self, stiffness: f64, damping: f64) -> Result<Option<Finding>, Failure> {
        for contact in Contact::ALL {
            if let Some(violation) = self.run(contact, stiffness, damping)? {
                return Ok(Some(Finding { contact, violation }));
            }
        }
        Ok(None)
    }

    fn run(&self, contact: Contact, k: f64, b: f64) -> Result<Option<Violation>, Failure> {
        let mut device = self.device.clone();
        if contact == Contact::LightGrip {
            device.hand.stiffness_nm_per_rad *= LIGHT;
            device.hand.damping_nms_per_rad *= LIGHT;
        }
        let (hand, rests) = match contact {
            Contact::Throw => (Hand::Gone(THROW), false),
            _ => (Hand::Pressing(PRESS), true),
        };
        let scene = match k {
            0.0 => Viscous::new(b as f32).map(AnyScene::from),
            _ => Wall::new(Radians(WALL as f32), k as f32, b as f32).map(AnyScene::from),
        };
        let scene = scene.map_err(|error| Failure::Input(error.to_string()))?;
        let threshold = 0.5 * device.interval.threshold_n * device.handle.diameter_m;
        let inertia = device.stages.small.inertia;
        let mut evaluator = Evaluator::new(threshold, 1.0 / self.rate_hz, inertia);
        let run = Loop {
            assumed: device.stages,
            device,
            scene,
            hand,
            rate_hz: self.rate_hz,
            seed: self.seed,
            large: self.large.clone(),
            handle: self.handle.clone(),
            encoder: FeedbackEncoder::Own,
            poles: LoopPoles::DEFAULT,
            late_ticks: 0,
            offsets_a: [0.0; 2],
        };
        let rest = SETTLED_S..PRESS.moving_s + PRESS.rest_s;
        let conditions = Conditions {
            exact: self.exact,
            ..Conditions::default()
        };
        let ticks = (SECONDS * self.rate_hz) as usize;
        run.run_under(ticks, conditions, |moment| {
            evaluator.update(ContactTick {
                resting: rests && rest.contains(&moment.t),
                contact: k == 0.0 || moment.handle.angle > WALL,
                felt: moment.felt,
                omega: moment.handle.omega,
                stopped: moment.stopped.is_some(),
            });
        })?;
        Ok(evaluator.violation())
    }
}
