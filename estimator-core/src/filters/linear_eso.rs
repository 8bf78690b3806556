//! Linear extended-state observer.

use crate::design::DesignError;
use crate::estimator::VelocityEstimator;
use crate::memory::memory;
use crate::models::MotorModel;
use crate::sample::{Sample, Signals};
use crate::units::{CountsPerTick, Hertz};

use super::alpha_beta_gamma::{AlphaBetaGamma, AlphaBetaGammaState};

/// Linear extended-state observer (ESO): position, velocity, and as third state every acceleration that
/// the motor current does not explain.
///
/// It is the [`AlphaBetaGamma`] filter with the motor's acceleration as known input. In counts and ticks,
/// with `b0 = counts_per_rev Kt / (2 π J rate²)` and `p = exp(-2 π f / rate)`:
/// ```text
/// u = b0 i      e = y_k - (θ + v + (a + u)/2)      θ = θ + v + (a + u)/2 + (1 - p³) e
/// v = v + a + u + 3/2 (1 - p)² (1 + p) e           a = a + (1 - p)³ e
/// ```
/// The position is stored as for [`AlphaBetaGamma`]. All three poles lie at p, the discrete form of one
/// bandwidth for all poles. The velocity follows the current without delay, and other constant torques
/// without error. Damping and friction belong to the third state. A wrong b0 does too: with the current
/// of a constant torque the velocity stays exact, and only changes of the torque make an error.
///
/// Valid for f from 1e-6 to 1/2 of the rate. Sources: Han, From PID to active disturbance rejection
/// control, IEEE Trans. Industrial Electronics 56, 2009; one bandwidth for all poles: Gao, Scaling and
/// bandwidth-parameterization based controller tuning, American Control Conference 2003; discrete form:
/// Miklosovic, Radke and Gao, Discrete implementation and generalization of the extended state observer,
/// American Control Conference 2006.
///
/// ```
/// use estimator_core::{Amps, Count, Hertz, LinearEso, MotorModel, Sample, VelocityEstimator, preset};
/// const RATE: Hertz = Hertz(1000.0);
/// // 1 A accelerates by 1 count per tick².
/// const MOTOR: MotorModel = MotorModel {
///     counts_per_rev: 4096,
///     inertia: 4096.0 / (2.0 * core::f64::consts::PI) * 1e-6,
///     damping: 0.0,
///     torque_constant: 1.0,
/// };
/// const OBSERVER: LinearEso = preset!(LinearEso::new(&MOTOR, RATE, Hertz(20.0)));
/// let mut state = OBSERVER.start(&Sample::new(Count(0)));
/// for k in 1..100u32 {
///     // Position k², acceleration 2 counts per tick²: exact from the first tick on.
///     let sample = Sample::new(Count(k * k)).with_current(Amps::new(2.0));
///     let v = OBSERVER.update(&mut state, &sample).0;
///     assert!((v - 2.0 * k as f32).abs() < 1e-4);
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LinearEso {
    filter: AlphaBetaGamma,
    /// b0, counts/tick² per A.
    per_amp: f32,
}

memory!(LinearEso { filter, per_amp });

impl LinearEso {
    /// An observer of `motor` with its three poles at the frequency `bandwidth`, updated at `rate`. It
    /// does not read the motor's damping.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::BANDWIDTH`]; the errors of [`MotorModel::checked`];
    /// [`DesignError::RATE_FOR_CURRENT`].
    pub const fn new(
        motor: &MotorModel,
        rate: Hertz,
        bandwidth: Hertz,
    ) -> Result<Self, DesignError> {
        let filter = match AlphaBetaGamma::new(bandwidth, rate) {
            Ok(filter) => filter,
            Err(error) => return Err(error),
        };
        let motor = match motor.checked() {
            Ok(motor) => motor,
            Err(error) => return Err(error),
        };
        let t = rate.period_s();
        let per_amp = motor.counts_per_rev as f64 * motor.torque_constant * t * t / motor.inertia;
        if !(per_amp > 0.0 && per_amp < 1e6) {
            return Err(DesignError::RATE_FOR_CURRENT);
        }
        Ok(Self {
            filter,
            per_amp: (per_amp / (2.0 * core::f64::consts::PI)) as f32,
        })
    }
}

impl VelocityEstimator for LinearEso {
    type State = AlphaBetaGammaState;
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    fn start(&self, first: &Sample) -> AlphaBetaGammaState {
        self.filter.start(first)
    }

