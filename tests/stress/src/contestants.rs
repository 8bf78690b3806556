//! Every estimator of the core, beside its twin.

use estimator_core as core;
use estimator_twin as twin;

use crate::course::EDGE_CLOCK_HZ;
use crate::definition::{Definition, Line};
use crate::findings::Bounds;
use crate::pair::{Both, Pair};
use crate::settling;

/// An estimator under stress.
pub struct Contestant {
    /// Name and parameters.
    pub name: String,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// What it has to give exactly, if it is a window.
    pub definition: Option<Definition>,
    /// What is asked of it.
    pub bounds: Bounds,
    /// Below this an output at rest is at rest, rad/s.
    pub at_rest_rad_s: f64,
    make: Box<dyn Fn() -> Box<dyn Pair> + Send + Sync>,
}

impl Contestant {
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

    /// At rest after so many ticks.
    fn settles(mut self, ticks: u32) -> Self {
        self.bounds.settles_ticks = ticks;
        self
    }

    /// At rest once so many poles within this radius have forgotten the fastest motion there is.
    fn poles(self, radius: f64, order: i32) -> Self {
        let quiet = self.at_rest_rad_s / self.rad_per_count();
        self.settles(settling::poles(radius, order, quiet))
    }

    /// At rest once only the current count is in the window; what the definition gives.
    fn window(self, n: usize, d: i32, line: Line) -> Self {
        Self {
            definition: Some(Definition { n, d, line }),
            ..self
        }
        .settles(n as u32 - 1)
    }

    /// At rest once one count over the time since is below 0.05 rad/s: it would take two minutes
    /// and a half to come below 1e-5.
    fn one_count_over_time(mut self) -> Self {
        self.at_rest_rad_s = 0.05;
        let ticks = self.rad_per_count() / self.at_rest_rad_s;
        self.settles(ticks.ceil() as u32)
    }
}

/// The same expression over the core and over its twin.
macro_rules! both {
    ($name:expr, $rate:expr, |$c:ident| $make:expr) => {{
        let rate_hz: f64 = $rate;
        let core = {
            use core as $c;
            $make
        };
        let twin = {
            use twin as $c;
            $make
        };
        Contestant {
            name: String::from($name),
            rate_hz,
            definition: None,
            bounds: Bounds {
                deviation_rad_s: DEVIATION_RAD_S,
                settles_ticks: 0,
            },
            at_rest_rad_s: AT_REST_RAD_S,
            make: Box::new(move || {
                Box::new(Both {
                    core,
                    twin,
                    states: None,
                })
            }),
        }
    }};
}

/// An observer as host-sim's presets have it.
macro_rules! observer {
    ($c:ident, $rate:expr) => {
        observer!($c, $rate, new)
    };
    ($c:ident, $rate:expr, $ends:ident) => {
        $c::Observer::$ends(
            &$c::CoupledMotor::DCX35L,
            $c::Hertz($rate),
            &$c::Uncertainty {
                torque_noise: 7e-5,
                load: 7.5e-4,
                load_time: LOAD_TIME_S,
                friction_share: 0.7,
                boundary_noise: 0.0625,
            },
        )
        .expect("valid")
    };
}

/// The project's goal for what f32 may cost, rad/s.
pub const DEVIATION_RAD_S: f64 = 1e-5;

/// Below this an output at rest is at rest, rad/s.
const AT_REST_RAD_S: f64 = 1e-5;

/// What it costs those with the slowest poles at 10 kHz, where a count a tick is 15 rad/s: as many
/// half units in the last place of it as the pole has ticks of memory. The loop always passes
/// [`DEVIATION_RAD_S`], the full covariance in one of ten courses of 1e8 ticks.
const SLOW_DEVIATION_RAD_S: f64 = 2e-5;

/// Spectral density of the jerk that the triple integrator expects, rad/s³ per √Hz.
const JERK: f64 = 2e4;

/// Error of the current that the motor model expects, A.
const CURRENT_NOISE: f64 = 0.1;

/// Time constant of the torque that the observers know nothing of, s.
const LOAD_TIME_S: f64 = 0.1;

/// An observer that has learned from nonsense may believe in a friction near nothing: then it rests
/// only when what it takes for friction has been corrected, count by count. Not derived: twice
/// what was seen.
const LEARNED_NONSENSE_S: f64 = 6.0;

/// Length of the gain tables, ticks.
pub(crate) const TABLE: usize = 1024;

