//! Simulated recordings: a scenario in open loop, or a scene in closed loop.

use std::f64::consts::TAU;

use haptic_control::{Excite, LoopPoles, SceneKind};

use crate::closed_loop::{FeedbackEncoder, Hand, Loop, estimator, loop_ticks, named, usual};
use crate::transparency::compare::DEFAULT_ESTIMATOR;
use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use recordings::recording::Recording;
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate::simulate;
use simulation::trace::Columns;
use terminal::failure::Failure;

/// Default duration of a scene, s: a little longer than the excitation.
const EXCITE_S: f64 = 16.0;
/// Time before the end of scene excite, or of a run, from which a current is certain, s.
const PAUSE_S: f64 = 0.2;

/// What a recording of a scenario or of a scene is made from.
#[derive(Clone, Debug)]
pub struct Run {
    /// The simulated device.
    pub device: Device,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Duration, s; `None` for that of the scenario, or 16 s of a scene.
    pub seconds: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Run {
    /// The scenario called `name`, with all columns that a recording can have.
    ///
    /// # Errors
    /// [`Failure::Input`] that names an unknown scenario, or a rate or a duration out of range.
    pub fn scenario(&self, name: &str) -> Result<Recording, Failure> {
        let name: ScenarioName = name.parse()?;
        let seconds = self.seconds.unwrap_or_else(|| name.default_seconds());
        let columns = Columns {
            counts_small: true,
            edges: true,
        };
        let trace = simulate(
            &self.device,
            name,
            self.rate_hz,
            self.seed,
            seconds,
            columns,
        )?;
        Ok(Recording {
            t: (0..trace.len()).map(|k| k as f64 / self.rate_hz).collect(),
            trace,
            ..Recording::default()
        })
    }

    /// Every tick of number `every` of the scene called `name` [default: excite], with the load `hand` on
    /// the handle. The recording has a note where scene excite ended early or did not move the motor.
    ///
    /// # Errors
    /// [`Failure::Input`] that names an unknown scene, or a rate or a duration out of range.
    pub fn scene(
        &self,
        name: Option<&str>,
        hand: Hand,
        every: usize,
    ) -> Result<Recording, Failure> {
        let device = self.device.clone();
        let scene = match name {
            None => SceneKind::Excite,
            // Scenes that need commands of the host are not offered.
            Some(name) => named(
                name,
                [SceneKind::Excite]
                    .into_iter()
                    .chain(SceneKind::environments()),
            )?,
        };
        let is_free = matches!(hand, Hand::Gone(_));
        let ticks = loop_ticks(self.rate_hz, self.seconds.unwrap_or(EXCITE_S))?;
        let parameters = Parameters::default();
        let estimator = |counts_per_rev| {
            let kind = Kind::named(DEFAULT_ESTIMATOR)?;
            estimator(kind, &device, counts_per_rev, self.rate_hz, &parameters)
        };
        let assumed = device.stages;
        let run = Loop {
            assumed,
            scene: usual(scene, &assumed, self.rate_hz)?,
            hand,
            rate_hz: self.rate_hz,
            seed: self.seed,
            large: estimator(device.stages.large.counts_per_rev)?,
            handle: estimator(device.stages.small.counts_per_rev)?,
            encoder: FeedbackEncoder::Own,
            poles: LoopPoles::DEFAULT,
            late_ticks: 0,
            offsets_a: [0.0; 2],
            device,
        };
        let mut recording = run.record(ticks, every)?;
        if scene == SceneKind::Excite {
            let ended = (!is_free).then(|| self.ended(&recording)).flatten();
            recording
                .notes
                .extend(ended.or_else(|| self.at_rest(&recording)));
        }
        Ok(recording)
    }

    /// What ended the excitation before its pattern or the run did.
    fn ended(&self, recording: &Recording) -> Option<String> {
        let columns = [&recording.trace.current, &recording.current_small];
        let flows = |k: &usize| {
            columns
                .iter()
                .any(|c| c.as_ref().is_some_and(|c| c[*k] != 0.0))
        };
        let last = (0..recording.t.len()).rev().find(flows);
        let last_s = last.map_or(0.0, |k| recording.t[k]);
        let end_s = self.seconds.unwrap_or(EXCITE_S).min(EXCITE_S);
        if last_s > end_s - PAUSE_S {
            return None;
        }
        let counts = self.device.stages.small.counts_per_rev;
        let (angle, step) = (Excite::LARGEST_ANGLE.0, Excite::LARGEST_STEP.0);
        let fewest = TAU / f64::from(step);
        let why = match f64::from(counts) < fewest {
            true => format!(
                "a count of small.counts_per_rev = {counts} is more than that: give --hand clamp, or an encoder \
                 of {:.0} counts or more",
                fewest.ceil()
            ),
            false => "hold the handle, with --hand still or --hand clamp".to_owned(),
        };
        Some(format!(
            "scene excite ended after {last_s:.2} s, because the handle moved by more than {step} rad in \
             a millisecond or {angle} rad in all; {why}"
        ))
    }

    /// Why the motor does not move by a count.
    fn at_rest(&self, recording: &Recording) -> Option<String> {
        let moves = recording
            .trace
            .counts_large
            .windows(2)
            .any(|pair| pair[0] != pair[1]);
        if moves {
            return None;
        }
        let current = recording.trace.current.as_deref().unwrap_or_default();
        let largest = current.iter().fold(0.0_f64, |most, i| most.max(i.abs()));
        let stages = &self.device.stages;
        Some(format!(
            "the large motor does not move: scene excite has {largest:.3} A at most, {:.2e} N.m, and \
             large.coulomb_nm is {:.2e}; its current is lower where 0.9 A would drive the motor beyond 60 rad/s \
             against coupler.damping_nms_per_rad = {:.2e}, or beyond large.current_limit_a: check these keys, or \
             record another motion that speeds up, slows down and reverses",
            largest * stages.large.torque_constant,
            stages.large.coulomb_friction,
            stages.damping
        ))
    }
}
