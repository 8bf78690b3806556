//! Gains of an observer, computed at compile time.

use super::Observer;
use super::correction::{Cells, Edges};
use super::inputs::{AmplifierCurrent, HeldHandle, NoCurrent, SmallEncoder};
use super::learned::Learned;
use super::learning::Fixed;
use super::motion::Motion;
use super::soft_cells::SoftCells;
use super::table::Table;
use crate::const_math::{exp, phi1, phi2};
use crate::coupled_motor::CoupledMotor;
use crate::design_error::DesignError;
use crate::device::Device;
use crate::units::Hertz;

/// What an observer is unsure of. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// White torque on the large shaft, N·m/√Hz.
    pub torque_noise: f64,
    /// Standard deviation of a slow torque that the model does not know, N·m.
    pub load: f64,
    /// Correlation time of that torque, s.
    pub load_time: f64,
    /// Part of it that is taken for friction: it turns round with the motion, and holds a rotor
    /// at rest. 0 to 1.
    pub friction_share: f64,
    /// Error of a boundary's position, counts: for a perfect disc about 1/16, for the rounding of
    /// the model.
    pub boundary_noise: f64,
}

/// Time over which the direction of motion is averaged to tell friction from what pushes, s: an
/// innovation shows what went wrong over about the time since the last few.
const WAY_TIME: f64 = 8e-3;

impl Uncertainty {
    /// The uncertainty itself, if every value is in its range.
    const fn checked(&self) -> Result<&Self, DesignError> {
        if !(self.torque_noise > 0.0 && self.torque_noise < 1e6) {
            return Err(DesignError::TORQUE_NOISE);
        }
        if !(self.load > 0.0 && self.load < 1e6) {
            return Err(DesignError::LOAD);
        }
        if !(self.load_time > 0.0 && self.load_time < 1e9) {
            return Err(DesignError::LOAD_TIME);
        }
        if !(self.friction_share >= 0.0 && self.friction_share <= 1.0) {
            return Err(DesignError::FRICTION_SHARE);
        }
        if !(self.boundary_noise >= 1e-4 && self.boundary_noise <= 1e3) {
            return Err(DesignError::BOUNDARY_NOISE);
        }
        Ok(self)
    }
}

/// Gain of one correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Of the position.
    pub position: f32,
    /// Of the velocity, counts a tick per count.
    pub velocity: f32,
    /// Of the unknown torque, counts a tick² per count.
    pub load: f32,
    /// Variance of the innovation, counts².
    pub variance: f32,
}

/// An [`Uncertainty`] in counts and ticks.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    /// Variance of the velocity by a tick's white torque, (counts a tick)².
    pub(super) white: f64,
    /// The same of the unknown torque, (counts a tick²)².
    pub(super) load: f64,
    /// What is left of the unknown torque after a tick.
    pub(super) decay: f64,
    /// Standard deviation of a boundary's position, counts.
    pub(super) boundary: f64,
}

impl Noise {
    /// `per_torque`: counts a tick² per N·m.
    const fn new(uncertainty: &Uncertainty, per_torque: f64, t: f64) -> Result<Self, DesignError> {
        let decay = exp(-(t / uncertainty.load_time).min(700.0));
        let white = per_torque * uncertainty.torque_noise;
        let load = per_torque * uncertainty.load;
        let noise = Self {
            white: white * white / t,
            load: load * load * (1.0 - decay * decay),
            decay,
            boundary: uncertainty.boundary_noise,
        };
        if !(noise.white > 0.0) {
            return Err(DesignError::TORQUE_NOISE);
        }
        if !(noise.load > 0.0) {
            return Err(DesignError::LOAD);
        }
        Ok(noise)
    }
}

/// A motor with what drives it, and what its correction is made of.
struct Plan {
    motor: Observer<AmplifierCurrent, SmallEncoder, (), Fixed>,
    /// b T / J.
    beta: f64,
    noise: Noise,
}

impl Plan {
    const fn new(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let device = match device.checked(rate) {
            Ok(device) => device,
            Err(error) => return Err(error),
        };
        let uncertainty = match uncertainty.checked() {
            Ok(uncertainty) => uncertainty,
            Err(error) => return Err(error),
        };
        let t = rate.period_s();
        let beta = device.large.damping * t / device.large.inertia;
        // Counts a tick² per N·m.
        let per_torque = device.large.counts_per_rev as f64 / (2.0 * core::f64::consts::PI) * t * t
            / device.large.inertia;
        let noise = match Noise::new(uncertainty, per_torque, t) {
            Ok(noise) => noise,
            Err(error) => return Err(error),
        };
        let friction = per_torque * device.coulomb_friction;
        let share = if friction > 0.0 {
            uncertainty.friction_share
        } else {
            0.0
        };
        let ratio = device.large.counts_per_rev as f64 / device.small_counts_per_rev as f64;
        let motor = Observer {
            motion: Motion {
                phi0: exp(-beta) as f32,
                phi1: phi1(beta) as f32,
                phi2: phi2(beta) as f32,
                coupling: beta as f32,
                friction: friction as f32,
            },
            current: AmplifierCurrent::new(
                per_torque * device.large.torque_constant,
                device.amplifier_lag / t,
            ),
            slip: SmallEncoder {
                ratio: ratio as f32,
            },
            correction: (),
            learning: Fixed,
            load_decay: noise.decay as f32,
            way_pole: exp(-(t / WAY_TIME).min(700.0)) as f32,
            friction_share: share as f32,
        };
        Ok(Self { motor, beta, noise })
    }

