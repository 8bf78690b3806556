use estimator_core::*;

const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e-60));
const FILTER: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));

fn main() {
    let _ = FILTER;
}
