use estimator_core::*;

const FOAW: Foaw<15, EndFit> = preset!(Foaw::new(16, 1));

fn main() {
    let _ = FOAW;
}
