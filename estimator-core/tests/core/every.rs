//! Estimators that read counts and a current at most, each with its ramp, memory and largest output, so
//! that one test can try them all. Observers and M/T have a list in `observer`. An estimator that is in
//! neither list has the general invariants, which the package `acceptance` tries on every row of the
//! catalogue.

use estimator_core::{
    AlphaBetaGamma, BestFit, EndFit, FiniteDifference, Fit, Foaw, Handover, Hertz, Kalman,
    LateCurrent, LowPass, Model, MotorModel, Pll, Sample, Signals, SteadyKalman, TableKalmanMotor,
    TableKalmanTriple, VelocityEstimator,
};

use crate::reference::{self, Reference, Vector};

/// The control rates of the paper and of the board, Hz.
pub(crate) const RATES: [f64; 3] = [1000.0, 10_000.0, 11_600.0];

/// Spectral density of the jerk that the triple integrator expects, rad/s³ per √Hz.
pub(crate) const JERK: f64 = 2e4;

/// Error of the current that the motor model expects, A.
pub(crate) const CURRENT_NOISE: f64 = 0.1;

/// How the estimator answers to a constant number of counts a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ramp {
    /// Exactly that number, bit for bit.
    Exact,
    /// To within rounding.
    Rounded,
}

/// An estimator under test.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) ramp: Ramp,
    /// Ticks after which less than 1e-6 of any earlier state is left.
    pub(crate) memory: usize,
    /// Largest output over largest displacement in a tick: the sum of the magnitudes of the
    /// response.
    pub(crate) per_count: f64,
    /// Largest output per ampere.
    pub(crate) per_amp: f64,
    /// The current that keeps the model of the motor at one count a tick; 0 without a model.
    pub(crate) holding_amps: f64,
    pub(crate) needs: Signals,
    make: Box<dyn Fn() -> Box<dyn Run> + Send + Sync>,
}

impl Case {
    /// The estimator itself, not started.
    pub(crate) fn make(&self) -> Box<dyn Run> {
        (self.make)()
    }

    /// Output at every sample but the first.
    pub(crate) fn run(&self, samples: &[Sample]) -> Vec<f32> {
        let mut run = self.make();
        run.start(&samples[0]);
        samples[1..]
            .iter()
            .map(|sample| run.update(sample))
            .collect()
    }
}

/// An estimator together with its state.
pub(crate) trait Run {
    fn start(&mut self, first: &Sample);
    fn update(&mut self, sample: &Sample) -> f32;
}

struct Running<E: VelocityEstimator> {
    estimator: E,
    state: Option<E::State>,
}

impl<E: VelocityEstimator> Run for Running<E> {
    fn start(&mut self, first: &Sample) {
        self.state = Some(self.estimator.start(first));
    }

    fn update(&mut self, sample: &Sample) -> f32 {
        let state = self.state.as_mut().expect("started");
        self.estimator.update(state, sample).0
    }
}

/// A case of an estimator whose response is positive and sums to one: no output is larger than
/// the largest displacement.
fn averaging<E>(name: &str, rate: f64, ramp: Ramp, memory: usize, estimator: E) -> Case
where
    E: VelocityEstimator + Copy + Send + Sync + 'static,
{
    Case {
        name: format!("{name} at {rate} Hz"),
        ramp,
        memory,
        per_count: 1.0,
        per_amp: 0.0,
        holding_amps: 0.0,
        needs: E::NEEDS,
        make: Box::new(move || {
            Box::new(Running {
                estimator,
                state: None,
            })
        }),
    }
}

/// A case of a Kalman filter, with the bounds of its textbook model.
fn kalman<E, const S: usize>(
    name: &str,
    rate: f64,
    estimator: E,
    model: &Reference<S>,
    steady: bool,
) -> Case
where
    E: VelocityEstimator + Copy + Send + Sync + 'static,
{
    let limit = model.steady_gain();
    let slowest = model.spectral_radius(&limit);
    // A double pole decays as n times its power: 1e-8 leaves room for the factor.
    let memory = (1e-8f64.ln() / slowest.ln()).ceil() as usize + 50;
    // The filter varies in time while it settles, so that every moment has its own response.
    let gains = if steady {
        vec![limit; memory]
    } else {
        model.gains(memory)
    };
    let moments = (1..=64.min(memory)).chain([memory]);
    let (mut per_count, mut per_amp) = (0.0f64, 0.0f64);
    for moment in moments {
        let (steps, currents) = model.response(&gains[..moment]);
        per_count = per_count.max(steps.iter().map(|h| h.abs()).sum());
        per_amp = per_amp.max(currents.iter().map(|h| h.abs()).sum());
    }
    // At a constant velocity of 1 the model loses 1 - a_11 and needs b_1 i to make up for it.
    let holding = if per_amp > 0.0 {
        (1.0 - model.a[(1, 1)]) / model.b[1]
    } else {
        0.0
    };
    Case {
        per_count,
        per_amp,
        holding_amps: holding,
        ..averaging(name, rate, Ramp::Rounded, memory, estimator)
    }
}

