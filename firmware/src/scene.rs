//! What the image holds: estimators, scenes, evaluation parts. The only file with `cfg`.

#[cfg(not(feature = "large-adaptive"))]
use estimator_core::Skip;
use estimator_core::{
    Confidence as _, Hertz, Model, NoInput, SteadyKalman, SteadyKalmanTriple, Variance,
    VelocityEstimator, preset,
};
use haptic_control::{
    Bounds, Detents, DualStage, Excite, FreeAir, Hold, Inertia, LoopPoles, Off, Radians, Rig,
    SpringDamper, Texture, Torque, Viscous, Wall,
};

use crate::board::RATE_HZ;

pub(crate) const DEVICE: DualStage = DualStage::DEFAULT;
pub(crate) const RATE: Hertz = Hertz(RATE_HZ as f64);
pub(crate) const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));

/// Whether to arm without being told.
pub(crate) const AUTO_ARM: bool = cfg!(feature = "auto-arm");
/// Whether to read the reference encoder.
pub(crate) const REFERENCE: bool = cfg!(feature = "reference");
/// Whether edges are stamped.
pub(crate) const EDGES: bool = cfg!(feature = "edge-capture");
/// Longest silence of the command channel while running, ticks.
pub(crate) const SILENCE: Option<u32> = if AUTO_ARM { None } else { Some(RATE_HZ / 2) };

/// What stamps the large encoder's edges.
#[cfg(feature = "edge-capture")]
pub(crate) use crate::edge::Capture as Stamps;
#[cfg(not(feature = "edge-capture"))]
pub(crate) use estimator_core::Skip as Stamps;

/// Estimators of the large motor that images share.
pub(crate) mod large {
    #![allow(dead_code, reason = "an image of one estimator uses one at most")]
    use estimator_core::{EndFit, Foaw, Model, NoInput, SteadyKalman, SteadyKalmanTriple, preset};

    pub(crate) type Window = Foaw<32, EndFit>;
    pub(crate) const WINDOW: Window = preset!(Foaw::new(32, 1));

    pub(crate) type Filter = SteadyKalmanTriple;
    const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(
        super::DEVICE.large.counts_per_rev,
        super::RATE,
        1e4
    ));
    pub(crate) const FILTER: Filter = preset!(SteadyKalman::new(&MODEL));
}

/// FOAW, number 0, and the Kalman filter, number 1, which commands exchange.
#[cfg(not(any(
    feature = "large-foaw",
    feature = "large-kalman",
    feature = "large-adaptive"
)))]
mod choice {
    use super::large::{FILTER, Filter, WINDOW, Window};
    use estimator_core::{Handover, HandoverState, Side, VelocityEstimator, preset};

    pub(crate) type Large = Handover<Window, Filter>;
    /// 20 ms: the filter has settled by then, and what the two differ by comes in slower than a
    /// fingertip feels best.
    const TICKS: u16 = (super::RATE.0 / 50.0) as u16;
    pub(crate) const LARGE: Large = preset!(Handover::new(WINDOW, FILTER, TICKS, TICKS));

    pub(crate) type Choice = Side;

    /// The estimator of this number.
    pub(crate) const fn choice(number: u8) -> Option<Choice> {
        match number {
            0 => Some(Side::First),
            1 => Some(Side::Second),
            _ => None,
        }
    }

    type State = <Large as VelocityEstimator>::State;

    pub(crate) const fn choose(state: &mut State, choice: Choice) {
        HandoverState::select(state, choice);
    }

    /// Number of the one in charge; `None` while one takes over.
    pub(crate) fn in_charge(state: &State) -> Option<u8> {
        state.in_charge().map(|side| side as u8)
    }
}

/// One estimator: there is nothing to choose, and no code for it.
#[cfg(any(
    feature = "large-foaw",
    feature = "large-kalman",
    feature = "large-adaptive"
))]
mod choice {
    use estimator_core::VelocityEstimator;

