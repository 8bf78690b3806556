//! The designed loop and the scales of a device: everything of a controller except scene and
//! estimators.

use core::f64::consts::PI;

use estimator_core::{Counts, CountsPerTickSquared, Hertz, Scale};

use crate::compensation::Compensation;
use crate::design_error::DesignError;
use crate::device::DualStage;
use crate::rst_design::{LoopPoles, RstDesign};
use crate::scene::Scene;
use crate::stage::{ContinuousStage, TransientStage};
use crate::units::{RadPerS2, Radians};

/// Both stages and the scales of both encoders, for one device at one control rate.
///
/// ```
/// use estimator_core::{Hertz, preset};
/// use haptic_control::{DualStage, LoopPoles, Rig};
/// const RIG: Rig = preset!(Rig::new(&DualStage::DEFAULT, Hertz(10e3), LoopPoles::DEFAULT));
/// assert!(RIG.large_scale.rad_per_s_per_count_per_tick > RIG.handle_scale.rad_per_s_per_count_per_tick);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The large motor and its loop.
    pub continuous: ContinuousStage,
    /// The small motor.
    pub transient: TransientStage,
    /// What is compensated beside a spring.
    pub sprung: Compensation,
    /// What is compensated for a handle that moves freely.
    pub free: Compensation,
    /// Scale of the large encoder.
    pub large_scale: Scale,
    /// Scale of the small encoder's velocity.
    pub handle_scale: Scale,
    /// Scale of the small encoder's position.
    pub angle_scale: AngleScale,
    /// Scale of the small encoder's acceleration.
    pub acceleration_scale: AccelerationScale,
}

/// The factor between counts per tick squared and rad/s² of one encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerationScale {
    rad_per_s2_per_count_per_tick2: f32,
}

impl AccelerationScale {
    /// The acceleration in rad/s².
    #[must_use]
    pub fn of(&self, acceleration: CountsPerTickSquared) -> RadPerS2 {
        RadPerS2(acceleration.0 * self.rad_per_s2_per_count_per_tick2)
    }
}

/// The factor between counts and radians of one encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleScale {
    rad_per_count: f32,
}

impl AngleScale {
    /// The angle of a displacement, exact to an f32's last digit up to 2^24 counts.
    #[must_use]
    pub fn of(&self, displacement: Counts) -> Radians {
        Radians(displacement.to_f32() * self.rad_per_count)
    }
}

/// Largest slope of the large motor's current, A/s: full scale in 5 ms.
const LARGE_SLEW: f64 = 1200.0;
/// Largest slope of the small motor's current, A/s: above that of 300 Hz at 0.3 A.
const SMALL_SLEW: f64 = 600.0;

impl Rig {
    /// What is compensated in a scene.
    pub(crate) const fn compensation<S: Scene>(&self) -> &Compensation {
        if S::FREE { &self.free } else { &self.sprung }
    }

    /// Designs the loop of `device` at `rate`.
    ///
    /// # Errors
    /// As [`RstDesign::new`].
    pub const fn new(
        device: &DualStage,
        rate: Hertz,
        poles: LoopPoles,
    ) -> Result<Self, DesignError> {
        let design = match RstDesign::new(device, rate, poles) {
            Ok(design) => design,
            Err(error) => return Err(error),
        };
        let (Ok(large), Ok(handle)) = (
            Scale::new(device.large.counts_per_rev, rate),
            Scale::new(device.small.counts_per_rev, rate),
        ) else {
            return Err(DesignError::Device);
        };
        let t = rate.period_s();
        Ok(Self {
            continuous: ContinuousStage::new(device, &design, (LARGE_SLEW * t) as f32),
            transient: TransientStage::new(device, (SMALL_SLEW * t) as f32),
            sprung: Compensation::sprung(device, rate, poles),
            free: Compensation::free(device, rate, poles),
            large_scale: large,
            handle_scale: handle,
            angle_scale: AngleScale {
                rad_per_count: (2.0 * PI / device.small.counts_per_rev as f64) as f32,
            },
            acceleration_scale: AccelerationScale {
                rad_per_s2_per_count_per_tick2: (2.0 * PI * rate.0 * rate.0
                    / device.small.counts_per_rev as f64)
                    as f32,
            },
        })
    }
}
