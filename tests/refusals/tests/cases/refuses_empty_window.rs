use estimator_core::*;

const FOAW: Foaw<15, BestFit> = preset!(Foaw::new(0, 1));

fn main() {
    let _ = FOAW;
}