    pub(crate) use super::one_estimator::{LARGE, Large};

    pub(crate) type Choice = core::convert::Infallible;

    pub(crate) const fn choice(_: u8) -> Option<Choice> {
        None
    }

    type State = <Large as VelocityEstimator>::State;

    pub(crate) const fn choose(_: &mut State, choice: Choice) {
        match choice {}
    }

    pub(crate) const fn in_charge(_: &State) -> Option<u8> {
        Some(0)
    }
}

#[cfg(feature = "large-foaw")]
mod one_estimator {
    pub(crate) use super::large::{WINDOW as LARGE, Window as Large};
}

#[cfg(feature = "large-kalman")]
mod one_estimator {
    pub(crate) use super::large::{FILTER as LARGE, Filter as Large};
}

#[cfg(feature = "large-adaptive")]
mod one_estimator {
    use super::DEVICE;
    use crate::board::RATE_HZ;
    use estimator_core::{CountObserver, Hertz, Observer, Uncertainty, preset};

    const RATE: Hertz = Hertz(RATE_HZ as f64);
    /// As `host-sim tune` has it for these rates.
    const UNSURE: Uncertainty = Uncertainty {
        torque_noise: if EDGES { 3.68e-5 } else { 3.57e-6 },
        load: if EDGES { 8.9e-4 } else { 1e-5 },
        load_time: 0.1,
        friction_share: 0.7,
        boundary_noise: if EDGES { 0.03 } else { 0.0625 },
    };
    const EDGES: bool = cfg!(feature = "edge-capture");
    const COUNTS: CountObserver = preset!(Observer::new(&DEVICE.coupled_motor(), RATE, &UNSURE));

    #[cfg(not(feature = "edge-capture"))]
    pub(crate) type Large = estimator_core::AdaptiveObserver;
    #[cfg(not(feature = "edge-capture"))]
    pub(crate) const LARGE: Large = preset!(COUNTS.learning(DEVICE.large.counts_per_rev, RATE));

    #[cfg(feature = "edge-capture")]
    pub(crate) type Large = estimator_core::AdaptiveEdgeObserver;
    #[cfg(feature = "edge-capture")]
    pub(crate) const LARGE: Large = preset!(
        preset!(COUNTS.with_edges(Hertz(84e6), RATE)).learning(DEVICE.large.counts_per_rev, RATE)
    );
}

#[cfg(any(
    all(feature = "large-foaw", feature = "large-kalman"),
    all(feature = "large-foaw", feature = "large-adaptive"),
    all(feature = "large-kalman", feature = "large-adaptive")
))]
compile_error!("one estimator for the large motor: large-foaw, large-kalman or large-adaptive");

pub(crate) use choice::{Choice, LARGE, Large, choice, choose, in_charge};

/// What the large motor's estimator says of itself after a tick.
#[derive(Clone, Copy)]
pub(crate) struct Estimation {
    /// Variance of its velocity; 0 where the scene needs none.
    pub(crate) variance: Variance,
    /// Its number; `None` while one takes over, and where the scene needs none.
    pub(crate) number: Option<u8>,
}

impl Estimation {
    /// Of an estimator that did not run.
    pub(crate) const NONE: Self = Self {
        variance: Variance(0.0),
        number: None,
    };

    fn of(state: &<Large as VelocityEstimator>::State) -> Self {
        Self {
            variance: LARGE.variance(state),
            number: in_charge(state),
        }
    }
}

/// What is learned of the device while it runs: nothing, by estimators that do not learn.
#[cfg(not(feature = "large-adaptive"))]
pub(crate) type Learned = Skip;
#[cfg(feature = "large-adaptive")]
pub(crate) type Learned = estimator_core::Deviations;

#[cfg(not(feature = "large-adaptive"))]
fn learned(_: &<Large as VelocityEstimator>::State) -> Learned {
    Skip
}
#[cfg(feature = "large-adaptive")]
fn learned(state: &<Large as VelocityEstimator>::State) -> Learned {
    LARGE.deviations(state)
}

