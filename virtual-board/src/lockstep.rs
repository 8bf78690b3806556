//! Board and plant in lockstep: the plant runs one step of 10 us ahead of the processor, and its
//! edges reach the pins at their instants.

use std::collections::VecDeque;

use host_sim::closed_loop::{Bench, Eye, Motion};
use host_sim::plant::Grip;
use rigless::emulator::{AccessKind, Driver, Hit, Host, Settled, Stop, Watch};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use crate::board::ControllerBoard;
use crate::fault::Fault;
use crate::image::Image;
use crate::lines::Lines;
use crate::pins;
use crate::probe::{Probe, schedule};
use crate::quadrature::{Edge, Edges, Generator, LARGE, SMALL};
use crate::run::{AMPS_PER_CODE, Moment, RATE_HZ, Setup, Tick};

const STEP_NS: u64 = 10_000;
const STEP_S: f64 = 10e-6;
/// Steps of the plant in a tick of the hand, and between two looks of the probe.
const STEPS_PER_TICK: u64 = 10;
const STEPS_PER_LOOK: u64 = 100;

/// Counters of TIM4 (large) and TIM3 (small).
const COUNTERS: [u64; 2] = [0x4000_0824, 0x4000_0424];
/// Control register of the control tick's timer, TIM5.
const TICK_CONTROL: u64 = 0x4000_0C00;

/// What a run has shown.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    pub(crate) ticks: Vec<Tick>,
    pub(crate) first_counts: [Option<u16>; 2],
    pub(crate) moments: Vec<Moment>,
    pub(crate) enables: Vec<(u64, [bool; 2])>,
    pub(crate) complaints: Vec<String>,
    pub(crate) unclosed: u32,
}

pub(crate) struct Lockstep {
    pub(crate) seen: Seen,
    bench: Bench,
    motion: Motion,
    grip: Grip,
    lines: Lines,
    edges: VecDeque<Edge>,
    /// Edges of the step being computed.
    fresh: Vec<Edge>,
    generator: Option<Generator>,
    /// Steps of the plant so far.
    steps: u64,
    end_ns: u64,
    currents: [f64; 2],
    faults: VecDeque<(u64, Fault)>,
    pub(crate) probe: Probe,
    entry: u64,
    exits: Vec<u64>,
    /// The call of the control task that is running, and the instruction count at its start.
    running: Option<(Tick, u64)>,
    resets: usize,
    progress: Box<dyn FnMut(f64) + Send>,
}

impl Lockstep {
    pub(crate) fn new(image: &Image, setup: &Setup, progress: Box<dyn FnMut(f64) + Send>) -> Self {
        let bench = Bench::new(
            &setup.device,
            setup.hand,
            Eye::Large,
            RATE_HZ,
            setup.seed,
            STEP_S,
        );
        Self {
            seen: Seen::default(),
            lines: Lines::at([
                setup.generator_hz.map_or(bench.large.count(), |_| 0),
                bench.small.count(),
            ]),
            bench,
            motion: setup.hand.motion(1.0 / RATE_HZ, setup.seed),
            grip: Grip::Free,
            edges: VecDeque::new(),
            fresh: Vec::new(),
            generator: setup.generator_hz.map(Generator::new),
            steps: 0,
            end_ns: (setup.seconds * 1e9) as u64,
            currents: [0.0; 2],
            faults: schedule(setup.faults.iter().copied()),
            probe: Probe::new(image.rtt, setup),
            entry: image.entry,
            exits: image.exits.clone(),
            running: None,
            resets: 0,
            progress,
        }
    }

    /// Asks to be told about the control task.
    pub(crate) fn watch(&self, session: &mut Session<ControllerBoard>) {
        for &address in self.exits.iter().chain([&self.entry]) {
            session.watch(Watch::Instruction(address));
        }
    }

    /// The instant that the plant has reached.
    fn plant_ns(&self) -> u64 {
        self.steps * STEP_NS
    }

    /// Time since the hand's tick began, s.
    fn since_tick(&self) -> f64 {
        (self.steps % STEPS_PER_TICK) as f64 * STEP_S
    }

    /// One step of the plant with what the amplifiers are told now.
    fn step(&mut self, board: &mut ControllerBoard) {
        let enabled = pins::enabled(&mut board.part);
        if self
            .seen
            .enables
            .last()
            .is_none_or(|(_, last)| *last != enabled)
        {
            self.seen.enables.push((self.plant_ns(), enabled));
        }
        let codes = board.part.dac_codes();
        for n in [LARGE, SMALL] {
            // A pin that floats reads as mid-scale.
            let code = codes[n].map_or(0.0, |code| f64::from(code) - 2048.0);
            self.currents[n] = if enabled[n] {
                code * AMPS_PER_CODE[n]
            } else {
                0.0
            };
        }
        self.bench
            .plant
            .command(self.currents[LARGE], self.currents[SMALL]);
        if self.steps.is_multiple_of(STEPS_PER_TICK) {
            self.grip = self.motion.grip(self.steps / STEPS_PER_TICK);
            self.seen.moments.push(Moment {
                felt: self.bench.plant.handle_torque(&self.grip, 0.0),
                currents: self.currents,
                large_omega: self.bench.plant.large().omega,
            });
        }
        let (from_ns, since) = (self.plant_ns(), self.since_tick());
        let (mut of_large, mut of_small) = (Vec::new(), Vec::new());
        std::mem::swap(&mut of_large, &mut self.fresh);
        let observer = |into, encoder, count| Edges {
            into,
            encoder,
            count,
            from_ns,
            step_ns: STEP_NS as f64,
        };
        let (large, small) = (self.bench.large.count(), self.bench.small.count());
        self.bench.step(
            &self.grip,
            since,
            STEP_S,
            &mut observer(&mut of_large, LARGE, large),
            &mut observer(&mut of_small, SMALL, small),
        );
        if let Some(generator) = &mut self.generator {
            of_large.clear();
            generator.run(from_ns + STEP_NS, &mut of_large);
        }
        of_large.append(&mut of_small);
        of_large.sort_by_key(|edge| edge.at_ns);
        self.edges.extend(of_large.drain(..));
        self.fresh = of_large;
        self.steps += 1;
    }

