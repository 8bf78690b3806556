//! Simulation of the controller of `haptic-control` in closed loop with the plant.

mod bench;
mod conditions;
mod fault;
mod hand;
mod oracle;
mod possible;
mod press;
mod protection;
mod rate;
mod record;
mod scene;
mod tracking;
mod truth;

use estimator_core::{Amps, Count, Hertz, Sample, VelocityEstimator};
use haptic_control::{
    Action, AnyScene, Controller, Currents, DualStage, LoopPoles, Need, NewtonMetres, Rig, Scene,
    Senses, Stop,
};

use catalogue::estimators::{Estimator, Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use oracle::{Foresight, Present};
use protection::Protection;
use simulation::device::Device;
use simulation::plant::{HandleTorques, Pose, steps_per_tick};
use truth::{TrueMotion, Truth};

pub use bench::Bench;
pub use conditions::{Conditions, Dac, Exact};
use fault::OngoingFault;
pub use fault::{EncoderFault, Faulty};
pub use hand::{Hand, Motion};
pub use oracle::Oracle;
pub use possible::{check_handle, check_stamps};
pub use press::Press;
pub use rate::{LOWEST_RATE_HZ, loop_ticks};
use scene::Visit;
pub use scene::{environments_with, named, usual};

/// Encoder of the large motor that closes the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedbackEncoder {
    /// The device's own encoder.
    Own,
    /// The reference encoder, as in the paper.
    Reference,
}

/// One closed-loop run.
#[derive(Clone)]
pub struct Loop {
    /// The simulated device.
    pub device: Device,
    /// The device constants that the controller uses.
    pub assumed: DualStage,
    /// Scene with its parameters.
    pub scene: AnyScene,
    /// The simulated hand.
    pub hand: Hand,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Seed of the hand's motion, the encoders' phases and the disc.
    pub seed: u64,
    /// Estimator of the large motor's velocity.
    pub large: Estimator,
    /// Estimator of the handle's velocity.
    pub handle: Estimator,
    /// Encoder that `large` reads.
    pub encoder: FeedbackEncoder,
    /// Poles of the velocity loop.
    pub poles: LoopPoles,
    /// Delay of the currents in ticks, in addition to the amplifier's lag.
    pub late_ticks: usize,
    /// Errors of the amplifiers' zeros: currents of the large and of the small motor at a command of zero, A.
    pub offsets_a: [f64; 2],
}

/// State of the simulation at a tick, with the true values.
#[derive(Clone, Copy, Debug)]
pub struct TickState {
    /// Time, s.
    pub t: f64,
    /// True angle and velocity of the large motor.
    pub large: Pose,
    /// True angle and velocity of the handle.
    pub handle: Pose,
    /// Acceleration of the handle over the last tick, rad/s².
    pub handle_acceleration: f64,
    /// Torque of the handle on the hand, N.m.
    pub felt: f64,
    /// Torques on the handle's shaft, whose sum is `felt`.
    pub torques: HandleTorques,
    /// Input of the controller.
    pub sample: Sample,
    /// Count of the device's own large encoder, whichever encoder closes the loop.
    pub own_count: Count,
    /// Output of the controller.
    pub action: Action,
    /// Currents after the monitor, large then small motor, A; zero after a stop.
    pub commanded: (f64, f64),
    /// Parasitic torque that the oracle expects at the next tick, N.m, if one commands the small motor.
    pub expected: Option<f64>,
    /// Current that the small motor's amplifier was commanded until this tick, and from it on, A.
    pub small_amplifier: [f64; 2],
    /// Reason for which the monitor stopped the device, if it did.
    pub stopped: Option<Stop>,
}

impl Loop {
    /// Runs for `ticks` and calls `observe` at each tick.
    ///
    /// # Errors
    /// One line on an invalid device or a loop that cannot be designed.
    pub fn run(&self, ticks: usize, observe: impl FnMut(&TickState)) -> Result<(), String> {
        self.run_under(ticks, Conditions::default(), observe)
    }

