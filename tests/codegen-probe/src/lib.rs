//! One plain function per estimator and duty, built for the board and read by the test `codegen`.
//!
//! Names matter: `start` and `update` must be clean, `planted_*` must be found out.
#![no_std]

use estimator_core::{
    Adaptive, AmplifierCurrent, BestFit, CountsPerTick, CoupledMotor, EdgeUpdate, EndFit, Foaw,
    Handover, HeldShaft, Hertz, KalmanTriple, LateCurrent, LowPass, MOverT, Model, MotorModel,
    Observer, ObserverDesign, Sample, SteadyKalman, SteadyKalmanMotor, TableKalman,
    TableKalmanMotor, Uncertainty, VelocityEstimator, preset,
};

const RATE: Hertz = Hertz(10_000.0);

const CLOCK: Hertz = Hertz(84e6);

const UNSURE: Uncertainty = Uncertainty {
    torque_noise: 5e-6,
    disturbance: 1e-4,
    disturbance_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.03,
};

macro_rules! probes {
    ($($start:ident, $update:ident: $type:ty = $value:expr;)*) => {
        $(
            /// Starts the estimator.
            #[inline(never)]
            pub fn $start(first: &Sample) -> <$type as VelocityEstimator>::State {
                const ESTIMATOR: $type = $value;
                ESTIMATOR.start(first)
            }

            /// Updates the estimator.
            #[inline(never)]
            pub fn $update(
                state: &mut <$type as VelocityEstimator>::State,
                sample: &Sample,
            ) -> CountsPerTick {
                const ESTIMATOR: $type = $value;
                ESTIMATOR.update(state, sample)
            }
        )*
    };
}

macro_rules! rows {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:ident: $hertz:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        /// The rows of the catalogue: a module per row, and in it a module per variant.
        pub mod rows {
            $(
                #[doc = concat!("Row `", $name, "`.")]
                pub mod $id {
                    use estimator_catalogue::design;
                    use estimator_core::Hertz;

                    #[allow(unused_variables, reason = "a row may have no parameter")]
                    const fn parameters(rate: Hertz, capacity: usize) -> design::$id::Parameters {
                        design::$id::Parameters {
                            $($parameter: tuned::value_for($name, rate, capacity, stringify!($parameter)),)*
                        }
                    }

                    $(
                        #[doc = concat!("With the capacity ", $capacity, ".")]
                        pub mod $variant {
                            use estimator_core as $c;
                            use estimator_core::{CoupledMotor, DesignError, Sample, VelocityEstimator};

                            #[allow(dead_code, reason = "not every design has a capacity")]
                            const $N: usize = $capacity;

                            #[allow(unused_variables, reason = "not every design uses everything")]
                            const ESTIMATOR: $type = {
                                let ($rate, $clock) = (crate::rate($hertz), crate::CLOCK);
                                let $motor = &CoupledMotor::DCX35L;
                                let $p = super::parameters($rate, $capacity);
                                let design: Result<$type, DesignError> = $make;
                                match design {
                                    Ok(estimator) => estimator,
                                    Err(error) => panic!("{}", error.message()),
                                }
                            };

                            /// Starts the estimator.
                            #[inline(never)]
                            pub fn start(first: &Sample) -> <$type as VelocityEstimator>::State {
                                ESTIMATOR.start(first)
                            }

                            /// Updates the estimator.
                            #[inline(never)]
                            pub fn update(
                                state: &mut <$type as VelocityEstimator>::State,
                                sample: &Sample,
                            ) -> estimator_core::CountsPerTick {
                                ESTIMATOR.update(state, sample)
                            }
                        }
                    )*
                }
            )*
        }
    };
}

estimator_catalogue::estimators!(rows);

/// The rate of a variant; [`RATE`] for one that suits every rate.
const fn rate(hertz: f64) -> Hertz {
    if hertz > 0.0 { Hertz(hertz) } else { RATE }
}

