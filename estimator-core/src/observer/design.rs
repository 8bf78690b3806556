//! Gains of an observer, computed at compile time.

use super::correction::{Cells, Edges};
use super::inputs::{AmplifierCurrent, HeldHandle, NoCurrent, SmallEncoder};
use super::learned::Learned;
use super::learning::Fixed;
use super::motion::Motion;
use super::soft_cells::SoftCells;
use super::{Observer, ROWS};
use crate::const_math::{exp, phi1, phi2};
use crate::coupled_motor::CoupledMotor;
use crate::design_error::DesignError;
use crate::device::Device;
use crate::edge_clock::EdgeClock;
use crate::riccati;
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
    const fn is_sane(&self) -> bool {
        let positive = self.torque_noise > 0.0 && self.load > 0.0 && self.load_time > 0.0;
        let finite = self.torque_noise < 1e6 && self.load < 1e6 && self.load_time < 1e9;
        let share = self.friction_share >= 0.0 && self.friction_share <= 1.0;
        positive && finite && share && self.boundary_noise >= 1e-4 && self.boundary_noise <= 1e3
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

/// What belongs to each gap between corrections.
pub(super) struct Table {
    gains: [Gain; ROWS],
    /// Variance of the velocity before the correction, (counts a tick)²; beside the gains, whose
    /// rows are a power of two long.
    velocity_variances: [f32; ROWS],
}

impl Observer<AmplifierCurrent, SmallEncoder, Cells, Fixed> {
    /// The observer of a device that has everything but time stamps: current and both encoders.
    ///
    /// # Errors
    /// [`DesignError::Rate`], [`DesignError::Device`], [`DesignError::ProcessNoise`];
    /// [`DesignError::NotConverged`] and [`DesignError::NotStable`] as
    /// [`Model::steady_gain`](crate::Model::steady_gain), for any row of the table.
    pub const fn new(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let device = match device.checked(rate) {
            Ok(device) => device,
            Err(error) => return Err(error),
        };
        if !uncertainty.is_sane() {
            return Err(DesignError::ProcessNoise);
        }
        let t = rate.period_s();
        let beta = device.large.damping * t / device.large.inertia;
        // Counts a tick² per N·m.
        let per_torque = device.large.counts_per_rev as f64 / (2.0 * core::f64::consts::PI) * t * t
            / device.large.inertia;
        let decay = exp(-(t / uncertainty.load_time).min(700.0));
        let table = match table(beta, decay, per_torque, t, uncertainty) {
            Ok(table) => table,
            Err(error) => return Err(error),
        };
        let friction = per_torque * device.coulomb_friction;
        let share = if friction > 0.0 {
            uncertainty.friction_share
        } else {
            0.0
        };
        let ratio = device.large.counts_per_rev as f64 / device.small_counts_per_rev as f64;
        Ok(Self {
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
            correction: Cells,
            learning: Fixed,
            load_decay: decay as f32,
            way_pole: exp(-(t / WAY_TIME).min(700.0)) as f32,
            friction_share: share as f32,
            gains: table.gains,
            velocity_variances: table.velocity_variances,
        })
    }
}

/// Row n - 1: the steady gain of the filter that is corrected once every n ticks.
const fn table(
    beta: f64,
    decay: f64,
    per_torque: f64,
    t: f64,
    uncertainty: &Uncertainty,
) -> Result<Table, DesignError> {
    let a = [
        [1.0, phi1(beta), phi2(beta)],
        [0.0, exp(-beta), phi1(beta)],
        [0.0, 0.0, decay],
    ];
    let white = per_torque * uncertainty.torque_noise;
    let white = white * white / t;
    let load = per_torque * uncertainty.load;
    let load = load * load * (1.0 - decay * decay);
    let q = [
        [white / 3.0, white / 2.0, 0.0],
        [white / 2.0, white, 0.0],
        [0.0, 0.0, load],
    ];
    if !(white > 0.0 && load > 0.0) {
        return Err(DesignError::ProcessNoise);
    }
    let r = uncertainty.boundary_noise * uncertainty.boundary_noise;
    let none = Gain {
        position: 0.0,
        velocity: 0.0,
        load: 0.0,
        variance: 0.0,
    };
    let mut table = Table {
        gains: [none; ROWS],
        velocity_variances: [0.0; ROWS],
    };
    let (mut a_n, mut q_n) = (a, q);
    let mut row = 0;
    while row < ROWS {
        let steady = match riccati::steady(&a_n, &q_n, r) {
            Ok(steady) => steady,
            Err(error) => return Err(error),
        };
        table.gains[row] = Gain {
            position: steady.gain[0],
            velocity: steady.gain[1],
            load: steady.gain[2],
            variance: steady.innovation as f32,
        };
        table.velocity_variances[row] = steady.velocity[0] as f32;
        q_n = riccati::later_noise(&a, &q, &q_n);
        a_n = riccati::product(&a, &a_n);
        row += 1;
    }
    Ok(table)
}

impl<C: Copy, S: Copy, M: Copy, L: Copy> Observer<C, S, M, L> {
    /// The same motor and gains with these parts.
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
            gains: self.gains,
            velocity_variances: self.velocity_variances,
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
        let clock = match EdgeClock::new(clock, rate) {
            Ok(clock) => clock,
            Err(error) => return Err(error),
        };
        Ok(Self {
            motion: known.motion,
            current: NoCurrent,
            slip: HeldHandle,
            correction: Edges { clock },
            learning: Fixed,
            load_decay: known.load_decay,
            way_pole: known.way_pole,
            friction_share: 0.0,
            gains: known.gains,
            velocity_variances: known.velocity_variances,
        })
    }
}

impl<C: Copy, S: Copy, L: Copy> Observer<C, S, Cells, L> {
    /// The same with edge time stamps by a clock of this frequency, at the rate it was made for.
    ///
    /// # Errors
    /// [`DesignError::Rate`] unless the clock is at least as fast as the rate.
    pub const fn with_edges(
        self,
        clock: Hertz,
        rate: Hertz,
    ) -> Result<Observer<C, S, Edges, L>, DesignError> {
        let clock = match EdgeClock::new(clock, rate) {
            Ok(clock) => clock,
            Err(error) => return Err(error),
        };
        Ok(self.with_parts(self.current, self.slip, Edges { clock }, self.learning))
    }
}

impl<C: Copy, S: Copy, L: Copy> Observer<C, S, Cells, L> {
    /// The same with soft ends of the dead zone, at the rate it was made for: see [`SoftCells`].
    /// `growth`: how fast the position gets uncertain, counts a second.
    ///
    /// # Errors
    /// [`DesignError::Rate`]; [`DesignError::ProcessNoise`] unless `growth` is above zero and
    /// finite.
    pub const fn soft(
        self,
        growth: f64,
        rate: Hertz,
    ) -> Result<Observer<C, S, SoftCells, L>, DesignError> {
        let correction = match SoftCells::new(growth, rate) {
            Ok(correction) => correction,
            Err(error) => return Err(error),
        };
        Ok(self.with_parts(self.current, self.slip, correction, self.learning))
    }
}

impl<C: Copy, S: Copy, M: Copy> Observer<C, S, M, Fixed> {
    /// The same, learning damping, friction and torque constant per inertia, at the rate it was
    /// made for. `counts_per_rev` says how fast half a radian a second is, below which nothing is
    /// learned.
    ///
    /// # Errors
    /// [`DesignError::Rate`], [`DesignError::Device`] without counts.
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
