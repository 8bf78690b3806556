//! Board and plant in lockstep: the plant is one step of 10 us ahead of the processor, and its
//! edges reach the pins at their times.

mod core_access;
mod flash;
mod follow;
mod hits;
mod inject;
mod plant;
mod traced;

use std::collections::VecDeque;

use experiments::closed_loop::{Bench, FeedbackEncoder, Motion};
use rigless::emulator::{AccessKind, HitKind, Host, Settled, Stop, Watch};
use rigless::session::Session;
use rigless::time::VirtualNanos;
use simulation::device::LONGEST_STEP_S;
use simulation::encoder::{DiscErrors, Encoder};
use simulation::plant::Grip;

use crate::amplifiers::{Amplifiers, Monitor};
use crate::board::ControllerBoard;
use crate::fault::Fault;
use crate::image::Image;
use crate::lines::Lines;
use crate::live::{Acts, Guided, Live, Seen};
use crate::pins;
use crate::port::Port;
use crate::probe::{DebugProbe, schedule};
use crate::quadrature::{Edge, Generator, LARGE};
use crate::run::{ControlTick, DacError, HAND_HZ, MONITOR_AMPS, PlantState, RATE_HZ, Setup};
use crate::stack::Stack;
use crate::trace::Trace;
pub use core_access::CoreAccess;
use core_access::CoreAccesses;
use follow::Follow;
use inject::Stalls;

/// Step of the plant, ns and s.
const STEP_NS: u64 = 10_000;
const STEP_S: f64 = 10e-6;
const _: () = assert!((STEP_S * 1e9 + 0.5) as u64 == STEP_NS && STEP_S <= LONGEST_STEP_S);
/// Steps of the plant per tick of the hand, and per poll of the debug probe.
const STEPS_PER_TICK: u64 = (1e9 / HAND_HZ) as u64 / STEP_NS;
const STEPS_PER_LOOK: u64 = 100;

/// Counters of TIM4 (large) and TIM3 (small).
const COUNTERS: [u64; 2] = [0x4000_0824, 0x4000_0424];

/// Counter of TIM2, which stamps the large encoder's edges.
const STAMP_CLOCK: u64 = 0x4000_0024;

/// Recorded signals and events of a run.
#[derive(Debug, Default)]
pub(crate) struct Recorded {
    pub(crate) ticks: Vec<ControlTick>,
    pub(crate) first_counts: [Option<u16>; 2],
    pub(crate) plant_states: Vec<PlantState>,
    pub(crate) enables: Vec<(u64, [bool; 2])>,
    pub(crate) complaints: Vec<String>,
    pub(crate) unclosed: u32,
    /// Largest number of bytes of stack in use.
    pub(crate) stack: u64,
}

impl Recorded {
    /// Period of the latest control ticks, ns; that of an image that is built without `RATE` before the second.
    fn period_ns(&self) -> f64 {
        let latest = self.ticks.len().saturating_sub(10);
        let starts = self.ticks[latest..].windows(2);
        // One that comes late brings the next one nearer by as much.
        let count = starts.len() as f64;
        let all: u64 = starts.map(|pair| pair[1].at_ns - pair[0].at_ns).sum();
        if count > 0.0 {
            all as f64 / count
        } else {
            1e9 / RATE_HZ
        }
    }
}

pub(crate) struct Lockstep {
    pub(crate) recorded: Recorded,
    bench: Bench,
    reference: Encoder,
    motion: Motion,
    grip: Grip,
    lines: Lines,
    amplifiers: Amplifiers,
    edges: VecDeque<Edge>,
    /// Edges of the step being computed.
    fresh: Vec<Edge>,
    generator: Option<Generator>,
    /// Steps of the plant so far.
    steps: u64,
    end_ns: u64,
    currents: [f64; 2],
    faults: VecDeque<(u64, Fault)>,
    /// Start of the crystal, ns, and its frequency; `None` if it has run from the beginning.
    crystal: Option<(u64, u64)>,
    pub(crate) probe: DebugProbe,
    pub(crate) port: Port,
    /// The client of a run.
    pub(crate) live: Option<Live>,
    /// The hand that the client guides, instead of that of the setup.
    guided: Option<Guided>,
    /// Number of the ticks in `recorded` that the client has seen.
    shown: usize,
    /// The record of the run, if it is traced.
    pub(crate) trace: Option<Trace>,
    stack: Stack,
    pub(crate) accesses: CoreAccesses,
    entry: u64,
    exits: Vec<u64>,
    wait: u64,
    for_ever: u64,
    panic: u64,
    /// Whether the processor waits for an interrupt, or is about to.
    asleep: bool,
    /// The call of the control task that is running, and the instruction count at its start.
    running: Option<(ControlTick, u64)>,
    follow: Follow,
    stalls: Stalls,
    /// Virtual time that an instruction takes, ns.
    instruction_ns: f64,
    dac_errors: [DacError; 2],
    dac_load_ohm: [f64; 2],
    monitors: [Monitor; 2],
    /// Voltage of the amplifiers' supply, V.
    supply_v: f64,
    /// Whether the pins of both current monitors and of the supply are analogue.
    analog: [bool; 3],
    resets: usize,
    progress: Box<dyn FnMut(f64) + Send>,
}

