use estimator_core::*;

fn main() {
    let first = Sample::new(Count(0));
    let mut state = FiniteDifference.start(&first);
    let pll = Pll::new(Hertz(60.0), Hertz(1000.0)).unwrap();
    pll.update(&mut state, &first);
}
