//! The loop closes, on time and at a known cost, and does no harm before it is armed.

use std::num::NonZeroU64;

use drivers::{Setting, Settings};
use experiments::closed_loop::Hand;
use haptic_control::{Mode, SceneKind, Stop};
use simulation::device::Device;
use virtual_board::board::CORE_HZ;
use virtual_board::run::{
    AMPS_PER_CODE, CoreAccess, DacError, LEAST_LOAD_OHM, Outcome, RATE_HZ, Setup, on_board,
};
use virtual_board::scene::{press, stiffness};
use virtual_board::trace::Kind;

use crate::image::{SETTLED_S, free_air, image, of_scene, run};
use crate::second_core::{HOLDING, records};

#[test]
fn the_image_boots_and_closes_the_loop_at_10_khz() {
    let run = free_air();
    assert_eq!(run.complaints, [""; 0], "pins");
    assert_eq!(run.restarts, []);
    assert_eq!(run.unclosed, 0);
    let late = f64::from(u32::try_from(run.ticks[0].at_ns).unwrap()) * 1e-9;
    assert!(late < 0.01, "control began after {late} s");
    let wanted = (10.0 - late) * RATE_HZ;
    assert!((run.ticks.len() as f64 - wanted).abs() < 2.0);
    let period = run.periods().unwrap();
    assert!(period.min > 99_800 && period.max < 100_200, "{period:?}");

    let telemetry = &run.telemetry;
    assert_eq!(telemetry.malformed, [""; 0]);
    assert!(telemetry.frames.len() > 9900);
    for (k, frame) in telemetry.frames.iter().enumerate() {
        assert_eq!(frame.seq as usize, k);
        assert_eq!((frame.overruns, frame.drops), (0, 0));
    }
    // The loop is closed: the large motor follows the handle, driven by the DAC.
    let moving = run
        .ticks
        .iter()
        .filter(|tick| tick.handle.omega.abs() > 1.0);
    let (mut slip, mut speed, mut n) = (0.0, 0.0, 0);
    for tick in moving.filter(|tick| tick.at_ns as f64 * 1e-9 > SETTLED_S) {
        slip += (tick.large.omega - tick.handle.omega).powi(2);
        speed += tick.handle.omega.powi(2);
        n += 1;
    }
    assert!(n > 12_000, "{n} ticks");
    let part = (slip / speed).sqrt();
    assert!(part < 0.25, "slip is {part} of the handle's speed");
}

#[test]
fn currents_are_zero_before_the_amplifiers_are_enabled() {
    let run = free_air();
    let first = run.enables.iter().find(|(_, on)| on.contains(&true));
    let (armed_ns, _) = *first.expect("it is armed");
    assert_eq!(run.enables[0], (0, [false; 2]));
    assert!(armed_ns > 90_000_000, "armed after {armed_ns} ns");
    for (k, moment) in run.plant_states.iter().enumerate() {
        if (k as u64) * 100_000 < armed_ns {
            assert_eq!(moment.currents, [0.0; 2], "{k}");
        }
    }
    // Nor would it if somebody had wired the enables to the supply.
    for tick in run
        .ticks
        .iter()
        .filter(|tick| tick.at_ns + 100_000 < armed_ns)
    {
        assert_eq!(tick.codes, [Some(2048); 2], "at {} ns", tick.at_ns);
    }
    let flowing = run
        .plant_states
        .iter()
        .filter(|moment| moment.currents[0] != 0.0);
    assert!(flowing.count() > 50_000);
}

/// The enables of both channels in [`DAC_CONTROL`].
const CHANNELS: u32 = 1 << 16 | 1;

/// A channel that is switched on with the code of a reset would command the largest current until the first
/// control task.
#[test]
fn dac_has_the_codes_of_no_current_before_it_is_switched_on() {
    let run = run(&Setup {
        seconds: 0.01,
        commands: Vec::new(),
        trace: true,
        ..Setup::default()
    });
    let mut codes = [None; 2];
    for (kind, _, address, value, _) in records(&run.trace) {
        if kind != Kind::Write as u8 {
            continue;
        }
        if address == DAC_CONTROL && value & CHANNELS != 0 {
            break;
        }
        for (code, _) in codes
            .iter_mut()
            .zip(HOLDING)
            .filter(|(_, at)| *at == address)
        {
            *code = Some(value);
        }
    }
    assert_eq!(codes, [Some(2048); 2]);
}

/// Largest force that the hand feels after the first 0.4 s, N.
fn largest_force(run: &Outcome) -> f64 {
    let felt = run.plant_states.iter().skip((SETTLED_S * 1e4) as usize);
    let most = felt.map(|moment| moment.felt.abs()).fold(0.0, f64::max);
    2.0 * most / Device::default().handle.diameter_m
}

#[test]
fn a_press_of_10_n_switches_no_scene_off() {
    for scene in SceneKind::environments() {
        let run = run(&of_scene(scene, press(scene, &Device::default()), 2.4));
        let last = run.telemetry.frames.last().expect("frames");
        let state = if scene == SceneKind::Off {
            Mode::Armed
        } else {
            Mode::Running
        };
        assert_eq!((last.state, last.cause), (state, Stop::None), "{scene}");
        let force = largest_force(&run);
        println!("{scene}: {force} N");
        if stiffness(scene, &Device::default().stages).is_some() {
            // What the coupler transmits at the limit of its slip is 4.1 N, so it is near that.
            assert!(force > 3.0, "{scene}: {force} N");
        }
    }
}

