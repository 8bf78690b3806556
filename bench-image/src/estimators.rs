//! What is measured: one line an estimator and rate; peers begin with `peer_`.

use estimator_core::{
    AdaptiveEdgeObserver, AdaptiveObserver, AdaptiveSoftObserver, BestFit, CountObserver,
    CoupledMotor, CurrentInput, DesignError, Device, EdgeObserver, EndFit, FiniteDifference, Foaw,
    Hertz, Kalman, KalmanMotor, KalmanTriple, LowPass, MOverT, Model, NoInput, Observer, Pll,
    Sample, SoftObserver, SteadyKalman, SteadyKalmanMotor, SteadyKalmanTriple, TableKalman,
    TableKalmanTriple, preset,
};

use crate::peers::{AdsKalman, IdspKalman, IdspLowPass, IdspPll, MiniKalman, NalgebraKalman};
use crate::subject::{Measured, Subject, subjects};

/// For parameters that suit every rate.
const ANY: Hertz = Hertz(0.0);
const SLOW: Hertz = Hertz(1000.0);
const FAST: Hertz = Hertz(10_000.0);

/// The clock that stamps edges.
pub const CLOCK: Hertz = Hertz(84e6);

const fn observer(tuned_as: &str, rate: Hertz) -> Result<CountObserver, DesignError> {
    let unsure = tuned::uncertainty(tuned_as, rate);
    Observer::new(&CoupledMotor::DCX35L, rate, &unsure)
}

const fn soft(tuned_as: &str, rate: Hertz) -> Result<SoftObserver, DesignError> {
    let unsure = tuned::uncertainty(tuned_as, rate);
    Observer::soft(&CoupledMotor::DCX35L, rate, &unsure)
}

const fn triple(rate: Hertz) -> Result<Model<3, NoInput>, DesignError> {
    let jerk = tuned::value("kalman-triple", rate, "jerk");
    Model::triple_integrator(4096, rate, jerk)
}

const fn motor(rate: Hertz) -> Result<Model<2, CurrentInput>, DesignError> {
    let noise = tuned::value("kalman-motor", rate, "current_noise");
    Model::motor(&Device::DCX35L, rate, noise)
}

const fn hertz(estimator: &str, rate: Hertz, parameter: &str) -> Hertz {
    Hertz(tuned::value(estimator, rate, parameter))
}

