use estimator_core::*;

const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(4096, Hertz(1000.0), 1e3));
const FILTER: TableKalmanTriple<20> = preset!(TableKalman::new(&MODEL));

fn main() {
    let _ = FILTER;
}
