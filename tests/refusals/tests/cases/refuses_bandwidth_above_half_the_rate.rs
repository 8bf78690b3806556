use estimator_core::*;

const LOOP: Pll = preset!(Pll::new(Hertz(500.1), Hertz(1000.0)));

fn main() {
    let _ = LOOP;
}
