//! Every estimator of the core, beside its twin.

use estimator_core as core;
use estimator_twin as twin;

use crate::course::EDGE_CLOCK_HZ;
use crate::definition::{Definition, Line};
use crate::pair::{Both, Pair};

/// An estimator under stress.
pub struct Contestant {
    /// Name and parameters.
    pub name: String,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// What it has to give exactly, if it is a window.
    pub definition: Option<Definition>,
    /// What rounding may add to a velocity inside the haptic range, rad/s; infinite where it may
    /// turn a decision.
    pub deviation_bound_rad_s: f64,
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

    /// One count over the time since: at 1e-5 rad/s after two minutes and a half.
    fn comes_to_rest_slowly(self) -> Self {
        Self {
            at_rest_rad_s: 0.05,
            ..self
        }
    }

    /// Decides, as whether a rotor sticks: rounding may turn a decision, and is not bounded.
    fn decides(self) -> Self {
        Self {
            deviation_bound_rad_s: f64::INFINITY,
            ..self
        }
    }

    fn window(self, n: usize, d: i32, line: Line) -> Self {
        Self {
            definition: Some(Definition { n, d, line }),
            ..self
        }
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
            deviation_bound_rad_s: DEVIATION_RAD_S,
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
        $c::Observer::new(
            &$c::CoupledMotor::DCX35L,
            $c::Hertz($rate),
            &$c::Uncertainty {
                torque_noise: 7e-5,
                load: 7.5e-4,
                load_time: 0.1,
                friction_share: 0.7,
                boundary_noise: 0.0625,
            },
        )
        .expect("valid")
    };
}

/// The same design over the core and over its twin, which have to agree on whether to refuse it.
macro_rules! refusable {
    (|$c:ident| $make:expr) => {{
        let core = {
            use core as $c;
            $make
        };
        let twin = {
            use twin as $c;
            $make
        };
        match (core, twin) {
            (Ok(core), Ok(twin)) => Ok(Box::new(Both {
                core,
                twin,
                states: None,
            })),
            (Err(core), Err(twin)) => {
                assert_eq!(core.message(), twin.message());
                Err(format!("{core:?}"))
            }
            (core, twin) => panic!("refused by one alone: {:?}, {:?}", core.err(), twin.err()),
        }
    }};
}

/// The project's goal for what f32 may cost, rad/s.
pub const DEVIATION_RAD_S: f64 = 1e-5;

/// Below this an output at rest is at rest, rad/s.
const AT_REST_RAD_S: f64 = 1e-5;

/// What it costs filters with slow poles at 10 kHz, where a count a tick is 15 rad/s: as many
/// half units in the last place of it as the pole has ticks of memory.
const SLOW_DEVIATION_RAD_S: f64 = 2e-5;

/// Spectral density of the jerk that the triple integrator expects, rad/s³ per √Hz.
const JERK: f64 = 2e4;

/// Error of the current that the motor model expects, A.
const CURRENT_NOISE: f64 = 0.1;

