//! Telemetry frames.

use estimator_core::Sample;
use haptic_control::Action;
use heapless::spsc::{Consumer, Producer, Queue};

/// Control ticks for one frame: 1 kHz.
pub(crate) const DECIMATION: u32 = crate::board::RATE_HZ / 1000;
/// Frames that wait at most.
pub(crate) const DEPTH: usize = 32;

/// Frames between the control task and the log.
pub(crate) type Frames = Queue<Frame, DEPTH>;

/// One record of the control task.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    seq: u32,
    drops: u32,
    record: Record,
}

/// What a tick came to.
#[derive(Clone, Copy)]
pub(crate) struct Record {
    pub(crate) tick: u32,
    pub(crate) sample: Sample,
    pub(crate) action: Action,
    pub(crate) state: u8,
    pub(crate) cause: u8,
    pub(crate) overruns: u32,
    pub(crate) cycles: u32,
}

/// Where the control task puts its frames.
pub(crate) struct Sender {
    queue: Producer<'static, Frame>,
    seq: u32,
    drops: u32,
}

impl Sender {
    pub(crate) fn new(queue: Producer<'static, Frame>) -> Self {
        Self {
            queue,
            seq: 0,
            drops: 0,
        }
    }

    /// Makes a frame of every `DECIMATION`th record; one that finds no place is counted.
    pub(crate) fn offer(&mut self, record: Record) {
        if !record.tick.is_multiple_of(DECIMATION) {
            return;
        }
        let Self { seq, drops, .. } = *self;
        self.seq = seq.wrapping_add(1);
        if self.queue.enqueue(Frame { seq, drops, record }).is_err() {
            self.drops = drops.wrapping_add(1);
        }
    }
}

/// Logs every frame that waits, at most `DEPTH`.
pub(crate) fn drain(frames: &mut Consumer<'static, Frame>) {
    for _ in 0..DEPTH {
        let Some(Frame { seq, drops, record }) = frames.dequeue() else {
            return;
        };
        let Record {
            tick,
            sample,
            action,
            state,
            cause,
            overruns,
            cycles,
        } = record;
        defmt::info!(
            "frame seq={=u32} tick={=u32} large={=u32} small={=u32} wl={=f32} ws={=f32} torque={=f32} il={=f32} is={=f32} state={=u8} cause={=u8} overruns={=u32} drops={=u32} cycles={=u32}",
            seq,
            tick,
            sample.large.0,
            sample.small.0,
            action.large.0,
            action.handle.0,
            action.torque.0,
            action.currents.large.get(),
            action.currents.small.get(),
            state,
            cause,
            overruns,
            drops,
            cycles
        );
    }
}