/// Wait states and bus contention, which the emulator does not have, may cost as much again or twice as much.
#[test]
fn slower_core_misses_no_tick() {
    for cycles_per_instruction in [2, 3] {
        for scene in [SceneKind::FreeAir, SceneKind::Wall, SceneKind::Inertia] {
            let slower = NonZeroU64::new(CORE_HZ / cycles_per_instruction).expect("not zero");
            let run = run(&Setup {
                instructions_per_second: slower,
                ..Setup::playing(scene, 0.6)
            });
            let last = run.telemetry.frames.last().expect("frames");
            let name = format!("{scene}, {cycles_per_instruction} cycles an instruction");
            assert_eq!(
                (last.state, last.cause),
                (Mode::Running, Stop::None),
                "{name}"
            );
            assert_eq!((last.overruns, last.drops), (0, 0), "{name}");
            assert!(last.tick > 5_800, "{name}: {}", last.tick);
            assert!(!run.port.is_empty(), "{name}");
        }
    }
}

/// Mean torque that a still hand feels in free air, N·m, with these errors of the large motor's channel
/// and of the small one's.
fn mean_torque(errors: [DacError; 2], settings: Settings) -> f64 {
    let run = run(&Setup {
        dac_errors: errors,
        settings: Some(settings),
        ..of_scene(SceneKind::FreeAir, Hand::Still, 3.0)
    });
    let last = run.telemetry.frames.last().expect("frames");
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
    let felt = run.plant_states.iter().skip((SETTLED_S * 1e4) as usize);
    let n = felt.len() as f64;
    felt.map(|moment| moment.felt).sum::<f64>() / n
}

/// Twelve codes is what the datasheet allows the DAC; a little more. The small motor makes its part
/// of it felt, and nothing stops.
#[test]
fn dac_offset_causes_a_force_and_no_stop() {
    let mean = |offset| mean_torque([DacError::offset(offset); 2], Settings::COMMISSIONED);
    let [up, down] = [15.0, -15.0].map(mean);
    let device = Device::default();
    let small = 15.0 * AMPS_PER_CODE[1] * device.stages.small.torque_constant;
    println!("{up} {down} N.m of {small}");
    assert!(((up - down) / 2.0 / small - 1.0).abs() < 0.1);
}

/// Control register of the DAC, and its value with both channels on and their buffers off.
const DAC_CONTROL: u32 = 0x4000_7400;
const UNBUFFERED: u32 = 0b11 << 16 | 0b11;

/// The firmware leaves the buffers on, so that the smallest load that the data sheet allows changes nothing.
/// Without them it would divide the levels, and command a current.
#[test]
fn load_of_the_dac_pins_changes_no_current() {
    let currents = |load_ohm, accesses| {
        let run = run(&Setup {
            dac_load_ohm: [load_ohm; 2],
            accesses,
            ..of_scene(SceneKind::FreeAir, Hand::Moving, 0.6)
        });
        let states = run.plant_states.iter();
        states.map(|moment| moment.currents).collect::<Vec<_>>()
    };
    let unloaded = currents(1e12, Vec::new());
    assert!(unloaded.iter().flatten().any(|current| *current != 0.0));
    assert_eq!(currents(LEAST_LOAD_OHM, Vec::new()), unloaded);
    let off = vec![(0.3, CoreAccess::Store(DAC_CONTROL, UNBUFFERED))];
    let most = |currents: &[[f64; 2]]| {
        currents
            .iter()
            .flatten()
            .fold(0.0, |most: f64, i| most.max(i.abs()))
    };
    let divided = currents(LEAST_LOAD_OHM, off);
    assert!(most(&divided) > 2.0 + most(&unloaded), "{}", most(&divided));
    let small = Setup {
        dac_load_ohm: [LEAST_LOAD_OHM, 4e3],
        ..Setup::default()
    };
    let refused = on_board(image(""), &small, |_| ()).unwrap_err();
    assert!(refused.contains("4000 ohm at a DAC pin"), "{refused}");
}

/// Settings in flash that state zero and gain of both channels leave less than 1 mN of what the errors
/// cost.
#[test]
fn settings_in_flash_take_zero_and_gain_of_the_dac_into_account() {
    let perfect = mean_torque([DacError::NONE; 2], Settings::COMMISSIONED);
    let [up, down] = [(15.3, 1.04), (-15.3, 0.96)].map(|(offset, gain)| DacError { offset, gain });
    for errors in [[up, up], [down, down], [up, down]] {
        let [large, small] = errors;
        let mut settings = Settings::COMMISSIONED;
        for (setting, value) in [
            (Setting::ZeroLarge, 2048.0 - large.offset),
            (Setting::ZeroSmall, 2048.0 - small.offset),
            (Setting::GainLarge, large.gain),
            (Setting::GainSmall, small.gain),
        ] {
            assert!(settings.set(setting, value as f32));
        }
        let force = |settings| {
            let torque = mean_torque(errors, settings) - perfect;
            2e3 * torque.abs() / Device::default().handle.diameter_m
        };
        let [without, with] = [Settings::COMMISSIONED, settings].map(force);
        println!("{errors:?}: {without} mN without them in the settings, {with} mN with");
        assert!(without > 5.0 && with < 1.0, "{without} {with} mN");
    }
}
