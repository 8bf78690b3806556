//! One run of an image on the board, and its results.

mod setup;

use std::time::{Duration, Instant};

use recordings::telemetry::{Frame, Telemetry};
use rigless::emulator::{Start, run};
use rigless::session::Session;
use rigless::time::VirtualNanos;
use simulation::plant::Pose;
use terminal::failure::Failure;

use crate::board::ControllerBoard;
use crate::fault::Fault;
use crate::fetch::Fetches;
use crate::flash::{self, Change, Sectors};
use crate::image::Image;
use crate::live::Live;
pub use crate::lockstep::CoreAccess;
use crate::lockstep::Lockstep;
use crate::objections;
pub use setup::{DacError, LEAST_LOAD_OHM, Setup};

/// Control rate of an image that is built without `RATE`, Hz.
pub const RATE_HZ: f64 = 10e3;

/// Rate at which the motion of the hand is given and the state of the plant is recorded, Hz.
pub(crate) const HAND_HZ: f64 = 10e3;

/// Current per DAC code from mid-scale, A: large motor, small motor.
pub const AMPS_PER_CODE: [f64; 2] = [6.0 / 2047.0, 1.5 / 2047.0];

/// Current from the middle of the range of a current monitor to its ends, A: large motor, small motor.
pub const MONITOR_AMPS: [f64; 2] = [7.5, 1.875];

/// Voltage of the amplifiers' supply at the upper end of the range of its input, V: 3.3 V behind a divider by
/// 11.
pub const SUPPLY_FULL_SCALE_V: f64 = 36.3;

/// One call of the control task, and the true state at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlTick {
    /// Start of the call, ns.
    pub at_ns: u64,
    /// Whether the call woke the processor. Otherwise the call preempted another task.
    pub asleep: bool,
    /// Number of instructions, from the first of the handler to its return.
    pub instructions: u32,
    /// Estimated cycles from the interrupt to the end of the call, if the tick was followed.
    pub cycles: Option<u32>,
    /// Instruction fetches from flash, if the tick was followed.
    pub fetches: Option<Fetches>,
    /// Values read from the counters of the large and the small encoder.
    pub counts: [Option<u16>; 2],
    /// Time of the last read of the edge clock in the call, ns.
    pub stamp_clock_read_ns: Option<u64>,
    /// DAC codes at the end of the call.
    pub codes: [Option<u16>; 2],
    /// Whether each amplifier is enabled at the end of the call.
    pub enabled: [bool; 2],
    /// Large motor.
    pub large: Pose,
    /// Handle.
    pub handle: Pose,
    /// Torque on the hand, N.m.
    pub felt: f64,
}

/// State of the plant at a multiple of 100 us.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantState {
    /// Torque on the hand, N.m.
    pub felt: f64,
    /// Commanded currents, A.
    pub currents: [f64; 2],
    /// Velocity of the large motor, rad/s.
    pub large_omega: f64,
}

/// A restart of the processor.
#[derive(Clone, Debug, PartialEq)]
pub struct Restart {
    /// Time, s.
    pub at_s: f64,
    /// Cause, as the emulator names it.
    pub cause: String,
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Every call of the control task.
    pub ticks: Vec<ControlTick>,
    /// State of the plant, every 100 us.
    pub plant_states: Vec<PlantState>,
    /// Values that the image read from both counters before its first tick.
    pub first_counts: [Option<u16>; 2],
    /// Bytes that the debug probe read from up channel 0.
    pub rtt: Vec<u8>,
    /// Bytes that the debug probe read from up channel 1: messages of the link.
    pub rtt_link: Vec<u8>,
    /// Decoded telemetry of the firmware.
    pub telemetry: Telemetry,
    /// Each change of the amplifiers' enables, with its time in ns.
    pub enables: Vec<(u64, [bool; 2])>,
    /// Restarts.
    pub restarts: Vec<Restart>,
    /// Pins with a wrong mode at the start of control, one line each.
    pub complaints: Vec<String>,
    /// Number of calls of the control task without a return.
    pub unclosed: u32,
    /// Objections of the emulator, one line each: accesses that it does not model, and conditions
    /// of clocks and flash. No objection is allowed.
    pub objections: Vec<String>,
    /// Values stored and read for [`Setup::accesses`], in their order.
    pub values: Vec<u32>,
    /// Largest number of bytes of stack in use.
    pub stack: u64,
    /// Bytes sent on the command channel, each with the time of the last byte, ns.
    pub sent: Vec<(u64, Vec<u8>)>,
    /// Bytes that the serial port of the board has sent, each with the time of its end, ns.
    pub port: Vec<(u64, u8)>,
    /// Content of the sectors of the settings at the end of the run.
    pub flash: Sectors,
    /// What the firmware has programmed and erased, in its order.
    pub flash_changes: Vec<Change>,
    /// The record of the run for another core, of the format in [`crate::trace`]; empty without
    /// [`Setup::trace`].
    pub trace: Vec<u8>,
    /// Run time of the emulation.
    pub wall: Duration,
    /// Number of the first of `ticks` in telemetry.
    first_tick: Option<u32>,
}

impl Outcome {
    /// Checks that the emulator has no objection.
    ///
    /// # Errors
    /// [`Failure::Check`] with all of [`Self::objections`].
    pub fn check(&self) -> Result<(), Failure> {
        objections::verdict(&self.objections)
    }

