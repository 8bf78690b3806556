use estimator_core::*;

fn main() {
    let _ = Foaw::<0, EndFit>::new(1, 1);
}
