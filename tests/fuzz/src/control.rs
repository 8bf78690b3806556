//! Any inputs into a control task: scenes, monitor and safety state as the firmware has them.

use estimator_core::{
    Count, EndFit, Foaw, Hertz, Model, NoInput, Sample, Skip, SteadyKalman, SteadyKalmanTriple,
    preset,
};
use haptic_control::{
    AnyScene, Balance, Bounds, Currents, DualStage, Findings, LoopPoles, Mode, Monitor, Refusal,
    Request, Rig, Safety, SceneKind, Stop, Switchboard, SwitchboardState,
};

use crate::bytes::Bytes;

const RATE: Hertz = Hertz(10_000.0);
const DEVICE: DualStage = DualStage::DEFAULT;
const RIG: Rig = preset!(Rig::new(&DEVICE, RATE, LoopPoles::DEFAULT));
const LARGE: Foaw<15, EndFit> = preset!(Foaw::new(15, 1));
const MODEL: Model<3, NoInput> = preset!(Model::triple_integrator(
    DEVICE.small.counts_per_rev,
    RATE,
    4e3
));
type Board = Switchboard<Foaw<15, EndFit>, SteadyKalmanTriple>;
type State = SwitchboardState<Foaw<15, EndFit>, SteadyKalmanTriple>;
const HANDLE: SteadyKalmanTriple = preset!(SteadyKalman::new(&MODEL));
const MONITOR: Monitor = Monitor::new(&DEVICE, RATE);
const BALANCE: Balance = Balance::new(&DEVICE, RATE);
const SCENES: [AnyScene; SceneKind::ALL.len()] = preset!(AnyScene::usual(&DEVICE, RATE));
/// Beyond what any device renders, so that the current limits alone bound the currents.
const BOUNDS: Bounds = Bounds {
    stiffness: 10.0,
    damping: 0.1,
    angle: 100.0,
    torque: 1.0,
    inertia: 5e-6,
    rate: RATE,
};
const SAFETY: Safety = Safety {
    settle: 3,
    silence: Some(50),
    disarm: Some(200),
    missed: 4,
    scenes: SCENES.len() as u8,
};

/// Runs the task on the inputs in `data`.
///
/// # Panics
/// If a current is beyond the amplifier, the amplifiers stay on after a finding, or a stop is
/// left without being armed again.
pub fn run(data: &[u8]) {
    let board = Switchboard::new(LARGE, HANDLE, RIG, RATE);
    let mut sample = Sample::new(Count(0x8000_0000));
    let mut scene = board.start(&sample);
    let mut monitor = MONITOR.start(&sample);
    let mut balance = BALANCE.start(&sample);
    let mut safety = SAFETY.start(Stop::None);
    let mut bytes = Bytes(data);
    while let (Some(next), Some(inputs)) = (bytes.sample(&sample), bytes.byte()) {
        sample = next;
        let request = match inputs & 15 {
            1 => Some(Request::Arm),
            2 => Some(Request::Disarm),
            3 => Some(Request::Select(inputs >> 4)),
            4 => Some(Request::KeepAlive),
            5 => {
                tune(&board, &mut scene, &mut bytes);
                None
            }
            _ => None,
        };
        if inputs == 0xFD {
            balance.begin_after(1);
        }
        let findings = Findings {
            monitor: MONITOR
                .check(&mut monitor, &sample)
                .or(BALANCE.check(&mut balance, &sample)),
            present: None,
            amplifiers_ready: inputs != 0xFF,
            interlock: inputs == 0xFB,
            clock_failure: inputs == 0xFE,
            finite: true,
            missed: u32::from(inputs == 0xFD),
            debugger: inputs == 0xFC,
            supply: Skip,
        };
        let action = board.step(&mut scene, &sample);
        check(&action.currents);
        assert!(action.torque.0.is_finite(), "{action:?}");
        assert!(
            action.large_velocity.0.is_finite() && action.handle_velocity.0.is_finite(),
            "{action:?}"
        );

        let before = safety.mode();
        let order = SAFETY.tick(&mut safety, &findings, request);
        let not_ready = !findings.amplifiers_ready && before != Mode::Settling;
        let wrong =
            findings.monitor.is_some() || not_ready || findings.interlock || findings.clock_failure;
        // What is wrong while enabled stops it in this very tick.
        if wrong && before.is_enabled() {
            assert!(!order.enable && safety.mode() == Mode::Safe, "{findings:?}");
        }
        if before == Mode::Safe && request != Some(Request::Arm) {
            assert!(!order.enable, "left safe by {request:?}");
        }
        if order.restart {
            scene = board.start(&sample);
            monitor = MONITOR.start(&sample);
            balance = BALANCE.start(&sample);
        }
        if let Some(number) = order.select {
            board.select(&mut scene, SCENES[usize::from(number)], &sample);
        }
        sample.current = if order.enable {
            action.currents.large
        } else {
            Currents::default().large
        };
    }
}

/// Sets a parameter of a scene to any bits. The switchboard ignores scenes that are not on.
fn tune(board: &Board, scene: &mut State, bytes: &mut Bytes<'_>) {
    let mut next = || bytes.byte().unwrap_or(0);
    let (number, parameter) = (usize::from(next()) % SCENES.len(), next());
    let value = f32::from_le_bytes([next(), next(), next(), next()]);
    match SCENES[number].tuned(parameter, value, &BOUNDS) {
        Ok(tuned) => {
            assert!(value.is_finite(), "{tuned:?}");
            board.retune(scene, tuned);
        }
        Err(Refusal::Unknown) => {
            assert!(usize::from(parameter) >= SCENES[number].kind().facts().parameters.len());
        }
        Err(_) => {}
    }
}

fn check(currents: &Currents) {
    let (large, small) = (currents.large.get(), currents.small.get());
    assert!(
        f64::from(large.abs()) <= DEVICE.large.current_limit,
        "{large} A"
    );
    assert!(
        f64::from(small.abs()) <= DEVICE.small.current_limit,
        "{small} A"
    );
}
