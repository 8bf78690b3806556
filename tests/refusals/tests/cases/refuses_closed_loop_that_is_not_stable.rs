use estimator_core::*;

// Without damping, noise this large makes the gain cancel the acceleration within one tick: a
// pole at -1.
const UNDAMPED: MotorModel = MotorModel {
    damping: 0.0,
    ..MotorModel::DCX35L
};
const MODEL: Model<2, CurrentInput> = preset!(Model::motor(&UNDAMPED, Hertz(1000.0), 1e9));
const FILTER: SteadyKalmanMotor = preset!(SteadyKalman::new(&MODEL));

fn main() {
    let _ = FILTER;
}
