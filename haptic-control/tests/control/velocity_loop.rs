//! The velocity loop with the plant that it is designed for, limits included.

use std::f64::consts::TAU;

use haptic_control::{DualStage, LoopPoles, RadPerS, Rst, RstDesign};

use crate::design::{RATES, design};

/// The plant in f64, with the controller as it runs, in f32.
struct Bench {
    design: RstDesign,
    rst: Rst,
    state: haptic_control::RstState,
    omega: [f64; 2],
    current: [f64; 2],
}

impl Bench {
    fn new(rate: f64) -> Self {
        let design = design(rate);
        let rst = Rst::new(&design);
        Self {
            design,
            rst,
            state: rst.start(RadPerS(0.0)),
            omega: [0.0; 2],
            current: [0.0; 2],
        }
    }

    /// One tick; the current is limited, and `disturbance` amperes act beside it.
    fn tick(&mut self, wanted: f64, limit: f64, disturbance: f64) -> f64 {
        let omega = self.limited_tick(wanted, |asked| asked.clamp(-limit, limit));
        self.current[0] += disturbance;
        omega
    }

    /// One tick: of the current asked for, `limit` says what is applied.
    fn limited_tick(&mut self, wanted: f64, limit: impl FnOnce(f64) -> f64) -> f64 {
        let Self {
            design: d,
            omega,
            current,
            ..
        } = self;
        let now =
            -d.a[1] * omega[0] - d.a[2] * omega[1] + d.b[1] * current[0] + d.b[2] * current[1];
        *omega = [now, omega[0]];
        let asked = self
            .rst
            .update(&mut self.state, RadPerS(wanted as f32), RadPerS(now as f32));
        let applied = limit(f64::from(asked));
        if applied != f64::from(asked) {
            self.state.limited(applied as f32);
        }
        *current = [applied, current[0]];
        now
    }
}

#[test]
fn velocity_follows_the_tracking_filter() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        let gain = 1.0 - bench.design.tracking_pole;
        let (mut lag, mut filtered, mut before) = (0.0, 0.0, 0.0);
        let mut worst = 0.0_f64;
        for _ in 0..(0.5 * rate) as usize {
            let omega = bench.tick(10.0, 1e9, 0.0);
            let [b1, b2] = [bench.design.b[1], bench.design.b[2]];
            worst = worst.max((omega - (b1 * filtered + b2 * before) / (b1 + b2)).abs());
            lag += gain * (10.0 - lag);
            before = filtered;
            filtered += gain * (lag - filtered);
        }
        // 10 rad/s to four digits, at every rate: f32 loses nothing that matters.
        assert!(worst < 1e-3, "{rate}: {worst}");
    }
}

#[test]
fn constant_disturbance_is_rejected_within_a_tenth_of_a_second() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        let mut largest = 0.0_f64;
        let mut omega = 0.0;
        for _ in 0..(0.1 * rate) as usize {
            // Coulomb friction of 4 mN.m is 85 mA.
            omega = bench.tick(0.0, 1e9, 0.085);
            largest = largest.max(omega);
        }
        assert!((0.5..4.2).contains(&largest), "{rate}: {largest}");
        assert!(omega.abs() < 0.12 * largest, "{rate}: {omega} of {largest}");
        for _ in 0..rate as usize {
            omega = bench.tick(0.0, 1e9, 0.085);
        }
        assert!(omega.abs() < 1e-3, "{rate}: {omega}");
    }
}

#[test]
fn saturation_does_not_wind_the_integrator_up() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        // 100 rad/s would take 2.05 A: with 1 A it cannot be reached.
        for _ in 0..(2.0 * rate) as usize {
            bench.tick(100.0, 1.0, 0.0);
        }
        let back = (0..(0.3 * rate) as usize).map(|_| bench.tick(0.0, 1.0, 0.0));
        let least = back.fold(0.0_f64, f64::min);
        // A wound-up integrator would hold the speed for as long as it had been asked for.
        assert!(bench.omega[0].abs() < 1.0, "{rate}: {}", bench.omega[0]);
        assert!(least > -15.0, "{rate}: {least}");
    }
}