    /// What a restart leaves on the pins: the board's pull-downs, healthy amplifiers, no lines.
    fn restart(&mut self, board: &mut ControllerBoard, at: VirtualNanos) {
        for pin in pins::ENABLES {
            pins::drive(&mut board.part, at, pin, false);
        }
        for pin in pins::FAULTS {
            pins::drive(&mut board.part, at, pin, true);
        }
        self.lines.restart();
        self.running = None;
    }

    fn fail(
        &mut self,
        fault: Fault,
        session: &mut Session<ControllerBoard>,
        at: VirtualNanos,
        host: &mut dyn Host,
    ) {
        let part = &mut session.board_mut().part;
        let now = self.lines.now();
        match fault {
            Fault::StuckA => self.lines.stuck[0] = Some(now[0]),
            Fault::StuckB => self.lines.stuck[1] = Some(now[1]),
            Fault::StuckBoth => self.lines.stuck = now.map(Some),
            Fault::Swapped => self.lines.swapped = true,
            Fault::AmplifierFault => pins::drive(part, at, pins::FAULTS[0], false),
            Fault::HungCore => host.hold(true),
            Fault::HungControl => {
                // The timer is there: the write cannot be refused.
                let _ = part.write(at, TICK_CONTROL, Width::W32, 0);
            }
            Fault::BusError => session.fail_next(COUNTERS[LARGE], COUNTERS[LARGE] + 4),
            Fault::NobodyDrains => self.probe.drains = false,
            Fault::CrystalFails => part.stm32.drive_clocks(at, |rcc, registers, context| {
                rcc.fail_hse(registers, context);
            }),
        }
    }

    fn hit(&mut self, session: &mut Session<ControllerBoard>, hit: &Hit) {
        if hit.address == self.entry {
            if self.seen.ticks.is_empty() {
                self.seen.complaints = pins::complaints(&mut session.board_mut().part);
            }
            self.seen.unclosed += u32::from(self.running.is_some());
            let tick = Tick {
                at_ns: hit.at.0,
                instructions: 0,
                counts: [None; 2],
                codes: [None; 2],
                enabled: [false; 2],
                large: self.bench.plant.large(),
                handle: self.bench.plant.small(),
                felt: self
                    .bench
                    .plant
                    .handle_torque(&self.grip, self.since_tick()),
            };
            self.running = Some((tick, hit.instruction_count));
        } else if let Some((mut tick, start)) = self.running.take() {
            // The return itself is still to run.
            tick.instructions = (hit.instruction_count - start + 1) as u32;
            let part = &mut session.board_mut().part;
            tick.codes = part.dac_codes();
            tick.enabled = pins::enabled(part);
            self.seen.ticks.push(tick);
        }
    }
}

impl Driver<ControllerBoard> for Lockstep {
    fn on_settled(
        &mut self,
        session: &mut Session<ControllerBoard>,
        host: &mut dyn Host,
        settled: Settled,
    ) {
        match settled {
            Settled::Access { access, value } => {
                let counter = COUNTERS.iter().position(|at| *at == access.address);
                if let (AccessKind::Read, Some(encoder)) = (access.kind, counter) {
                    let value = Some(value as u16);
                    match &mut self.running {
                        Some((tick, _)) => tick.counts[encoder] = value,
                        None if self.seen.ticks.is_empty() => {
                            self.seen.first_counts[encoder] = value;
                        }
                        None => {}
                    }
                }
            }
            Settled::Hit(hit) => self.hit(session, &hit),
            Settled::Stop(stop) if session.resets().len() > self.resets => {
                self.resets = session.resets().len();
                host.hold(false);
                self.restart(session.board_mut(), stop.at);
            }
            _ => {}
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<ControllerBoard>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        if self.steps == 0 {
            self.restart(session.board_mut(), stop.at);
        }
        let now_ns = stop.at.0;
        loop {
            let board = session.board_mut();
            while let Some(edge) = self.edges.front().copied().filter(|e| e.at_ns <= now_ns) {
                self.edges.pop_front();
                self.lines.counts[edge.encoder] = edge.count;
                self.lines.drive(&mut board.part, stop.at, edge.encoder);
            }
            if self.plant_ns() > now_ns {
                break;
            }
            if self.steps.is_multiple_of(STEPS_PER_LOOK) {
                self.probe.look(now_ns, host);
                self.lines.look(&mut board.part, stop.at);
                (self.progress)(now_ns as f64 * 1e-9);
            }
            if now_ns >= self.end_ns {
                return None;
            }
            while let Some((_, fault)) = self.faults.front().copied().filter(|f| f.0 <= now_ns) {
                self.faults.pop_front();
                self.fail(fault, session, stop.at, host);
            }
            self.step(session.board_mut());
        }
        let next_edge = self.edges.front().map_or(u64::MAX, |edge| edge.at_ns);
        Some(VirtualNanos(next_edge.min(self.plant_ns())))
    }
}