    #[inline(always)]
    fn update(&self, state: &mut AlphaBetaGammaState, sample: &Sample) -> CountsPerTick {
        let known = self.per_amp * sample.current.get();
        self.filter
            .tick(state, sample, state.acceleration() + known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Amps, Count};

    const RATE: Hertz = Hertz(1000.0);

    /// The paper's motor with a friction-free bearing.
    fn observer(bandwidth: f64) -> LinearEso {
        LinearEso::new(&MotorModel::DCX35L, RATE, Hertz(bandwidth)).unwrap()
    }

    /// counts/tick² per A of the paper's motor.
    fn per_amp() -> f64 {
        let motor = MotorModel::DCX35L;
        let per_rad = f64::from(motor.counts_per_rev) / core::f64::consts::TAU;
        per_rad * motor.torque_constant / motor.inertia * 1e-6
    }

    /// Velocities of the observer with position, velocity and disturbance as states, stepped by matrices
    /// in f64, with the position kept as such.
    #[test]
    fn velocity_is_that_of_the_observer_in_state_space() {
        let p = (-core::f64::consts::TAU * 30.0 / RATE.0).exp();
        let gains = [
            1.0 - p * p * p,
            1.5 * (1.0 - p) * (1.0 - p) * (1.0 + p),
            (1.0 - p) * (1.0 - p) * (1.0 - p),
        ];
        let observer = observer(30.0);
        let mut state = observer.start(&Sample::new(Count(5)));
        let mut x = [5.0, 0.0, 0.0];
        for k in 1..2000u32 {
            let amps = f64::from(k % 37) / 20.0 - 0.9;
            let count = 5 + (k * k / 300) % 5000;
            let u = per_amp() * amps;
            x = [x[0] + x[1] + 0.5 * (x[2] + u), x[1] + x[2] + u, x[2]];
            let innovation = f64::from(count) - x[0];
            for (x, gain) in x.iter_mut().zip(gains) {
                *x += gain * innovation;
            }
            let sample = Sample::new(Count(count)).with_current(Amps::new(amps as f32));
            let v = f64::from(observer.update(&mut state, &sample).0);
            assert!((v - x[1]).abs() <= 1e-4, "{k}: {v} for {}", x[1]);
        }
    }

    /// From the start on, without waiting for the third state.
    #[test]
    fn torque_of_the_known_current_is_followed_at_once() {
        let observer = observer(5.0);
        let mut state = observer.start(&Sample::new(Count(0)));
        let (mut position, mut velocity) = (0.0f64, 0.0f64);
        for tick in 0..400 {
            let amps = if tick / 50 % 2 == 0 { 8.0 } else { -8.0 };
            position += velocity + 0.5 * per_amp() * amps;
            velocity += per_amp() * amps;
            let count = Count(f64::round(position) as i64 as u32);
            let sample = Sample::new(count).with_current(Amps::new(amps as f32));
            let v = f64::from(observer.update(&mut state, &sample).0);
            // Half a count of rounding, through poles that pass 2 π 5/1000 = 0.03 of it in a tick.
            assert!((v - velocity).abs() < 0.05, "{tick}: {v} for {velocity}");
        }
    }

    /// A wrong b0 is a constant torque, which the third state takes.
    #[test]
    fn constant_torque_of_a_wrong_gain_is_learned() {
        let wrong = MotorModel {
            torque_constant: -0.5 * MotorModel::DCX35L.torque_constant,
            ..MotorModel::DCX35L
        };
        let refused = LinearEso::new(&wrong, RATE, Hertz(20.0)).err();
        assert_eq!(refused, Some(DesignError::TORQUE_CONSTANT));
        let wrong = MotorModel {
            inertia: 0.1 * MotorModel::DCX35L.inertia,
            ..MotorModel::DCX35L
        };
        let observer = LinearEso::new(&wrong, RATE, Hertz(20.0)).unwrap();
        let mut state = observer.start(&Sample::new(Count(0)));
        let mut v = 0.0;
        for k in 1..400u32 {
            // 1 count per tick², explained as ten times as much.
            let sample = Sample::new(Count(k * k / 2));
            let amps = Amps::new((1.0 / per_amp()) as f32);
            v = observer.update(&mut state, &sample.with_current(amps)).0;
        }
        // Half a count of rounding at every second tick.
        assert!((v - 399.0).abs() < 0.05, "{v}");
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let motor = MotorModel::DCX35L;
        let new = |motor: MotorModel, rate, bandwidth| {
            LinearEso::new(&motor, Hertz(rate), Hertz(bandwidth)).err()
        };
        assert_eq!(new(motor, 1000.0, 20.0), None);
        assert_eq!(new(motor, 0.0, 20.0), Some(DesignError::RATE));
        assert_eq!(new(motor, 1000.0, 501.0), Some(DesignError::BANDWIDTH));
        assert_eq!(new(motor, 1.0, 0.1), Some(DesignError::RATE_FOR_CURRENT));
        let light = MotorModel {
            inertia: 0.0,
            ..motor
        };
        assert_eq!(new(light, 1000.0, 20.0), Some(DesignError::INERTIA));
    }
}
