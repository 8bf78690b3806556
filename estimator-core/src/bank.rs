//! A bank of Kalman filters that needs no parameters of the device.

mod driven;
mod input;
mod interval;
mod ladder;
mod learned_current;
mod member;
mod regression;
mod stamps;
mod state;
mod uneven;

use crate::confidence::{Confidence, Variance};
use crate::design::DesignError;
use crate::estimator::{AccelerationEstimator, VaryingPeriod, VelocityEstimator};
use crate::interval::{limited_period, smaller};
use crate::memory::{Memory, memory};
use crate::observer::{AdaptiveEdgeObserver, AdaptiveObserver};
use crate::sample::{Sample, Signals};
use crate::units::{CountsPerTick, CountsPerTickSquared, Hertz};

pub use driven::{DrivenBank, DrivenBankState};
pub use input::{BankInput, Followed};
use interval::{Ends, Likelihood};
use ladder::{Ladder, Predict};
pub use learned_current::{LearnedCurrent, LearnedCurrentState};
pub use stamps::{NoStamps, Stamped, Stamps};
pub use state::ModelBankState;
use uneven::Interval;

/// The bank of three members on counts.
pub type Imm = ModelBank<3, NoStamps>;

/// The bank of two members on counts.
pub type ImmPair = ModelBank<2, NoStamps>;

/// The bank of three members on counts and edge time stamps.
pub type ImmEdge = ModelBank<3, Stamped>;

/// The bank on counts beside one that is driven by the motor current.
pub type ImmMotor = DrivenBank<NoStamps, LearnedCurrent>;

/// The bank on counts and edge time stamps beside one that is driven by the motor current.
pub type ImmMotorEdge = DrivenBank<Stamped, LearnedCurrent>;

/// The bank on counts beside one that follows the adaptive observer.
pub type ImmAdaptive = DrivenBank<NoStamps, Followed<AdaptiveObserver>>;

/// The bank on counts and edge time stamps beside one that follows the adaptive observer.
pub type ImmAdaptiveEdge = DrivenBank<Stamped, Followed<AdaptiveEdgeObserver>>;

