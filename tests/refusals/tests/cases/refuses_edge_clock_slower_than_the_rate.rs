use estimator_core::*;

const ESTIMATOR: MOverT = preset!(MOverT::new(Hertz(999.0), Hertz(1000.0)));

fn main() {
    let _ = ESTIMATOR;
}
