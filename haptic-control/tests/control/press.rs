//! A hand that presses with up to 10 N on every scene, against a plant in f64.

use std::f64::consts::TAU;

use estimator_core::{
    Count, Hertz, Model, NoInput, Sample, SteadyKalman, SteadyKalmanTriple, preset,
};
use haptic_control::{
    AnyScene, Currents, DualStage, LoopPoles, Monitor, Rig, SceneKind, Stop, Switchboard, Torque,
    Windings, WindingsState,
};

const RATE: Hertz = Hertz(10e3);
const DEVICE: DualStage = DualStage::DEFAULT;
const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));
const SLOW: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.large.counts_per_rev,
    RATE,
    1e4
));
const LARGE: SteadyKalmanTriple = preset!(SteadyKalman::new(&SLOW));
const FAST: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.small.counts_per_rev,
    RATE,
    4e3
));
const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&FAST));
const MONITOR: Monitor = Monitor::new(&DEVICE, RATE);
const WINDINGS: Windings = Windings::new(&DEVICE, RATE);

/// All scenes; the torque that is set is all that the small motor makes.
fn scenes() -> [AnyScene; SceneKind::ALL.len()] {
    let set = Torque::new((DEVICE.small.torque_constant * DEVICE.small.current_limit) as f32);
    AnyScene::usual(&DEVICE, RATE)
        .unwrap()
        .map(|scene| match scene {
            AnyScene::Torque(_) => AnyScene::Torque(set.unwrap()),
            scene => scene,
        })
}

/// Both shafts behind their amplifiers, with the coupler between them.
struct Plant {
    device: DualStage,
    angle: [f64; 2],
    omega: [f64; 2],
    current: [f64; 2],
}

impl Plant {
    /// A tick with these commands and a torque of the hand's on the handle.
    fn tick(&mut self, commands: [f64; 2], hand: impl Fn(f64, f64) -> f64) {
        const STEPS: u32 = 20;
        let h = RATE.period_s() / f64::from(STEPS);
        let motors = [self.device.large, self.device.small];
        let lag = 1.0 - (-TAU * self.device.amplifier_bandwidth.0 * h).exp();
        for _ in 0..STEPS {
            let slip = self.device.damping * (self.omega[0] - self.omega[1]);
            let outside = [-slip, slip + hand(self.angle[1], self.omega[1])];
            for i in 0..2 {
                self.current[i] += lag * (commands[i] - self.current[i]);
                let torque = outside[i] + motors[i].torque_constant * self.current[i];
                let moved = self.omega[i] + h * torque / motors[i].inertia;
                // Coulomb friction takes velocity away, and at most all of it.
                let friction = h * motors[i].coulomb_friction / motors[i].inertia;
                self.omega[i] = moved - moved.clamp(-friction, friction);
                self.angle[i] += h * self.omega[i];
            }
        }
    }

    fn sample(&self, current: Currents) -> Sample {
        let [large, small] = [
            (self.angle[0], self.device.large.counts_per_rev),
            (self.angle[1], self.device.small.counts_per_rev),
        ]
        .map(|(angle, counts)| Count((angle / TAU * f64::from(counts)).floor() as i64 as u32));
        Sample::new(large)
            .with_coupled(small)
            .with_current(current.large)
    }
}

/// Radius of the handle, m, and the hand's largest force, N.
const RADIUS: f64 = 0.035;
const FORCE: f64 = 10.0;

/// A hand of 0.5 N·m/rad that moves to `angle` along a curve of least jerk, rests there and comes
/// back. Its force is at most 10 N.
#[derive(Clone, Copy)]
struct Hand {
    angle: f64,
}

impl Hand {
    /// Time of the last instant at which the hand rests, s.
    const RESTED: f64 = 1.0;

    /// Angle and velocity that the hand intends at `t`.
    fn intent(self, t: f64) -> (f64, f64) {
        let (x, sign) = if t < Self::RESTED {
            ((t / 0.5).min(1.0), 1.0)
        } else {
            (1.0 - ((t - Self::RESTED) / 0.5).min(1.0), -1.0)
        };
        let slope = 30.0 * x * x * (1.0 - x) * (1.0 - x) / 0.5;
        let share = x * x * x * (10.0 - x * (15.0 - 6.0 * x));
        (self.angle * share, sign * self.angle * slope)
    }