#[test]
fn step_under_a_slew_limit_has_the_right_sign_and_no_overshoot() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        let (slew, mut before) = (1200.0 / rate, 0.0_f64);
        let (mut least, mut largest) = (0.0_f64, 0.0_f64);
        for _ in 0..(0.3 * rate) as usize {
            let omega = bench.limited_tick(40.0, |asked| {
                before = asked.clamp(before - slew, before + slew);
                before
            });
            (least, largest) = (least.min(omega), largest.max(omega));
        }
        assert!(least > -1e-3, "{rate}: {least}");
        // Without the limit there is none; what the limit costs is below 3 %.
        assert!(largest < 41.2, "{rate}: {largest}");
        assert!((bench.omega[0] - 40.0).abs() < 0.1, "{rate}");
    }
}

/// `S c = R e + (Q - S) d` and `u = A ω_f / B(1) + c` as they are written, in f64, with the
/// poles of Q at the regulation bandwidth and d the current applied less the current asked for.
#[test]
fn limited_law_agrees_with_its_difference_equation() {
    for rate in RATES {
        let d = design(rate);
        let rst = Rst::new(&d);
        let mut state = rst.start(RadPerS(0.0));
        let at_one = d.b[1] + d.b[2];
        let pole = (-TAU * LoopPoles::DEFAULT.regulation.0 / rate).exp();
        let tracking = (-TAU * LoopPoles::DEFAULT.tracking.0 / rate).exp();
        let q = [1.0, -2.0 * pole, pole * pole];
        // Each the latest first.
        let (mut w, mut e, mut c, mut cut) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
        let mut lag = 0.0;
        let mut limited = 0;
        for k in 0..2000 {
            let phase = f64::from(k) / 300.0;
            let (wanted, measured) = (30.0 * phase.sin(), 25.0 * (1.3 * phase).sin());
            lag = tracking * lag + (1.0 - tracking) * wanted;
            w = [tracking * w[0] + (1.0 - tracking) * lag, w[0], w[1]];
            let shaped = (d.b[1] * w[1] + d.b[2] * w[2]) / at_one;
            e = [shaped - measured, e[0], e[1]];
            let regulated =
                d.r[0] * e[0] + d.r[1] * e[1] + d.r[2] * e[2] - d.s[1] * c[0] - d.s[2] * c[1]
                    + (q[1] - d.s[1]) * cut[0]
                    + (q[2] - d.s[2]) * cut[1];
            c = [regulated, c[0], c[1]];
            let forward = (w[0] + d.a[1] * w[1] + d.a[2] * w[2]) / at_one;
            let asked = rst.update(&mut state, RadPerS(wanted as f32), RadPerS(measured as f32));
            let difference = (f64::from(asked) - forward - regulated).abs();
            assert!(
                difference < 2e-4,
                "{rate} {k}: {asked} {forward} {regulated}"
            );
            let applied = asked.clamp(-0.5, 0.5);
            if applied != asked {
                state.limited(applied);
                limited += 1;
            }
            cut = [f64::from(applied) - (forward + regulated), cut[0], cut[1]];
        }
        assert!((200..1900).contains(&limited), "{rate}: {limited}");
    }
}

/// Of a motor at a constant velocity against a coupler that is held, from the first tick on.
#[test]
fn loop_that_starts_at_a_velocity_commands_the_current_of_this_velocity() {
    let device = DualStage::DEFAULT;
    for rate in RATES {
        let rst = Rst::new(&design(rate));
        for speed in [-100.0_f32, 20.0] {
            let mut state = rst.start(RadPerS(speed));
            let wanted = f64::from(speed) * device.damping / device.large.torque_constant;
            for tick in 0..5 {
                let asked = rst.update(&mut state, RadPerS(speed), RadPerS(speed));
                // Sums of f32 at 100 rad/s, times coefficients of up to 1 A per rad/s.
                let off = (f64::from(asked) - wanted).abs();
                assert!(off < 1e-3, "{rate} Hz, {tick}: {asked} A, {wanted} A");
            }
        }
    }
}