    /// Runs for `ticks` under these conditions.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_under(
        &self,
        ticks: usize,
        conditions: Conditions<'_>,
        mut observe: impl FnMut(&TickState),
    ) -> Result<(), String> {
        self.device.validate()?;
        self.hand.check(&self.device)?;
        let rate = Hertz(self.rate_hz);
        let mut rig = Rig::new(&self.assumed, rate, self.poles)
            .map_err(|error| format!("control at {} Hz: {error}", rate.0))?;
        if self.encoder == FeedbackEncoder::Reference {
            rig.large_scale =
                estimator_core::Scale::new(self.device.reference.counts_per_rev, rate)
                    .map_err(|error| format!("reference encoder: {error}"))?;
        }
        let scene = self.scene.kind();
        if scene.facts().needs.acceleration && !self.handle.gives_acceleration() {
            let names = Kind::all().iter().filter(|kind| kind.gives_acceleration());
            let names: Vec<_> = names.map(|kind| kind.name).collect();
            return Err(format!(
                "scene {}: the handle's estimator provides no acceleration; choose one of {}",
                scene,
                names.join(", ")
            ));
        }
        let visit = Running {
            run: self,
            rig: &rig,
            ticks,
            conditions,
            observe: &mut observe,
        };
        scene::visit(&self.scene, visit);
        Ok(())
    }
}

/// A prepared run; generic over the type of the scene.
struct Running<'a> {
    run: &'a Loop,
    rig: &'a Rig,
    ticks: usize,
    conditions: Conditions<'a>,
    // Of one type: the loops of all scenes are compiled once, and not for every observer.
    observe: &'a mut dyn FnMut(&TickState),
}

impl Visit for Running<'_> {
    fn visit<S>(self, scene: S)
    where
        S: Scene<Acceleration: Senses<Estimator> + for<'a> Senses<TrueMotion<'a>>> + Clone,
    {
        let truth = [Truth::default(), Truth::default()];
        let exact = truth.each_ref().map(TrueMotion);
        let (large, handle) = (self.run.large.clone(), self.run.handle.clone());
        let [exact_large, exact_handle] = exact;
        match self.conditions.exact {
            Exact::Neither => self.close(scene, large, handle, &truth),
            Exact::Large => self.close(scene, exact_large, handle, &truth),
            Exact::Both => self.close(scene, exact_large, exact_handle, &truth),
        }
    }
}