    /// The same motor with this correction.
    const fn corrected_by<M: Copy>(
        self,
        correction: M,
    ) -> Observer<AmplifierCurrent, SmallEncoder, M, Fixed> {
        let motor = self.motor;
        motor.with_parts(motor.current, motor.slip, correction, motor.learning)
    }
}

impl Observer<AmplifierCurrent, SmallEncoder, Cells, Fixed> {
    /// The observer of a device that has everything but time stamps: current and both encoders.
    ///
    /// # Errors
    /// The constant of [`DesignError`] for the rate, for the constant of `device` or for the value of
    /// `uncertainty` that is out of its range; [`DesignError::NOT_CONVERGED`] and
    /// [`DesignError::NOT_STABLE`] for any row of the table.
    pub const fn new(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let plan = match Plan::new(device, rate, uncertainty) {
            Ok(plan) => plan,
            Err(error) => return Err(error),
        };
        match Table::new(plan.beta, &plan.noise) {
            Ok(table) => Ok(plan.corrected_by(Cells { table })),
            Err(error) => Err(error),
        }
    }

    /// The gain of a correction after `ticks` ticks without one.
    #[must_use]
    pub fn gain(&self, ticks: usize) -> Gain {
        *self.correction.table.gain(ticks as f32)
    }
}

impl Observer<AmplifierCurrent, SmallEncoder, SoftCells, Fixed> {
    /// The same, but of counts that say something inside their cell too: see [`SoftCells`].
    ///
    /// # Errors
    /// As [`Observer::new`]; [`DesignError::TORQUE_NOISE_FOR_SOFT`] too if the white torque alone
    /// spreads the velocity by less than 1e-9 or more than 512 counts a tick in a tick.
    pub const fn soft(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let plan = match Plan::new(device, rate, uncertainty) {
            Ok(plan) => plan,
            Err(error) => return Err(error),
        };
        match SoftCells::new(plan.beta, &plan.noise) {
            Ok(cells) => Ok(plan.corrected_by(cells)),
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, M: Copy, L: Copy> Observer<C, S, M, L> {
    /// The same motor with these parts.
    const fn with_parts<D: Copy, T: Copy, N: Copy, K: Copy>(
        self,
        current: D,
        slip: T,
        correction: N,
        learning: K,
    ) -> Observer<D, T, N, K> {
        Observer {
            motion: self.motion,
            current,
            slip,
            correction,
            learning,
            load_decay: self.load_decay,
            way_pole: self.way_pole,
            friction_share: self.friction_share,
        }
    }
}

impl<M: Copy, L: Copy> Observer<AmplifierCurrent, SmallEncoder, M, L> {
    /// The same for a device without the small encoder: its handle is taken to stand still.
    #[must_use]
    pub const fn held(self) -> Observer<AmplifierCurrent, HeldHandle, M, L> {
        self.with_parts(self.current, HeldHandle, self.correction, self.learning)
    }
}

impl Observer<NoCurrent, HeldHandle, Edges, Fixed> {
    /// The observer of a device that measures no current, by edge time stamps of this clock.
    ///
    /// Damping and friction answer to a current: here they are in the unknown torque too, which
    /// wants to be large. Counts alone say too little for that; for them there is
    /// [`KalmanTriple`](crate::KalmanTriple).
    ///
    /// # Errors
    /// As [`Observer::new`] and [`Observer::with_edges`].
    pub const fn blind(
        device: &CoupledMotor,
        rate: Hertz,
        clock: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let unknown = CoupledMotor {
            large: Device {
                damping: 0.0,
                ..device.large
            },
            coulomb_friction: 0.0,
            ..*device
        };
        let known = match Observer::new(&unknown, rate, uncertainty) {
            Ok(known) => known,
            Err(error) => return Err(error),
        };
        match Edges::new(clock, rate, known.correction) {
            Ok(edges) => {
                // No friction that could be wrong holds the rotor inside its cell.
                let edges = Edges {
                    unstamped: 0.0,
                    ..edges
                };
                Ok(known.with_parts(NoCurrent, HeldHandle, edges, Fixed))
            }
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, L: Copy> Observer<C, S, Cells, L> {
    /// The same with edge time stamps by a clock of this frequency, at the rate it was made for.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CLOCK`].
    pub const fn with_edges(
        self,
        clock: Hertz,
        rate: Hertz,
    ) -> Result<Observer<C, S, Edges, L>, DesignError> {
        match Edges::new(clock, rate, self.correction) {
            Ok(edges) => Ok(self.with_parts(self.current, self.slip, edges, self.learning)),
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, M: Copy> Observer<C, S, M, Fixed> {
    /// The same, learning damping, friction and torque constant per inertia, at the rate it was
    /// made for. `counts_per_rev` says how fast half a radian a second is, below which nothing is
    /// learned.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`].
    pub const fn learning(
        self,
        counts_per_rev: u32,
        rate: Hertz,
    ) -> Result<Observer<C, S, M, Learned>, DesignError> {
        let learning = match Learned::new(counts_per_rev, rate) {
            Ok(learning) => learning,
            Err(error) => return Err(error),
        };
        Ok(self.with_parts(self.current, self.slip, self.correction, learning))
    }
}
