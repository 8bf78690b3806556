//! Motion of the motor over one tick, with friction that can stop it inside the tick.

use crate::memory::memory;

/// The motor, discretised exactly for a drive that is constant over the tick, with `β = b T / J`:
/// ```text
/// φ0 = exp(-β)     φ1 = (1 - φ0) / β     φ2 = (1 - φ1) / β
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Motion {
    pub(super) phi0: f32,
    pub(super) phi1: f32,
    pub(super) phi2: f32,
    /// β: acceleration per slip velocity, counts/tick² per count/tick.
    pub(super) coupling: f32,
    /// Coulomb friction, counts/tick².
    pub(super) friction: f32,
}

memory!(Motion {
    phi0,
    phi1,
    phi2,
    coupling,
    friction
});

/// Motion over one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Displacement over the tick, counts.
    pub(super) moved: f32,
    /// Velocity at the end of the tick, counts/tick.
    pub(super) velocity: f32,
    /// Mean direction of motion over the tick, -1 to 1: friction acted against it.
    pub(super) direction: f32,
    /// Direction that friction acts against: that of the motion, or at rest that of the drive.
    pub(super) against: f32,
    /// Whether friction holds the rotor at the end of the tick.
    pub(super) stuck: bool,
}

/// Sign of `value`: -1, 0 or 1.
#[inline]
fn sign(value: f32) -> f32 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Whether `friction` holds a rotor at rest under `drive`, whose sign is `along`. A friction below zero,
/// which learning can find, holds it only where there is no drive.
#[inline]
fn holds(friction: f32, drive: f32, along: f32) -> bool {
    !(drive.abs() > friction) || along == 0.0
}

