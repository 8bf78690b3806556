//! A controller of the small motor that knows the device and the hand: the least parasitic force that any
//! controller leaves.
//!
//! At each tick it knows angle, velocity and current of both motors, all constants, the ripple, the hand and
//! the scene. It simulates the coming tick and takes the current of the small motor for which the parasitic
//! torque at the next tick is zero. Period, amplifier lag, limits of the current and DAC are those of the
//! device.

use estimator_core::Amps;
use haptic_control::{
    Handle, HandleFor, Need, NewtonMetres, RadPerS, RadPerS2, Radians, Rig, Scene, TransientState,
};
use simulation::device::Device;
use simulation::plant::{Grip, HandMotion, HandleTorques, Plant, Pose};

/// What the controller of the small motor knows of the coming tick, and what it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Oracle {
    /// It knows the hand up to the tick: its angle and its velocity, but no change of this velocity. It takes
    /// off every torque but the inertia of the handle.
    InertiaLeft,
    /// It knows the hand up to the tick, as above. It takes off every torque.
    Present,
    /// It knows the motion of the hand until the next tick. It takes off every torque.
    NextTick,
}

/// Bisections of the range of the small motor's current, which is 4095 steps of the DAC: to 1/32 of a step.
const BISECTIONS: u32 = 17;

/// An oracle in a run.
pub(super) struct Foresight<'a, S: Scene> {
    oracle: Oracle,
    scene: S,
    state: S::State,
    rig: &'a Rig,
    limited: TransientState,
    /// Angle of the handle at the start, rad.
    origin: f64,
    period: f64,
    steps: u32,
    inertia: f64,
    torque_constant: f64,
    limit: f64,
}

/// The device at a tick.
#[derive(Clone, Copy)]
pub(super) struct Present<'a> {
    pub(super) plant: &'a Plant,
    /// The hand during the tick that begins.
    pub(super) grip: &'a Grip,
    /// Current commanded to the large motor during this tick, A.
    pub(super) large_a: f64,
}

impl<'a, S: Scene> Foresight<'a, S> {
    /// At rest, with ticks of `steps` steps of the plant.
    pub(super) fn new(
        oracle: Oracle,
        scene: S,
        device: &Device,
        rig: &'a Rig,
        (origin, period, steps): (f64, f64, u32),
    ) -> Self {
        Self {
            oracle,
            state: scene.start(Radians(0.0)),
            scene,
            rig,
            limited: rig.transient.start(),
            origin,
            period,
            steps,
            inertia: device.stages.small.inertia,
            torque_constant: device.stages.small.torque_constant,
            limit: device.stages.small.current_limit,
        }
    }

    /// Torque that the scene wants for the true motion of the handle, N.m. The state of the scene moves on by
    /// a tick.
    pub(super) fn wanted(&mut self, pose: Pose, torques: &HandleTorques) -> f64 {
        let handle = self.handle(pose, torques);
        f64::from(self.scene.torque(&mut self.state, &handle).0)
    }

    fn handle(&self, pose: Pose, torques: &HandleTorques) -> HandleFor<S> {
        let acceleration = -torques.inertia / self.inertia;
        Handle {
            angle: Radians((pose.angle - self.origin) as f32),
            velocity: S::Velocity::make(|| RadPerS(pose.omega as f32)),
            acceleration: S::Acceleration::make(|| RadPerS2(acceleration as f32)),
        }
    }

    /// Current of the small motor within its limits, A, after [`Self::wanted`] of this tick.
    pub(super) fn current(&mut self, now: Present<'_>) -> Amps {
        let expected = self.expected(now.grip);
        let now = Present {
            grip: &expected,
            ..now
        };
        let wanted = match self.oracle {
            Oracle::InertiaLeft => self.current_in_direction(now),
            Oracle::Present | Oracle::NextTick => {
                self.zero(|current| self.next_tick(now, current).parasitic())
            }
        };
        let torque = NewtonMetres((wanted * self.torque_constant) as f32);
        self.rig.transient.update(&mut self.limited, torque)
    }

    /// Parasitic torque that the oracle expects at the next tick for this current, N.m.
    pub(super) fn parasitic(&self, now: Present<'_>, small_a: f64) -> f64 {
        let expected = self.expected(now.grip);
        let now = Present {
            grip: &expected,
            ..now
        };
        self.next_tick(now, small_a).parasitic()
    }

    /// What the oracle knows of the hand during the tick that begins.
    fn expected(&self, grip: &Grip) -> Grip {
        match (self.oracle, grip) {
            (Oracle::InertiaLeft | Oracle::Present, Grip::Hand(motion)) => {
                let from = motion.at(0.0);
                let to = Pose {
                    angle: from.angle + self.period * from.omega,
                    ..from
                };
                Grip::Hand(HandMotion::between(from, to, self.period))
            }
            _ => *grip,
        }
    }

    fn next_tick(&self, now: Present<'_>, small_a: f64) -> NextTick {
        let mut plant = now.plant.clone();
        plant.command(now.large_a, small_a);
        let step = self.period / f64::from(self.steps);
        for j in 0..self.steps {
            plant.step(now.grip, f64::from(j) * step, 0.0);
        }
        let torques = plant.handle_torques(now.grip, self.period);
        let handle = self.handle(plant.small(), &torques);
        let wanted = self.scene.torque(&mut self.state.clone(), &handle);
        NextTick {
            omega: plant.small().omega,
            friction: plant.small_friction(),
            torques,
            wanted: f64::from(wanted.0),
        }
    }

    /// The current for which all torques but the inertia are the wanted one at the next tick. Friction takes
    /// the direction of the motion then, which depends on the current: the direction of this tick comes
    /// first, at rest that in which the hand pushes.
    fn current_in_direction(&self, now: Present<'_>) -> f64 {
        let against_friction = |direction: f64| {
            self.zero(|current| self.next_tick(now, current).without_inertia(direction))
        };
        let pose = now.plant.small();
        let push = -now.plant.handle_torque(now.grip, 0.0);
        let first = if pose.omega == 0.0 { push } else { pose.omega }.signum();
        let current = against_friction(first);
        if first * self.next_tick(now, current).omega > 0.0 {
            return current;
        }
        against_friction(-first)
    }

    /// The current at which a torque that rises with it is zero, or the limit nearest to it, A.
    fn zero(&self, torque: impl Fn(f64) -> f64) -> f64 {
        let (mut low, mut high) = (-self.limit, self.limit);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if torque(middle) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// The device at the next tick.
struct NextTick {
    omega: f64,
    friction: f64,
    torques: HandleTorques,
    wanted: f64,
}

impl NextTick {
    /// N.m.
    fn parasitic(&self) -> f64 {
        self.torques.felt - self.wanted
    }

    /// Torques of motor and coupler, less the wanted one and less the friction of a motion in this
    /// direction, N.m.
    fn without_inertia(&self, direction: f64) -> f64 {
        let HandleTorques {
            motor,
            ripple,
            coupler,
            ..
        } = self.torques;
        motor + ripple + coupler - direction * self.friction - self.wanted
    }
}
