//! Reported variances of the estimators against their errors on a motor with the noise of their
//! design, simulated in steps far shorter than a tick, in SI units, without a matrix.

use estimator_core::{
    Amps, ClockTicks, Confidence, Count, CoupledMotor, Edge, Hertz, Kalman, Model, MotorModel,
    Observer, ObserverDesign, Sample, SteadyKalman, Uncertainty,
};
use std::f64::consts::TAU;

use crate::motion::Draws;

const CLOCK: Hertz = Hertz(84e6);
const RATE: Hertz = Hertz(1000.0);
const STEPS: u32 = 8;
const DT: f64 = 1.0 / (1000.0 * STEPS as f64);

/// Gaussian, of variance 1.
fn gauss(draws: &mut Draws) -> f64 {
    let radius = (-2.0 * (0.5 + 0.5 * draws.unit()).max(1e-300).ln()).sqrt();
    radius * (TAU * 0.5 * draws.unit()).cos()
}

/// An encoder whose boundaries lie off by a Gaussian error of this deviation, counts.
struct Disc(f64);

impl Disc {
    fn boundary(&self, k: i64) -> f64 {
        let mut draws = Draws((k as u64).wrapping_mul(0xD134_2543_DE82_EF95) ^ 99);
        k as f64 + self.0 * gauss(&mut draws)
    }

    fn count(&self, position: f64) -> i64 {
        let k = position.floor() as i64;
        if position < self.boundary(k) {
            k - 1
        } else if position >= self.boundary(k + 1) {
            k + 1
        } else {
            k
        }
    }
}

/// Acceleration of the rotor over the next step, rad/s².
trait Drive {
    /// The current that is commanded for the next tick.
    fn tick(&mut self) -> f64;
    fn acceleration(&mut self, omega: f64) -> f64;
}

/// Samples, and the velocity at each in counts a tick.
fn simulated(
    mut drive: impl Drive,
    disc: &Disc,
    counts_per_rev: u32,
    omega: f64,
    ticks: usize,
) -> Vec<(Sample, f64)> {
    let per_rad = f64::from(counts_per_rev) / TAU;
    let (mut angle, mut omega) = (0.3 / per_rad, omega);
    let (mut edge, mut current) = (None, 0.0);
    let mut from = disc.count(angle * per_rad);
    let mut all = Vec::with_capacity(ticks);
    for tick in 0..ticks {
        let now = tick as f64 * f64::from(STEPS);
        let mut sample = Sample::new(Count(from as u32)).with_current(Amps::new(current as f32));
        if let Some((at, boundary)) = edge {
            let age: f64 = (now - at) * DT * CLOCK.0;
            sample = sample.with_edge(Edge {
                boundary: Count(boundary as u32),
                age: ClockTicks(age as u32),
            });
        }
        all.push((sample, omega * per_rad / RATE.0));
        current = drive.tick();
        for step in 0..STEPS {
            let before = angle * per_rad;
            let end = omega + DT * drive.acceleration(omega);
            angle += DT * (omega + end) / 2.0;
            omega = end;
            let after = angle * per_rad;
            let to = disc.count(after);
            if from != to {
                let crossed = from.max(to);
                let part = (disc.boundary(crossed) - before) / (after - before);
                edge = Some((now + f64::from(step) + part, crossed));
                from = to;
            }
        }
    }
    all
}

/// A motor with a current that steps, damping, a white torque and a slow unknown one.
struct Motor {
    device: CoupledMotor,
    unsure: Uncertainty,
    mean: f64,
    current: f64,
    disturbance: f64,
    draws: Draws,
}

impl Drive for Motor {
    fn tick(&mut self) -> f64 {
        let left = (-1.0 / (RATE.0 * self.unsure.disturbance_time)).exp();
        let new = self.unsure.disturbance * (1.0 - left * left).sqrt();
        self.disturbance = left * self.disturbance + new * gauss(&mut self.draws);
        if self.draws.bits() % 50 == 0 {
            self.current = self.mean + 0.02 * self.draws.unit();
        }
        self.current
    }

    fn acceleration(&mut self, omega: f64) -> f64 {
        let white = self.unsure.torque_noise / DT.sqrt() * gauss(&mut self.draws);
        let motor = &self.device.motor;
        let torque =
            motor.torque_constant * self.current - motor.damping * omega + self.disturbance;
        (torque + white) / motor.inertia
    }
}

/// Mean of the squared error over the reported variance, over samples before a change of the count.
/// The variance of an observer is that before the correction that is due.
fn ratio<E>(estimator: &E, samples: &[(Sample, f64)]) -> f64
where
    E: Confidence,
{
    let mut state = estimator.start(&samples[0].0);
    let (mut sum, mut terms) = (0.0, 0u32);
    for (k, pair) in samples.windows(2).enumerate() {
        let ((sample, truth), (next, _)) = (pair[0], pair[1]);
        if k == 0 {
            continue;
        }
        let velocity = estimator.update(&mut state, &sample);
        if k >= 1000 && next.count != sample.count {
            let error = f64::from(velocity.0) - truth;
            sum += error * error / f64::from(estimator.variance(&state).0);
            terms += 1;
        }
    }
    sum / f64::from(terms)
}