    /// Control rate of the image, Hz, as its log has it; [`RATE_HZ`] if it did not boot.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        let booted = self.telemetry.boots.first();
        booted.map_or(RATE_HZ, |boot| boot.rate_hz)
    }

    /// Index in `ticks` of the tick of a frame.
    #[must_use]
    pub fn tick_index(&self, frame: &Frame) -> Option<usize> {
        let index = frame.tick.wrapping_sub(self.first_tick?) as usize;
        (index < self.ticks.len()).then_some(index)
    }

    /// The control tick of a frame.
    #[must_use]
    pub fn tick(&self, frame: &Frame) -> Option<&ControlTick> {
        self.ticks.get(self.tick_index(frame)?)
    }
}

/// Runs `image` and calls `progress` from time to time with the virtual time in s.
///
/// # Errors
/// One line on an invalid device, an invalid image, or an error of the emulator.
pub fn on_board(
    image: &Image,
    setup: &Setup,
    progress: impl FnMut(f64) + Send + 'static,
) -> Result<Outcome, String> {
    let (session, lockstep, wall) = emulate(image, setup, None, progress)?;
    let restarts = session.resets().iter().map(|reset| Restart {
        at_s: reset.at.0 as f64 * 1e-9,
        cause: format!("{:?}", reset.cause),
    });
    let restarts = restarts.collect();
    let Lockstep {
        recorded,
        probe,
        accesses,
        port,
        trace,
        ..
    } = lockstep;
    let sent_by_port = std::mem::take(&mut port.wire().up);
    let flash = &session.board().part.flash;
    let telemetry = rtt::decode(&image.elf, &probe.stream)?;
    Ok(Outcome {
        first_tick: first_tick(&telemetry.frames, &recorded.ticks),
        rtt: probe.stream,
        rtt_link: probe.link,
        telemetry,
        ticks: recorded.ticks,
        first_counts: recorded.first_counts,
        plant_states: recorded.plant_states,
        enables: recorded.enables,
        complaints: recorded.complaints,
        unclosed: recorded.unclosed,
        stack: recorded.stack,
        values: accesses.values,
        sent: probe.sent,
        port: sent_by_port,
        trace: trace.map_or_else(Vec::new, |trace| trace.bytes),
        restarts,
        objections: objections::of(&session),
        flash: flash.sectors().clone(),
        flash_changes: flash.changes.clone(),
        wall,
    })
}

/// The run, with a client if there is one: final state of board and plant, and the
/// run time.
pub(crate) fn emulate(
    image: &Image,
    setup: &Setup,
    client: Option<Live>,
    progress: impl FnMut(f64) + Send + 'static,
) -> Result<(Session<ControllerBoard>, Lockstep, Duration), String> {
    setup.device.validate()?;
    if let Some(load_ohm) = setup
        .dac_load_ohm
        .iter()
        .find(|ohm| **ohm < LEAST_LOAD_OHM || ohm.is_nan())
    {
        return Err(format!(
            "a load of {load_ohm} ohm at a DAC pin: the buffer of the output drives at least {LEAST_LOAD_OHM} ohm"
        ));
    }
    let emulator = |error: &dyn std::fmt::Display| format!("emulator: {error}");
    let has = |fault| setup.faults.iter().any(|(_, other)| *other == fault);
    let crystal_hz = if has(Fault::DeadCrystal) || setup.crystal_from_s > 0.0 {
        0
    } else {
        setup.crystal_hz
    };
    let mut board = ControllerBoard::new(crystal_hz, setup.instructions_per_second)
        .map_err(|error| emulator(&error))?;
    for (fault, hz) in [(Fault::SlowWatchdog, 17_000), (Fault::FastWatchdog, 47_000)] {
        if has(fault) {
            board.part.stm32.rcc.calibrate_lsi(hz);
        }
    }
    let flash = match (&setup.flash, &setup.settings) {
        (Some(sectors), _) => sectors.clone(),
        (None, Some(settings)) => Sectors::with(settings, setup.older_records)?,
        (None, None) => Sectors::erased(),
    };
    board.part.flash.place(flash);
    board.part.flash.take(setup.flash_times);
    let mut session =
        Session::new(Box::new(board), 0, VirtualNanos(0)).map_err(|error| emulator(&error))?;
    let mut lockstep = Lockstep::new(image, setup, Box::new(progress));
    lockstep.live = client;
    lockstep.watch(&mut session);
    let since = Instant::now();
    let images = [image.placed.clone(), flash::size()?];
    let finished =
        run(session, &Start::new(&images), lockstep).map_err(|error| emulator(&error))?;
    let wall = since.elapsed();
    let mut session = finished.session;
    if let Some(error) = session.take_error() {
        return Err(emulator(&error));
    }
    Ok((session, finished.driver, wall))
}

/// Number of the first tick in telemetry: the one with which the counts of every frame agree with
/// those that its tick read.
fn first_tick(frames: &[Frame], ticks: &[ControlTick]) -> Option<u32> {
    (0..4).find(|first| {
        frames.iter().all(|frame| {
            let tick = ticks.get(frame.tick.wrapping_sub(*first) as usize);
            tick.is_some_and(|tick| {
                tick.counts
                    == [
                        Some(frame.counts_large as u16),
                        Some(frame.counts_small as u16),
                    ]
            })
        })
    })
}