/// Every estimator at one control rate.
#[must_use]
#[allow(
    clippy::missing_panics_doc,
    reason = "the parameters are constants that a test tries"
)]
pub fn at(rate: f64) -> Vec<Contestant> {
    let cutoff = if rate < 5000.0 { 240.0 } else { 120.0 };
    let mut all = vec![
        both!("finite-difference", rate, |c| c::FiniteDifference),
        both!("low-pass", rate, |c| c::LowPass::new(
            c::FiniteDifference,
            c::Hertz(cutoff),
            c::Hertz(rate)
        )
        .expect("valid")),
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
        }),
        both!("kalman-triple", rate, |c| {
            let model = c::Model::triple_integrator(4096, c::Hertz(rate), JERK).expect("valid");
            c::Kalman::new(&model).expect("valid")
        }),
        both!("kalman-triple-steady", rate, |c| {
            let model = c::Model::triple_integrator(4096, c::Hertz(rate), JERK).expect("valid");
            c::SteadyKalman::new(&model).expect("valid")
        }),
        both!("kalman-motor", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::Kalman::new(&model).expect("valid")
        }),
        both!("kalman-motor-steady", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::SteadyKalman::new(&model).expect("valid")
        }),
        both!("kalman-motor, literal", rate, |c| {
            let model =
                c::Model::motor(&c::Device::DCX35L, c::Hertz(rate), CURRENT_NOISE).expect("valid");
            c::LateCurrent(c::SteadyKalman::new(&model).expect("valid"))
        }),
        both!("m-over-t", rate, |c| {
            c::MOverT::new(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate)).expect("valid")
        })
        .comes_to_rest_slowly()
        .decides(),
        both!("observer", rate, |c| observer!(c, rate)).decides(),
        both!("observer-edge", rate, |c| {
            observer!(c, rate)
                .with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate))
                .expect("valid")
        })
        .decides(),
        both!("adaptive", rate, |c| {
            observer!(c, rate)
                .learning(4096, c::Hertz(rate))
                .expect("valid")
        })
        .decides(),
        both!("adaptive-edge", rate, |c| {
            observer!(c, rate)
                .with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate))
                .and_then(|observer| observer.learning(4096, c::Hertz(rate)))
                .expect("valid")
        })
        .decides(),
    ];
    if rate > 5000.0 {
        for slow in ["low-pass", "pll", "kalman-motor"] {
            for one in all.iter_mut().filter(|one| one.name.starts_with(slow)) {
                one.deviation_bound_rad_s = SLOW_DEVIATION_RAD_S;
            }
        }
    }
    all
}

/// A pair, or the name of the error that both precisions refuse it with.
pub type Refusable = Result<Box<dyn Pair>, String>;

/// The kinds of estimators that have a parameter to choose.
pub const KINDS: [&str; 6] = [
    "low-pass",
    "pll",
    "kalman-triple",
    "kalman-triple-steady",
    "kalman-motor",
    "kalman-motor-steady",
];

/// The parameter of `kind` over its range and beyond: a cut-off in Hz, or a noise over 24 decades.
#[must_use]
pub fn parameters(kind: &str, rate: f64) -> Vec<f64> {
    match kind {
        "low-pass" | "pll" => [1e-7, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.51]
            .iter()
            .map(|part| part * rate)
            .collect(),
        _ => (-12..=12).map(|exponent| 10f64.powi(exponent)).collect(),
    }
}

/// `kind` with these parameters.
///
/// # Errors
/// The name of the design error, if core and twin agree in it.
///
/// # Panics
/// If only one of them refuses, or `kind` is none of [`KINDS`].
pub fn design(kind: &str, rate: f64, counts_per_rev: u32, parameter: f64) -> Refusable {
    match kind {
        "low-pass" => refusable!(|c| c::LowPass::new(
            c::FiniteDifference,
            c::Hertz(parameter),
            c::Hertz(rate)
        )),
        "pll" => refusable!(|c| c::Pll::new(c::Hertz(parameter), c::Hertz(rate))),
        "kalman-triple" => {
            refusable!(
                |c| c::Model::triple_integrator(counts_per_rev, c::Hertz(rate), parameter)
                    .and_then(|model| c::Kalman::new(&model))
            )
        }
        "kalman-triple-steady" => {
            refusable!(
                |c| c::Model::triple_integrator(counts_per_rev, c::Hertz(rate), parameter)
                    .and_then(|model| c::SteadyKalman::new(&model))
            )
        }
        "kalman-motor" => refusable!(|c| {
            let device = c::Device {
                counts_per_rev,
                ..c::Device::DCX35L
            };
            c::Model::motor(&device, c::Hertz(rate), parameter)
                .and_then(|model| c::Kalman::new(&model))
        }),
        "kalman-motor-steady" => refusable!(|c| {
            let device = c::Device {
                counts_per_rev,
                ..c::Device::DCX35L
            };
            c::Model::motor(&device, c::Hertz(rate), parameter)
                .and_then(|model| c::SteadyKalman::new(&model))
        }),
        _ => panic!("no estimator {kind}"),
    }
}