    /// Torque on the handle, N·m.
    fn torque(self, t: f64, angle: f64, omega: f64) -> f64 {
        let (wanted, speed) = self.intent(t);
        let torque = 0.5 * (wanted - angle) + 3e-3 * (speed - omega);
        torque.clamp(-FORCE * RADIUS, FORCE * RADIUS)
    }
}

/// Result of a press.
#[derive(Debug, Default)]
struct Pressed {
    stopped: Option<Stop>,
    /// Torque of the hand at the end of its rest, N·m.
    resting: f64,
    /// Velocity of the large motor farthest to either side, rad/s.
    fastest: f64,
}

fn press(device: DualStage, scene: AnyScene, hand: Hand) -> Pressed {
    let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
    let mut plant = Plant {
        device,
        angle: [0.0; 2],
        omega: [0.0; 2],
        current: [0.0; 2],
    };
    let mut sample = plant.sample(Currents::default());
    let mut state = board.start(&sample);
    let mut watch = MONITOR.start(&sample);
    let mut windings = WindingsState::cold();
    board.select(&mut state, scene, &sample);
    let mut pressed = Pressed::default();
    for k in 0..18_000 {
        let currents = board.step(&mut state, &sample).currents;
        let overload = WINDINGS.check(&mut windings, &currents);
        pressed.stopped = MONITOR.check(&mut watch, &sample).or(overload);
        if pressed.stopped.is_some() {
            return pressed;
        }
        let t = f64::from(k) * RATE.period_s();
        if t < Hand::RESTED {
            pressed.resting = hand.torque(t, plant.angle[1], plant.omega[1]);
        }
        let amps = [currents.large, currents.small].map(|amps| f64::from(amps.get()));
        plant.tick(amps, |angle, omega| hand.torque(t, angle, omega));
        if plant.omega[0].abs() > pressed.fastest.abs() {
            pressed.fastest = plant.omega[0];
        }
        sample = plant.sample(currents);
    }
    pressed
}

/// 10 N on a handle that stays where the wall begins, and a good deal beyond.
const HANDS: [Hand; 2] = [Hand { angle: 0.8 }, Hand { angle: 2.0 }];

#[test]
fn a_press_of_10_n_stops_no_scene() {
    for scene in scenes() {
        for hand in HANDS {
            let pressed = press(DEVICE, scene, hand);
            assert_eq!(pressed.stopped, None, "{scene:?}: {pressed:?}");
        }
    }
}

#[test]
fn press_on_a_device_with_other_constants_stops_no_scene() {
    // Torque constant, damping and inertia of the large motor and its coupler, as factors.
    for [constant, damping, inertia] in [[1.2, 1.0, 1.0], [1.2, 0.7, 0.85], [0.8, 1.3, 1.15]] {
        let mut device = DEVICE;
        device.large.torque_constant *= constant;
        device.damping *= damping;
        device.large.inertia *= inertia;
        for scene in scenes() {
            for hand in HANDS {
                let pressed = press(device, scene, hand);
                assert_eq!(pressed.stopped, None, "{constant} {scene:?}: {pressed:?}");
            }
        }
    }
}

#[test]
fn spring_renders_the_largest_torque_within_the_speed_limit() {
    // 85 % of the speed at which the monitor stops the large motor, and all of the small motor's
    // current.
    let coupler = 0.85 * 150.0 * DEVICE.damping;
    let both = coupler + DEVICE.small.current_limit * DEVICE.small.torque_constant;
    for (scene, stiffness, start) in [(2, 0.30, 0.1), (3, 0.10, 0.0), (7, 0.20, 0.0)] {
        for hand in HANDS {
            // Where the springs of hand and scene are in balance.
            let spring = 0.5 * stiffness / (0.5 + stiffness) * (hand.angle - start);
            let wanted = spring.min(both);
            let pressed = press(DEVICE, scenes()[scene], hand);
            // Within the friction of the handle.
            let off = (pressed.resting - wanted).abs();
            assert!(off < 0.9e-3, "{scene}: {pressed:?}, {wanted} N.m");
            // The motor follows what is wanted without overshoot.
            let speed = wanted.min(coupler) / DEVICE.damping;
            assert!(pressed.fastest < 0.0, "{scene}: {pressed:?}");
            assert!(pressed.fastest > -speed - 5.0, "{scene}: {pressed:?}");
        }
    }
}