/// The handle's estimator.
pub(crate) type Handle = SteadyKalmanTriple;
const HANDLE_MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.small.counts_per_rev,
    RATE,
    4e3
));
pub(crate) const HANDLE: Handle = preset!(SteadyKalman::new(&HANDLE_MODEL));

/// What commands may set: stiffness and damping stay inside the passive region that
/// `host-sim zwidth` finds for these estimators (docs/telemetry.md), torque inside what the small
/// motor makes.
pub(crate) const BOUNDS: Bounds = Bounds {
    stiffness: 0.35,
    damping: 5e-3,
    angle: 6.3,
    torque: (DEVICE.small.torque_constant * DEVICE.small.current_limit) as f32,
    inertia: DEVICE.small.inertia as f32,
    rate: RATE,
};

/// Scenes by number: off, free-air, wall, spring-damper, viscous, detents, texture, hold, torque, inertia,
/// excite.
pub(crate) const SCENES: u8 = 11;
/// The scene of the torque set-point.
pub(crate) const TORQUE_SCENE: u8 = 8;

/// Scenes with their parameters, those of the host simulation.
mod preset {
    #![allow(dead_code, reason = "an image of one scene uses one")]
    use super::*;

    pub(crate) const OFF: Off = Off;
    pub(crate) const FREE_AIR: FreeAir = FreeAir;
    pub(crate) const WALL: Wall = preset!(Wall::new(Radians(0.1), 0.30, 0.0));
    pub(crate) const SPRING: SpringDamper = preset!(SpringDamper::new(Radians(0.0), 0.10, 0.5e-3));
    pub(crate) const VISCOUS: Viscous = preset!(Viscous::new(2e-3));
    pub(crate) const DETENTS: Detents = preset!(Detents::new(8e-3, 24));
    pub(crate) const TEXTURE: Texture = preset!(Texture::new(6e-3, Hertz(150.0), RATE));
    pub(crate) const HOLD: Hold = preset!(Hold::new(0.20, 1e-3));
    pub(crate) const TORQUE: Torque = preset!(Torque::new(0.0));
    pub(crate) const INERTIA: Inertia = preset!(Inertia::new(-2e-6, DEVICE.small.inertia as f32));
    pub(crate) const EXCITE: Excite = preset!(Excite::new(&DEVICE, RATE));
}

macro_rules! image {
    ($($feature:literal, $number:literal, $scene:ident, $preset:ident;)+) => {
        $(
            #[cfg(feature = $feature)]
            use {$scene as TheScene, preset::$preset as THE_SCENE};
            #[cfg(feature = $feature)]
            pub(crate) const FIRST: u8 = $number;
        )+
        #[cfg(any($(feature = $feature),+))]
        mod one;
        #[cfg(any($(feature = $feature),+))]
        pub(crate) use one::{Core, Settings, Tuned};

        #[cfg(not(any($(feature = $feature),+)))]
        mod all;
        #[cfg(not(any($(feature = $feature),+)))]
        pub(crate) use all::{Core, Settings, Tuned};
        /// What arming by itself puts on: the one scene, or free-air.
        #[cfg(not(any($(feature = $feature),+)))]
        pub(crate) const FIRST: u8 = 1;
    };
}

image! {
    "scene-off", 0, Off, OFF;
    "scene-free-air", 1, FreeAir, FREE_AIR;
    "scene-wall", 2, Wall, WALL;
    "scene-spring-damper", 3, SpringDamper, SPRING;
    "scene-viscous", 4, Viscous, VISCOUS;
    "scene-detents", 5, Detents, DETENTS;
    "scene-texture", 6, Texture, TEXTURE;
    "scene-hold", 7, Hold, HOLD;
    "scene-torque", 8, Torque, TORQUE;
    "scene-inertia", 9, Inertia, INERTIA;
    "scene-excite", 10, Excite, EXCITE;
}
