use estimator_core::*;

fn main() {
    let period_in_clock_ticks = 168_000;
    let _ = Model::triple_integrator(4096, period_in_clock_ticks, 1e4);
    let _ = Pll::new(Hertz(60.0), ClockTicks(168_000));
    let _ = LowPass::new(FiniteDifference, 240.0, 1000.0);
    let _ = Scale::new(4096, 0.001);
}