/// The fading-memory filter, with the response of its textbook form.
fn alpha_beta_gamma(bandwidth: f64, rate: f64) -> Case {
    let p = (-std::f64::consts::TAU * bandwidth / rate).exp();
    let gains = [
        1.0 - p.powi(3),
        1.5 * (1.0 - p).powi(2) * (1.0 + p),
        (1.0 - p).powi(3),
    ];
    // A triple pole: n² p^n.
    let memory = forgets(bandwidth, rate) * 3 / 2;
    let (mut x, mut v, mut a, mut per_count) = (0.0, 0.0, 0.0, 0.0f64);
    // The answer to a step of the count, the displacement of one tick.
    for _ in 0..memory {
        let predicted = x + v + 0.5 * a;
        let innovation = 1.0 - predicted;
        x = predicted + gains[0] * innovation;
        v += a + gains[1] * innovation;
        a += gains[2] * innovation;
        per_count += f64::abs(v);
    }
    let filter = AlphaBetaGamma::new(Hertz(bandwidth), Hertz(rate)).expect("valid");
    Case {
        per_count,
        ..averaging("fading memory", rate, Ramp::Rounded, memory, filter)
    }
}

fn foaw<const N: usize, F>(fit: &str, rate: f64, n: usize, d: u16) -> Case
where
    F: Fit + Copy + Send + Sync + 'static,
{
    let name = format!("FOAW<{N}> {fit}, n = {n}, d = {d}");
    let estimator = Foaw::<N, F>::new(n, d).expect("valid");
    averaging(&name, rate, Ramp::Exact, n + 1, estimator)
}

/// Ticks in which a real pole of this cut-off forgets all but 1e-8.
fn forgets(cutoff: f64, rate: f64) -> usize {
    (1e8f64.ln() * rate / (std::f64::consts::TAU * cutoff)).ceil() as usize + 1
}

/// Every estimator at this rate.
pub(crate) fn at(rate: f64) -> Vec<Case> {
    let hertz = Hertz(rate);
    let device = MotorModel::DCX35L;
    let cutoff = if rate < 5000.0 { 240.0 } else { 120.0 };
    let low_pass = LowPass::new(FiniteDifference, Hertz(cutoff), hertz).expect("valid");
    let window = Foaw::<15, EndFit>::new(15, 1).expect("valid");
    let smoothed = LowPass::new(window, Hertz(cutoff), hertz).expect("valid");
    let pll = Pll::new(Hertz(60.0), hertz).expect("valid");

    let triple_model = Model::triple_integrator(4096, hertz, JERK).expect("valid");
    let triple = reference::triple(4096, rate, JERK);
    let motor_model = Model::motor(&device, hertz, CURRENT_NOISE).expect("valid");
    let motor = reference::motor_reduced(&device, rate, CURRENT_NOISE);
    let full = Kalman::new(&motor_model).expect("valid");
    let steady = SteadyKalman::new(&motor_model).expect("valid");

    vec![
        averaging("finite difference", rate, Ramp::Exact, 1, FiniteDifference),
        averaging(
            "low-pass over finite difference",
            rate,
            Ramp::Rounded,
            forgets(cutoff, rate),
            low_pass,
        ),
        averaging(
            "low-pass over FOAW",
            rate,
            Ramp::Rounded,
            forgets(cutoff, rate) + 16,
            smoothed,
        ),
        foaw::<1, EndFit>("end-fit", rate, 1, 1),
        foaw::<15, EndFit>("end-fit", rate, 15, 1),
        foaw::<15, EndFit>("end-fit", rate, 4, 0),
        foaw::<15, BestFit>("best-fit", rate, 15, 1),
        foaw::<15, BestFit>("best-fit", rate, 7, 3),
        foaw::<64, EndFit>("end-fit", rate, 64, 2),
        foaw::<64, BestFit>("best-fit", rate, 37, 1),
        foaw::<128, EndFit>("end-fit", rate, 128, 1),
        foaw::<128, BestFit>("best-fit", rate, 128, 1),
        foaw::<128, BestFit>("best-fit", rate, 128, 5),
        // The first alone, as long as nobody selects the other.
        averaging(
            "handover from FOAW to PLL",
            rate,
            Ramp::Exact,
            16,
            Handover::new(window, pll, 60, 40).expect("valid"),
        ),
        averaging(
            "PLL",
            rate,
            Ramp::Rounded,
            // A double pole: n p^n.
            forgets(60.0, rate) * 5 / 4,
            pll,
        ),
        alpha_beta_gamma(60.0, rate),
        kalman(
            "Kalman triple",
            rate,
            Kalman::new(&triple_model).expect("valid"),
            &triple,
            false,
        ),
        kalman(
            "Kalman triple with a table",
            rate,
            TableKalmanTriple::<512>::new(&triple_model).expect("valid"),
            &triple,
            false,
        ),
        kalman(
            "steady Kalman triple",
            rate,
            SteadyKalman::new(&triple_model).expect("valid"),
            &triple,
            true,
        ),
        kalman("Kalman motor", rate, full, &motor, false),
        kalman(
            "Kalman motor with a table",
            rate,
            TableKalmanMotor::<512>::new(&motor_model).expect("valid"),
            &motor,
            false,
        ),
        kalman("steady Kalman motor", rate, steady, &motor, true),
        kalman(
            "Kalman motor, current late",
            rate,
            LateCurrent(full),
            &motor,
            false,
        ),
        kalman(
            "steady Kalman motor, current late",
            rate,
            LateCurrent(steady),
            &motor,
            true,
        ),
    ]
}

/// Every estimator at every rate.
pub(crate) fn everywhere() -> Vec<Case> {
    RATES.iter().flat_map(|rate| at(*rate)).collect()
}

/// The displacements that drive a linear estimator of these gains to its largest output.
pub(crate) fn worst_steps<const S: usize>(
    model: &Reference<S>,
    gains: &[Vector<S>],
    limit: i64,
) -> Vec<i64> {
    let (steps, _) = model.response(gains);
    let sign = |h: &f64| if *h < 0.0 { -limit } else { limit };
    steps.iter().map(sign).collect()
}
