//! Simulated recordings: a scenario in open loop, or a scene in closed loop.

use haptic_control::{LoopPoles, SceneKind};

use crate::closed_loop::{FeedbackEncoder, Hand, Loop, estimator, loop_ticks, named, usual};
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
            current_small: None,
            uneven_steps: 0,
            notes: Vec::new(),
        })
    }

    /// Every tick of number `every` of the scene called `name` [default: excite], with the load `hand` on
    /// the handle.
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
        let ticks = loop_ticks(self.rate_hz, self.seconds.unwrap_or(EXCITE_S))?;
        let parameters = Parameters::default();
        let estimator = |counts_per_rev| {
            let kind = Kind::named("kalman-triple-steady")?;
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
        Ok(run.record(ticks, every)?)
    }
}
