//! How each kind is built from its parameters.

use estimator_core::{
    BestFit, DesignError, EndFit, FiniteDifference, Fit, Foaw, Hertz, Kalman, LateCurrent, LowPass,
    Model, Pll, Scale, Signals, SteadyKalman, TableKalmanTriple,
};

use super::erased::{Estimator, accelerating, confident, erased};
use super::{Kind, Parameter, Search, Setup, Values};

pub(super) type Build = fn(&Setup, &Values) -> Result<Estimator, DesignError>;

/// Largest window on offer; firmware takes a ring of the size it needs.
const RING: usize = 128;

/// Length of the gain table on offer, enough for its presets at 100 kHz; firmware takes as much as
/// it needs.
const TABLE: usize = 4096;

const CUTOFF: Parameter = Parameter {
    name: "cutoff_hz",
    unit: "Hz",
    meaning: "cut-off of the filter, at most half the rate",
    lowest: 1e-3,
    highest: 1e6,
    whole: false,
    search: Search::Log(5.0, 500.0),
};

const BANDWIDTH: Parameter = Parameter {
    name: "bandwidth_hz",
    meaning: "frequency of the loop's two poles, at most half the rate",
    ..CUTOFF
};

const WINDOW: Parameter = Parameter {
    name: "n",
    unit: "intervals",
    meaning: "largest number of intervals in the window",
    lowest: 1.0,
    highest: RING as f64,
    whole: true,
    search: Search::Each(1, RING as u32),
};

const BOUND: Parameter = Parameter {
    name: "d",
    unit: "counts",
    meaning: "noise bound: half-width of the band around the line",
    lowest: 0.0,
    highest: 16_384.0,
    whole: true,
    search: Search::Each(0, 4),
};

const JERK: Parameter = Parameter {
    name: "jerk",
    unit: "rad/s^3/sqrt(Hz)",
    meaning: "spectral density of the jerk that the filter expects",
    lowest: 1e-9,
    highest: 1e12,
    whole: false,
    search: Search::Log(1.0, 1e6),
};

const CURRENT_NOISE: Parameter = Parameter {
    name: "current_noise",
    unit: "A",
    meaning: "standard deviation of the current's error, drawn anew each tick",
    lowest: 1e-9,
    highest: 1e6,
    whole: false,
    search: Search::Log(1e-4, 100.0),
};

const LITERAL: Parameter = Parameter {
    name: "literal",
    unit: "",
    meaning: "1 takes the paper's eq. 15 literally: the current acts one tick late",
    lowest: 0.0,
    highest: 1.0,
    whole: true,
    search: Search::Fixed(0.0),
};

pub(super) const KINDS: &[Kind] = &[
    Kind {
        name: "finite-difference",
        summary: "displacement over the last period (eq. 4)",
        needs: Signals::COUNT,
        parameters: &[],
        build: |setup, _| Ok(confident(FiniteDifference, scale(setup)?)),
    },
    Kind {
        name: "low-pass",
        summary: "first-order low-pass over the finite difference",
        needs: Signals::COUNT,
        parameters: &[CUTOFF],
        build: |setup, values| {
            let filter = LowPass::new(FiniteDifference, Hertz(values[0]), setup.rate)?;
            Ok(erased(filter, scale(setup)?))
        },
    },
    Kind {
        name: "foaw-end-fit",
        summary: "slope through both ends of the longest straight window",
        needs: Signals::COUNT,
        parameters: &[WINDOW, BOUND],
        build: foaw::<EndFit>,
    },
    Kind {
        name: "foaw-best-fit",
        summary: "least-squares slope of the longest straight window (eq. 6)",
        needs: Signals::COUNT,
        parameters: &[WINDOW, BOUND],
        build: foaw::<BestFit>,
    },
    Kind {
        name: "kalman-triple",
        summary: "Kalman filter on a triple integrator, full covariance (eqs. 9 to 12)",
        needs: Signals::COUNT,
        parameters: &[JERK],
        build: |setup, values| {
            Ok(accelerating(
                Kalman::new(&triple(setup, values)?)?,
                scale(setup)?,
            ))
        },
    },
    Kind {
        name: "kalman-triple-table",
        summary: "the same with a preset table of gains, from the start until they are steady",
        needs: Signals::COUNT,
        parameters: &[JERK],
        build: |setup, values| {
            let filter = TableKalmanTriple::<TABLE>::new(&triple(setup, values)?)?;
            Ok(accelerating(filter, scale(setup)?))
        },
    },
    Kind {
        name: "kalman-triple-steady",
        summary: "the same with its preset steady gain alone",
        needs: Signals::COUNT,
        parameters: &[JERK],
        build: |setup, values| {
            Ok(accelerating(
                SteadyKalman::new(&triple(setup, values)?)?,
                scale(setup)?,
            ))
        },
    },
    Kind {
        name: "kalman-motor",
        summary: "Kalman filter on the motor model with known current, full covariance (eqs. 14, 16)",
        needs: Signals::COUNT_AND_CURRENT,
        parameters: &[CURRENT_NOISE, LITERAL],
        build: |setup, values| {
            let filter = Kalman::new(&Model::motor(&setup.device, setup.rate, values[0])?)?;
            Ok(match values[1] != 0.0 {
                true => confident(LateCurrent(filter), scale(setup)?),
                false => confident(filter, scale(setup)?),
            })
        },
    },
    Kind {
        name: "kalman-motor-steady",
        summary: "the same with its preset steady gain",
        needs: Signals::COUNT_AND_CURRENT,
        parameters: &[CURRENT_NOISE, LITERAL],
        build: |setup, values| {
            let filter = SteadyKalman::new(&Model::motor(&setup.device, setup.rate, values[0])?)?;
            Ok(match values[1] != 0.0 {
                true => confident(LateCurrent(filter), scale(setup)?),
                false => confident(filter, scale(setup)?),
            })
        },
    },
    Kind {
        name: "pll",
        summary: "critically damped tracking loop, as motor boards have it",
        needs: Signals::COUNT,
        parameters: &[BANDWIDTH],
        build: |setup, values| {
            Ok(erased(
                Pll::new(Hertz(values[0]), setup.rate)?,
                scale(setup)?,
            ))
        },
    },
];

fn foaw<F: Fit + Send + Sync + 'static>(
    setup: &Setup,
    values: &Values,
) -> Result<Estimator, DesignError> {
    let foaw = Foaw::<RING, F>::new(values[0] as usize, values[1] as u16)?;
    Ok(confident(foaw, scale(setup)?))
}

fn triple(
    setup: &Setup,
    values: &Values,
) -> Result<Model<3, estimator_core::NoInput>, DesignError> {
    Model::triple_integrator(setup.device.counts_per_rev, setup.rate, values[0])
}

pub(super) fn scale(setup: &Setup) -> Result<Scale, DesignError> {
    Scale::new(setup.device.counts_per_rev, setup.rate)
}
