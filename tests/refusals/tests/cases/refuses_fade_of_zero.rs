use estimator_core::*;

const BOTH: Handover<FiniteDifference, FiniteDifference> =
    preset!(Handover::new(FiniteDifference, FiniteDifference, 10, 0));

fn main() {
    let _ = BOTH;
}