/// Multiple-model estimator: a moving bank of K Kalman filters. It has no parameter of the device; the
/// control rate alone fixes it, for any number of counts per revolution.
///
/// Every member models the acceleration a as a process that decays with τ = 20 ms (Singer 1970), and
/// a white acceleration besides:
/// ```text
/// dθ/dt = v      dv/dt = a + n      da/dt = -a / τ + m
/// ```
/// The spectral density of m is q counts²/s⁵, that of n is q τ² / 40. Members differ by q alone. The
/// values of q are the 18 rungs of a ladder from 10 to 1e18 counts²/s⁵; the members stand on K
/// neighbouring rungs. One tick is
/// ```text
/// reset      a member with w < 0.003 takes state and covariance of the heaviest one, and w = 0.06
/// move       w > 0.9 of the last member: the bank moves up by a rung; of the first: down. The new
///            member takes state and covariance of its neighbour, and w = 0.2
/// predict    x = F x       P = F P Fᵀ + Q(q)             F: transition of the model over one tick
/// edge       H = [1, -t, t²/2], t the age of the edge    e = boundary - H x
///            S = H P Hᵀ + R    K = P Hᵀ / S              x += K e    P -= K S Kᵀ
///            rounding: S has 1e-6 P_00 more, and P_11 keeps 1e-6 of itself
/// interval   the position plus a noise of variance R lies in the quantisation interval of the count: mean and
///            variance of the truncated Gaussian, whose mean shifts by s_i. In a count that is not
///            new, what exceeds the truncation by an end at √3 standard deviations. Rounding: x_0 has
///            1e-6 (P_00 + 1 count²) more for the truncation, and P_11 keeps 1e-6 of itself
/// weights    w_i = (w_i + c) L_i / Σ    L: density of e; without an edge the probability of the
///            interval
/// surprise   every member is 8 standard deviations off, e² > 64 S: w = 1 of the last one, 0 of the others;
///            40: its P_11 += e² / 10 and P_22 += e² / 100, e² at most 1e4 counts²
/// restart    Σ is no positive finite number: the bank starts anew
/// noise      with stamps R = R (1 - 0.1 ρ)       ρ = e (e' + e'' / 2) / S within ±1, of Σ w_i e_i, Σ w_i S_i and the
///            two edges before; R within 3e-4 and 0.1 counts²; less 0.02 e e' where e e' < 0 as at the edge before, and
///            the tick before had an edge or another count. R = s² where e s < 0, e² > 2 S, s² > 1/2 and none of the
///            last eight products e e' is below 0. At 0.1 counts² no stamp is used
///            without, or with stamps that are not used, s = Σ w_i s_i, s' the last one that was not 0, V = P_00 + R of
///            the last member, r = Σ w_i r_i of the part r_i of V that the interval removes; u = min(0.6 r, 0.5); R
///            within 1e-5 and 1e4 counts²:
///            R = 0.998 R if s = 0 and the count is new
///            R = 0.95 R if s² > u V and none of the last eight products s s' is below 0; else
///            R = R + a (min(s² / V, 1.5) - u) min(V, R + 0.01) - 0.02 s s'    s s' within ±V
///            a = 0.03, but 0.006 where the count stays and s² < u V. s s' < 0 after one that was not is 0, or
///            at least -1/4 count² where the count turned back by one
/// output     v = Σ w_i v_i      a = Σ w_i a_i      variance Σ w_i (P_11,i + (v_i - v)²)
/// ```
/// A density that fills the interval is uniform, and its ends are √3 deviations from its mean. The tails of
/// the Gaussian beyond them are no probability, and are not truncated again at every tick.
///
/// c is the probability that q changes, one a second. The density of e has the tails of a Student
/// distribution, `S^-1/2 (1 + e² / 32 S)^-16`. After a calm motion all members are so sure that an impact
/// surprises them alike, and the ratios of the likelihoods say nothing: hence the surprise. The innovations
/// of an optimal filter are white: if successive ones have opposite signs, R is too small. Without stamps, or where a
/// magnetic encoder makes them too noisy to be used, R is the noise of the counts: it needs no parameter either.
///
/// Rest: 0.3 s after the last change of the count and the last edge, v and a become 0 exactly, and stay
/// 0 until the next change or edge. A shaft slower than 3.3 counts per second is taken for one at rest.
/// A count that alternates between two values is not at rest.
///
/// Over another interval between samples F and Q are those of this interval, c and the time at rest
/// grow with it, and an edge older than τ is not used.
///
/// Units: counts and ticks. Valid for rates from 100 Hz to 100 kHz. The ladder covers encoders of 64 to
/// 1e6 counts per revolution: q grows with the square of the counts, hence by 2.4e8 from one to the
/// other.
///
/// Sources: interacting multiple models, Blom and Bar-Shalom, IEEE Transactions on Automatic Control
/// 33(8), 1988; the moving bank, Maybeck and Hentz, Journal of Guidance, Control, and Dynamics 10(1),
/// 1987; the acceleration, Singer, IEEE Transactions on Aerospace and Electronic Systems 6(4), 1970.
/// The members do not mix their states at each tick; an improbable one is reset instead.
///
/// ```
/// use estimator_core::*;
/// const BANK: Imm = preset!(ModelBank::new(Hertz(1000.0)));
/// let mut state = BANK.start(&Sample::new(Count(0)));
/// let mut v = CountsPerTick(0.0);
/// for tick in 1..400u32 {
///     v = BANK.update(&mut state, &Sample::new(Count(tick * 7 / 2)));
/// }
/// assert!((v.0 - 3.5).abs() < 0.05);
/// assert!(BANK.variance(&state).std_dev().0 < 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct ModelBank<const K: usize, S> {
    ladder: Ladder,
    stamps: S,
    /// Time without a change after which the shaft is at rest, 1/1024 ticks.
    rest: u32,
    /// Probability that q changes in a tick, to one of the other members.
    change: f32,
}

memory!([const K: usize, S: Memory] ModelBank<K, S> { ladder, stamps, rest, change });

/// Time without a change after which the shaft is at rest, s.
const REST: f64 = 0.3;

/// Units of the time without a change in a tick.
const TICK: u32 = 1024;

/// Rate of changes of q, 1/s.
const CHANGES: f64 = 1.0;

/// Range of the control rate, Hz.
const RATES: [f64; 2] = [100.0, 1e5];

/// Refuses a control rate for which no bank is made.
const fn checked(rate: Hertz) -> Result<(), DesignError> {
    if !rate.is_positive() {
        return Err(DesignError::RATE);
    }
    if !(rate.0 >= RATES[0] && rate.0 <= RATES[1]) {
        return Err(DesignError::RATE_OF_BANK);
    }
    Ok(())
}

impl<const K: usize> ModelBank<K, NoStamps> {
    /// The bank on counts, updated at `rate`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::RATE_OF_BANK`].
    pub const fn new(rate: Hertz) -> Result<Self, DesignError> {
        Self::with_stamps(NoStamps, rate)
    }
}

impl<const K: usize> ModelBank<K, Stamped> {
    /// The bank on counts and edges, stamped by a clock of frequency `clock`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::RATE_OF_BANK`], [`DesignError::CLOCK`].
    pub const fn with_edges(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        match Stamped::new(clock, rate) {
            Ok(stamps) => Self::with_stamps(stamps, rate),
            Err(error) => Err(error),
        }
    }
}

impl<const K: usize, S: Copy> ModelBank<K, S> {
    const fn with_stamps(stamps: S, rate: Hertz) -> Result<Self, DesignError> {
        const { assert!(K >= 2 && K <= 8, "2 to 8 members") };
        if let Err(error) = checked(rate) {
            return Err(error);
        }
        Ok(Self {
            ladder: Ladder::new(rate.period_s()),
            stamps,
            rest: (REST * rate.0) as u32 * TICK,
            change: (CHANGES / rate.0 / (K as f64 - 1.0)) as f32,
        })
    }
}

