use estimator_core::*;

const BARE: MotorModel = MotorModel {
    counts_per_rev: 0,
    ..MotorModel::DCX35L
};
const MODEL: Model<2, CurrentInput> = preset!(Model::motor(&BARE, Hertz(1000.0), 0.1));

fn main() {
    let _ = MODEL;
}