// Cases without a row in the catalogue: other sizes, wrappers and parts.
probes! {
    start_low_pass_foaw, update_low_pass_foaw: LowPass<Foaw<15, EndFit>> =
        preset!(LowPass::new(preset!(Foaw::new(15, 1)), Hertz(120.0), RATE));
    start_foaw_1, update_foaw_1: Foaw<1, EndFit> = preset!(Foaw::new(1, 1));
    start_foaw_16_end, update_foaw_16_end: Foaw<16, EndFit> = preset!(Foaw::new(16, 1));
    start_foaw_128_end, update_foaw_128_end: Foaw<128, EndFit> = preset!(Foaw::new(128, 1));
    start_foaw_128_best, update_foaw_128_best: Foaw<128, BestFit> = preset!(Foaw::new(100, 2));
    start_table_motor, update_table_motor: TableKalmanMotor<1024> =
        preset!(TableKalman::new(&preset!(Model::motor(&MotorModel::DCX35L, RATE, 0.1))));
    start_late_motor, update_late_motor: LateCurrent<SteadyKalmanMotor> =
        LateCurrent(preset!(SteadyKalman::new(&preset!(Model::motor(&MotorModel::DCX35L, RATE, 0.1)))));
    start_adaptive_edge_held, update_adaptive_edge_held:
        Observer<AmplifierCurrent, HeldShaft, EdgeUpdate, Adaptive> =
        preset!(
            ObserverDesign::new(&CoupledMotor::DCX35L, RATE, &UNSURE)
                .with_edges(CLOCK)
                .adaptive()
                .held()
                .build()
        );
    start_handover, update_handover: Handover<MOverT, Foaw<15, EndFit>> = preset!(Handover::new(
        preset!(MOverT::new(CLOCK, RATE)),
        preset!(Foaw::new(15, 1)),
        16,
        100
    ));
}

/// Updates a window whose parameters are known at run time only, as after a change of settings.
#[inline(never)]
pub fn update_foaw_tuned(
    foaw: &Foaw<128, BestFit>,
    state: &mut <Foaw<128, BestFit> as VelocityEstimator>::State,
    sample: &Sample,
) -> CountsPerTick {
    foaw.update(state, sample)
}

/// Updates a filter whose parameters are known at run time only.
#[inline(never)]
pub fn update_triple_tuned(
    filter: &KalmanTriple,
    state: &mut <KalmanTriple as VelocityEstimator>::State,
    sample: &Sample,
) -> CountsPerTick {
    filter.update(state, sample)
}

/// Faults.
#[cfg(feature = "planted")]
pub mod planted {
    use estimator_core::Sample;

    /// Indexes with a check.
    #[inline(never)]
    pub fn planted_index(window: &[f32; 16], sample: &Sample) -> f32 {
        window[sample.count.0 as usize]
    }

    /// Slices with a check.
    #[inline(never)]
    pub fn planted_slice<'a>(window: &'a [f32; 16], sample: &Sample) -> &'a [f32] {
        &window[sample.count.0 as usize..]
    }

    /// Unwraps.
    #[inline(never)]
    pub fn planted_unwrap(sample: &Sample) -> u32 {
        sample.edge.unwrap().age.0
    }

    /// Panics two calls away.
    #[inline(never)]
    pub fn planted_indirect(window: &[f32; 16], sample: &Sample) -> f32 {
        1.0 + planted_index(window, sample)
    }

    /// Multiplies in f64, which the board has no hardware for.
    #[inline(never)]
    pub fn planted_double(sample: &Sample) -> f32 {
        (f64::from(sample.current.get()) * 1.000_000_1) as f32
    }

    /// Divides in 64 bits, which the board has no instruction for.
    #[inline(never)]
    pub fn planted_wide_division(sample: &Sample) -> i64 {
        i64::from(sample.count.0 as i32) * 0x1_0000_0001 / i64::from(sample.coupled.0 | 1)
    }
}