impl Running<'_> {
    /// Runs with the estimators `large` and `handle`; `truth` gets the true motion of the large motor and of
    /// the handle before each tick.
    fn close<S, L, H>(self, scene: S, large: L, handle: H, truth: &[Truth; 2])
    where
        S: Scene<Acceleration: Senses<H>> + Clone,
        L: VelocityEstimator,
        H: VelocityEstimator,
    {
        let Loop {
            device,
            assumed,
            rate_hz,
            ..
        } = self.run;
        let Conditions {
            fault, dac, oracle, ..
        } = self.conditions;
        let scales = [self.rig.large_scale, self.rig.handle_scale];
        let per_count = scales.map(|scale| f64::from(scale.rad_per_s_per_count_per_tick));
        let period = 1.0 / rate_hz;
        let steps = steps_per_tick(period);
        let step = period / f64::from(steps);
        let run = self.run;
        let mut bench = Bench::new(device, run.hand, run.encoder, *rate_hz, run.seed, step);
        let oracle = oracle.filter(|_| S::Transient::WANTED);
        let start = (bench.plant.small().angle, period, steps);
        let foresight = |oracle| Foresight::new(oracle, scene.clone(), device, self.rig, start);
        let mut foresight = oracle.map(foresight);
        let controller = Controller::new(scene, large, handle, self.rig);
        let mut monitored = *assumed;
        if run.encoder == FeedbackEncoder::Reference {
            monitored.large.counts_per_rev = device.reference.counts_per_rev;
        }
        let mut sample = bench.sample(Amps::ZERO);
        let mut state = controller.start(&sample);
        let mut protection = Protection::start(&monitored, Hertz(*rate_hz), &sample);
        let mut pending = vec![(0.0, 0.0); self.run.late_ticks];
        let mut last_omega = bench.plant.small().omega;
        let mut hand = self.run.hand.motion(period, self.run.seed);
        let known = (self.conditions.grips).filter(|grips| grips.len() >= self.ticks);
        let mut fault = fault.map(|(from, faulty)| OngoingFault::new(from, faulty));
        for k in 0..self.ticks {
            if let Some(fault) = &mut fault {
                fault.distort(k, &mut sample);
            }
            let grip = match known {
                Some(grips) => grips[k],
                None => hand.grip(k as u64),
            };
            let torques = bench.plant.handle_torques(&grip, 0.0);
            let omega = bench.plant.small().omega;
            // The controller uses no acceleration of the large motor.
            truth[0].set(bench.plant.large().omega, 0.0, per_count[0], period);
            let acceleration = -torques.inertia / device.stages.small.inertia;
            truth[1].set(omega, acceleration, per_count[1], period);
            let mut action = controller.step(&mut state, &sample);
            let stopped = protection.check(&sample);
            let present = |large_a| Present {
                plant: &bench.plant,
                grip: &grip,
                large_a,
            };
            if let Some(foresight) = &mut foresight {
                let torque = foresight.wanted(bench.plant.small(), &torques);
                action.torque = NewtonMetres(torque as f32);
                let (large_a, _) = applied(dac.as_ref(), &action.currents);
                action.currents.small = foresight.current(present(large_a));
            }
            let wanted = match stopped {
                None => action.currents,
                Some(_) => Currents::default(),
            };
            let commanded = applied(None, &wanted);
            pending.push(applied(dac.as_ref(), &wanted));
            let (large_a, small_a) = pending.remove(0);
            // A disabled amplifier has no current, whatever its zero.
            let [large_zero, small_zero] = match stopped {
                None => self.run.offsets_a,
                Some(_) => [0.0; 2],
            };
            let expected = (foresight.as_ref())
                .map(|foresight| foresight.parasitic(present(large_a), small_a));
            let (_, small_before) = bench.plant.commands();
            bench
                .plant
                .command(large_a + large_zero, small_a + small_zero);
            (self.observe)(&TickState {
                t: k as f64 * period,
                large: bench.plant.large(),
                handle: bench.plant.small(),
                handle_acceleration: (omega - last_omega) * rate_hz,
                felt: torques.felt,
                torques,
                sample,
                own_count: Count(bench.own.as_ref().unwrap_or(&bench.large).count()),
                action,
                commanded,
                expected,
                small_amplifier: [small_before, bench.plant.commands().1],
                stopped,
            });
            last_omega = omega;
            for j in 0..steps {
                bench.step(&grip, f64::from(j) * step, step, &mut (), &mut ());
            }
            sample = bench.sample(wanted.large);
        }
    }
}

/// Currents that the amplifiers are commanded, large then small, A.
fn applied(dac: Option<&Dac>, currents: &Currents) -> (f64, f64) {
    match dac {
        Some(dac) => dac.currents(currents),
        None => (
            f64::from(currents.large.get()),
            f64::from(currents.small.get()),
        ),
    }
}

/// The estimator `kind` with its tuned parameters, for an encoder of `counts_per_rev`.
///
/// # Errors
/// As [`Kind::build`].
pub fn estimator(
    kind: &Kind,
    device: &Device,
    counts_per_rev: u32,
    rate_hz: f64,
    parameters: &Parameters,
) -> Result<Estimator, terminal::failure::Failure> {
    let mut setup: Setup = Setup::of(device, rate_hz);
    setup.stages.large.counts_per_rev = counts_per_rev;
    let values = parameters.values(kind, &setup, PlantKind::Friction);
    kind.build(&setup, &values)
}

#[cfg(test)]
mod tests;
