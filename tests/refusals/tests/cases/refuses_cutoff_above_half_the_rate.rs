use estimator_core::*;

const FILTER: LowPass<FiniteDifference> =
    preset!(LowPass::new(FiniteDifference, Hertz(500.1), Hertz(1000.0)));

fn main() {
    let _ = FILTER;
}
