//! Every estimator of the core with its twin, and the bounds of its test.

use catalogue::parameters::middle;
use estimator_catalogue::{Parameter, Row, Settling};
use estimator_core as core;

use crate::definition::{Definition, Line};
use crate::findings::Bounds;
use crate::pair::Pair;
use crate::pairs::{self, Design, Entry, request};
use crate::settling;

/// An estimator of one design at one control rate, with the bounds of the stress test.
pub struct TestedEstimator {
    /// Name and parameters.
    pub name: String,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Definition in exact fractions, of a window.
    pub definition: Option<Definition>,
    /// Bounds that it must meet.
    pub bounds: Bounds,
    /// Largest output at rest, rad/s.
    pub at_rest_rad_s: f64,
    make: Box<dyn Fn() -> Box<dyn Pair> + Send + Sync>,
}

impl TestedEstimator {
    /// An estimator of this design, with the default bounds and without a definition.
    fn new(
        name: String,
        rate_hz: f64,
        capacity: usize,
        design: Design,
        value: impl Fn(&str) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            name,
            rate_hz,
            definition: None,
            bounds: Bounds {
                deviation_rad_s: DEVIATION_RAD_S,
                settles_ticks: 0,
            },
            at_rest_rad_s: AT_REST_RAD_S,
            make: Box::new(move || {
                design(&request(rate_hz, capacity, &value)).expect("a design that holds")
            }),
        }
    }

    /// A fresh pair, not started.
    #[must_use]
    pub fn pair(&self) -> Box<dyn Pair> {
        (self.make)()
    }

    /// rad/s of a count per tick, with 1024 lines.
    #[must_use]
    pub fn rad_per_count(&self) -> f64 {
        std::f64::consts::TAU * self.rate_hz / 4096.0
    }

    /// Decides, as whether a rotor sticks: rounding may turn a decision, and is not bounded.
    fn decides(mut self) -> Self {
        self.bounds.deviation_rad_s = f64::INFINITY;
        self
    }

    /// At rest after this number of ticks.
    fn settles(mut self, ticks: u32) -> Self {
        self.bounds.settles_ticks = ticks;
        self
    }

    /// At rest after this number of further ticks.
    fn also(self, ticks: u32) -> Self {
        let before = self.bounds.settles_ticks;
        self.settles(before + ticks)
    }

    /// At rest when this number of poles within the radius have decayed from the fastest motion.
    fn poles(self, radius: f64, order: i32) -> Self {
        let quiet = self.at_rest_rad_s / self.rad_per_count();
        self.settles(settling::poles(radius, order, quiet))
    }

    /// At rest when `counts` over the time since the last edge are below 0.05 rad/s; below 1e-5
    /// rad/s would take two and a half minutes.
    fn counts_over_time(mut self, counts: f64) -> Self {
        self.at_rest_rad_s = 0.05;
        let ticks = counts * self.rad_per_count() / self.at_rest_rad_s;
        self.settles(ticks.ceil() as u32)
    }
}

/// Goal for the largest error by f32, rad/s.
pub const DEVIATION_RAD_S: f64 = 1e-5;

/// Below this an output at rest is at rest, rad/s.
const AT_REST_RAD_S: f64 = 1e-5;

/// What it costs those with the slowest poles at 10 kHz, where a count a tick is 15 rad/s: as many
/// half units in the last place of it as two poles have ticks of memory. The loop always passes
/// [`DEVIATION_RAD_S`], the full covariance in one of ten courses of 1e8 ticks.
const SLOW_DEVIATION_RAD_S: f64 = 2e-5;

/// Spectral density of the jerk that the triple integrator expects, rad/s³ per √Hz.
const JERK: f64 = 2e4;

/// Error of the current that the motor model expects, A.
const CURRENT_NOISE: f64 = 0.1;

/// Correlation time of the observers' disturbance torque, s.
const LOAD_TIME_S: f64 = 0.1;

/// Disturbance torque of the observers: white, N·m/√Hz, and slow, N·m.
const TORQUE_NOISE: f64 = 7e-5;
const DISTURBANCE_NM: f64 = 7.5e-4;