/// Every estimator at one control rate.
#[must_use]
#[allow(
    clippy::missing_panics_doc,
    reason = "the parameters are constants that a test tries"
)]
pub fn at(rate: f64) -> Vec<Contestant> {
    let cutoff = if rate < 5000.0 { 240.0 } else { 120.0 };
    let triple = {
        let model = core::Model::triple_integrator(4096, core::Hertz(rate), JERK).expect("valid");
        settling::radius(model.transition(), &model.steady_gain().expect("valid"))
    };
    let motor = {
        let device = core::Device::DCX35L;
        let model = core::Model::motor(&device, core::Hertz(rate), CURRENT_NOISE).expect("valid");
        settling::radius(model.transition(), &model.steady_gain().expect("valid"))
    };
    let counts = observer!(core, rate);
    let forgotten = |gain| settling::unknown_torque(gain, LOAD_TIME_S, rate);
    let forgotten_softly = forgotten(settling::largest_soft_gain(&counts));
    let forgotten = forgotten(settling::largest_gain(&counts));
    let learned = (LEARNED_NONSENSE_S * rate) as u32;
    let mut all = vec![
        both!("finite-difference", rate, |c| c::FiniteDifference),
        both!("low-pass", rate, |c| c::LowPass::new(
            c::FiniteDifference,
            c::Hertz(cutoff),
            c::Hertz(rate)
        )
        .expect("valid"))
        .poles(settling::pole(cutoff, rate), 1),
        both!("foaw-end-fit n 15", rate, |c| {
            c::Foaw::<15, c::EndFit>::new(15, 1).expect("valid")
        })
        .window(15, 1, Line::EndFit),
        both!("foaw-end-fit n 64", rate, |c| {
            c::Foaw::<64, c::EndFit>::new(64, 1).expect("valid")
        })
        .window(64, 1, Line::EndFit),
        both!("foaw-best-fit n 15", rate, |c| {
            c::Foaw::<15, c::BestFit>::new(15, 1).expect("valid")
        })
        .window(15, 1, Line::BestFit),
        both!("foaw-best-fit n 64 d 2", rate, |c| {
            c::Foaw::<64, c::BestFit>::new(64, 2).expect("valid")
        })
        .window(64, 2, Line::BestFit),
        both!("pll", rate, |c| {
            c::Pll::new(c::Hertz(60.0), c::Hertz(rate)).expect("valid")
        })
        .poles(settling::pole(60.0, rate), 2),
        both!("kalman-triple", rate, |c| {
            let model = c::Model::triple_integrator(4096, c::Hertz(rate), JERK).expect("valid");
            c::Kalman::new(&model).expect("valid")
        })
        .poles(triple, 3),
        both!("kalman-triple-table", rate, |c| {
            let model = c::Model::triple_integrator(4096, c::Hertz(rate), JERK).expect("valid");
            c::TableKalmanTriple::<TABLE>::new(&model).expect("valid")
        })
        .poles(triple, 3),
        both!("kalman-triple-steady", rate, |c| {
            let model = c::Model::triple_integrator(4096, c::Hertz(rate), JERK).expect("valid");
            c::SteadyKalman::new(&model).expect("valid")
        })
        .poles(triple, 3),
        both!("kalman-motor", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::Kalman::new(&model).expect("valid")
        })
        .poles(motor, 2),
        both!("kalman-motor-table", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::TableKalmanMotor::<TABLE>::new(&model).expect("valid")
        })
        .poles(motor, 2),
        both!("kalman-motor-steady", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::SteadyKalman::new(&model).expect("valid")
        })
        .poles(motor, 2),
        both!("kalman-motor, literal", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::LateCurrent(c::SteadyKalman::new(&model).expect("valid"))
        })
        .poles(motor, 2),
        both!("m-over-t", rate, |c| {
            c::MOverT::new(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate)).expect("valid")
        })
        .one_count_over_time()
        .decides(),
        both!("observer", rate, |c| observer!(c, rate))
            .decides()
            .settles(forgotten),
        both!("observer-edge", rate, |c| {
            observer!(c, rate)
                .with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate))
                .expect("valid")
        })
        .decides()
        .settles(forgotten),
        both!("observer-soft", rate, |c| observer!(c, rate, soft))
            .decides()
            .settles(forgotten_softly),
        both!("adaptive", rate, |c| {
            observer!(c, rate)
                .learning(4096, c::Hertz(rate))
                .expect("valid")
        })
        .decides()
        .settles(learned),
        both!("adaptive-soft", rate, |c| {
            observer!(c, rate, soft)
                .learning(4096, c::Hertz(rate))
                .expect("valid")
        })
        .decides()
        .settles(learned),
        both!("adaptive-edge", rate, |c| {
            observer!(c, rate)
                .with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate))
                .and_then(|observer| observer.learning(4096, c::Hertz(rate)))
                .expect("valid")
        })
        .decides()
        .settles(learned),
    ];
    if rate > 5000.0 {
        let slowest = |one: &&mut Contestant| matches!(&*one.name, "pll" | "kalman-triple");
        for slow in all.iter_mut().filter(slowest) {
            slow.bounds.deviation_rad_s = SLOW_DEVIATION_RAD_S;
        }
    }
    all
}
