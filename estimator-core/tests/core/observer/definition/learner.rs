//! Adaptation of the parameters, by definition.

use nalgebra::{Matrix3, Vector3};

/// Adapted parameters of a [`Definition`].
pub(in super::super) struct Learner {
    pub(in super::super) parameters: Vector3<f64>,
    /// A column each for damping, friction and torque constant.
    pub(in super::super) sensitivity: Matrix3<f64>,
    pub(in super::super) p: Matrix3<f64>,
    pub(in super::super) span: Span,
    pub(in super::super) waiting: f64,
    pub(in super::super) age: f64,
    /// Whether the start is over, and whether it showed motion.
    pub(in super::super) over: bool,
    pub(in super::super) in_motion: bool,
}

/// The errors that are learned.
pub(in super::super) struct Span {
    /// Standard deviations at the start.
    pub(in super::super) prior: [f64; 3],
    pub(in super::super) least: [f64; 3],
    pub(in super::super) most: [f64; 3],
    /// The friction that the second error is a part of.
    pub(in super::super) friction: f64,
    /// Whether the model may be so wrong that it moves unlike the motor.
    pub(in super::super) wide: bool,
}

impl Span {
    pub(super) fn narrow(friction: f64) -> Self {
        Self {
            prior: [0.35, 0.6, 0.35],
            least: [-0.6, -0.9, -0.6],
            most: [0.6, 0.9, 0.6],
            friction,
            wide: false,
        }
    }

    /// For a model that decays to `left` of its velocity in a tick.
    pub(super) fn wide(friction: f64, load: f64, left: f64) -> Self {
        let unit = friction.max(load);
        Self {
            prior: [1.0; 3],
            least: [-0.95, -friction / unit, -20.0],
            most: [(left / (1.0 - left)).clamp(0.6, 20.0), 20.0, 20.0],
            friction: unit,
            wide: true,
        }
    }
}

/// `U D Uᵀ` with a unit upper triangle U: the elements of D, and U.
pub(in super::super) fn factors(p: &Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let mut u = Matrix3::identity();
    let d2 = p[(2, 2)];
    u[(0, 2)] = p[(0, 2)] / d2;
    u[(1, 2)] = p[(1, 2)] / d2;
    let d1 = p[(1, 1)] - u[(1, 2)].powi(2) * d2;
    u[(0, 1)] = (p[(0, 1)] - u[(0, 2)] * u[(1, 2)] * d2) / d1;
    let d0 = p[(0, 0)] - u[(0, 1)].powi(2) * d1 - u[(0, 2)].powi(2) * d2;
    (Vector3::new(d0, d1, d2), u)
}

impl Learner {
    pub(super) fn new(span: Span) -> Self {
        Self {
            parameters: Vector3::zeros(),
            sensitivity: Matrix3::zeros(),
            p: Matrix3::from_diagonal(&Vector3::from(span.prior.map(|sigma| sigma * sigma))),
            span,
            waiting: 0.0,
            age: 0.0,
            over: false,
            in_motion: false,
        }
    }

    /// Whether the start was in motion and is not over.
    pub(super) fn is_moving(&self) -> bool {
        self.in_motion && !self.over
    }

    /// The gain of the velocity instead of `gain`, if this innovation belongs to a start in motion.
    pub(super) fn starting(&mut self, e: f64, gap: f64, gain: f64, v: f64) -> Option<f64> {
        if self.over || gap == 0.0 {
            return None;
        }
        self.age += gap;
        if self.age >= 1.0 / gain {
            self.over = true;
            return None;
        }
        if !self.in_motion {
            if e.abs() <= 0.5 + 0.6 * v.abs() * gap {
                return None;
            }
            self.in_motion = true;
            self.age = gap;
        }
        Some(1.0 / self.age.max(1.0))
    }
}
