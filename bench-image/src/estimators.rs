//! What is measured: one line an estimator and rate; peers begin with `peer_`.

use estimator_core::{
    AdaptiveEdgeObserver, AdaptiveObserver, AdaptiveSoftObserver, BestFit, CountObserver,
    CoupledMotor, DesignError, Device, EdgeObserver, EndFit, FiniteDifference, Foaw, Hertz, Kalman,
    KalmanMotor, KalmanTriple, LowPass, MOverT, Model, Observer, Pll, Sample, SoftObserver,
    SteadyKalman, SteadyKalmanMotor, SteadyKalmanTriple, TableKalman, TableKalmanTriple,
    Uncertainty, preset,
};

use crate::peers::{AdsKalman, IdspKalman, IdspLowPass, IdspPll, MiniKalman, NalgebraKalman};
use crate::subject::{Measured, Subject, subjects};

/// For parameters that suit every rate.
const ANY: Hertz = Hertz(0.0);
// Parameters are those of host-sim/presets.toml for these rates and the plant with friction.
const SLOW: Hertz = Hertz(1000.0);
const FAST: Hertz = Hertz(10_000.0);

/// The clock that stamps edges.
const CLOCK: Hertz = Hertz(84e6);

const fn unsure(torque_noise: f64, load: f64, boundary_noise: f64) -> Uncertainty {
    Uncertainty {
        torque_noise,
        load,
        load_time: 0.1,
        friction_share: 0.7,
        boundary_noise,
    }
}

const fn observer(
    rate: Hertz,
    torque_noise: f64,
    load: f64,
    boundary_noise: f64,
) -> Result<CountObserver, DesignError> {
    let unsure = unsure(torque_noise, load, boundary_noise);
    Observer::new(&CoupledMotor::DCX35L, rate, &unsure)
}

const fn soft(rate: Hertz, torque_noise: f64, load: f64) -> Result<SoftObserver, DesignError> {
    let unsure = unsure(torque_noise, load, 0.0625);
    Observer::soft(&CoupledMotor::DCX35L, rate, &unsure)
}