impl<const K: usize, S: Stamps> VelocityEstimator for ModelBank<K, S> {
    type State = ModelBankState<K>;
    const NEEDS: Signals = S::NEEDS;

    fn start(&self, first: &Sample) -> ModelBankState<K> {
        ModelBankState::start(first.count, S::NOISE)
    }

    fn update(&self, state: &mut ModelBankState<K>, sample: &Sample) -> CountsPerTick {
        self.update_of_memory(state, sample)
    }

    // Without a call, which needs the sample in memory.
    #[inline(always)]
    fn update_of_memory(&self, state: &mut ModelBankState<K>, sample: &Sample) -> CountsPerTick {
        match self.advance(state, sample, None, state.reads_stamps()) {
            Some(_) => CountsPerTick(state.velocity()),
            None => CountsPerTick(0.0),
        }
    }
}

impl<const K: usize, S: Stamps> VaryingPeriod for ModelBank<K, S> {
    fn update_over(
        &self,
        state: &mut ModelBankState<K>,
        sample: &Sample,
        period: f32,
    ) -> CountsPerTick {
        if period == 1.0 {
            return self.update(state, sample);
        }
        let period = limited_period(period);
        let over = Over {
            predict: &Interval::new(&self.ladder, period),
            elapsed: (TICK as f32 * period + 0.5) as u32,
            edges_within: smaller(self.ladder.correlation_time(), period),
            change: self.change * period,
        };
        match self.advance_over(state, sample, None, state.reads_stamps(), &over) {
            Some(_) => CountsPerTick(state.velocity()),
            None => CountsPerTick(0.0),
        }
    }
}

/// The interval between two samples, as a bank uses it.
struct Over<'a, P> {
    predict: &'a P,
    /// Its length, 1/1024 ticks.
    elapsed: u32,
    /// Age below which an edge is used, ticks.
    edges_within: f32,
    /// Probability that q changes in it, to one of the other members.
    change: f32,
}

/// How likely a bank found the measurement of a tick.
struct Evidence {
    /// The likelihood, times the root of `variance`.
    likelihood: Likelihood,
    /// Variance of the middle member's innovation, counts²; 1 without an edge.
    variance: f32,
}

impl<const K: usize, S: Stamps> ModelBank<K, S> {
    /// Advances the state by one tick, over which the known acceleration is `input`, counts/tick². An edge
    /// is used if `stamped`. `None` at rest.
    #[inline(always)]
    fn advance(
        &self,
        state: &mut ModelBankState<K>,
        sample: &Sample,
        input: Option<f32>,
        stamped: bool,
    ) -> Option<Evidence> {
        let over = Over {
            predict: &self.ladder,
            elapsed: TICK,
            edges_within: 1.0,
            change: self.change,
        };
        self.advance_over(state, sample, input, stamped, &over)
    }

    /// Advances the state as [`ModelBank::advance`], over the interval `over`.
    #[inline(always)]
    fn advance_over(
        &self,
        state: &mut ModelBankState<K>,
        sample: &Sample,
        input: Option<f32>,
        stamped: bool,
        over: &Over<impl Predict>,
    ) -> Option<Evidence> {
        let displacement = sample.count - state.anchor;
        state.anchor = sample.count;
        let edge = self.stamps.fresh_within(sample, over.edges_within);
        let moved = state.still == 0;
        let turns = state.turns(displacement);
        if displacement.0 != 0 || edge.is_some() {
            state.still = 0;
        } else if state.resting {
            return None;
        } else {
            state.still = state.still.saturating_add(over.elapsed);
        }
        state.resting = false;
        state.reset();
        state.follow();
        state.predict(over.predict, displacement.to_f32());
        if let Some(input) = input {
            state.drive(input);
        }
        let ends = Ends::of(displacement.0 != 0);
        let judged = match edge {
            Some(mut edge) if stamped => {
                if let Some(input) = input {
                    edge.position -= 0.5 * input * edge.age * edge.age;
                }
                state.correct_by_edge(&edge, ends, moved)
            }
            _ => state.correct_by_interval(ends, S::LEARNS_FROM_COUNTS || !stamped, turns),
        };
        let likelihood = state.weigh(&judged, over.change, S::NOISE);
        if state.still >= self.rest {
            state.stop();
        }
        Some(Evidence {
            likelihood,
            variance: judged.variance,
        })
    }
}

impl<const K: usize, S: Stamps> AccelerationEstimator for ModelBank<K, S> {
    fn acceleration(&self, state: &ModelBankState<K>) -> CountsPerTickSquared {
        CountsPerTickSquared(state.acceleration())
    }
}

impl<const K: usize, S: Stamps> Confidence for ModelBank<K, S> {
    fn variance(&self, state: &ModelBankState<K>) -> Variance {
        Variance(state.velocity_variance())
    }
}

#[cfg(test)]
mod tests;
