//! Estimators by parameters that may be refused.

use estimator_core as core;
use estimator_twin as twin;

use crate::contestants::TABLE;
use crate::course::EDGE_CLOCK_HZ;
use crate::pair::{Both, Pair};

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

/// An observer that expects this white torque, N·m/√Hz, and ten times it as an unknown one, N·m.
macro_rules! observer {
    ($c:ident, $rate:expr, $counts:expr, $torque_noise:expr) => {
        observer!($c, $rate, $counts, $torque_noise, new)
    };
    ($c:ident, $rate:expr, $counts:expr, $torque_noise:expr, $ends:ident $(, $clock:expr)?) => {
        $c::Observer::$ends(
            &$c::CoupledMotor {
                large: $c::Device {
                    counts_per_rev: $counts,
                    ..$c::Device::DCX35L
                },
                ..$c::CoupledMotor::DCX35L
            },
            $c::Hertz($rate),
            $($c::Hertz($clock),)?
            &$c::Uncertainty {
                torque_noise: $torque_noise,
                load: 10.0 * $torque_noise,
                load_time: 0.1,
                friction_share: 0.7,
                boundary_noise: 0.0625,
            },
        )
    };
}

/// A pair, or the name of the error that both precisions refuse it with.
pub type Refusable = Result<Box<dyn Pair>, String>;

/// The kinds of estimators that have a parameter to choose.
pub const KINDS: [&str; 20] = [
    "foaw-end-fit",
    "foaw-best-fit",
    "low-pass",
    "pll",
    "kalman-triple",
    "kalman-triple-table",
    "kalman-triple-steady",
    "kalman-motor",
    "kalman-motor-table",
    "kalman-motor-steady",
    "m-over-t",
    "observer",
    "observer-edge",
    "observer-soft",
    "observer-held",
    "observer-edge-held",
    "observer-edge-blind",
    "adaptive",
    "adaptive-soft",
    "adaptive-edge",
];

/// The parameter of `kind` over its range and beyond: a window, a cut-off or an edge clock in Hz,
/// or a noise over 24 decades.
#[must_use]
pub fn parameters(kind: &str, rate: f64) -> Vec<f64> {
    match kind {
        "low-pass" | "pll" => [1e-7, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.51]
            .iter()
            .map(|part| part * rate)
            .collect(),
        "foaw-end-fit" | "foaw-best-fit" => vec![0.0, 1.0, 2.0, 15.0, 64.0, 65.0],
        "m-over-t" => [0.5, 1.0, 84.0, 1e4, 1e7]
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
        // As many counts of noise as intervals, so that both ends of both are tried.
        "foaw-end-fit" => {
            refusable!(|c| c::Foaw::<64, c::EndFit>::new(parameter as usize, parameter as u16))
        }
        "foaw-best-fit" => {
            refusable!(|c| c::Foaw::<64, c::BestFit>::new(parameter as usize, parameter as u16))
        }
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
        "kalman-triple-table" => {
            refusable!(
                |c| c::Model::triple_integrator(counts_per_rev, c::Hertz(rate), parameter)
                    .and_then(|model| c::TableKalmanTriple::<TABLE>::new(&model))
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
        "kalman-motor-table" => refusable!(|c| {
            let device = c::Device {
                counts_per_rev,
                ..c::Device::DCX35L
            };
            c::Model::motor(&device, c::Hertz(rate), parameter)
                .and_then(|model| c::TableKalmanMotor::<TABLE>::new(&model))
        }),
        "kalman-motor-steady" => refusable!(|c| {
            let device = c::Device {
                counts_per_rev,
                ..c::Device::DCX35L
            };
            c::Model::motor(&device, c::Hertz(rate), parameter)
                .and_then(|model| c::SteadyKalman::new(&model))
        }),
        "m-over-t" => refusable!(|c| c::MOverT::new(c::Hertz(parameter), c::Hertz(rate))),
        "observer" => refusable!(|c| observer!(c, rate, counts_per_rev, parameter)),
        "observer-edge" => refusable!(|c| {
            observer!(c, rate, counts_per_rev, parameter)
                .and_then(|known| known.with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate)))
        }),
        "observer-soft" => refusable!(|c| observer!(c, rate, counts_per_rev, parameter, soft)),
        "observer-held" => refusable!(|c| {
            observer!(c, rate, counts_per_rev, parameter).map(|known| known.held())
        }),
        "observer-edge-held" => refusable!(|c| {
            observer!(c, rate, counts_per_rev, parameter)
                .and_then(|known| known.with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate)))
                .map(|known| known.held())
        }),
        "observer-edge-blind" => {
            refusable!(|c| observer!(c, rate, counts_per_rev, parameter, blind, EDGE_CLOCK_HZ))
        }
        "adaptive-soft" => refusable!(|c| {
            observer!(c, rate, counts_per_rev, parameter, soft)
                .and_then(|known| known.learning(counts_per_rev, c::Hertz(rate)))
        }),
        "adaptive" => refusable!(|c| {
            observer!(c, rate, counts_per_rev, parameter)
                .and_then(|known| known.learning(counts_per_rev, c::Hertz(rate)))
        }),
        "adaptive-edge" => refusable!(|c| {
            observer!(c, rate, counts_per_rev, parameter)
                .and_then(|known| known.with_edges(c::Hertz(EDGE_CLOCK_HZ), c::Hertz(rate)))
                .and_then(|known| known.learning(counts_per_rev, c::Hertz(rate)))
        }),
        _ => panic!("no estimator {kind}"),
    }
}
