//! What must be true of the observers and the M/T method, whatever the motion.
//!
//! They read more than counts, so they have their own motions: the medley with a handle, currents
//! and edges at random instants, and a motor that obeys its own model exactly.

use estimator_core::{
    Amps, ClockTicks, Count, CountsPerTick, CoupledMotor, Edge, Hertz, MOverT, Observer, Sample,
    Signals, Uncertainty, VelocityEstimator,
};
use proptest::prelude::*;

use crate::motion::{Draws, Motion, any_motion, medley};

const CLOCK: Hertz = Hertz(84e6);
const RATES: [f64; 3] = [1000.0, 10_000.0, 11_600.0];

const UNSURE: Uncertainty = Uncertainty {
    torque_noise: 1e-5,
    load: 3e-4,
    load_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.03,
};

type Runner = Box<dyn Fn(&[Sample]) -> Vec<f32> + Send + Sync>;

struct Case {
    name: String,
    needs: Signals,
    run: Runner,
}

fn case<E>(name: &str, rate: f64, estimator: E) -> Case
where
    E: VelocityEstimator<Output = CountsPerTick> + Send + Sync + 'static,
{
    Case {
        name: format!("{name} at {rate} Hz"),
        needs: E::NEEDS,
        run: Box::new(move |samples| {
            let mut state = estimator.start(&samples[0]);
            let update = |sample| estimator.update(&mut state, sample).0;
            samples[1..].iter().map(update).collect()
        }),
    }
}

/// Every type of observer, and M/T, at this rate.
fn at(rate: f64) -> Vec<Case> {
    let hertz = Hertz(rate);
    let device = CoupledMotor::DCX35L;
    let counts = Observer::new(&device, hertz, &UNSURE).expect("valid");
    let edges = counts.with_edges(CLOCK, hertz).expect("valid");
    let blind = Observer::blind(&device, hertz, CLOCK, &UNSURE).expect("valid");
    vec![
        case("M/T", rate, MOverT::new(CLOCK, hertz).expect("valid")),
        case("observer", rate, counts),
        case("observer, held", rate, counts.held()),
        case(
            "observer, soft",
            rate,
            counts.soft(150.0, Hertz(rate)).expect("valid"),
        ),
        case("observer, edges", rate, edges),
        case("observer, edges, held", rate, edges.held()),
        case("observer, edges, blind", rate, blind),
        case(
            "adaptive",
            rate,
            counts.learning(4096, hertz).expect("valid"),
        ),
        case(
            "adaptive, edges",
            rate,
            edges.learning(4096, hertz).expect("valid"),
        ),
    ]
}

fn everywhere() -> Vec<Case> {
    RATES.iter().flat_map(|&rate| at(rate)).collect()
}

/// The motion with a handle that follows and an edge wherever a count changed, at a drawn age.
fn dressed(motion: &Motion, start: u32, rate: f64, direction: i64) -> Vec<Sample> {
    let mut draws = Draws(77);
    let period = (CLOCK.0 / rate) as u64;
    let (mut edge, mut stamped) = (None, 0u64);
    let mut samples = Vec::new();
    for (tick, (&count, &amps)) in motion.counts.iter().zip(&motion.amps).enumerate() {
        let now = period * (tick as u64 + 1);
        // The same draws whatever the direction.
        let (instant, handle) = (now - draws.bits() % period, draws.within(3));
        let before = if tick == 0 {
            count
        } else {
            motion.counts[tick - 1]
        };
        if count != before {
            stamped = instant;
            edge = Some(if count > before { count } else { count + 1 });
        }
        let age = ClockTicks(u32::try_from(now - stamped).unwrap_or(u32::MAX));
        let place = |count: i64| ((direction * count) as u32).wrapping_add(start);
        let mut sample = Sample::new(Count(place(count)))
            .with_small(Count(place(4 * count + handle)))
            .with_current(Amps::new(direction as f32 * amps));
        if let Some(boundary) = edge {
            // Boundary e lies between counts e - 1 and e: turned round, it is 1 - e.
            let turned = if direction < 0 {
                boundary - 1
            } else {
                boundary
            };
            sample = sample.with_edge(Edge {
                boundary: Count(place(turned)),
                age,
            });
        }
        samples.push(sample);
    }
    samples
}

