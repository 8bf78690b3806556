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

    /// Fault of the f32 state; `None` if it is valid.
    fn fault(&self) -> Option<&'static str>;

    /// Length of the window last used, where there is one.
    fn window(&self) -> Option<usize>;

    /// Signals that the estimator of the core reads.
    fn needs(&self) -> core::Signals;

    /// Type of the estimator of the core.
    fn kind(&self) -> &'static str;
}

/// A state of the core and its estimator, to check the invariant of the state.
///
/// A method of the type itself is preferred to the method of a trait. A state with an invariant of
/// its own has the methods below; every other state has those of [`General`]. The choice is made where
/// both types are known: in [`asks!`].
pub(crate) struct Of<'a, E, S>(pub(crate) &'a E, pub(crate) &'a S);

/// What holds for a state without an invariant of its own.
pub(crate) trait General {
    /// What is wrong with the state.
    fn fault(&self) -> Option<&'static str> {
        None
    }

    /// Length of the window last used.
    fn window(&self) -> Option<usize> {
        None
    }
}

impl<E, S> General for Of<'_, E, S> {}

impl<E, const N: usize, F: core::Fit> Of<'_, E, core::FoawState<N, F>> {
    pub(crate) fn window(&self) -> Option<usize> {
        Some(self.1.window())
    }
}

impl<const S: usize, U: core::Input<S>> Of<'_, core::Kalman<S, U>, core::KalmanState<S>> {
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let p = self.0.covariance(self.1);
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

impl<E, C, S, M: Corrections> Of<'_, E, core::ObserverState<C, S, M, ()>> {
    pub(crate) fn fault(&self) -> Option<&'static str> {
        self.1.correction().fault()
    }
}

impl<E, const K: usize> Of<'_, E, core::ModelBankState<K>> {
    pub(crate) fn fault(&self) -> Option<&'static str> {
        bank_fault(self.1)
    }
}

impl<E, I> Of<'_, E, core::DrivenBankState<I>> {
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let probability = self.1.probability();
        if !(0.0..=1.0).contains(&probability) {
            return Some("probability of the driven bank out of its range");
        }
        bank_fault(self.1.plain()).or_else(|| bank_fault(self.1.driven()))
    }
}

/// What is wrong with the state of a bank after an update.
fn bank_fault<const K: usize>(state: &core::ModelBankState<K>) -> Option<&'static str> {
    let weights = state.weights();
    let sum: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
    // Each weight is rounded twice.
    let rounding = K as f64 * f64::from(f32::EPSILON);
    if !(weights.iter().all(|weight| *weight >= 0.0) && (sum - 1.0).abs() <= rounding) {
        return Some("weights of a bank not a distribution");
    }
    let definite = state.covariances().into_iter().all(|member| {
        let [p00, p01, p02, p11, p12, p22] = member;
        is_positive_definite(&[[p00, p01, p02], [p01, p11, p12], [p02, p12, p22]])
    });
    (!definite).then_some("covariance of a bank not positive definite")
}

/// `U D Uᵀ` is positive definite if D is positive and U is made of numbers. D is never above the
/// prior.
impl<A, B, K, R: core::Range, C, S, M: Corrections>
    Of<
        '_,
        core::Observer<A, B, K, core::Adaptive<R>>,
        core::ObserverState<C, S, M, core::AdaptiveState>,
    >
{
    pub(crate) fn fault(&self) -> Option<&'static str> {
        if let Some(fault) = self.1.correction().fault() {
            return Some(fault);
        }
        let learned = self.1.adaptation();
        let diagonal = learned.diagonal().iter().zip(R::PRIOR);
        let positive = diagonal
            .into_iter()
            .all(|(d, prior)| *d > 0.0 && *d <= prior * prior);
        let finite = learned.upper().iter().all(|u| u.is_finite());
        (!(positive && finite)).then_some("covariance of the parameters not positive definite")
    }
}

/// The methods of [`Of`] for one estimator.
pub(crate) struct Asks<E: core::VelocityEstimator> {
    pub(crate) fault: fn(&E, &E::State) -> Option<&'static str>,
    pub(crate) window: fn(&E, &E::State) -> Option<usize>,
}

/// The methods of [`Of`] for an estimator of this type.
macro_rules! asks {
    ($type:ty) => {{
        #[allow(unused_imports, reason = "a state may have both methods of its own")]
        use $crate::pair::General as _;
        $crate::pair::Asks::<$type> {
            fault: |estimator, state| $crate::pair::Of(estimator, state).fault(),
            window: |estimator, state| $crate::pair::Of(estimator, state).window(),
        }
    }};
}

pub(crate) use asks;

/// The part of an observer's state that belongs to its correction.
pub(crate) trait Corrections {
    fn fault(&self) -> Option<&'static str> {
        None
    }
}

impl Corrections for f32 {}
impl Corrections for core::EdgeUpdateState {}

impl Corrections for core::QuantisedUpdateState {
    fn fault(&self) -> Option<&'static str> {
        let covariance = self.covariance();
        let bounded = (covariance.diagonal().iter()).all(|d| *d >= 0.0 && *d < 1e20);
        // The core derives it: rounding apart, the coupling is within 0 and 3/2.
        let coupled = covariance.coupling() >= 0.0 && covariance.coupling() < 1.500_01;
        (!(bounded && coupled)).then_some("covariance of position and velocity out of its range")
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
    pub(crate) asks: Asks<C>,
    pub(crate) states: Option<(C::State, T::State)>,
}

impl<C, T> Pair for Both<C, T>
where
    C: core::VelocityEstimator,
    T: twin::VelocityEstimator,
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
        let (core, _) = self.states.as_ref()?;
        (self.asks.fault)(&self.core, core)
    }

    fn window(&self) -> Option<usize> {
        let (core, _) = self.states.as_ref()?;
        (self.asks.window)(&self.core, core)
    }

    fn needs(&self) -> core::Signals {
        C::NEEDS
    }

    fn kind(&self) -> &'static str {
        std::any::type_name::<C>()
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

#[cfg(test)]
mod tests {
    use estimator_core::{
        AdaptiveEdgeObserver, AdaptiveObserver, AdaptiveQuantisedObserver, CountObserver,
        EdgeObserver, EndFit, Foaw, Imm, ImmAdaptiveEdge, ImmEdge, ImmMotor, ImmPair, KalmanMotor,
        KalmanTriple, QuantisedObserver, VelocityEstimator,
    };

    // [`General`](super::General) is not in scope here, so that only a method of the type compiles.
    use super::Of;

    #[test]
    fn states_with_an_invariant_have_methods_of_their_own() {
        macro_rules! have {
            ($method:ident: $($type:ty),* $(,)?) => {
                $(let _ = |estimator: &$type, state: &<$type as VelocityEstimator>::State| {
                    Of(estimator, state).$method()
                };)*
            };
        }
        have!(window: Foaw<15, EndFit>);
        have!(fault: KalmanTriple, KalmanMotor);
        have!(fault: CountObserver, EdgeObserver, QuantisedObserver);
        have!(fault: AdaptiveObserver, AdaptiveEdgeObserver, AdaptiveQuantisedObserver);
        have!(fault: Imm, ImmPair, ImmEdge, ImmMotor, ImmAdaptiveEdge);
    }
}
