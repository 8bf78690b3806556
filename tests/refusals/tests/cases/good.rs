use estimator_core::*;

const RATE: Hertz = Hertz(1000.0);

fn main() {
    let first = Sample::new(Count(0));
    const WIDEST: Foaw<128, BestFit> = preset!(Foaw::new(128, 1));
    const NARROWEST: Foaw<1, EndFit> = preset!(Foaw::new(1, 0));
    const HIGHEST: Pll = preset!(Pll::new(Hertz(500.0), RATE));
    const LOW_PASS: LowPass<FiniteDifference> =
        preset!(LowPass::new(FiniteDifference, Hertz(500.0), RATE));
    const TRIPLE: SteadyKalmanTriple =
        preset!(SteadyKalman::new(&preset!(Model::triple_integrator(4096, RATE, 1e4))));
    assert_eq!(WIDEST.update(&mut WIDEST.start(&first), &first).0, 0.0);
    assert_eq!(NARROWEST.update(&mut NARROWEST.start(&first), &first).0, 0.0);
    assert_eq!(HIGHEST.update(&mut HIGHEST.start(&first), &first).0, 0.0);
    assert_eq!(LOW_PASS.update(&mut LOW_PASS.start(&first), &first).0, 0.0);
    assert_eq!(TRIPLE.update(&mut TRIPLE.start(&first), &first).0, 0.0);
}
