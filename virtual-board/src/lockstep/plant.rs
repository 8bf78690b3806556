//! The plant's steps.

use rigless::time::VirtualNanos;

use super::{Lockstep, STEP_NS, STEP_S, STEPS_PER_TICK};
use crate::board::ControllerBoard;
use crate::quadrature::{Edge, Edges, LARGE, REFERENCE, SMALL};
use crate::run::{AMPS_PER_CODE, DacError, PlantState, SUPPLY_FULL_SCALE_V};

impl Lockstep {
    /// One step of the plant with the present commands of the amplifiers.
    pub(super) fn step(&mut self, board: &mut ControllerBoard, at: VirtualNanos) {
        let outputs = self.amplifiers.follow(&mut board.part, at);
        let enabled = outputs.enables;
        if self
            .recorded
            .enables
            .last()
            .is_none_or(|(_, last)| *last != enabled)
        {
            self.recorded.enables.push((self.plant_ns(), enabled));
        }
        let levels = board.part.dac_levels(self.dac_load_ohm);
        for n in [LARGE, SMALL] {
            // A floating pin is assumed at mid-scale.
            let DacError { offset, gain } = self.dac_errors[n];
            let steps = levels[n].map_or(0.0, |level| level - 2048.0 + offset);
            self.currents[n] = if outputs.drives[n] {
                steps * gain * AMPS_PER_CODE[n]
            } else {
                0.0
            };
        }
        // A monitor shows the current of the amplifier, whatever the leads of the motor.
        let sides = self
            .amplifiers
            .each
            .map(|one| if one.reversed { -1.0 } else { 1.0 });
        let (large, small) = self.bench.plant.currents();
        let levels = self
            .amplifiers
            .monitors([large * sides[LARGE], small * sides[SMALL]], self.monitors);
        let levels = [levels[LARGE], levels[SMALL], supply_code(self.supply_v)];
        let analog = self.analog;
        board
            .part
            .drive_analog([0, 1, 2].map(|n| analog[n].then_some(levels[n])));
        self.bench.plant.command(
            self.currents[LARGE] * sides[LARGE],
            self.currents[SMALL] * sides[SMALL],
        );
        if self.steps.is_multiple_of(STEPS_PER_TICK) {
            self.grip = match &mut self.guided {
                Some(guided) => guided.grip(),
                None => self.motion.grip(self.steps / STEPS_PER_TICK),
            };
            self.recorded.plant_states.push(PlantState {
                felt: self.bench.plant.handle_torque(&self.grip, 0.0),
                currents: self.currents,
                large_omega: self.bench.plant.large().omega,
            });
        }
        self.turn();
        self.steps += 1;
    }

    /// Advances shafts and encoders by one step.
    fn turn(&mut self) {
        fn observer(
            into: &mut Vec<Edge>,
            (encoder, count): (usize, u32),
            from_ns: u64,
        ) -> Edges<'_> {
            Edges {
                into,
                encoder,
                count,
                from_ns,
                step_ns: STEP_NS as f64,
            }
        }
        let (from_ns, since) = (self.plant_ns(), self.since_tick());
        let (mut fresh, mut of_small) = (std::mem::take(&mut self.fresh), Vec::new());
        let (large, small) = (self.bench.large.count(), self.bench.small.count());
        let before = self.bench.plant.large();
        self.bench.step(
            &self.grip,
            since,
            STEP_S,
            &mut observer(&mut fresh, (LARGE, large), from_ns),
            &mut observer(&mut of_small, (SMALL, small), from_ns),
        );
        if let Some(generator) = &mut self.generator {
            fresh.retain(|edge| edge.encoder != LARGE);
            generator.run(from_ns + STEP_NS, &mut fresh);
        }
        fresh.append(&mut of_small);
        let (after, count) = (self.bench.plant.large(), self.reference.count());
        if self.lines.reads_reference() {
            let mut edges = observer(&mut fresh, (REFERENCE, count), from_ns);
            self.reference.follow(before, after, STEP_S, &mut edges);
        } else {
            self.reference.follow(before, after, STEP_S, &mut ());
            self.lines.pass(self.reference.count());
        }
        fresh.sort_by_key(|edge| edge.at_ns);
        self.edges.extend(fresh.drain(..));
        self.fresh = fresh;
    }
}

/// Level at the divider of a supply of this voltage, codes.
fn supply_code(volts: f64) -> f64 {
    volts / SUPPLY_FULL_SCALE_V * 4096.0
}