/// Uncertainty of the observer that uses edges only: its disturbance torque includes damping,
/// friction and the motor's torque.
const ALONE: core::Uncertainty = core::Uncertainty {
    torque_noise: 5e-4,
    disturbance: 1e-4,
    disturbance_time: LOAD_TIME_S,
    friction_share: 0.0,
    boundary_noise: 0.03,
};

/// Frequency of the tracking loop's poles, Hz.
const BANDWIDTH_HZ: f64 = 60.0;

/// Cut-off of the low-pass, Hz.
fn cutoff_hz(rate_hz: f64) -> f64 {
    if rate_hz < 5000.0 { 240.0 } else { 120.0 }
}

/// The line of a row that has the definition of FOAW.
fn line(row: &Row) -> Option<Line> {
    match row.id {
        "foaw_end_fit" => Some(Line::EndFit),
        "foaw_best_fit" => Some(Line::BestFit),
        _ => None,
    }
}

/// Noise bound of a window, counts: the longest best fit is tried with a wider band.
fn noise_bound(row: &Row, capacity: usize) -> i32 {
    match (line(row), capacity) {
        (Some(Line::BestFit), 64) => 2,
        _ => 1,
    }
}

/// The value of a parameter in every run, by its name. A parameter that is not named here takes the
/// middle of its search range.
fn value(name: &str, entry: &Entry, rate_hz: f64, capacity: usize) -> f64 {
    let alone = entry.row.settling == Settling::DisturbanceAlone;
    match name {
        "n" => capacity as f64,
        "d" => f64::from(noise_bound(entry.row, capacity)),
        "cutoff_hz" => cutoff_hz(rate_hz),
        "bandwidth_hz" => BANDWIDTH_HZ,
        "jerk" => JERK,
        "torque_noise" if alone => ALONE.torque_noise,
        "load" if alone => ALONE.disturbance,
        "boundary_noise" if alone => ALONE.boundary_noise,
        "current_noise" => CURRENT_NOISE,
        "torque_noise" => TORQUE_NOISE,
        "load" => DISTURBANCE_NM,
        "load_time" => LOAD_TIME_S,
        "friction_share" => 0.7,
        "boundary_noise" => 0.0625,
        name => {
            let mut parameters = entry.row.parameters.iter();
            let found = parameters.find(|parameter| parameter.name == name);
            middle(found.expect("a parameter of the row").search)
        }
    }
}

/// Poles and longest times to rest of the laws of settling, at one rate.
struct Laws {
    rate_hz: f64,
    triple: f64,
    motor: f64,
    forgotten: u32,
    forgotten_softly: u32,
    forgotten_alone: u32,
}

impl Laws {
    fn new(rate_hz: f64) -> Self {
        let rate = core::Hertz(rate_hz);
        let triple = {
            let model = core::Model::triple_integrator(4096, rate, JERK).expect("valid");
            settling::radius(model.transition(), &model.steady_gain().expect("valid"))
        };
        let motor = {
            let model = core::Model::motor(&core::MotorModel::DCX35L, rate, CURRENT_NOISE);
            let model = model.expect("valid");
            settling::radius(model.transition(), &model.steady_gain().expect("valid"))
        };
        let uncertainty = core::Uncertainty {
            torque_noise: TORQUE_NOISE,
            disturbance: DISTURBANCE_NM,
            disturbance_time: LOAD_TIME_S,
            friction_share: 0.7,
            boundary_noise: 0.0625,
        };
        let counts = core::Observer::new(&core::CoupledMotor::DCX35L, rate, &uncertainty);
        let counts = counts.expect("valid");
        let forgotten = |gain| settling::unknown_torque(gain, LOAD_TIME_S, rate_hz);
        let forgotten_alone = {
            let free = core::CoupledMotor {
                motor: core::MotorModel {
                    damping: 0.0,
                    ..core::MotorModel::DCX35L
                },
                coulomb_friction: 0.0,
                ..core::CoupledMotor::DCX35L
            };
            let counts = core::Observer::new(&free, rate, &ALONE).expect("valid");
            settling::unknown_torque_alone(settling::largest_gain(&counts), LOAD_TIME_S, rate_hz)
        };
        Self {
            rate_hz,
            triple,
            motor,
            forgotten: forgotten(settling::largest_gain(&counts)),
            forgotten_softly: forgotten(settling::largest_soft_gain(&counts)),
            forgotten_alone,
        }
    }

