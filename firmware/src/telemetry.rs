//! Telemetry frames: made by the control task, logged by the lowest priority.

use estimator_core::{Count, Deviations, Sample, Skip};
use haptic_control::Action;
use heapless::spsc::{Consumer, Producer, Queue};

use crate::scene::{EDGES, Estimation, Learned, RIG};

/// Frames a second.
const FRAMES_HZ: u32 = 1000;
/// Control ticks for one frame.
const DECIMATION: u32 = crate::board::RATE_HZ / FRAMES_HZ;
/// Frames that wait, and that one look logs at most.
const DEPTH: usize = 32;

/// Frames between the control task and the log.
pub(crate) type Frames = Queue<Frame, DEPTH>;

/// What a tick came to.
#[derive(Clone, Copy)]
pub(crate) struct Record {
    pub(crate) tick: u32,
    pub(crate) sample: Sample,
    pub(crate) action: Action,
    pub(crate) state: u8,
    pub(crate) cause: u8,
    pub(crate) overruns: u32,
    pub(crate) estimation: Estimation,
    pub(crate) learned: Learned,
}

/// A record on its way out.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    seq: u32,
    drops: u32,
    record: Record,
    cycles: u32,
    reference: Option<Count>,
}

/// Where the control task puts its records.
pub(crate) struct Sender {
    queue: Producer<'static, Frame>,
    /// Ticks until the next frame.
    wait: u32,
    seq: u32,
    drops: u32,
}

impl Sender {
    /// A sender that has made no frame.
    pub(crate) fn new(queue: Producer<'static, Frame>) -> Self {
        Self {
            queue,
            wait: 0,
            seq: 0,
            drops: 0,
        }
    }

    /// Whether this tick is told of, as every `DECIMATION`th is. To be asked once a tick.
    pub(crate) fn is_due(&mut self) -> bool {
        let due = self.wait == 0;
        self.wait = if due { DECIMATION } else { self.wait } - 1;
        due
    }

    /// Sends a record; one that finds no place is counted.
    pub(crate) fn send(&mut self, record: Record, cycles: u32, reference: Option<Count>) {
        let frame = Frame {
            seq: self.seq,
            drops: self.drops,
            record,
            cycles,
            reference,
        };
        self.seq = self.seq.wrapping_add(1);
        if self.queue.enqueue(frame).is_err() {
            self.drops = self.drops.wrapping_add(1);
        }
    }
}

/// Logs the frames that wait; whether there were any.
pub(crate) fn log(frames: &mut Consumer<'static, Frame>) -> bool {
    let mut any = false;
    for _ in 0..DEPTH {
        let Some(frame) = frames.dequeue() else {
            break;
        };
        frame.log();
        any = true;
    }
    any
}

impl Frame {
    #[rustfmt::skip]
    fn log(&self) {
        let Record { tick, sample, action, state, cause, overruns, estimation, learned } = self.record;
        let deviation = estimation.variance.deviation().rad_per_s(&RIG.large);
        // Lost on the way to the queue, or between the queue and the probe.
        let drops = self.drops.wrapping_add(bare::lost());
        defmt::info!(
            "frame seq={=u32} tick={=u32} large={=u32} small={=u32} wl={=f32} ws={=f32} sl={=f32} estimator={=u8} torque={=f32} il={=f32} is={=f32} state={=u8} cause={=u8} overruns={=u32} drops={=u32} cycles={=u32}",
            self.seq, tick, sample.large.0, sample.small.0,
            action.large.0, action.handle.0, deviation, estimation.number.unwrap_or(NOBODY), action.torque.0,
            action.currents.large.get(), action.currents.small.get(),
            state, cause, overruns, drops, self.cycles
        );
        if EDGES && let Some(edge) = sample.edge {
            defmt::info!("edge seq={=u32} bound={=u32} age={=u32}", self.seq, edge.boundary.0, edge.age.0);
        }
        if self.seq.is_multiple_of(LEARNED_EVERY) {
            learned.log(self.seq);
        }
        if let Some(Count(count)) = self.reference {
            defmt::info!("reference seq={=u32} count={=u32}", self.seq, count);
        }
    }
}

/// What a frame says where no estimator is in charge.
const NOBODY: u8 = u8::MAX;

/// Frames for one line of what was learned, which changes slowly.
const LEARNED_EVERY: u32 = 128;

/// What may be said beside a frame.
trait Aside {
    fn log(&self, seq: u32);
}

/// Nothing is learned: no code.
impl Aside for Skip {
    fn log(&self, _: u32) {}
}

impl Aside for Deviations {
    #[rustfmt::skip]
    fn log(&self, seq: u32) {
        defmt::info!(
            "learned seq={=u32} damping={=f32} friction={=f32} torque_constant={=f32}",
            seq, self.damping, self.friction, self.torque_constant
        );
    }
}