/// A device without friction and lag, with this number of counts per revolution.
fn device(counts_per_rev: u32) -> CoupledMotor {
    CoupledMotor {
        motor: MotorModel {
            counts_per_rev,
            ..MotorModel::DCX35L
        },
        coulomb_friction: 0.0,
        amplifier_lag: 0.0,
        coupled_counts_per_rev: 4096,
    }
}

const UNSURE: Uncertainty = Uncertainty {
    torque_noise: 1e-5,
    disturbance: 3e-4,
    disturbance_time: 0.1,
    friction_share: 0.0,
    boundary_noise: 0.0625,
};

/// The mean velocity is 20 rad/s forward, and the noise is random.
const OMEGA: f64 = 20.0;
const TICKS: usize = 200_000;

fn motor(counts_per_rev: u32, unsure: Uncertainty) -> Vec<(Sample, f64)> {
    let device = device(counts_per_rev);
    let mean = device.motor.damping * OMEGA / device.motor.torque_constant;
    let drive = Motor {
        device,
        unsure,
        mean,
        current: mean,
        disturbance: 0.0,
        draws: Draws(4),
    };
    simulated(
        drive,
        &Disc(unsure.boundary_noise),
        counts_per_rev,
        OMEGA,
        TICKS,
    )
}

/// A motor whose current has an independent error at each tick.
struct NoisyCurrent {
    device: MotorModel,
    mean: f64,
    noise: f64,
    draws: Draws,
    acts: f64,
}

impl Drive for NoisyCurrent {
    fn tick(&mut self) -> f64 {
        self.acts = self.mean + self.noise * gauss(&mut self.draws);
        self.mean
    }

    fn acceleration(&mut self, omega: f64) -> f64 {
        (self.device.torque_constant * self.acts - self.device.damping * omega)
            / self.device.inertia
    }
}

/// A white jerk, rad/s³/√Hz.
struct Jerk {
    density: f64,
    acceleration: f64,
    draws: Draws,
}

impl Drive for Jerk {
    fn tick(&mut self) -> f64 {
        0.0
    }

    fn acceleration(&mut self, _: f64) -> f64 {
        self.acceleration += self.density * DT.sqrt() * gauss(&mut self.draws);
        self.acceleration
    }
}

/// Errors of 200 000 ticks that an estimator remembers some 100 of: the mean is good to about 3 %.
/// The rest is what a count and an edge are beyond the model's white error of a boundary.
#[track_caller]
fn assert_calibrated(found: f64, what: &str) {
    assert!((found - 1.0).abs() < 0.15, "{what}: {found}");
}

#[test]
fn errors_of_observers_have_their_standard_deviation_with_matching_noise() {
    // 0.1, 0.3 and 1.3 counts a tick.
    for counts_per_rev in [40, 100, 400] {
        let device = device(counts_per_rev);
        let edges = |unsure| {
            let edges = ObserverDesign::new(&device, RATE, unsure).with_edges(CLOCK);
            edges.build().expect("valid")
        };
        let samples = motor(counts_per_rev, UNSURE);
        let what = |name: &str| format!("{name}, {counts_per_rev} counts");
        assert_calibrated(
            ratio(&edges(&UNSURE), &samples),
            &what("edges, disturbance"),
        );
        // Without time stamps the instant of a crossing inside its tick is unknown, which matters
        // with a disturbance; and the covariance of the quantised update contains no disturbance.
        let unsure = Uncertainty {
            disturbance: 1e-5,
            ..UNSURE
        };
        let samples = motor(counts_per_rev, unsure);
        let counts = Observer::new(&device, RATE, &unsure).expect("valid");
        let quantised = ObserverDesign::quantised(&device, RATE, &unsure);
        let quantised = quantised.build().expect("valid");
        assert_calibrated(ratio(&edges(&unsure), &samples), &what("edges"));
        assert_calibrated(ratio(&counts, &samples), &what("counts"));
        assert_calibrated(ratio(&quantised, &samples), &what("quantised"));
    }
}

#[test]
fn errors_of_filters_have_their_standard_deviation_with_a_matching_model() {
    let device = MotorModel::DCX35L;
    for noise in [0.1, 1.0] {
        let mean = device.damping * OMEGA / device.torque_constant;
        let drive = NoisyCurrent {
            device,
            mean,
            noise,
            acts: mean,
            draws: Draws(9),
        };
        let samples = simulated(drive, &Disc(0.0), device.counts_per_rev, OMEGA, TICKS);
        let model = Model::motor(&device, RATE, noise).expect("valid");
        let full = ratio(&Kalman::new(&model).expect("valid"), &samples);
        let steady = ratio(&SteadyKalman::new(&model).expect("valid"), &samples);
        assert_calibrated(full, &format!("motor, full, {noise} A"));
        assert_calibrated(steady, &format!("motor, steady, {noise} A"));
    }
    for density in [1e2, 2e3, 2e4] {
        let drive = Jerk {
            density,
            acceleration: 0.0,
            draws: Draws(9),
        };
        let samples = simulated(drive, &Disc(0.0), 4096, OMEGA, TICKS / 10);
        let model = Model::triple_integrator(4096, RATE, density).expect("valid");
        let full = ratio(&Kalman::new(&model).expect("valid"), &samples);
        let steady = ratio(&SteadyKalman::new(&model).expect("valid"), &samples);
        assert_calibrated(full, &format!("triple, full, {density}"));
        assert_calibrated(steady, &format!("triple, steady, {density}"));
    }
}