    /// The estimator `one` with the bounds of its law of settling.
    fn bounded(
        &self,
        one: TestedEstimator,
        settling: Settling,
        capacity: usize,
    ) -> TestedEstimator {
        let pole = |hertz| settling::pole(hertz, self.rate_hz);
        match settling {
            Settling::AtOnce => one,
            Settling::OnePole => one.poles(pole(cutoff_hz(self.rate_hz)), 1),
            Settling::EqualPoles(order) => {
                let mut one = one.poles(pole(BANDWIDTH_HZ), order.into());
                if self.rate_hz > 5000.0 {
                    // The settling times of poles in series add up.
                    one.bounds.deviation_rad_s = SLOW_DEVIATION_RAD_S * f64::from(order) / 2.0;
                }
                one
            }
            Settling::Window => one.settles(capacity as u32 - 1),
            Settling::TripleIntegrator => one.poles(self.triple, 3),
            Settling::MotorModel => one.poles(self.motor, 2),
            Settling::CountsOverTime(counts) => one.counts_over_time(counts).decides(),
            Settling::Disturbance => one.decides().settles(self.forgotten),
            Settling::DisturbanceTruncated => one.decides().settles(self.forgotten_softly),
            Settling::DisturbanceAlone => {
                let one = one.decides().counts_over_time(1.0);
                one.also(self.forgotten_alone)
            }
            Settling::Switching(seconds) | Settling::Within(seconds) => {
                one.decides().settles((seconds * self.rate_hz) as u32)
            }
            Settling::Chattering(seconds) => {
                let mut one = one.decides().settles((seconds * self.rate_hz) as u32);
                // The parameter in every run is the middle of its range.
                let acceleration = middle(Parameter::ACCELERATION.search);
                one.at_rest_rad_s = 2.5 * acceleration / self.rate_hz;
                one
            }
        }
    }
}

/// Every estimator at one control rate: the rows of the catalogue, and two designs of the core that
/// no row has.
#[must_use]
#[allow(
    clippy::missing_panics_doc,
    reason = "the parameters are constants that a test tries"
)]
pub fn at(rate_hz: f64) -> Vec<TestedEstimator> {
    let laws = Laws::new(rate_hz);
    let mut all = Vec::new();
    for entry in pairs::ALL {
        for &capacity in entry.capacities() {
            let settling = entry.row.settling;
            let bound = noise_bound(entry.row, capacity);
            let name = match (settling.is_window(), bound) {
                (false, _) => entry.row.name.to_owned(),
                (true, 1) => format!("{} n {capacity}", entry.row.name),
                (true, d) => format!("{} n {capacity} d {d}", entry.row.name),
            };
            let value = move |name: &str| value(name, entry, rate_hz, capacity);
            let mut one = TestedEstimator::new(name, rate_hz, capacity, entry.design, value);
            one.definition = line(entry.row).map(|line| Definition {
                n: capacity,
                d: bound,
                line,
            });
            all.push(laws.bounded(one, settling, capacity));
        }
    }
    let more: [(&str, Design); 2] = [
        ("kalman-motor-table", pairs::kalman_motor_table),
        ("kalman-motor, literal", pairs::late_kalman_motor),
    ];
    for (name, design) in more {
        let one = TestedEstimator::new(name.to_owned(), rate_hz, 0, design, |_| CURRENT_NOISE);
        all.push(laws.bounded(one, Settling::MotorModel, 0));
    }
    if rate_hz > 5000.0 {
        let slowest = |one: &&mut TestedEstimator| one.name == "kalman-triple";
        for slow in all.iter_mut().filter(slowest) {
            slow.bounds.deviation_rad_s = SLOW_DEVIATION_RAD_S;
        }
    }
    all
}