impl Motion {
    /// Motion over one tick from `velocity` under `drive`, the acceleration by all torques except
    /// friction and the damping of the motor's own velocity. `drive` and `friction` are in
    /// counts/tick².
    ///
    /// A rotor whose velocity would pass zero stops at the part `v / (v - v')` of the tick. It stays
    /// there unless the drive overcomes friction; then it accelerates during the rest of the tick. In
    /// a reversal friction therefore acts in both directions, each for its part of the tick.
    ///
    /// Damping acts during that rest too: over the part l of a tick φ1 is `φ1 / (φ1 + l (1 - φ1))`,
    /// which is exact at both ends. Without it a drive in proportion to the velocity, as that of an
    /// adapted damping, would increase the speed from `β = 4.6` on.
    #[inline(always)]
    pub(super) fn step(&self, velocity: f32, drive: f32, friction: f32) -> Step {
        let (direction, net) = if velocity > 0.0 {
            (1.0, drive - friction)
        } else if velocity < 0.0 {
            (-1.0, drive + friction)
        } else {
            let along = sign(drive);
            if holds(friction, drive, along) {
                return Step {
                    moved: 0.0,
                    velocity: 0.0,
                    direction: 0.0,
                    against: along,
                    stuck: true,
                };
            }
            (along, drive - along * friction)
        };
        let end = self.phi0 * velocity + self.phi1 * net;
        if end * direction > 0.0 {
            return Step {
                moved: self.phi1 * velocity + self.phi2 * net,
                velocity: end,
                direction,
                against: direction,
                stuck: false,
            };
        }
        // From rest only by underflow, where the rotor stays as good as there.
        let part = if velocity == end {
            0.0
        } else {
            velocity / (velocity - end)
        };
        let stopped = 0.5 * part * velocity;
        let along = sign(drive);
        if holds(friction, drive, along) {
            return Step {
                moved: stopped,
                velocity: 0.0,
                direction: direction * part,
                against: along,
                stuck: true,
            };
        }
        let left = 1.0 - part;
        let shorter = self.phi1 + left * (1.0 - self.phi1);
        let away = left * (drive - along * friction) * (self.phi1 / shorter);
        let direction = direction * part + along * left;
        Step {
            moved: stopped + 0.5 * left * away,
            velocity: away,
            direction,
            against: direction,
            stuck: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Motion, Step};

    const MOTION: Motion = Motion {
        phi0: 1.0,
        phi1: 1.0,
        phi2: 0.5,
        coupling: 0.0,
        friction: 2.0,
    };

    fn step(velocity: f32, drive: f32) -> Step {
        MOTION.step(velocity, drive, MOTION.friction)
    }

    #[test]
    fn friction_slows_stops_and_lets_go() {
        // Slows: -2 a tick.
        let slowed = step(3.0, 0.0);
        assert_eq!((slowed.moved, slowed.velocity), (2.0, 1.0));
        // Stops half-way: 1 / 2 of a tick at a mean of 1 / 2.
        let stopped = step(1.0, 0.0);
        assert_eq!((stopped.moved, stopped.velocity), (0.25, 0.0));
        assert!(stopped.stuck && stopped.direction == 0.5);
        // Rests under any drive up to friction, and leaves above it.
        assert!(step(0.0, 2.0).stuck && step(0.0, -2.0).stuck);
        let left = step(0.0, 3.0);
        assert_eq!((left.moved, left.velocity, left.direction), (0.5, 1.0, 1.0));
    }

    /// Learning can find a friction below zero. The rotor leaves along the drive, and rests without one.
    #[test]
    fn friction_below_zero_does_not_choose_the_direction() {
        for (velocity, drive) in [(0.0, 1.0), (0.0, -1.0), (0.1, -3.0), (-0.1, 3.0)] {
            let left = MOTION.step(velocity, drive, -0.5);
            assert!(left.velocity * drive > 0.0, "{velocity} {drive}: {left:?}");
        }
        assert!(MOTION.step(0.0, 0.0, -0.5).stuck);
    }

    /// What friction acts against at the end of a tick: the motion, the drive of a rotor that has
    /// stopped, or nothing.
    #[test]
    fn friction_acts_against_motion_or_drive() {
        for (velocity, drive, against, stuck) in [
            (3.0, 0.5, 1.0, false),
            (3.0, -0.5, 1.0, false),
            (-3.0, 0.5, -1.0, false),
            // Stopped inside the tick: what would move the rotor counts, not where it came from.
            (1.0, 0.5, 1.0, true),
            (1.0, -0.5, -1.0, true),
            (-1.0, 0.5, 1.0, true),
            (-1.0, -0.5, -1.0, true),
            (1.0, 0.0, 0.0, true),
            (0.0, 0.5, 1.0, true),
            (0.0, -0.5, -1.0, true),
            (0.0, 0.0, 0.0, true),
            (0.0, 2.5, 1.0, false),
            (0.0, -2.5, -1.0, false),
        ] {
            let after = step(velocity, drive);
            assert_eq!(
                (after.against, after.stuck),
                (against, stuck),
                "{velocity} {drive}"
            );
        }
        // After a reversal half-way both directions count as long as they lasted.
        let turned = step(1.5, -4.0);
        assert_eq!((turned.direction, turned.against), (-0.5, -0.5));
    }

    #[test]
    fn reversal_has_friction_in_both_directions() {
        // From 2.5 under -3: stops after half a tick at 5 a tick², leaves at 1 a tick².
        let turned = step(2.5, -3.0);
        assert_eq!((turned.moved, turned.velocity), (0.625 - 0.125, -0.5));
        assert_eq!(turned.direction, 0.0);
        let mirrored = step(-2.5, 3.0);
        assert_eq!((mirrored.moved, mirrored.velocity), (-0.5, 0.5));
    }

    #[test]
    fn rotor_leaves_with_damping() {
        for beta in [0.01f64, 0.1, 1.0, 3.0, 7.9] {
            let phi0 = (-beta).exp();
            let phi1 = (1.0 - phi0) / beta;
            let motion = Motion {
                phi0: phi0 as f32,
                phi1: phi1 as f32,
                phi2: ((1.0 - phi1) / beta) as f32,
                coupling: beta as f32,
                friction: 0.0,
            };
            // A drive against the motion, as that of a damping that is 60 % larger, never leaves
            // more velocity than there was.
            let turned = motion.step(100.0, -60.0 * beta as f32, 0.0).velocity;
            assert!((-60.0..100.0).contains(&turned), "β = {beta}: {turned}");
            // A rotor that turns at once has the whole tick: v' = φ1 drive, its limit drive / β.
            let whole = motion.step(1e-4, -10.0, 0.0).velocity;
            assert!(
                (f64::from(whole) / (-10.0 * phi1) - 1.0).abs() < 1e-4,
                "{whole}"
            );
            // One that turns inside the tick has the rest l of it, by v' = φ1(β l) l drive to 10 %.
            let drive = -2.0 * (beta + 1.0);
            let end = phi0 + phi1 * drive;
            let left = end / (end - 1.0);
            let turned = f64::from(motion.step(1.0, drive as f32, 0.0).velocity);
            let exact = drive * (1.0 - (-beta * left).exp()) / beta;
            assert!(
                (turned / exact - 1.0).abs() < 0.1,
                "β = {beta}: {turned} for {exact}"
            );
        }
    }
}
