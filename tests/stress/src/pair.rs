//! One estimator in both precisions.
#![allow(
    clippy::needless_range_loop,
    reason = "matrix code reads as its equations, with indices"
)]

use estimator_core as core;
use estimator_twin as twin;

use crate::course::Shown;

/// An estimator in both precisions, with its states.
pub trait Pair {
    /// Both at rest at the first sample.
    fn start(&mut self, first: &Shown);

    /// One tick of both: velocities in counts per tick.
    fn update(&mut self, shown: &Shown) -> (f32, f64);

    /// What is wrong with the f32 state, if anything is.
    fn fault(&self) -> Option<&'static str>;

    /// Length of the window last used, where there is one.
    fn window(&self) -> Option<usize>;
}

/// What may be asked of a state of estimator `E`.
pub(crate) trait State<E> {
    fn fault(&self, _: &E) -> Option<&'static str> {
        None
    }

    fn window(&self) -> Option<usize> {
        None
    }
}

impl<E> State<E> for core::Count {}
impl<E> State<E> for core::AlphaBetaGammaState {}
impl<E> State<E> for core::PllState {}
impl<E> State<E> for core::MOverTState {}
impl<E, const S: usize> State<E> for core::SteadyKalmanState<S> {}
impl<E, const S: usize> State<E> for core::TableKalmanState<S> {}
impl<E, S> State<E> for core::LateCurrentState<S> {}
impl<E, S> State<E> for core::LowPassState<S> {}

impl<E, const N: usize> State<E> for core::FoawState<N> {
    fn window(&self) -> Option<usize> {
        Some(self.window())
    }
}

impl<const S: usize, U: core::Input<S>> State<core::Kalman<S, U>> for core::KalmanState<S> {
    fn fault(&self, filter: &core::Kalman<S, U>) -> Option<&'static str> {
        let p = filter.covariance(self);
        for i in 0..S {
            for j in 0..i {
                if p[i][j].to_bits() != p[j][i].to_bits() {
                    return Some("covariance not symmetric");
                }
            }
        }
        (!is_positive_definite(&p)).then_some("covariance not positive definite")
    }
}

/// What is carried of an observer's corrections.
trait Corrections {
    fn fault(&self) -> Option<&'static str> {
        None
    }
}

impl Corrections for f32 {}
impl Corrections for core::EdgeUpdateState {}

impl Corrections for core::QuantisedUpdateState {
    fn fault(&self) -> Option<&'static str> {
        let bell = self.covariance();
        let sound = bell.diagonal().iter().all(|d| *d >= 0.0 && *d < 1e20);
        // The core says why: rounding apart, the coupling is within 0 and 3/2.
        let coupled = bell.coupling() >= 0.0 && bell.coupling() < 1.500_01;
        (!(sound && coupled)).then_some("covariance of position and velocity out of its range")
    }
}

impl<E, C, S, M: Corrections> State<E> for core::ObserverState<C, S, M, ()> {
    fn fault(&self, _: &E) -> Option<&'static str> {
        self.correction().fault()
    }
}

/// `U D Uᵀ` is positive definite if D is positive and U is made of numbers.
impl<E, C, S, M: Corrections> State<E> for core::ObserverState<C, S, M, core::AdaptiveState> {
    fn fault(&self, _: &E) -> Option<&'static str> {
        if let Some(fault) = self.correction().fault() {
            return Some(fault);
        }
        let learned = self.adaptation();
        let positive = learned.diagonal().iter().all(|d| *d > 0.0 && *d < 1.0);
        let finite = learned.upper().iter().all(|u| u.is_finite());
        (!(positive && finite)).then_some("covariance of the parameters not positive definite")
    }
}

/// Whether Cholesky's factorisation, in f64, meets positive pivots only.
fn is_positive_definite<const S: usize>(p: &[[f32; S]; S]) -> bool {
    let mut m = p.map(|row| row.map(f64::from));
    for k in 0..S {
        // A NaN is not positive.
        if !(m[k][k] > 0.0 && m[k][k].is_finite()) {
            return false;
        }
        for i in k + 1..S {
            let factor = m[i][k] / m[k][k];
            for j in k..S {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    true
}

/// An estimator and its twin, not started.
pub(crate) struct Both<C: core::VelocityEstimator, T: twin::VelocityEstimator> {
    pub(crate) core: C,
    pub(crate) twin: T,
    pub(crate) states: Option<(C::State, T::State)>,
}

impl<C, T> Pair for Both<C, T>
where
    C: core::VelocityEstimator<Output = core::CountsPerTick, State: State<C>>,
    T: twin::VelocityEstimator<Output = twin::CountsPerTick>,
{
    fn start(&mut self, first: &Shown) {
        self.states = Some((
            self.core.start(&first.sample()),
            self.twin.start(&twin_sample(first)),
        ));
    }

    fn update(&mut self, shown: &Shown) -> (f32, f64) {
        let (core, twin) = self.states.as_mut().expect("started");
        let narrow = self.core.update(core, &shown.sample()).0;
        (narrow, self.twin.update(twin, &twin_sample(shown)).0)
    }

    fn fault(&self) -> Option<&'static str> {
        self.states
            .as_ref()
            .and_then(|(core, _)| core.fault(&self.core))
    }

    fn window(&self) -> Option<usize> {
        self.states.as_ref().and_then(|(core, _)| core.window())
    }
}

fn twin_sample(shown: &Shown) -> twin::Sample {
    twin::Sample {
        count: twin::Count(shown.large),
        coupled: twin::Count(shown.small),
        current: twin::Amps::new(f64::from(shown.amps)),
        edge: shown.edge.map(|(boundary, age)| twin::Edge {
            boundary: twin::Count(boundary),
            age: twin::ClockTicks(age),
        }),
    }
}
