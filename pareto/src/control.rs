//! The control task as a whole, in the flash image: its budget in every scene, with each estimator
//! that the firmware offers for the large motor.

pub mod plot;
pub mod table;

use haptic_control::SceneKind;
use measured::control_rate::{IMAGES, NONE, STEADY};
use rayon::prelude::*;
use serde::Serialize;
use virtual_board::budget::{self, Budget, highest_rate_hz};
use virtual_board::image::Image;
use virtual_board::run::Setup;

use crate::measure::Row;

/// Virtual time in each scene, s.
const SECONDS: f64 = 1.0;

/// The control task in a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Task {
    /// Name of the scene.
    pub scene: String,
    /// Estimator on the large motor; [`NONE`] if the scene needs none.
    pub estimator: &'static str,
    /// Instructions: mean and largest number.
    pub instructions: (f64, u64),
    /// Estimated cycles: mean and largest number.
    pub cycles: (f64, u32),
}

impl Task {
    fn new(scene: SceneKind, estimator: &'static str, budget: &Budget) -> Self {
        Self {
            scene: scene.to_string(),
            estimator,
            instructions: (budget.instructions.mean, budget.instructions.max),
            cycles: (budget.cycles_mean, budget.cycles_most),
        }
    }

    /// Highest control rates at half load, Hz: by instructions at one cycle each and by cycles,
    /// both in the mean and at most.
    #[must_use]
    pub fn highest_rates_hz(&self) -> [f64; 4] {
        let (mean, most) = self.instructions;
        let (cycles_mean, cycles_most) = self.cycles;
        [mean, most as f64, cycles_mean, f64::from(cycles_most)].map(highest_rate_hz)
    }
}

/// Measures every scene of every image.
///
/// # Errors
/// One line if an image does not build or run.
pub fn measure() -> Result<Vec<Task>, String> {
    let images: Result<Vec<_>, String> = IMAGES
        .iter()
        .map(|(estimator, features)| Ok((*estimator, Image::build(features)?)))
        .collect();
    let images = images?;
    let mut jobs = Vec::new();
    for scene in SceneKind::ALL {
        if scene.facts().needs.continuous {
            jobs.extend(images.iter().map(|(name, image)| (scene, *name, image)));
        } else {
            jobs.push((scene, NONE, &images[0].1));
        }
    }
    let task = |(scene, estimator, image): (SceneKind, &'static str, &Image)| {
        let budget = budget::measure(image, &Setup::playing(scene, SECONDS))
            .map_err(|error| format!("{scene} with {estimator}: {error}"))?;
        Ok(Task::new(scene, estimator, &budget))
    };
    jobs.into_par_iter().map(task).collect()
}

/// Estimates the highest control rate with each estimator on the large motor: the longest task of the
/// image with the steady Kalman filter, with its update replaced by the longest one of the estimator.
pub fn rate(rows: &mut [Row], tasks: &[Task]) {
    let steady = tasks.iter().filter(|task| task.estimator == STEADY);
    let longest = steady.map(|task| task.cycles.1).max();
    let own = rows.iter().find(|row| row.name == STEADY);
    let (Some(longest), Some(own)) = (longest, own.map(Row::cycles_most)) else {
        return;
    };
    let rest = f64::from(longest) - own;
    for row in rows {
        row.highest_rate_hz = highest_rate_hz(rest + row.cycles_most());
    }
}
