//! The design of observers, which computes their gains at compile time.

use super::adaptation::Fixed;
use super::adaptive::Adaptive;
use super::count_update::CountUpdate;
use super::edge_update::EdgeUpdate;
use super::gain::Gain;
use super::inputs::{AmplifierCurrent, CoupledEncoder, HeldShaft, NoCurrent};
use super::plan::Plan;
use super::quantised_update::QuantisedUpdate;
use super::range::{Narrow, Range, Wide};
use super::uncertainty::Uncertainty;
use super::{CountObserver, Observer};
use crate::design::DesignError;
use crate::models::{CoupledMotor, MotorModel};
use crate::units::Hertz;

/// The design of an [`Observer`]: an observer with the control rate and the counts per revolution
/// that its parts are designed from. The observer itself keeps neither of them.
///
/// [`new`](Self::new), [`quantised`](Self::quantised) and [`blind`](Self::blind) begin a design,
/// [`held`](Self::held), [`with_edges`](Self::with_edges), [`adaptive`](Self::adaptive) and
/// [`widely_adaptive`](Self::widely_adaptive) exchange one part of it, and [`build`](Self::build) gives the observer or the first error.
///
/// ```
/// use estimator_core::*;
/// const OBSERVER: AdaptiveEdgeObserver = preset!(
///     ObserverDesign::new(&CoupledMotor::DCX35L, Hertz(10e3), &Uncertainty {
///         torque_noise: 5e-6,
///         disturbance: 1e-4,
///         disturbance_time: 0.1,
///         friction_share: 0.7,
///         boundary_noise: 0.03,
///     })
///     .with_edges(Hertz(84e6))
///     .adaptive()
///     .build()
/// );
/// assert_eq!(OBSERVER.start(&Sample::default()), OBSERVER.start(&Sample::default()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverDesign<C = AmplifierCurrent, S = CoupledEncoder, M = CountUpdate, L = Fixed> {
    observer: Result<Observer<C, S, M, L>, DesignError>,
    /// Standard deviation of the disturbance, counts/tick².
    load: f32,
    rate: Hertz,
    counts_per_rev: u32,
}

impl ObserverDesign {
    /// An observer of counts, current and coupled shaft, for a device without edge time stamps.
    ///
    /// The error is the constant of [`DesignError`] for the rate, for the constant of `device` or for
    /// the value of `uncertainty` that is out of its range; or [`DesignError::NOT_CONVERGED`] or
    /// [`DesignError::NOT_STABLE`] for any row of the gain table.
    #[must_use]
    pub const fn new(device: &CoupledMotor, rate: Hertz, uncertainty: &Uncertainty) -> Self {
        let (observer, load) = match Plan::new(device, rate, uncertainty) {
            Ok(plan) => (plan.counts(), plan.load()),
            Err(error) => (Err(error), 0.0),
        };
        Self {
            observer,
            load,
            rate,
            counts_per_rev: device.motor.counts_per_rev,
        }
    }
}

impl ObserverDesign<AmplifierCurrent, CoupledEncoder, QuantisedUpdate, Fixed> {
    /// An observer of counts, current and coupled shaft that also uses a count while the prediction
    /// agrees with it: see [`QuantisedUpdate`].
    ///
    /// The error is one of [`ObserverDesign::new`]; or
    /// [`DesignError::TORQUE_NOISE_FOR_QUANTISED`] if the white torque alone spreads the velocity in a
    /// tick by less than 1e-9 or more than 512 counts/tick.
    #[must_use]
    pub const fn quantised(device: &CoupledMotor, rate: Hertz, uncertainty: &Uncertainty) -> Self {
        let (observer, load) = match Plan::new(device, rate, uncertainty) {
            Ok(plan) => (plan.quantised(), plan.load()),
            Err(error) => (Err(error), 0.0),
        };
        Self {
            observer,
            load,
            rate,
            counts_per_rev: device.motor.counts_per_rev,
        }
    }
}

