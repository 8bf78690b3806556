//! Pole placement for the velocity loop of the large motor, at compile time.
//!
//! In powers of z⁻¹, with T the period, `τm = J / b`, `τa` the amplifier's lag:
//! ```text
//! plant       A ω = B i + ..   A = (1 - e^(-T/τm) z⁻¹) (1 - e^(-T/τa) z⁻¹)   B = b1 z⁻¹ + b2 z⁻²
//! law         S i = T ω_f - R ω            S = (1 - z⁻¹) (1 + s1 z⁻¹)       integral action
//! regulation  A S + B R = P                P = (1 - p z⁻¹)² (1 - q z⁻¹) (1 - e^(-T/τa) z⁻¹)
//! tracking    T = P / B(1)                 ω_f = ((1 - m) / (1 - m z⁻¹))² ω_wanted
//! ```
//! so that ω follows `B / B(1) ω_f`, a delay of about one tick, for any regulation poles.
//! `p = e^(-2π f_r T)`, `m = e^(-2π f_t T)`. `q = p`, or `q = e^(-T/τm)` if the motor on its coupler is
//! more than twice as fast as f_r.

use crate::design_error::DesignError;
use crate::device::DualStage;
use crate::margins::{Margins, margins};
use crate::numeric::{multiply, solve};
use estimator_core::Hertz;
use estimator_core::const_math::exp;

/// Poles and least margins of the velocity loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopPoles {
    /// Bandwidth f_r of regulation, up to which disturbances are rejected.
    pub regulation: Hertz,
    /// Bandwidth f_t of tracking, up to which the commanded velocity is followed.
    pub tracking: Hertz,
    /// Delay of the estimator, which the loop has to tolerate besides the modelled lags, s.
    pub estimator_delay_s: f64,
}

impl LoopPoles {
    /// Regulation at 12 Hz, tracking at 60 Hz, a delay of the estimator of 1 ms.
    pub const DEFAULT: Self = Self {
        regulation: Hertz(12.0),
        tracking: Hertz(60.0),
        estimator_delay_s: 1e-3,
    };

    /// Lowest control rate at which both bandwidths are at most a tenth of it.
    ///
    /// ```
    /// use haptic_control::LoopPoles;
    /// assert_eq!(LoopPoles::DEFAULT.lowest_rate().0, 600.0);
    /// ```
    #[must_use]
    pub const fn lowest_rate(&self) -> Hertz {
        let (regulation, tracking) = (self.regulation.0, self.tracking.0);
        Hertz(
            10.0 * if regulation > tracking {
                regulation
            } else {
                tracking
            },
        )
    }
}

/// Polynomials of the law in powers of z⁻¹, in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RstDesign {
    /// Plant's denominator A.
    pub a: [f64; 3],
    /// Plant's numerator B, rad/s per A.
    pub b: [f64; 3],
    /// R, A per rad/s.
    pub r: [f64; 3],
    /// S.
    pub s: [f64; 3],
    /// T, A per rad/s.
    pub t: [f64; 5],
    /// Closed loop P.
    pub p: [f64; 5],
    /// Pole e^(-T/τm) of the motor on its coupler.
    pub mechanical_pole: f64,
    /// Pole e^(-T/τa) of the amplifier.
    pub electrical_pole: f64,
    /// Pole p of regulation.
    pub regulation_pole: f64,
    /// Pole m of each half of the tracking filter.
    pub tracking_pole: f64,
    /// Margins, the estimator's delay included.
    pub margins: Margins,
}

/// Bandwidth of the motor on its coupler, in regulation bandwidths, above which its pole is kept.
const FAST: f64 = 2.0;

/// Least modulus margin that is accepted: the distance of the open loop from -1.
pub const LEAST_MODULUS: f64 = 0.5;

