//! Known accelerations that drive a bank.

use super::state::ModelBankState;
use crate::estimator::VelocityEstimator;
use crate::memory::{Memory, memory};
use crate::observer::{Adaptation, Correction, CurrentSource, Observer, SlipSource};
use crate::sample::{Sample, Signals};
use crate::sealed::Sealed;

/// Source of a known acceleration for a [`DrivenBank`](crate::DrivenBank).
pub trait BankInput: Sealed {
    /// State carried from tick to tick.
    type State: Clone + PartialEq;
    /// The parts of a sample that are read.
    const NEEDS: Signals;

    /// The state at the first sample.
    #[doc(hidden)]
    fn start(&self, first: &Sample) -> Self::State;

    /// The mean acceleration over the tick that ends with `sample`, counts/tick²; `None` while
    /// nothing is known. `bank` is the bank without input, before this tick.
    #[doc(hidden)]
    fn input<const K: usize>(
        &self,
        state: &mut Self::State,
        sample: &Sample,
        bank: &ModelBankState<K>,
    ) -> Option<f32>;
}

/// The acceleration that an observer predicts for each tick, before it corrects its velocity by the
/// tick's count or edge: the driven bank corrects by the same measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Followed<E>(pub E);

memory!([E: Memory] Followed<E> { 0 });

impl<E> Sealed for Followed<E> {}

impl<C, S, M, L> BankInput for Followed<Observer<C, S, M, L>>
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Adaptation,
{
    type State = <Observer<C, S, M, L> as VelocityEstimator>::State;
    const NEEDS: Signals = Observer::<C, S, M, L>::NEEDS;

    fn start(&self, first: &Sample) -> Self::State {
        self.0.start(first)
    }

    #[inline(always)]
    fn input<const K: usize>(
        &self,
        state: &mut Self::State,
        sample: &Sample,
        _: &ModelBankState<K>,
    ) -> Option<f32> {
        Some(self.0.advance(state, sample).predicted_change)
    }
}

#[cfg(test)]
mod tests {
    use super::{BankInput, Followed};
    use crate::bank::ModelBankState;
    use crate::design::const_math::exp;
    use crate::models::CoupledMotor;
    use crate::observer::{ObserverDesign, Uncertainty};
    use crate::sample::Sample;
    use crate::units::{Amps, Count, Hertz};

    const UNCERTAINTY: Uncertainty = Uncertainty {
        torque_noise: 5e-6,
        disturbance: 1e-4,
        disturbance_time: 0.1,
        friction_share: 0.7,
        boundary_noise: 0.0625,
    };

    #[test]
    fn input_is_the_acceleration_by_the_torque_before_the_correction() {
        let rate = Hertz(1000.0);
        let mut device = CoupledMotor::DCX35L;
        device.coulomb_friction = 0.0;
        device.amplifier_lag = 0.0;
        let observer = ObserverDesign::new(&device, rate, &UNCERTAINTY).adaptive();
        let input = Followed(observer.build().unwrap());
        let bank = ModelBankState::<3>::start(Count(0), 1e-3);
        let motor = device.motor;
        // The velocity after a tick from rest: a torque over the damping, with the pole of both.
        let counts_per_tick = f64::from(motor.counts_per_rev) / core::f64::consts::TAU / rate.0;
        let approached = 1.0 - exp(-motor.damping / motor.inertia / rate.0);
        for amps in [0.5, -2.0] {
            let torque = motor.torque_constant * f64::from(amps);
            let expected = torque / motor.damping * approached * counts_per_tick;
            for count in [0, 1, 40u32] {
                let sample = |count| Sample::new(Count(count)).with_current(Amps::new(amps));
                let mut state = input.start(&sample(0));
                let found = input.input(&mut state, &sample(count), &bank).unwrap();
                let ratio = f64::from(found) / expected;
                assert!((ratio - 1.0).abs() < 1e-4, "{amps} {count}: {ratio}");
            }
        }
    }
}