subjects! {
    finite_difference, "finite-difference", ANY: FiniteDifference = FiniteDifference;
    low_pass_1k, "low-pass", SLOW: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, hertz("low-pass", SLOW, "cutoff_hz"), SLOW));
    low_pass_10k, "low-pass", FAST: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, hertz("low-pass", FAST, "cutoff_hz"), FAST));
    foaw_end_15, "foaw-end-fit, n = 15", ANY: Foaw<15, EndFit> = preset!(Foaw::new(15, 1));
    foaw_end_64, "foaw-end-fit, n = 64", ANY: Foaw<64, EndFit> = preset!(Foaw::new(64, 1));
    foaw_best_15, "foaw-best-fit, n = 15", ANY: Foaw<15, BestFit> = preset!(Foaw::new(15, 1));
    foaw_best_64, "foaw-best-fit, n = 64", ANY: Foaw<64, BestFit> = preset!(Foaw::new(64, 1));
    kalman_triple_1k, "kalman-triple", SLOW: KalmanTriple =
        preset!(Kalman::new(&preset!(triple(SLOW))));
    kalman_triple_10k, "kalman-triple", FAST: KalmanTriple =
        preset!(Kalman::new(&preset!(triple(FAST))));
    kalman_triple_steady_1k, "kalman-triple-steady", SLOW: SteadyKalmanTriple =
        preset!(SteadyKalman::new(&preset!(triple(SLOW))));
    kalman_triple_steady_10k, "kalman-triple-steady", FAST: SteadyKalmanTriple =
        preset!(SteadyKalman::new(&preset!(triple(FAST))));
    kalman_triple_table_1k, "kalman-triple-table", SLOW: TableKalmanTriple<24> =
        preset!(TableKalman::new(&preset!(triple(SLOW))));
    kalman_triple_table_10k, "kalman-triple-table", FAST: TableKalmanTriple<168> =
        preset!(TableKalman::new(&preset!(triple(FAST))));
    kalman_motor_1k, "kalman-motor", SLOW: KalmanMotor =
        preset!(Kalman::new(&preset!(motor(SLOW))));
    kalman_motor_10k, "kalman-motor", FAST: KalmanMotor =
        preset!(Kalman::new(&preset!(motor(FAST))));
    kalman_motor_steady_1k, "kalman-motor-steady", SLOW: SteadyKalmanMotor =
        preset!(SteadyKalman::new(&preset!(motor(SLOW))));
    kalman_motor_steady_10k, "kalman-motor-steady", FAST: SteadyKalmanMotor =
        preset!(SteadyKalman::new(&preset!(motor(FAST))));
    m_over_t_1k, "m-over-t", SLOW: MOverT = preset!(MOverT::new(CLOCK, SLOW));
    m_over_t_10k, "m-over-t", FAST: MOverT = preset!(MOverT::new(CLOCK, FAST));
    observer_1k, "observer", SLOW: CountObserver = preset!(observer("observer", SLOW));
    observer_10k, "observer", FAST: CountObserver = preset!(observer("observer", FAST));
    observer_edge_1k, "observer-edge", SLOW: EdgeObserver =
        preset!(preset!(observer("observer-edge", SLOW)).with_edges(CLOCK, SLOW));
    observer_edge_10k, "observer-edge", FAST: EdgeObserver =
        preset!(preset!(observer("observer-edge", FAST)).with_edges(CLOCK, FAST));
    observer_soft_1k, "observer-soft", SLOW: SoftObserver =
        preset!(soft("observer-soft", SLOW));
    observer_soft_10k, "observer-soft", FAST: SoftObserver =
        preset!(soft("observer-soft", FAST));
    adaptive_1k, "adaptive", SLOW: AdaptiveObserver =
        preset!(preset!(observer("adaptive", SLOW)).learning(4096, SLOW));
    adaptive_10k, "adaptive", FAST: AdaptiveObserver =
        preset!(preset!(observer("adaptive", FAST)).learning(4096, FAST));
    adaptive_soft_1k, "adaptive-soft", SLOW: AdaptiveSoftObserver =
        preset!(preset!(soft("adaptive-soft", SLOW)).learning(4096, SLOW));
    adaptive_soft_10k, "adaptive-soft", FAST: AdaptiveSoftObserver =
        preset!(preset!(soft("adaptive-soft", FAST)).learning(4096, FAST));
    adaptive_edge_1k, "adaptive-edge", SLOW: AdaptiveEdgeObserver = preset!(
        preset!(preset!(observer("adaptive-edge", SLOW)).with_edges(CLOCK, SLOW))
            .learning(4096, SLOW)
    );
    adaptive_edge_10k, "adaptive-edge", FAST: AdaptiveEdgeObserver = preset!(
        preset!(preset!(observer("adaptive-edge", FAST)).with_edges(CLOCK, FAST))
            .learning(4096, FAST)
    );
    pll_1k, "pll", SLOW: Pll = preset!(Pll::new(hertz("pll", SLOW, "bandwidth_hz"), SLOW));
    pll_10k, "pll", FAST: Pll = preset!(Pll::new(hertz("pll", FAST, "bandwidth_hz"), FAST));
    peer_idsp_1k, "idsp: kalman", SLOW: IdspKalman =
        IdspKalman::new(&preset!(triple(SLOW)));
    peer_idsp_10k, "idsp: kalman", FAST: IdspKalman =
        IdspKalman::new(&preset!(triple(FAST)));
    peer_nalgebra_1k, "nalgebra by hand", SLOW: NalgebraKalman =
        NalgebraKalman::new(&preset!(triple(SLOW)));
    peer_nalgebra_10k, "nalgebra by hand", FAST: NalgebraKalman =
        NalgebraKalman::new(&preset!(triple(FAST)));
    peer_adskalman_1k, "adskalman", SLOW: AdsKalman =
        AdsKalman::new(&preset!(triple(SLOW)));
    peer_adskalman_10k, "adskalman", FAST: AdsKalman =
        AdsKalman::new(&preset!(triple(FAST)));
    peer_minikalman_1k, "minikalman", SLOW: MiniKalman =
        MiniKalman::new(&preset!(triple(SLOW)));
    peer_minikalman_10k, "minikalman", FAST: MiniKalman =
        MiniKalman::new(&preset!(triple(FAST)));
    peer_idsp_pll_1k, "idsp: pll", SLOW: IdspPll = IdspPll::new(Hertz(59.1), SLOW);
    peer_idsp_pll_10k, "idsp: pll", FAST: IdspPll = IdspPll::new(Hertz(148.0), FAST);
    peer_idsp_low_pass_1k, "idsp: low-pass", SLOW: IdspLowPass = IdspLowPass::new(Hertz(159.0), SLOW);
    peer_idsp_low_pass_10k, "idsp: low-pass", FAST: IdspLowPass = IdspLowPass::new(Hertz(175.0), FAST);
}