impl RstDesign {
    /// Designs the loop for `device` at `rate`.
    ///
    /// # Errors
    /// [`DesignError`]: rate, device or bandwidth out of range, no solution, or a modulus margin
    /// below [`LEAST_MODULUS`].
    pub const fn new(
        device: &DualStage,
        rate: Hertz,
        poles: LoopPoles,
    ) -> Result<Self, DesignError> {
        if !(rate.0 >= 100.0 && rate.0 <= 100e3) {
            return Err(DesignError::Rate);
        }
        let device = match device.checked() {
            Ok(device) => device,
            Err(error) => return Err(error),
        };
        if !(poles.regulation.0 > 0.0
            && poles.tracking.0 > 0.0
            && rate.0 >= poles.lowest_rate().0
            && poles.estimator_delay_s >= 0.0
            && poles.estimator_delay_s <= 0.1)
        {
            return Err(DesignError::Bandwidth);
        }
        let tau = 2.0 * core::f64::consts::PI;
        let t = rate.period_s();
        let mechanical = device.large.inertia / device.damping;
        let electrical = device.amplifier_lag();
        let gain = device.large.torque_constant / device.damping;
        let pm = exp(-t / mechanical);
        let pa = exp(-t / electrical);
        let a = multiply([1.0, -pm, 0.0], [1.0, -pa, 0.0]);
        let a = [a[0], a[1], a[2]];
        // Response to a unit step after one tick, and the rest up to the final value.
        let difference = mechanical - electrical;
        let response = if difference > 1e-4 * mechanical || difference < -1e-4 * mechanical {
            1.0 - (mechanical * pm - electrical * pa) / difference
        } else {
            // Around equal time constants the quotient loses its digits, up to 0/0: with pm = pa e^x, a series of e^x.
            let x = t * difference / (mechanical * electrical);
            1.0 - pa - pa * t / electrical * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0)))
        };
        let b1 = gain * response;
        let b2 = gain * (1.0 - pm) * (1.0 - pa) - b1;
        if !(b1 > 0.0 && b2 > 0.0) {
            return Err(DesignError::Device);
        }
        let b = [0.0, b1, b2];

        let pole = exp(-tau * poles.regulation.0 * t);
        let pair = multiply([1.0, -pole, 0.0], [1.0, -pole, 0.0]);
        // A motor that settles fast by itself keeps its pole: to slow it down costs the margin.
        let third = if FAST * tau * poles.regulation.0 * mechanical < 1.0 {
            pm
        } else {
            pole
        };
        let rest = multiply([1.0, -third, 0.0], [1.0, -pa, 0.0]);
        let p = multiply([pair[0], pair[1], pair[2]], [rest[0], rest[1], rest[2]]);
        // A (1 - z⁻¹) =: 1 + c1 z⁻¹ + c2 z⁻² + c3 z⁻³; unknown s1, r0, r1, r2.
        let c = multiply(a, [1.0, -1.0, 0.0]);
        let Some([s1, r0, r1, r2]) = solve(
            [
                [1.0, b1, 0.0, 0.0],
                [c[1], b2, b1, 0.0],
                [c[2], 0.0, b2, b1],
                [c[3], 0.0, 0.0, b2],
            ],
            [p[1] - c[1], p[2] - c[2], p[3] - c[3], p[4]],
        ) else {
            return Err(DesignError::Singular);
        };
        let r = [r0, r1, r2];
        let s = [1.0, s1 - 1.0, -s1];
        let margins = margins(&a, &b, &r, &s, t, poles.estimator_delay_s);
        if !(margins.modulus >= LEAST_MODULUS) {
            return Err(DesignError::Margins);
        }
        let at_one = b1 + b2;
        Ok(Self {
            a,
            b,
            r,
            s,
            t: [
                p[0] / at_one,
                p[1] / at_one,
                p[2] / at_one,
                p[3] / at_one,
                p[4] / at_one,
            ],
            p,
            mechanical_pole: pm,
            electrical_pole: pa,
            regulation_pole: pole,
            tracking_pole: exp(-tau * poles.tracking.0 * t),
            margins,
        })
    }
}
