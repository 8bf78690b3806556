//! One equation per window: the weak form of one shaft's equation of motion.

use std::f64::consts::TAU;

use super::fit::Equation;
use super::motion::Motion;
use super::test_function::TestFunction;

/// Half of a window, s, and the fewest samples in it.
const HALF_S: f64 = 20e-3;
const FEWEST: usize = 8;
/// Distance between the beginnings of windows, relative to half a window.
const HOPS: usize = 3;
/// Travel from which effects with one period per turn are separable from constant ones, rad.
pub(super) const TURNS: f64 = 3.0 * TAU;
/// Travel from which friction and torque are assumed to vary with the angle, rad.
const VARIES: f64 = 0.5;

/// Samples in half a window at this sampling period.
pub(super) fn half_window(period_s: f64) -> usize {
    ((HALF_S / period_s).round() as usize).max(FEWEST)
}

/// Signals of one shaft in one recording.
pub(super) struct Shaft<'a> {
    pub(super) period_s: f64,
    pub(super) own: &'a Motion,
    /// Motion of the other shaft; `None` for a clamped handle.
    pub(super) other: Option<&'a Motion>,
    pub(super) current: &'a [f64],
    /// Periods of the torque ripple per turn.
    pub(super) ripple_per_rev: f64,
    /// Number of uneven steps of the clock before each sample.
    pub(super) breaks: &'a [usize],
    /// Whether to include a hand: spring and damper to the ground.
    pub(super) hand: bool,
}

/// Columns common to all recordings: slip, friction, offset, and those of the hand.
pub(super) const SLIP: usize = 1;
pub(super) const FRICTION: usize = 2;
pub(super) const OFFSET: usize = 3;
pub(super) const HAND: usize = 4;

/// Columns of effects that are periodic in the angle: friction and eccentricity of the disc with one
/// period per turn, torque with several.
const RIPPLES: usize = 8;
/// Index of the disc's first column among them.
const DISC: usize = 4;

/// Number of windows, and the equations of the usable ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Equations {
    pub(super) usable: Vec<Equation>,
    pub(super) windows: usize,
    /// Number of usable windows with mainly forward motion.
    pub(super) forward: usize,
}

impl Equations {
    /// Adds the equations of recording `index` of `recordings`. Each recording has its own ripple
    /// columns, because it has its own origin of the angles.
    pub(super) fn add(&mut self, shaft: &Shaft<'_>, index: usize, recordings: usize) {
        let half = half_window(shaft.period_s);
        let phi = TestFunction::new(half, shaft.period_s);
        let hop = (half / HOPS).max(1);
        let samples = shaft.own.angle.len();
        // Over less than a turn an error of the disc is not separable from motion.
        let ripples = match shaft.own.travel() {
            travel if travel > TURNS => RIPPLES,
            travel if travel > VARIES => DISC,
            _ => 0,
        };
        for start in (0..samples.saturating_sub(2 * half)).step_by(hop) {
            self.windows += 1;
            if let Some(mut window) = shaft.window(&phi, start) {
                let mut others = std::mem::take(&mut window.shared);
                for recording in 0..recordings {
                    let own = if recording == index { ripples } else { 0 };
                    let ripple = window.ripple.iter().enumerate();
                    others.extend(ripple.map(|(k, x)| if k < own { *x } else { 0.0 }));
                }
                self.forward += usize::from(others[FRICTION - 1] < 0.0);
                self.usable.push(Equation {
                    response: window.response,
                    drive: window.drive,
                    others,
                    other_moved: window.other_moved,
                    halved: window.halved,
                });
            }
        }
    }
}

/// The integrals over one window.
struct Window {
    response: f64,
    drive: [f64; super::test_function::LAG_TERMS],
    shared: Vec<f64>,
    ripple: [f64; RIPPLES],
    other_moved: f64,
    halved: Vec<f64>,
}

impl Shaft<'_> {
    /// The equation; `None` if the clock is uneven or the shaft reverses in the window.
    fn window(&self, phi: &TestFunction, start: usize) -> Option<Window> {
        let end = start + 2 * phi.half;
        if self.breaks[end] != self.breaks[start] {
            return None;
        }
        let angle = &self.own.angle[start..=end];
        let current = &self.current[start..end];
        // The time at which friction changes its sign in a reversal is too uncertain: an error of
        // 0.1 ms causes an error of 0.1 % of the inertia.
        let way = self.own.direction[start];
        let one_way = self.own.direction[start..=end].iter().all(|d| *d == way);
        if way == 0 || !one_way {
            return None;
        }
        let way = f64::from(way);
        // Displacements relative to the window, which do not lose precision in long recordings.
        let (origin, other_origin) = (angle[0], self.other.map_or(0.0, |o| o.angle[start]));
        let slip = |j: usize| {
            let other = self
                .other
                .map_or(0.0, |o| o.angle[start + j] - other_origin);
            angle[j] - origin - other
        };
        let sum = |weights: &[f64], f: &dyn Fn(usize) -> f64| -> f64 {
            weights.iter().enumerate().map(|(j, w)| w * f(j)).sum()
        };
        let moved = |j: usize| angle[j] - origin;
        let mut shared = vec![sum(&phi.first, &slip), -way, 1.0];
        let odd = |j: usize| self.own.odd(start + j);
        let odd_slip = |j: usize| odd(j) - self.other.map_or(0.0, |o| o.odd(start + j));
        let mut halved = vec![sum(&phi.second, &odd), sum(&phi.first, &odd_slip), 0.0, 0.0];
        if self.hand {
            shared.push(-sum(&phi.weight, &|j| angle[j]));
            shared.push(sum(&phi.first, &moved));
            halved.push(-sum(&phi.weight, &odd));
            halved.push(sum(&phi.first, &odd));
        }
        let middle = |j: usize| 0.5 * (angle[j] + angle[j + 1]) * self.ripple_per_rev;
        Some(Window {
            response: sum(&phi.second, &moved),
            drive: std::array::from_fn(|m| sum(&phi.increments[m], &|j| current[j])),
            shared,
            ripple: [
                -sum(&phi.weight, &|j| way * angle[j].sin()),
                -sum(&phi.weight, &|j| way * angle[j].cos()),
                sum(&phi.increments[0], &|j| current[j] * middle(j).sin()),
                sum(&phi.increments[0], &|j| current[j] * middle(j).cos()),
                // The disc's error is part of the response and of the slip.
                sum(&phi.second, &|j| angle[j].sin()),
                sum(&phi.second, &|j| angle[j].cos()),
                sum(&phi.first, &|j| angle[j].sin()),
                sum(&phi.first, &|j| angle[j].cos()),
            ],
            other_moved: sum(&phi.first, &|j| moved(j) - slip(j)),
            halved,
        })
    }
}
