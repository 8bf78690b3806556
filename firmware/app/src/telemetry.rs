//! Telemetry frames: made by the control task, logged at the lowest priority.

use drivers::NO_ESTIMATOR;
use estimator_core::{Count, Edge, ParameterErrors, Sample};
use haptic_control::{Action, Currents, Mode, Stop, Volts};
use heapless::spsc::{Producer, Queue};

use crate::ammeter::{Measured, Measurement as _};
use crate::config::EDGES;
use crate::index::{Indication, Indications as _, Reported};
use crate::large::{Learnable as _, Learned};
use crate::scene::{Estimation, RIG};
use crate::supply::{Reading, Voltage as _};

/// Frames that wait, and that one look logs at most.
pub const DEPTH: usize = 32;

/// Frames between the control task and the log.
pub type Frames = Queue<Frame, DEPTH>;

/// The state of the control after a tick.
#[derive(Clone, Copy)]
pub struct Record {
    /// Number of the tick from 0, modulo 2^32.
    pub tick: u32,
    /// The tick's input.
    pub sample: Sample,
    /// The tick's output.
    pub action: Action,
    /// State of the safety machine.
    pub state: Mode,
    /// Cause of the latest stop.
    pub cause: Stop,
    /// Ticks missed or late so far, modulo 2^32.
    pub overruns: u32,
    /// The large motor's estimator on its latest velocity.
    pub estimation: Estimation,
    /// Relative parameter errors that the large motor's estimator has learned.
    pub learned: Learned,
}

/// A record on its way to the log.
#[derive(Clone, Copy)]
pub struct Frame {
    /// Number of the frame from 0, modulo 2^32. Frames that found no place count.
    pub seq: u32,
    /// The record.
    pub record: Record,
    /// Core clock cycles of the control task.
    pub cycles: u32,
    /// Count of the reference encoder, if there is one.
    pub reference: Option<Count>,
    measured: Measured,
    index: Reported,
    supply: Reading,
    drops: u32,
}

/// The control task's end of the queue of frames.
pub struct Sender<'q> {
    queue: Producer<'q, Frame>,
    seq: u32,
    drops: u32,
}

impl<'q> Sender<'q> {
    /// A sender that has made no frame.
    pub fn new(queue: Producer<'q, Frame>) -> Self {
        Self {
            queue,
            seq: 0,
            drops: 0,
        }
    }

    /// Sends a record, or counts it as dropped if the queue is full.
    pub fn send(
        &mut self,
        record: Record,
        measured: Measured,
        index: Reported,
        supply: Reading,
        cycles: u32,
        reference: Option<Count>,
    ) {
        let frame = Frame {
            seq: self.seq,
            drops: self.drops,
            record,
            cycles,
            reference,
            measured,
            index,
            supply,
        };
        self.seq = self.seq.wrapping_add(1);
        if self.queue.enqueue(frame).is_err() {
            self.drops = self.drops.wrapping_add(1);
        }
    }
}

/// Frames for one line of what changes slowly.
const SLOWLY: u32 = 128;

impl Frame {
    /// Frames lost so far: before this one in the queue, and `lost` of them after it.
    #[must_use]
    pub const fn drops(&self, lost: u32) -> u32 {
        self.drops.wrapping_add(lost)
    }

    /// Standard deviation of the large motor's velocity, rad/s; 0 where the scene needs none.
    #[must_use]
    pub fn deviation(&self) -> f32 {
        let variance = self.record.estimation.variance;
        variance.std_dev().rad_per_s(&RIG.large_scale)
    }

    /// Number of the estimator in charge of the large motor; 255 for none.
    #[must_use]
    pub fn estimator(&self) -> u8 {
        self.record.estimation.number.unwrap_or(NO_ESTIMATOR)
    }

    /// The latest stamped edge of the large encoder.
    #[must_use]
    pub const fn edge(&self) -> Option<Edge> {
        if EDGES { self.record.sample.edge } else { None }
    }

    /// Mean measured currents since the frame before.
    #[must_use]
    pub fn measured(&self) -> Option<Currents> {
        self.measured.currents()
    }

    /// Learned parameter errors, in one frame of 128 and by estimators that learn.
    #[must_use]
    pub fn learned(&self) -> Option<ParameterErrors> {
        self.record
            .learned
            .deviations()
            .filter(|_| self.is_one_of_many())
    }

    /// Index pulses of the large and the small encoder, if one came since the frame before, and in one
    /// frame of 128.
    #[must_use]
    pub fn index(&self) -> Option<[Indication; 2]> {
        self.index.pair(self.is_one_of_many())
    }

    /// Voltage of the amplifiers' supply.
    #[must_use]
    pub fn supply(&self) -> Option<Volts> {
        self.supply.volts()
    }

    fn is_one_of_many(&self) -> bool {
        self.seq.is_multiple_of(SLOWLY)
    }
}
