use estimator_core::*;

fn main() {
    let first = Sample::new(Count(0));
    let velocity: CountsPerTick = Skip.update(&mut (), &first);
    let _ = velocity;
}
