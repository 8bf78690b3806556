use estimator_core::*;

const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(4096, Hertz(0.0), 1e4));

fn main() {
    let _ = MODEL;
}
