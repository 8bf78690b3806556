//! The instruction budget: what a control tick costs in every scene, of what a period has.

use std::fmt::Write as _;

use host_sim::closed_loop::{Hand, SceneName};

use crate::board::CORE_HZ;
use crate::command::Command;
use crate::image::Image;
use crate::run::{RATE_HZ, Setup, on_board};
use crate::score::Range;

/// Cycles of a control period, and as many instructions if each took one.
const PERIOD: f64 = CORE_HZ as f64 / RATE_HZ;

/// Mean and largest share of a period.
pub(crate) fn share(cost: Range) -> String {
    let [mean, most] = [cost.mean, cost.max as f64].map(|n| 100.0 * n / PERIOD);
    format!("{mean:.1} % in the mean, {most:.1} % at most, at one cycle an instruction")
}

/// A line a scene, each run for `seconds` by whoever plays with it.
///
/// # Errors
/// As [`on_board`].
pub(crate) fn table(image: &Image, seconds: f64, seed: u64) -> Result<String, String> {
    let mut text = format!(
        "{:<16}{:>8}{:>8}{:>8}  share of the period\n",
        "scene", "least", "mean", "most"
    );
    for scene in SceneName::ALL {
        let hand = match scene {
            SceneName::Wall(..) => Hand::Pushing,
            SceneName::Hold(..) => Hand::Still,
            _ => Hand::Moving,
        };
        let setup = Setup {
            hand,
            seed,
            seconds,
            commands: vec![(0.05, Command::Scene(scene)), (0.1, Command::Arm)],
            ..Setup::default()
        };
        let outcome = on_board(image, &setup, |_| ())?;
        let name = scene.as_str();
        // Writing to a string cannot fail.
        let _ = match outcome.instructions() {
            Some(cost) => {
                let Range { min, mean, max } = cost;
                let share = share(cost);
                writeln!(text, "{name:<16}{min:>8}{mean:>8.0}{max:>8}  {share}")
            }
            None => writeln!(
                text,
                "{name:<16}never enabled; give --seconds more than 0.1"
            ),
        };
    }
    Ok(text)
}
