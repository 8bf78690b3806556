use estimator_core::*;

const FOAW: Foaw<15, BestFit> = preset!(Foaw::new(15, 16_385));

fn main() {
    let _ = FOAW;
}
