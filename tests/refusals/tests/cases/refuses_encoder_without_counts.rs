use estimator_core::*;

const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(0, Hertz(1000.0), 1e4));

fn main() {
    let _ = MODEL;
}
