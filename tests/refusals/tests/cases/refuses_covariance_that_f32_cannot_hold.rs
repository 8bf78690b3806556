use estimator_core::*;

const MODEL: Model<2, CurrentInput> =
    preset!(Model::motor(&MotorModel::DCX35L, Hertz(1000.0), 1e6));
const FILTER: KalmanMotor = preset!(Kalman::new(&MODEL));

fn main() {
    let _ = FILTER;
}