fn bits(values: &[f32]) -> Vec<u32> {
    // Adding zero turns the negative zero into the positive one.
    values.iter().map(|value| (value + 0.0).to_bits()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    #[test]
    fn shift_of_both_counters_changes_nothing(motion in any_motion(), shift: u32) {
        // By whole lines: an encoder that starts elsewhere has the same phases there.
        let shift = shift & !3;
        for rate in RATES {
            let (here, there) = (dressed(&motion, 0, rate, 1), dressed(&motion, shift, rate, 1));
            for case in at(rate) {
                prop_assert_eq!(bits(&(case.run)(&here)), bits(&(case.run)(&there)), "{}", case.name);
            }
        }
    }

    #[test]
    fn mirrored_motion_gives_mirrored_velocity(motion in any_motion(), start: u32) {
        for rate in RATES {
            let (forth, back) = (dressed(&motion, start, rate, 1), dressed(&motion, start, rate, -1));
            for case in at(rate) {
                let forth: Vec<f32> = (case.run)(&forth).iter().map(|v| -v).collect();
                prop_assert_eq!(bits(&forth), bits(&(case.run)(&back)), "{}", case.name);
            }
        }
    }

    #[test]
    fn any_input_gives_finite_output(seed: u64) {
        let mut draws = Draws(seed);
        let samples: Vec<Sample> = (0..400).map(|_| {
            let wild = |draws: &mut Draws| Count(draws.bits() as u32);
            let current = f32::from_bits(draws.bits() as u32);
            let large = if draws.bits().is_multiple_of(4) { wild(&mut draws) } else { Count(draws.within(40) as u32) };
            // Half of the stamps fit their count.
            let boundary = if draws.bits().is_multiple_of(2) { wild(&mut draws) } else { Count(large.0.wrapping_add(draws.bits() as u32 & 1)) };
            let age = ClockTicks((draws.bits() >> (draws.bits() % 60)) as u32);
            Sample::new(large)
                .with_small(wild(&mut draws))
                .with_current(Amps::new(current))
                .with_edge(Edge { boundary, age })
        }).collect();
        for case in everywhere() {
            let outputs = (case.run)(&samples);
            prop_assert!(outputs.iter().all(|v| v.is_finite()), "{}", case.name);
        }
    }

    #[test]
    fn signals_not_needed_are_not_read(motion in any_motion(), start: u32, seed: u64) {
        let mut draws = Draws(seed);
        for rate in RATES {
            let samples = dressed(&motion, start, rate, 1);
            for case in at(rate) {
                let other: Vec<Sample> = samples.iter().map(|sample| {
                    let mut other = *sample;
                    if !case.needs.current { other.current = Amps::new(draws.unit() as f32); }
                    if !case.needs.small { other.small = Count(draws.bits() as u32); }
                    if !case.needs.edge { other.edge = None; }
                    other
                }).collect();
                prop_assert_eq!(bits(&(case.run)(&samples)), bits(&(case.run)(&other)), "{}", case.name);
            }
        }
    }
}

#[test]
fn wrap_of_either_counter_leaves_no_trace() {
    let motion = medley();
    for case in everywhere() {
        let far = (case.run)(&dressed(&motion, 1 << 30, 1000.0, 1));
        for moment in (1..motion.counts.len()).step_by(31) {
            for boundary in [0u32, 1 << 31] {
                let start = boundary.wrapping_sub(motion.counts[moment] as u32) & !3;
                let wrapped = (case.run)(&dressed(&motion, start, 1000.0, 1));
                assert_eq!(bits(&far), bits(&wrapped), "{} at {moment}", case.name);
            }
        }
    }
}

#[test]
fn rest_is_silent_anywhere_and_below_friction() {
    let mut draws = Draws(5);
    for _ in 0..20 {
        let still = Sample::new(Count(draws.bits() as u32)).with_small(Count(draws.bits() as u32));
        // 80 mA are 3.7 of 4 mN.m; only who believes in friction may see them.
        for case in everywhere() {
            let pushed = still.with_current(Amps::new(if case.needs.current { 0.08 } else { 0.0 }));
            let mut samples = vec![still];
            samples.resize(400, pushed);
            let outputs = (case.run)(&samples);
            assert!(outputs.iter().all(|v| *v == 0.0), "{}", case.name);
        }
    }
}

#[test]
fn velocity_comes_back_to_zero_at_rest_without_current() {
    let motion = medley();
    for rate in RATES {
        let mut samples = dressed(&motion, 9, rate, 1);
        let last = samples.last().expect("not empty").with_current(Amps::ZERO);
        for tick in 0..20_000u32 {
            let mut rest = last;
            if let Some(edge) = &mut rest.edge {
                let waited = (f64::from(tick) + 1.0) * CLOCK.0 / rate;
                edge.age = ClockTicks(edge.age.0.saturating_add(waited as u32));
            }
            samples.push(rest);
        }
        for case in at(rate) {
            let outputs = (case.run)(&samples);
            let end = outputs.last().expect("not empty").abs();
            // Without a current nothing stops it inside its cell but the cell's walls.
            let bound = if case.name.contains("blind") {
                1e-2
            } else {
                1e-3
            };
            assert!(end < bound, "{}: {end}", case.name);
        }
    }
}

/// A motor that obeys the observer's own model, in f64 and small steps: friction, coupler, lag.
struct Motor {
    device: CoupledMotor,
    angle: f64,
    omega: f64,
    current: f64,
}

impl Motor {
    fn step(&mut self, command: f64, handle: f64, dt: f64) {
        let device = &self.device;
        if device.amplifier_lag > 0.0 {
            self.current += (command - self.current) * (1.0 - (-dt / device.amplifier_lag).exp());
        } else {
            self.current = command;
        }
        let push = device.large.torque_constant * self.current
            - device.large.damping * (self.omega - handle);
        let friction = device.coulomb_friction;
        let way = if self.omega == 0.0 { push } else { self.omega };
        if self.omega == 0.0 && push.abs() <= friction {
            return;
        }
        let next = self.omega + dt * (push - friction * way.signum()) / device.large.inertia;
        self.omega = if next * way < 0.0 { 0.0 } else { next };
        self.angle += dt * self.omega;
    }
}

/// Samples and true velocity (counts a tick) of a motor under a swinging current of both signs,
/// over a handle that swings too.
fn modelled(rate: f64, seconds: f64, first: f64, device: CoupledMotor) -> (Vec<Sample>, Vec<f64>) {
    let per_rad = f64::from(device.large.counts_per_rev) / std::f64::consts::TAU;
    let per_small = f64::from(device.small_counts_per_rev) / std::f64::consts::TAU;
    let mut motor = Motor {
        device,
        angle: first / per_rad,
        omega: 0.0,
        current: 0.0,
    };
    let steps = (2e5 / rate) as u32;
    let dt = 1.0 / rate / f64::from(steps);
    let handle = |t: f64| 0.3 * (7.0 * t).sin();
    let (mut samples, mut truth) = (Vec::new(), Vec::new());
    let (mut last, mut command) = (None, 0.0);
    for tick in 0..(rate * seconds) as u32 {
        let t = f64::from(tick) / rate;
        let count = (motor.angle * per_rad).floor() as i64;
        let mut sample = Sample::new(Count(count as u32))
            .with_small(Count((handle(t) * per_small).round() as i64 as u32))
            .with_current(Amps::new(command as f32));
        if let Some((instant, boundary)) = last {
            let age: f64 = (t - instant) * CLOCK.0;
            sample = sample.with_edge(Edge {
                boundary: Count(boundary as u32),
                age: ClockTicks(age as u32),
            });
        }
        samples.push(sample);
        truth.push(motor.omega * per_rad / rate);
        command = 0.35 * (11.0 * t).sin() + 0.2 * (3.0 * t).sin();
        for step in 0..steps {
            let since = t + f64::from(step) * dt;
            let before = motor.angle * per_rad;
            motor.step(command, 0.3 * 7.0 * (7.0 * since).cos(), dt);
            let after = motor.angle * per_rad;
            if after.floor() != before.floor() {
                let boundary = after.floor().max(before.floor());
                let part = (boundary - before) / (after - before);
                last = Some((since + part * dt, boundary as i64));
            }
        }
    }
    (samples, truth)
}

fn rms(estimates: &[f32], truth: &[f64], from: usize) -> f64 {
    let errors = estimates.iter().zip(&truth[1..]).skip(from);
    let squares: Vec<f64> = errors.map(|(v, w)| (f64::from(*v) - w).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// With a model that is right, what is left is the observer's own: a few thousandths of a count a
/// tick, through stops and reversals. Finite difference is off by 0.3 to 0.4.
#[test]
fn motor_that_obeys_the_model_is_followed() {
    for (rate, bound) in [(1000.0, 0.02), (10_000.0, 0.002)] {
        let (samples, truth) = modelled(rate, 4.0, 0.4, CoupledMotor::DCX35L);
        let from = (0.3 * rate) as usize;
        for case in at(rate) {
            let knows = case.needs.current && case.needs.small;
            if knows {
                let error = rms(&(case.run)(&samples), &truth, from);
                // Soft ends hear counts that a right model has no need of.
                let bound = bound * if case.name.contains("soft") { 1.5 } else { 1.0 };
                assert!(error < bound, "{}: {error}", case.name);
            }
        }
    }
}

/// A device whose damping, friction and torque constant are each off is learned: b, from Kt.
#[test]
fn what_is_off_is_learned() {
    let rate = Hertz(1000.0);
    let believed = CoupledMotor::DCX35L;
    for (damping, inertia, friction) in [(0.7, 1.0, 1.0), (1.3, 1.2, 0.7), (0.8, 0.8, 1.4)] {
        let mut device = believed;
        device.large.damping *= damping;
        device.large.inertia *= inertia;
        device.coulomb_friction *= friction;
        let (samples, truth) = modelled(rate.0, 12.0, 0.3, device);
        let counts = Observer::new(&believed, rate, &UNSURE).expect("valid");
        let edges = counts.with_edges(CLOCK, rate).expect("valid");
        let fixed = at(rate.0);
        let fixed = fixed
            .iter()
            .find(|case| case.name.starts_with("observer, edges at"));
        let fixed = rms(&(fixed.expect("there").run)(&samples), &truth, 6000);

        let estimator = edges.learning(4096, rate).expect("valid");
        let mut state = estimator.start(&samples[0]);
        let mut velocities = Vec::new();
        for sample in &samples[1..] {
            velocities.push(estimator.update(&mut state, sample).0);
        }
        let learned = f64::from(estimator.deviations(&state).damping_ratio());
        assert!(
            (learned / damping - 1.0).abs() < 0.05,
            "{learned} for {damping}"
        );
        let error = rms(&velocities, &truth, 6000);
        assert!(error < 0.5 * fixed, "{error} of {fixed}");
    }
}

/// In creep friction hides the rest: a current just above it, and fewer counts than it should
/// give, teach nothing.
#[test]
fn nothing_is_learned_in_creep() {
    let rate = Hertz(1000.0);
    let counts = Observer::new(&CoupledMotor::DCX35L, rate, &UNSURE).expect("valid");
    let estimator = counts.learning(4096, rate).expect("valid");
    let mut state = estimator.start(&Sample::new(Count(7)));
    let fresh = estimator.deviations(&state);
    let mut fastest = 0.0f32;
    for tick in 0..10_000u32 {
        // 4.2 of 4.0 mN.m: 0.22 rad/s, 0.14 counts a tick.
        let sample = Sample::new(Count(7 + tick / 20)).with_current(Amps::new(0.09));
        fastest = fastest.max(estimator.update(&mut state, &sample).0);
    }
    assert!(fastest > 0.02, "{fastest}");
    assert_eq!(estimator.deviations(&state), fresh);
}

/// M/T is exact at a constant velocity, however few counts that is.
#[test]
fn m_over_t_is_exact_on_a_ramp() {
    let rate = Hertz(1000.0);
    let estimator = MOverT::new(CLOCK, rate).expect("valid");
    for velocity in [0.013, -0.3137, 0.9073, -3.7071, 41.3031] {
        let period = CLOCK.0 / rate.0;
        let mut state = estimator.start(&Sample::new(Count(0)));
        let (mut seen, mut last) = (0, 0.0);
        for tick in 1..2000 {
            let t = f64::from(tick);
            let place: f64 = velocity * t + 0.5;
            let count = place.floor();
            // The boundary passed last and when.
            let boundary = if velocity > 0.0 { count } else { count + 1.0 };
            let age = (place - boundary) / velocity * period;
            let mut sample = Sample::new(Count(count as i64 as u32));
            if boundary != if velocity > 0.0 { 0.0 } else { 1.0 } {
                sample = sample.with_edge(Edge {
                    boundary: Count(boundary as i64 as u32),
                    age: ClockTicks(age as u32),
                });
            }
            last = f64::from(estimator.update(&mut state, &sample).0);
            if count as i64 != seen {
                seen = count as i64;
                if (count as i64).abs() > 3 {
                    assert!(
                        (last / velocity - 1.0).abs() < 1e-4,
                        "{last} for {velocity}"
                    );
                }
            }
        }
        // Between edges the bound is never below the velocity itself.
        assert!((last / velocity - 1.0).abs() < 1e-4);
    }
}

/// The covariance of the parameters stays positive definite through irregular, absurd updates:
/// counts that jump, with edges at any instant, or none.
#[test]
fn learned_covariance_stays_positive() {
    let rate = Hertz(1000.0);
    let counts = Observer::new(&CoupledMotor::DCX35L, rate, &UNSURE).expect("valid");
    let counts = counts.learning(4096, rate).expect("valid");
    let edges = counts.with_edges(CLOCK, rate).expect("valid");
    let mut draws = Draws(11);
    let (mut state, mut stamped) = (
        counts.start(&Sample::default()),
        edges.start(&Sample::default()),
    );
    let mut large = 0u32;
    for tick in 0..1_000_000 {
        let jump = if tick % 977 == 0 { 1 << 20 } else { 30 };
        large = large.wrapping_add(draws.within(jump) as u32);
        let mut sample = Sample::new(Count(large))
            .with_small(Count(draws.bits() as u32 >> (tick % 32)))
            .with_current(Amps::new(1000.0 * draws.unit() as f32));
        if tick % 5 != 0 {
            sample = sample.with_edge(Edge {
                boundary: Count(large.wrapping_add(draws.bits() as u32 & 1)),
                age: ClockTicks((draws.bits() % 84_000) as u32),
            });
        }
        counts.update(&mut state, &sample);
        edges.update(&mut stamped, &sample);
        for diagonal in [state.learning().diagonal(), stamped.learning().diagonal()] {
            assert!(
                diagonal.iter().all(|d| *d > 0.0 && *d < 1.0),
                "{diagonal:?} at {tick}"
            );
        }
    }
    // Both have learned: D has left the prior.
    for diagonal in [state.learning().diagonal(), stamped.learning().diagonal()] {
        assert!(diagonal.iter().any(|d| *d < 0.05), "{diagonal:?}");
    }
}
