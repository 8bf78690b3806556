//! What is measured: the rows of the catalogue with tuned parameters, and their peers.

use estimator_catalogue::design;
use estimator_core::{CoupledMotor, DesignError, Hertz, Model, NoInput, Sample, preset};

use peers::{
    Dvrk, Moteus, ODrive, OpenFfBoard, SimpleFocEncoder, SimpleFocSensor, VescFast, VescPll,
};

use crate::peers::{AdsKalman, IdspKalman, IdspLowPass, IdspPll, MiniKalman, NalgebraKalman};
use crate::subject::{Measured, Subject, subject};

const SLOW: Hertz = Hertz(1000.0);
const FAST: Hertz = Hertz(10_000.0);

/// The clock that stamps edges.
pub const CLOCK: Hertz = Hertz(84e6);

const fn triple(rate: Hertz) -> Result<Model<3, NoInput>, DesignError> {
    let jerk = tuned::value("kalman-triple", rate, "jerk");
    Model::triple_integrator(4096, rate, jerk)
}

macro_rules! rows {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:ident: $hertz:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        $(
            mod $id {
                use super::*;

                #[allow(unused_variables, reason = "a row may have no parameter")]
                const fn parameters(rate: Hertz, capacity: usize) -> design::$id::Parameters {
                    design::$id::Parameters {
                        $($parameter: tuned::value_for($name, rate, capacity, stringify!($parameter)),)*
                    }
                }

                $(
                    pub(super) mod $variant {
                        use super::*;
                        use estimator_core as $c;

                        #[allow(dead_code, reason = "not every design has a window or a table")]
                        const $N: usize = $capacity;

                        #[allow(unused_variables, reason = "not every design uses everything")]
                        const ESTIMATOR: $type = {
                            let ($rate, $clock) = (Hertz($hertz), CLOCK);
                            let $motor = &CoupledMotor::DCX35L;
                            let $p = parameters($rate, $capacity);
                            let design: Result<$type, DesignError> = $make;
                            match design {
                                Ok(estimator) => estimator,
                                Err(error) => panic!("{}", error.message()),
                            }
                        };

                        subject!(
                            $name,
                            &[stringify!($id), stringify!($variant)],
                            $hertz,
                            if design::$id::ROW.settling.is_window() { $capacity } else { 0 },
                            $type
                        );
                    }
                )*
            }
        )*

        /// Everything of ours that is measured.
        const ROWS: &[Subject] = &[$($($id::$variant::SUBJECT,)*)*];
    };
}

estimator_catalogue::estimators!(rows);

/// Filters of others: `LIST, description: module, "name", rate: Type = value;`.
macro_rules! peers {
    ($list:ident, $what:literal: $($module:ident, $name:literal, $rate:ident: $type:ty = $value:expr;)*) => {
        $(
            mod $module {
                use super::*;

                const ESTIMATOR: $type = $value;

                subject!($name, &[stringify!($module)], $rate.0, 0, $type);
            }
        )*

        #[doc = $what]
        const $list: &[Subject] = &[$($module::SUBJECT),*];
    };
}

peers! {
    PEERS, "Filters of other libraries.":
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

/// Counts in an electrical turn, as comparators have it.
const TURN: f64 = 4096.0 / VescPll::RATIO;

// Their constants have no influence on the instructions of an update.
peers! {
    COMPARATORS, "Velocity algorithms of other projects, written anew, with their defaults at the rate of the traces.":
    comparator_moteus, "peer:moteus", FAST: Moteus = Moteus::new(Moteus::CUTOFF, FAST, 4096);
    comparator_odrive, "peer:odrive", FAST: ODrive = ODrive::new(ODrive::BANDWIDTH_RAD_S, FAST);
    comparator_vesc_pll, "peer:vesc-pll", FAST: VescPll =
        VescPll::new(VescPll::KP, VescPll::KI, FAST, TURN);
    comparator_vesc_fast, "peer:vesc-fast", FAST: VescFast = VescFast::new(VescFast::SHARE, TURN);
    comparator_simplefoc_sensor, "peer:simplefoc-sensor", FAST: SimpleFocSensor =
        SimpleFocSensor::new(SimpleFocSensor::FILTER_TIME_S, FAST);
    comparator_simplefoc_encoder, "peer:simplefoc-encoder", FAST: SimpleFocEncoder =
        SimpleFocEncoder::new(SimpleFocEncoder::FILTER_TIME_S, FAST, CLOCK);
    comparator_openffboard, "peer:openffboard", FAST: OpenFfBoard =
        OpenFfBoard::new(OpenFfBoard::PROFILES[1], OpenFfBoard::Q, FAST);
    comparator_dvrk_measured, "peer:dvrk-measured", FAST: Dvrk = Dvrk::measured(FAST, CLOCK);
    comparator_dvrk_predicted, "peer:dvrk-predicted", FAST: Dvrk = Dvrk::predicted(FAST, CLOCK);
}

/// Everything that is measured: the rows of the catalogue, the peers, the comparators.
pub static SUBJECTS: &[Subject] = &{
    let mut all = [ROWS[0]; ROWS.len() + PEERS.len() + COMPARATORS.len()];
    let mut i = 0;
    while i < all.len() {
        all[i] = if i < ROWS.len() {
            ROWS[i]
        } else if i < ROWS.len() + PEERS.len() {
            PEERS[i - ROWS.len()]
        } else {
            COMPARATORS[i - ROWS.len() - PEERS.len()]
        };
        i += 1;
    }
    all
};