subjects! {
    finite_difference, "finite-difference", ANY: FiniteDifference = FiniteDifference;
    low_pass_1k, "low-pass", SLOW: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, Hertz(186.0), SLOW));
    low_pass_10k, "low-pass", FAST: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, Hertz(148.0), FAST));
    foaw_end_15, "foaw-end-fit, n = 15", ANY: Foaw<15, EndFit> = preset!(Foaw::new(15, 1));
    foaw_end_64, "foaw-end-fit, n = 64", ANY: Foaw<64, EndFit> = preset!(Foaw::new(64, 1));
    foaw_best_15, "foaw-best-fit, n = 15", ANY: Foaw<15, BestFit> = preset!(Foaw::new(15, 1));
    foaw_best_64, "foaw-best-fit, n = 64", ANY: Foaw<64, BestFit> = preset!(Foaw::new(64, 1));
    kalman_triple_1k, "kalman-triple", SLOW: KalmanTriple =
        preset!(Kalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0))));
    kalman_triple_10k, "kalman-triple", FAST: KalmanTriple =
        preset!(Kalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0))));
    kalman_triple_steady_1k, "kalman-triple-steady", SLOW: SteadyKalmanTriple =
        preset!(SteadyKalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0))));
    kalman_triple_steady_10k, "kalman-triple-steady", FAST: SteadyKalmanTriple =
        preset!(SteadyKalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0))));
    kalman_triple_table_1k, "kalman-triple-table", SLOW: TableKalmanTriple<24> =
        preset!(TableKalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0))));
    kalman_triple_table_10k, "kalman-triple-table", FAST: TableKalmanTriple<168> =
        preset!(TableKalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0))));
    kalman_motor_1k, "kalman-motor", SLOW: KalmanMotor =
        preset!(Kalman::new(&preset!(Model::motor(&Device::DCX35L, SLOW, 0.106))));
    kalman_motor_10k, "kalman-motor", FAST: KalmanMotor =
        preset!(Kalman::new(&preset!(Model::motor(&Device::DCX35L, FAST, 0.246))));
    kalman_motor_steady_1k, "kalman-motor-steady", SLOW: SteadyKalmanMotor =
        preset!(SteadyKalman::new(&preset!(Model::motor(&Device::DCX35L, SLOW, 0.106))));
    kalman_motor_steady_10k, "kalman-motor-steady", FAST: SteadyKalmanMotor =
        preset!(SteadyKalman::new(&preset!(Model::motor(&Device::DCX35L, FAST, 0.246))));
    m_over_t_1k, "m-over-t", SLOW: MOverT = preset!(MOverT::new(CLOCK, SLOW));
    m_over_t_10k, "m-over-t", FAST: MOverT = preset!(MOverT::new(CLOCK, FAST));
    observer_1k, "observer", SLOW: CountObserver = preset!(observer(SLOW, 7.01e-5, 7.55e-4, 0.0625));
    observer_10k, "observer", FAST: CountObserver = preset!(observer(FAST, 7.01e-5, 7.55e-4, 0.0625));
    observer_edge_1k, "observer-edge", SLOW: EdgeObserver =
        preset!(preset!(observer(SLOW, 9.21e-5, 9.85e-4, 0.03)).with_edges(CLOCK, SLOW));
    observer_edge_10k, "observer-edge", FAST: EdgeObserver =
        preset!(preset!(observer(FAST, 9.21e-5, 9.85e-4, 0.03)).with_edges(CLOCK, FAST));
    observer_soft_1k, "observer-soft", SLOW: SoftObserver =
        preset!(soft(SLOW, 8e-6, 3e-4));
    observer_soft_10k, "observer-soft", FAST: SoftObserver =
        preset!(soft(FAST, 8e-6, 3e-4));
    adaptive_1k, "adaptive", SLOW: AdaptiveObserver =
        preset!(preset!(observer(SLOW, 5.75e-6, 1.38e-4, 0.0625)).learning(4096, SLOW));
    adaptive_10k, "adaptive", FAST: AdaptiveObserver =
        preset!(preset!(observer(FAST, 5.75e-6, 1.38e-4, 0.0625)).learning(4096, FAST));
    adaptive_soft_1k, "adaptive-soft", SLOW: AdaptiveSoftObserver =
        preset!(preset!(soft(SLOW, 7.27e-6, 2.06e-4)).learning(4096, SLOW));
    adaptive_soft_10k, "adaptive-soft", FAST: AdaptiveSoftObserver =
        preset!(preset!(soft(FAST, 7.27e-6, 2.06e-4)).learning(4096, FAST));
    adaptive_edge_1k, "adaptive-edge", SLOW: AdaptiveEdgeObserver = preset!(
        preset!(preset!(observer(SLOW, 1.55e-5, 3.01e-4, 0.03)).with_edges(CLOCK, SLOW))
            .learning(4096, SLOW)
    );
    adaptive_edge_10k, "adaptive-edge", FAST: AdaptiveEdgeObserver = preset!(
        preset!(preset!(observer(FAST, 4e-5, 3e-4, 0.03)).with_edges(CLOCK, FAST))
            .learning(4096, FAST)
    );
    pll_1k, "pll", SLOW: Pll = preset!(Pll::new(Hertz(271.0), SLOW));
    pll_10k, "pll", FAST: Pll = preset!(Pll::new(Hertz(398.0), FAST));
    peer_idsp_1k, "idsp: kalman", SLOW: IdspKalman =
        IdspKalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0)));
    peer_idsp_10k, "idsp: kalman", FAST: IdspKalman =
        IdspKalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0)));
    peer_nalgebra_1k, "nalgebra by hand", SLOW: NalgebraKalman =
        NalgebraKalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0)));
    peer_nalgebra_10k, "nalgebra by hand", FAST: NalgebraKalman =
        NalgebraKalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0)));
    peer_adskalman_1k, "adskalman", SLOW: AdsKalman =
        AdsKalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0)));
    peer_adskalman_10k, "adskalman", FAST: AdsKalman =
        AdsKalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0)));
    peer_minikalman_1k, "minikalman", SLOW: MiniKalman =
        MiniKalman::new(&preset!(Model::triple_integrator(4096, SLOW, 4370.0)));
    peer_minikalman_10k, "minikalman", FAST: MiniKalman =
        MiniKalman::new(&preset!(Model::triple_integrator(4096, FAST, 3650.0)));
    peer_idsp_pll_1k, "idsp: pll", SLOW: IdspPll = IdspPll::new(Hertz(59.1), SLOW);
    peer_idsp_pll_10k, "idsp: pll", FAST: IdspPll = IdspPll::new(Hertz(148.0), FAST);
    peer_idsp_low_pass_1k, "idsp: low-pass", SLOW: IdspLowPass = IdspLowPass::new(Hertz(159.0), SLOW);
    peer_idsp_low_pass_10k, "idsp: low-pass", FAST: IdspLowPass = IdspLowPass::new(Hertz(175.0), FAST);
}
