//! One equation a window: the weak form of one shaft's equation of motion.

use std::f64::consts::TAU;

use super::fit::Equation;
use super::motion::Motion;
use super::test_function::TestFunction;

/// Half of a window, s, and the fewest samples in it.
const HALF_S: f64 = 20e-3;
const FEWEST: usize = 8;
/// Windows begin this part of their half apart.
const HOPS: usize = 3;
/// Travel from which what repeats once a turn can be told from what is constant, rad.
pub(super) const TURNS: f64 = 3.0 * TAU;
/// Travel from which friction and torque are taken to vary at all, rad.
const VARIES: f64 = 0.5;

/// One shaft over one recording.
pub(super) struct Shaft<'a> {
    pub(super) period_s: f64,
    pub(super) own: &'a Motion,
    /// The other shaft, or a handle that is held fast.
    pub(super) other: Option<&'a Motion>,
    pub(super) current: &'a [f64],
    /// Periods of the torque's ripple a turn.
    pub(super) ripple_per_rev: f64,
    /// Bad steps of the clock before each sample.
    pub(super) breaks: &'a [usize],
    /// Whether to ask for a hand: a spring and a damper to the ground.
    pub(super) hand: bool,
}

/// Columns that every recording shares: slip, friction, offset, and those of the hand.
pub(super) const SLIP: usize = 1;
pub(super) const FRICTION: usize = 2;
pub(super) const OFFSET: usize = 3;
pub(super) const HAND: usize = 4;

/// Columns of what repeats: friction and the disc's eccentricity once a turn, torque more often.
const RIPPLES: usize = 8;
/// The first of the disc's among them.
const DISC: usize = 4;

/// Windows that there are, and those of them whose equation can be used.
#[derive(Clone, Debug, Default)]
pub(super) struct Equations {
    pub(super) usable: Vec<Equation>,
    pub(super) windows: usize,
    /// Among the usable: those that turn forward for the most part.
    pub(super) forward: usize,
}

impl Equations {
    /// Adds those of recording `index` of `recordings`; each has ripple columns of its own, because
    /// its angles have an origin of their own.
    pub(super) fn add(&mut self, shaft: &Shaft<'_>, index: usize, recordings: usize) {
        let half = ((HALF_S / shaft.period_s).round() as usize).max(FEWEST);
        let phi = TestFunction::new(half, shaft.period_s);
        let hop = (half / HOPS).max(1);
        let samples = shaft.own.angle.len();
        // Over less than a turn a disc's error looks like motion.
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
}

impl Shaft<'_> {
    /// `None` where the clock is uneven or the shaft does not turn one way all the time.
    fn window(&self, phi: &TestFunction, start: usize) -> Option<Window> {
        let end = start + 2 * phi.half;
        if self.breaks[end] != self.breaks[start] {
            return None;
        }
        let angle = &self.own.angle[start..=end];
        let current = &self.current[start..end];
        // Where in a reversal friction changes its sign is not known well enough: even 0.1 ms
        // would cost 0.1 % of the inertia.
        let way = self.own.direction[start];
        let one_way = self.own.direction[start..=end].iter().all(|d| *d == way);
        if way == 0 || !one_way {
            return None;
        }
        let way = f64::from(way);
        // Displacements inside the window, so that long recordings lose nothing.
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
        if self.hand {
            shared.push(-sum(&phi.weight, &|j| angle[j]));
            shared.push(sum(&phi.first, &moved));
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
                // The disc's error is in the response and in the slip.
                sum(&phi.second, &|j| angle[j].sin()),
                sum(&phi.second, &|j| angle[j].cos()),
                sum(&phi.first, &|j| angle[j].sin()),
                sum(&phi.first, &|j| angle[j].cos()),
            ],
        })
    }
}
