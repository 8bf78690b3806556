//! Conditions of a run.

use std::collections::BTreeSet;
use std::num::NonZeroU64;

use drivers::Settings;
use experiments::closed_loop::Hand;
use haptic_control::SceneKind;
use simulation::device::Device;

use crate::board::CORE_HZ;
use crate::command::Command;
pub use crate::dac::LEAST_LOAD_OHM;
use crate::fault::Fault;
use crate::flash::{FlashTimes, Sectors};
use crate::lockstep::CoreAccess;
use crate::port::LineErrors;

/// Error of a channel from DAC code to current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DacError {
    /// Offset, codes; up to 12 on a real chip.
    pub offset: f64,
    /// Change of the current per code, over [`AMPS_PER_CODE`](super::AMPS_PER_CODE).
    pub gain: f64,
}

impl DacError {
    /// That of a perfect channel.
    pub const NONE: Self = Self {
        offset: 0.0,
        gain: 1.0,
    };

    /// An offset alone, codes.
    #[must_use]
    pub const fn offset(offset: f64) -> Self {
        Self {
            offset,
            ..Self::NONE
        }
    }
}

/// Conditions of a run.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The simulated device.
    pub device: Device,
    /// The hand on the handle.
    pub hand: Hand,
    /// Seed of the hand's motion, the encoders' phases and the disc.
    pub seed: u64,
    /// Virtual time, s.
    pub seconds: f64,
    /// Faults and their times, s.
    pub faults: Vec<(f64, Fault)>,
    /// Commands and their times, s.
    pub commands: Vec<(f64, Command)>,
    /// Bytes that are not a command, and their times, s.
    pub garbage: Vec<(f64, Vec<u8>)>,
    /// Whether to send a keep-alive every 50 ms.
    pub keep_alive: bool,
    /// Bytes that the serial port of the board receives, one after the other as fast as the line is,
    /// and the times at which they begin, s.
    pub port: Vec<(f64, Vec<u8>)>,
    /// How bytes arrive at the serial port, and the times from which on they do, s.
    pub port_errors: Vec<(f64, LineErrors)>,
    /// Edges per second of a signal generator instead of the large encoder, counting down if
    /// negative.
    pub generator_hz: Option<f64>,
    /// Frequency of the crystal, Hz; 0 if the crystal does not run.
    pub crystal_hz: u64,
    /// Start of the crystal, s.
    pub crystal_from_s: f64,
    /// Errors of the DAC outputs and of the inputs behind them: large motor, small motor.
    pub dac_errors: [DacError; 2],
    /// Loads of the DAC pins to ground, ohm: at least [`LEAST_LOAD_OHM`].
    pub dac_load_ohm: [f64; 2],
    /// Errors of the zeros of the current monitors, codes.
    pub monitor_offsets: [f64; 2],
    /// Voltage of the amplifiers' supply until a fault of it, V.
    pub supply_v: f64,
    /// Settings in the board's flash; `None`: the flash is erased.
    pub settings: Option<Settings>,
    /// Number of records of older settings before them.
    pub older_records: u32,
    /// Content of the sectors of the settings instead, such as another run has left it.
    pub flash: Option<Sectors>,
    /// How long the flash takes to program and to erase.
    pub flash_times: FlashTimes,
    /// Additional loads and stores of the core, and their times, s.
    pub accesses: Vec<(f64, CoreAccess)>,
    /// Instructions per second of virtual time.
    pub instructions_per_second: NonZeroU64,
    /// Indices in [`Outcome::ticks`](super::Outcome::ticks) of ticks to follow instruction by instruction, which is slow.
    pub follow: BTreeSet<usize>,
    /// Whether to record the run for another core.
    pub trace: bool,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            device: Device::default(),
            hand: Hand::Moving,
            seed: 1,
            seconds: 1.0,
            faults: Vec::new(),
            commands: vec![
                (0.05, Command::Scene(SceneKind::FreeAir)),
                (0.1, Command::Arm),
            ],
            garbage: Vec::new(),
            keep_alive: true,
            port: Vec::new(),
            port_errors: Vec::new(),
            generator_hz: None,
            crystal_hz: 8_000_000,
            crystal_from_s: 0.0,
            dac_errors: [DacError::NONE; 2],
            dac_load_ohm: [LEAST_LOAD_OHM; 2],
            monitor_offsets: [11.0, -7.0],
            supply_v: 24.0,
            settings: Some(Settings::COMMISSIONED),
            older_records: 1,
            flash: None,
            flash_times: FlashTimes::TYPICAL,
            accesses: Vec::new(),
            instructions_per_second: NonZeroU64::new(CORE_HZ).expect("not zero"),
            follow: BTreeSet::new(),
            trace: false,
        }
    }
}

impl Setup {
    /// A scene, selected and armed in the first 0.1 s, with the scene's hand.
    #[must_use]
    pub fn playing(scene: SceneKind, seconds: f64) -> Self {
        Self {
            hand: scene.facts().hand.into(),
            seconds,
            commands: vec![(0.05, Command::Scene(scene)), (0.1, Command::Arm)],
            ..Self::default()
        }
    }
}