impl ObserverDesign<NoCurrent, HeldShaft, EdgeUpdate, Fixed> {
    /// An observer of edges alone, stamped by a clock of frequency `clock`, for a device that
    /// measures neither current nor coupled shaft.
    ///
    /// Without the current, damping and friction cannot be predicted. They become part of the
    /// disturbance, which must be large for that. Counts alone correct too rarely for this; use
    /// [`KalmanTriple`](crate::KalmanTriple) with them.
    ///
    /// The error is one of [`ObserverDesign::new`] or of [`with_edges`](ObserverDesign::with_edges).
    #[must_use]
    pub const fn blind(
        device: &CoupledMotor,
        rate: Hertz,
        clock: Hertz,
        uncertainty: &Uncertainty,
    ) -> Self {
        let unknown = CoupledMotor {
            motor: MotorModel {
                damping: 0.0,
                ..device.motor
            },
            coulomb_friction: 0.0,
            ..*device
        };
        let known = ObserverDesign::new(&unknown, rate, uncertainty).with_edges(clock);
        let observer = match known.observer {
            Ok(observer) => {
                // No friction of the model could wrongly hold the rotor inside its interval.
                let edges = EdgeUpdate {
                    unstamped: 0.0,
                    ..observer.correction
                };
                Ok(observer.with_parts(NoCurrent, HeldShaft, edges, Fixed))
            }
            Err(error) => Err(error),
        };
        known.with_observer(observer)
    }
}

impl<C: Copy, S: Copy, M: Copy, L: Copy> ObserverDesign<C, S, M, L> {
    /// The observer.
    ///
    /// # Errors
    /// The first error of the design, as the constructors and the exchanged parts state them.
    pub const fn build(self) -> Result<Observer<C, S, M, L>, DesignError> {
        self.observer
    }

    /// This design of another observer.
    const fn with_observer<D, T, N, K>(
        self,
        observer: Result<Observer<D, T, N, K>, DesignError>,
    ) -> ObserverDesign<D, T, N, K> {
        ObserverDesign {
            observer,
            load: self.load,
            rate: self.rate,
            counts_per_rev: self.counts_per_rev,
        }
    }
}

impl<M: Copy, L: Copy> ObserverDesign<AmplifierCurrent, CoupledEncoder, M, L> {
    /// This observer for a device without an encoder on the coupled shaft: the coupled shaft is
    /// assumed to be at rest.
    #[must_use]
    pub const fn held(self) -> ObserverDesign<AmplifierCurrent, HeldShaft, M, L> {
        self.with_observer(match self.observer {
            Ok(it) => Ok(it.with_parts(it.current, HeldShaft, it.correction, it.adaptation)),
            Err(error) => Err(error),
        })
    }
}

impl<C: Copy, S: Copy, L: Copy> ObserverDesign<C, S, CountUpdate, L> {
    /// This observer with edge time stamps by a clock of frequency `clock`.
    ///
    /// The error is [`DesignError::CLOCK`].
    #[must_use]
    pub const fn with_edges(self, clock: Hertz) -> ObserverDesign<C, S, EdgeUpdate, L> {
        self.with_observer(match self.observer {
            Ok(it) => match EdgeUpdate::new(clock, self.rate, it.correction) {
                Ok(edges) => Ok(it.with_parts(it.current, it.slip, edges, it.adaptation)),
                Err(error) => Err(error),
            },
            Err(error) => Err(error),
        })
    }
}

impl<C: Copy, S: Copy, M: Copy> ObserverDesign<C, S, M, Fixed> {
    /// This observer with adaptation of damping, friction and torque constant per inertia: see
    /// [`Adaptive`].
    #[must_use]
    pub const fn adaptive(self) -> ObserverDesign<C, S, M, Adaptive> {
        self.adapted_in(Narrow)
    }

    /// As [`adaptive`](Self::adaptive), for a model that may be wrong by a factor of ten: see
    /// [`Wide`].
    #[must_use]
    pub const fn widely_adaptive(self) -> ObserverDesign<C, S, M, Adaptive<Wide>> {
        match self.observer {
            Ok(it) => self.adapted_in(Wide::new(&it.motion, self.load)),
            Err(error) => self.with_observer(Err(error)),
        }
    }

    /// This observer with adaptation in `range`.
    const fn adapted_in<R: Range>(self, range: R) -> ObserverDesign<C, S, M, Adaptive<R>> {
        self.with_observer(match self.observer {
            Ok(it) => {
                let adaptation = Adaptive::new(range, self.counts_per_rev, self.rate);
                Ok(it.with_parts(it.current, it.slip, it.correction, adaptation))
            }
            Err(error) => Err(error),
        })
    }
}

impl CountObserver {
    /// An observer of counts, current and coupled shaft: that of [`ObserverDesign::new`].
    ///
    /// # Errors
    /// Those of [`ObserverDesign::new`].
    pub const fn new(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        ObserverDesign::new(device, rate, uncertainty).build()
    }

    /// The gain of a correction that comes `ticks` ticks after the last.
    #[must_use]
    pub fn gain(&self, ticks: usize) -> Gain {
        *self.correction.table.gain(ticks as f32)
    }
}
