use estimator_core::*;

fn main() {
    let _ = Foaw::<129, EndFit>::new(1, 1);
}
