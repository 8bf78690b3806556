//! One plain function per estimator and duty, built for the board and read by the test `codegen`.
//!
//! Names matter: `start_*` and `update_*` must be clean, `planted_*` must be found out.
#![no_std]

use estimator_core::{
    AdaptiveEdgeObserver, AdaptiveObserver, AdaptiveSoftObserver, AmplifierCurrent, BestFit, Cells,
    CountObserver, CountsPerTick, CoupledMotor, Device, EdgeObserver, Edges, EndFit,
    FiniteDifference, Fixed, Foaw, Handover, HeldHandle, Hertz, Kalman, KalmanMotor, KalmanTriple,
    LateCurrent, Learned, LowPass, MOverT, Model, NoCurrent, Observer, Pll, Sample, Skip,
    SoftObserver, SteadyKalman, SteadyKalmanMotor, SteadyKalmanTriple, TableKalman,
    TableKalmanMotor, TableKalmanTriple, Uncertainty, VelocityEstimator, preset,
};

const RATE: Hertz = Hertz(10_000.0);

const CLOCK: Hertz = Hertz(84e6);

const UNSURE: Uncertainty = Uncertainty {
    torque_noise: 5e-6,
    load: 1e-4,
    load_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.03,
};

const COUNTS: CountObserver = preset!(Observer::new(&CoupledMotor::DCX35L, RATE, &UNSURE));

const SOFT: SoftObserver = preset!(Observer::soft(&CoupledMotor::DCX35L, RATE, &UNSURE));

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
            ) -> <$type as VelocityEstimator>::Output {
                const ESTIMATOR: $type = $value;
                ESTIMATOR.update(state, sample)
            }
        )*
    };
}

probes! {
    start_skip, update_skip: Skip = Skip;
    start_finite_difference, update_finite_difference: FiniteDifference = FiniteDifference;
    start_low_pass, update_low_pass: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, Hertz(120.0), RATE));
    start_low_pass_foaw, update_low_pass_foaw: LowPass<Foaw<15, EndFit>> =
        preset!(LowPass::new(preset!(Foaw::new(15, 1)), Hertz(120.0), RATE));
    start_foaw_1, update_foaw_1: Foaw<1, EndFit> = preset!(Foaw::new(1, 1));
    start_foaw_15_end, update_foaw_15_end: Foaw<15, EndFit> = preset!(Foaw::new(15, 1));
    start_foaw_15_best, update_foaw_15_best: Foaw<15, BestFit> = preset!(Foaw::new(15, 1));
    start_foaw_16_end, update_foaw_16_end: Foaw<16, EndFit> = preset!(Foaw::new(16, 1));
    start_foaw_128_end, update_foaw_128_end: Foaw<128, EndFit> = preset!(Foaw::new(128, 1));
    start_foaw_128_best, update_foaw_128_best: Foaw<128, BestFit> = preset!(Foaw::new(100, 2));
    start_triple, update_triple: KalmanTriple =
        preset!(Kalman::new(&preset!(Model::triple_integrator(4096, RATE, 2e4))));
    start_motor, update_motor: KalmanMotor =
        preset!(Kalman::new(&preset!(Model::motor(&Device::DCX35L, RATE, 0.1))));
    start_table_triple, update_table_triple: TableKalmanTriple<128> =
        preset!(TableKalman::new(&preset!(Model::triple_integrator(4096, RATE, 2e4))));
    start_table_motor, update_table_motor: TableKalmanMotor<1024> =
        preset!(TableKalman::new(&preset!(Model::motor(&Device::DCX35L, RATE, 0.1))));
    start_steady_triple, update_steady_triple: SteadyKalmanTriple =
        preset!(SteadyKalman::new(&preset!(Model::triple_integrator(4096, RATE, 2e4))));
    start_steady_motor, update_steady_motor: SteadyKalmanMotor =
        preset!(SteadyKalman::new(&preset!(Model::motor(&Device::DCX35L, RATE, 0.1))));
    start_late_motor, update_late_motor: LateCurrent<SteadyKalmanMotor> =
        LateCurrent(preset!(SteadyKalman::new(&preset!(Model::motor(&Device::DCX35L, RATE, 0.1)))));
    start_m_over_t, update_m_over_t: MOverT = preset!(MOverT::new(CLOCK, RATE));
    start_observer, update_observer: CountObserver = COUNTS;
    start_observer_edge, update_observer_edge: EdgeObserver =
        preset!(COUNTS.with_edges(CLOCK, RATE));
    start_observer_soft, update_observer_soft: SoftObserver = SOFT;
    start_adaptive_soft, update_adaptive_soft: AdaptiveSoftObserver =
        preset!(SOFT.learning(4096, RATE));
    start_adaptive, update_adaptive: AdaptiveObserver = preset!(COUNTS.learning(4096, RATE));
    start_adaptive_edge, update_adaptive_edge: AdaptiveEdgeObserver =
        preset!(preset!(COUNTS.with_edges(CLOCK, RATE)).learning(4096, RATE));
    start_observer_held, update_observer_held:
        Observer<AmplifierCurrent, HeldHandle, Cells, Fixed> = COUNTS.held();
    start_observer_blind, update_observer_blind: Observer<NoCurrent, HeldHandle, Edges, Fixed> =
        preset!(Observer::blind(&CoupledMotor::DCX35L, RATE, CLOCK, &UNSURE));
    start_adaptive_edge_held, update_adaptive_edge_held:
        Observer<AmplifierCurrent, HeldHandle, Edges, Learned> =
        preset!(preset!(COUNTS.with_edges(CLOCK, RATE)).learning(4096, RATE)).held();
    start_handover, update_handover: Handover<MOverT, Foaw<15, EndFit>> = preset!(Handover::new(
        preset!(MOverT::new(CLOCK, RATE)),
        preset!(Foaw::new(15, 1)),
        16,
        100
    ));
    start_pll, update_pll: Pll = preset!(Pll::new(Hertz(60.0), RATE));
}

/// Does nothing, for comparison.
#[inline(never)]
pub fn empty(_: &Sample) {}

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
        window[sample.large.0 as usize]
    }

    /// Slices with a check.
    #[inline(never)]
    pub fn planted_slice<'a>(window: &'a [f32; 16], sample: &Sample) -> &'a [f32] {
        &window[sample.large.0 as usize..]
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
        i64::from(sample.large.0 as i32) * 0x1_0000_0001 / i64::from(sample.small.0 | 1)
    }

    /// Reads a part of the sample that it should not: large where it should be empty.
    #[inline(never)]
    pub fn planted_not_empty(sample: &Sample) -> f32 {
        sample.current.get()
    }
}