impl Lockstep {
    pub(crate) fn new(image: &Image, setup: &Setup, progress: Box<dyn FnMut(f64) + Send>) -> Self {
        let bench = Bench::new(
            &setup.device,
            setup.hand,
            FeedbackEncoder::Own,
            HAND_HZ,
            setup.seed,
            STEP_S,
        );
        let reference = Encoder::new(
            setup.device.reference.counts_per_rev,
            0,
            0.3,
            bench.plant.large().angle,
            DiscErrors::none(),
        );
        let mut counts = [&bench.large, &bench.small, &reference].map(Encoder::count);
        if setup.generator_hz.is_some() {
            counts[LARGE] = 0;
        }
        let stages = &setup.device.stages;
        let turns = [&stages.large, &stages.small].map(|motor| motor.counts_per_rev);
        Self {
            recorded: Recorded::default(),
            lines: Lines::at(counts, turns),
            amplifiers: Amplifiers::new(&setup.faults),
            bench,
            reference,
            motion: setup.hand.motion(1.0 / HAND_HZ, setup.seed),
            grip: Grip::Free,
            edges: VecDeque::new(),
            fresh: Vec::new(),
            generator: setup.generator_hz.map(Generator::new),
            steps: 0,
            end_ns: (setup.seconds * 1e9) as u64,
            currents: [0.0; 2],
            faults: schedule(setup.faults.iter().copied()),
            crystal: (setup.crystal_from_s > 0.0)
                .then_some(((setup.crystal_from_s * 1e9) as u64, setup.crystal_hz)),
            probe: DebugProbe::new(image.rtt, setup),
            port: Port::new(setup),
            live: None,
            guided: None,
            shown: 0,
            trace: setup.trace.then(|| Trace::new(image)),
            stack: Stack(image.stack),
            accesses: CoreAccesses::new(&setup.accesses, Stack(image.stack)),
            entry: image.entry,
            exits: image.exits.clone(),
            wait: image.wait,
            for_ever: image.for_ever,
            panic: image.panic,
            asleep: false,
            running: None,
            follow: Follow::new(image, setup),
            stalls: Stalls::default(),
            instruction_ns: 1e9 / setup.instructions_per_second.get() as f64,
            dac_errors: setup.dac_errors,
            dac_load_ohm: setup.dac_load_ohm,
            monitors: [0, 1].map(|n| Monitor {
                offset: setup.monitor_offsets[n],
                amps: MONITOR_AMPS[n],
            }),
            supply_v: setup.supply_v,
            analog: [false; 3],
            resets: 0,
            progress,
        }
    }

    /// Sets the watchpoints of the control task.
    pub(crate) fn watch(&self, session: &mut Session<ControllerBoard>) {
        for &address in self.exits.iter().chain([&self.entry, &self.wait]) {
            session.watch(Watch::Instruction(address));
        }
        session.watch(flash::STORES);
        for watch in self.trace.iter().flat_map(Trace::watches) {
            session.watch(watch);
        }
    }

    /// Present time of the plant.
    fn plant_ns(&self) -> u64 {
        self.steps * STEP_NS
    }

    /// Time since the hand's tick began, s.
    fn since_tick(&self) -> f64 {
        (self.steps % STEPS_PER_TICK) as f64 * STEP_S
    }

    /// Serves the client of a run, and forgets what a run without a client records;
    /// whether the run goes on.
    fn serve(&mut self, now_ns: u64) -> bool {
        let Some(live) = &mut self.live else {
            return true;
        };
        let Recorded {
            ticks,
            plant_states,
            enables,
            ..
        } = &mut self.recorded;
        let (large, small) = self.bench.plant.currents();
        let seen = Seen {
            at_ns: now_ns,
            sent: &[],
            waiting: 0,
            ticks: &ticks[self.shown.min(ticks.len())..],
            restarts: self.resets,
            currents: [large, small],
            enables,
            hand: self.guided.as_ref().and_then(Guided::pose),
        };
        let mut acts = Acts::default();
        let goes_on = live.look(&mut self.port.wire(), seen, &mut acts);
        // The latest is compared with the next.
        ticks.drain(..ticks.len().saturating_sub(1));
        self.shown = ticks.len();
        enables.drain(..enables.len().saturating_sub(1));
        plant_states.clear();
        self.probe.stream.clear();
        self.probe.link.clear();
        for fault in acts.faults.into_iter().rev() {
            self.faults.push_front((now_ns, fault));
        }
        if let Some(hold) = acts.hand {
            let handle = self.bench.plant.small();
            self.guided = Some(Guided::after(self.guided, hold, handle));
        }
        goes_on
    }

