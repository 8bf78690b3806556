//! Tests of the attribution of the parasitic force.

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::closed_loop::{Conditions, Dac, Exact, Hand, Loop, environments_with};
use experiments::feel::{Case, Settings, Without, feel};
use experiments::transparency::attribution::CAUSES;
use experiments::transparency::{Attribution, Cause, Ledger, Part};
use haptic_control::{SceneKind, Torque};
use simulation::device::Device;

use crate::loops::on_default;

const HANDLE: &str = "kalman-triple-steady";

fn with(name: &str, scene: SceneKind, rate_hz: f64) -> Loop {
    on_default(scene, rate_hz, [name, HANDLE])
}

/// The same run on a device without these causes, known to the controller.
fn without(run: &Loop, what: Without) -> Loop {
    let device = what.of(&run.device);
    Loop {
        assumed: device.stages,
        device,
        ..run.clone()
    }
}

fn ledger(run: &Loop) -> Ledger {
    let scene = run.scene.kind();
    Ledger::new(&run.device, &run.assumed, scene, run.rate_hz, run.poles).unwrap()
}

/// Torques of the causes, N.m.
fn torques(run: &Loop, conditions: Conditions, ticks: usize) -> [Vec<f64>; CAUSES] {
    let mut ledger = ledger(run);
    let mut all: [Vec<f64>; CAUSES] = Default::default();
    run.run_under(ticks, conditions, |now| {
        for (term, torque) in all.iter_mut().zip(ledger.terms(now)) {
            term.push(torque);
        }
    })
    .unwrap();
    all
}

fn of(terms: &[Vec<f64>; CAUSES], cause: Cause) -> &[f64] {
    let at = Cause::ALL.iter().position(|known| *known == cause);
    &terms[at.unwrap()]
}

fn rms(signal: &[f64]) -> f64 {
    (signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64).sqrt()
}

fn rounded() -> Conditions<'static> {
    Conditions {
        dac: Some(Dac::board().unwrap()),
        ..Conditions::default()
    }
}

#[test]
fn causes_add_up_to_the_parasitic_torque_at_every_tick() {
    let estimators = [
        "finite-difference",
        "foaw-end-fit",
        "kalman-motor",
        "observer",
        "adaptive",
    ];
    for scene in environments_with(Kind::named(HANDLE).unwrap()) {
        for name in estimators {
            let rate_hz = if name == "observer" { 11.6e3 } else { 1e3 };
            let run = with(name, scene, rate_hz);
            let mut ledger = ledger(&run);
            let mut largest = 0.0_f64;
            run.run_under((0.6 * rate_hz) as usize, rounded(), |now| {
                let sum: f64 = ledger.terms(now).iter().sum();
                let parasitic = now.felt - f64::from(now.action.torque.0);
                largest = largest.max(parasitic.abs());
                // Torques up to 0.1 N.m in f64 have rounding errors of 1e-17 N.m each.
                assert!(
                    (sum - parasitic).abs() < 1e-15,
                    "{scene}, {name}, {} s: {sum} of {parasitic}",
                    now.t
                );
            })
            .unwrap();
            assert!(largest > 1e-4, "{scene}, {name}: {largest}");
        }
    }
}

#[test]
fn bookkeeping_repeats_the_large_motors_stage() {
    // With the large motor's stage repeated, the small motor renders what is asked for wherever its
    // limits do not act: to the rounding of its current to f32, 1e-7 of 10 mN.m.
    for scene in [
        SceneKind::FreeAir,
        SceneKind::SpringDamper,
        SceneKind::Inertia,
    ] {
        let terms = torques(&with("pll", scene, 1e3), rounded(), 1000);
        let limits = of(&terms, Cause::Limits);
        let small = limits.iter().filter(|torque| torque.abs() < 1e-8).count();
        assert!(small > 990, "{scene}: {small} of 1000 ticks without limits");
    }
}