    /// Levels of the pins after a restart.
    fn restart(&mut self, board: &mut ControllerBoard, at: VirtualNanos) {
        self.amplifiers.restart(&mut board.part, at);
        self.lines.restart();
        self.running = None;
        self.asleep = false;
        self.stalls = Stalls::default();
    }

    /// After an access, a hit of a watchpoint or a stop.
    fn settled(
        &mut self,
        session: &mut Session<ControllerBoard>,
        host: &mut dyn Host,
        settled: Settled,
    ) {
        match settled {
            Settled::Access { access, value } => {
                if (access.kind, access.address) == (AccessKind::Write, flash::CONTROL) {
                    Self::erase_flash(session, host);
                }
                if let (AccessKind::Read, STAMP_CLOCK, Some((tick, _))) =
                    (access.kind, access.address, &mut self.running)
                {
                    tick.stamp_clock_read_ns = Some(access.virtual_time.0);
                }
                let counter = COUNTERS.iter().position(|at| *at == access.address);
                if let (AccessKind::Read, Some(encoder)) = (access.kind, counter) {
                    if encoder == LARGE {
                        self.lengthen(access.virtual_time, host);
                    }
                    let value = Some(value as u16);
                    match &mut self.running {
                        Some((tick, _)) => tick.counts[encoder] = value,
                        None if self.recorded.ticks.is_empty() => {
                            self.recorded.first_counts[encoder] = value;
                        }
                        None => {}
                    }
                }
            }
            Settled::Hit(hit) if hit.kind == HitKind::Write => {
                self.store_to_flash(session, host, &hit);
            }
            Settled::Hit(hit) => {
                if hit.address == self.entry {
                    self.hang(hit.at, host);
                    if self.asleep {
                        self.accesses.wake(hit.at.0, self.wait + 2, host);
                    }
                }
                self.hit(session, host, &hit);
            }
            Settled::Stop(stop) if session.resets().len() > self.resets => {
                self.resets = session.resets().len();
                host.hold(false);
                self.restart(session.board_mut(), stop.at);
            }
            _ => {}
        }
    }

    /// At the instant that the run was to reach: the next one, or `None` at the end of the run.
    fn stopped(
        &mut self,
        session: &mut Session<ControllerBoard>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        if self.steps == 0 {
            self.port.attach(&mut session.board_mut().part);
            self.restart(session.board_mut(), stop.at);
            self.stack.paint(host);
            let sectors = session.board().part.flash.sectors();
            flash::place(sectors, 0..sectors.bytes().len(), host);
        }
        let now_ns = stop.at.0;
        self.release(session, stop.at, host);
        let mut stopped = false;
        loop {
            let board = session.board_mut();
            while let Some(edge) = self.edges.front().copied().filter(|e| e.at_ns <= now_ns) {
                self.edges.pop_front();
                let reached = (edge.encoder, edge.count);
                self.lines.reach(&mut board.part, stop.at, reached);
            }
            if self.plant_ns() > now_ns {
                break;
            }
            self.port.look(&mut board.part, now_ns);
            if self.steps.is_multiple_of(STEPS_PER_LOOK) {
                self.probe.poll(now_ns, host);
                self.hold_watchdog(&mut board.part, stop.at);
                self.lines.connect(&mut board.part, stop.at);
                let ([large, small], [supply]) = (pins::MONITORS, pins::SUPPLY);
                self.analog =
                    [large, small, supply].map(|wire| pins::wired(&mut board.part, &[wire]));
                (self.progress)(now_ns as f64 * 1e-9);
                stopped = !self.serve(now_ns);
            }
            if stopped || now_ns >= self.end_ns {
                self.recorded.stack = self.stack.used(host);
                return None;
            }
            if let Some((_, hz)) = self.crystal.take_if(|(from_ns, _)| *from_ns <= now_ns) {
                session.board_mut().part.start_crystal(hz);
            }
            while let Some((_, fault)) = self.faults.front().copied().filter(|f| f.0 <= now_ns) {
                self.faults.pop_front();
                self.fail(fault, session, stop, host);
            }
            self.step(session.board_mut(), stop.at);
        }
        let next_edge = self.edges.front().map_or(u64::MAX, |edge| edge.at_ns);
        let next = next_edge.min(self.plant_ns()).min(self.stalls.next());
        Some(VirtualNanos(next))
    }
}