#[test]
fn cause_that_is_switched_off_has_no_term() {
    let run = with("pll", SceneKind::FreeAir, 11.6e3);
    let ticks = 4000;
    let largest = |terms: &[Vec<f64>; CAUSES], cause| {
        let each = of(terms, cause).iter();
        each.fold(0.0_f64, |most, torque| most.max(torque.abs()))
    };
    let all = torques(&run, rounded(), ticks);
    for (what, cause) in [
        (Without::SmallFriction, Cause::Friction),
        (Without::Ripple, Cause::Ripple),
    ] {
        let left = torques(&without(&run, what), rounded(), ticks);
        assert_eq!(largest(&left, cause), 0.0, "{cause:?}");
        assert!(largest(&all, cause) > 1e-6, "{cause:?}");
    }
    let exact = torques(&run, Conditions::default(), ticks);
    assert_eq!(largest(&exact, Cause::Dac), 0.0);
    // Half a step of the small DAC: 27.5 mN.m/A times 1.5 A / 2047 / 2. Codes are f32.
    let half_a_step = 27.5e-3 * 1.5 / 2047.0 / 2.0;
    let of_dac = largest(&all, Cause::Dac);
    assert!((0.9..1.001).contains(&(of_dac / half_a_step)), "{of_dac}");
    // An amplifier with a lag of 1.6 us settles within a tick of 86 us.
    let quick = torques(&without(&run, Without::AmplifierLag), rounded(), ticks);
    assert!(largest(&quick, Cause::Amplifier) < 1e-15);
    assert!(largest(&all, Cause::Amplifier) > 1e-5);
    let conditions = Conditions {
        exact: Exact::Large,
        ..rounded()
    };
    // The true velocity is rounded to f32, 1e-7 of 10 rad/s, times 0.96 mN.m.s/rad.
    let truth = torques(&run, conditions, ticks);
    assert!(largest(&truth, Cause::Estimate) < 1e-8);
    assert!(largest(&all, Cause::Estimate) > 1e-4);
}

#[test]
fn velocity_that_the_estimation_error_causes_is_attributed_to_it() {
    // The default device, and one of which a tick is 2.4 time constants of the large motor with the coupler.
    for inertia in [Device::default().stages.large.inertia, 4e-7] {
        attribute_caused_velocity(inertia);
    }
}

fn attribute_caused_velocity(inertia: f64) {
    // A clamped handle and a constant torque, without friction and ripple: all that moves the large
    // motor away from the loop with the true velocity is the estimation error.
    let name = "finite-difference";
    let mut run = with(name, SceneKind::FreeAir, 1e3);
    run.device = run.device.frictionless();
    run.device.large_ripple.torque = 0.0;
    run.device.stages.large.inertia = inertia;
    run.assumed = run.device.stages;
    run.scene = Torque::new(7e-3).unwrap().into();
    run.hand = Hand::Clamp;
    let ticks = 3000;
    let mut omega = [Vec::new(), Vec::new()];
    let mut estimate = Vec::new();
    let mut ledger = ledger(&run);
    let damping = run.device.stages.damping;
    // The handle never turned back.
    let measured = 0.7 * damping;
    // The small motor renders the error of the tick before.
    let mut direct = 0.0;
    for (of_run, exact) in omega.iter_mut().zip([Exact::Neither, Exact::Large]) {
        let conditions = Conditions {
            exact,
            ..Conditions::default()
        };
        run.run_under(ticks, conditions, |now| {
            of_run.push(now.large.omega);
            if exact == Exact::Neither {
                let terms = ledger.terms(now).map(|term| vec![term]);
                estimate.push((of(&terms, Cause::Estimate)[0] - direct) / (damping - measured));
                let error = f64::from(now.action.large_velocity.0) - now.large.omega;
                direct = -measured * error;
            }
        })
        .unwrap();
    }
    let [with_error, exact] = omega;
    let caused: Vec<f64> = with_error.iter().zip(exact).map(|(a, b)| a - b).collect();
    let left: Vec<f64> = caused.iter().zip(&estimate).map(|(a, b)| a - b).collect();
    let (left, caused) = (rms(&left), rms(&caused));
    // The model has steps of at most a tenth of the time constant, the plant 100 a tick; the currents are f32.
    assert!(
        caused > 1e-3 && left < 0.02 * caused,
        "{inertia} kg.m2: {left} of {caused} rad/s"
    );
}

#[test]
fn shares_follow_from_amplitude_and_phase() {
    use std::f64::consts::TAU;
    let rate_hz = 1e3;
    let sine = |amplitude: f64, hz: f64, degrees: f64| -> Vec<f64> {
        let at = |k: i32| (TAU * (hz * f64::from(k) / rate_hz + degrees / 360.0)).sin();
        (0..4100).map(|k| amplitude * at(k)).collect()
    };
    let mut terms: [Vec<f64>; CAUSES] = std::array::from_fn(|_| vec![0.0; 4100]);
    // 10 Hz below the tactile band, 100 Hz in it; the third opposes the second, the fourth is at right
    // angles to both.
    terms[0] = sine(8.0, 10.0, 0.0);
    terms[1] = sine(4.0, 100.0, 0.0);
    terms[2] = sine(1.0, 100.0, 180.0);
    terms[3] = sine(3.0, 100.0, 90.0);
    let found = Attribution::of(&terms, rate_hz).unwrap();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
    // Mean squares: 32 at 10 Hz, and (3^2 + 3^2) / 2 at 100 Hz.
    near(found.rms_mn, 41_f64.sqrt());
    near(found.tactile_mn.unwrap(), 3.0);
    let [inertia, friction, ripple, slip, ..] = found.parts;
    near(inertia.rms_mn, 32_f64.sqrt());
    near(inertia.share.unwrap(), 32.0 / 41.0);
    near(inertia.tactile_share.unwrap(), 0.0);
    // 4 * 3 / 2 and -1 * 3 / 2.
    near(friction.share.unwrap(), 6.0 / 41.0);
    near(friction.tactile_share.unwrap(), 6.0 / 9.0);
    near(ripple.share.unwrap(), -1.5 / 41.0);
    near(ripple.tactile_share.unwrap(), -1.5 / 9.0);
    near(ripple.tactile_mn.unwrap(), 0.5_f64.sqrt());
    near(slip.tactile_share.unwrap(), 4.5 / 9.0);
    assert_eq!(found.parts[4].share, Some(0.0));

    terms[4][2000] = f64::NAN;
    assert_eq!(Attribution::of(&terms, rate_hz), None);
    let short: [Vec<f64>; CAUSES] = std::array::from_fn(|_| vec![1.0; 100]);
    assert_eq!(Attribution::of(&short, rate_hz), None);
    let still: [Vec<f64>; CAUSES] = std::array::from_fn(|_| vec![0.0; 200]);
    assert_eq!(
        Attribution::of(&still, rate_hz).unwrap().parts[0],
        Part {
            rms_mn: 0.0,
            ..Part::default()
        }
    );
}

#[test]
fn run_without_every_cause_is_hardly_felt() {
    let settings = Settings {
        device: Device::default(),
        parameters: Parameters::default(),
        handle: Kind::named(HANDLE).unwrap(),
        seed: 1,
        seconds: 3.0,
        without: vec![Without::SmallFriction, Without::Everything],
    };
    let case = Case {
        scene: SceneKind::FreeAir,
        rate_hz: 1e3,
        estimator: Kind::named("pll").ok(),
    };
    let felt = &feel(&[case], &settings, &|| ()).unwrap()[0];
    let shares: f64 = (felt.attribution.as_ref().unwrap().parts.iter())
        .map(|part| part.share.unwrap())
        .sum();
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
    let rms = felt.parasitic.parasitic_mn_rms.unwrap();
    assert!((felt.attribution.as_ref().unwrap().rms_mn / rms - 1.0).abs() < 1e-9);
    let [(first, friction), (last, everything)] = felt.without[..] else {
        panic!("{felt:?}");
    };
    assert_eq!((first, last), (Without::SmallFriction, Without::Everything));
    // A fingertip notices the friction of the small motor, 0.8 mN.m or 23 mN; nothing else is as large.
    assert!(friction.below_threshold.unwrap() > felt.parasitic.below_threshold.unwrap());
    assert!(everything.parasitic_mn_rms < friction.parasitic_mn_rms);
    assert_eq!(everything.below_threshold, Some(1.0));
}
