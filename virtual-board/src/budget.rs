//! The budget of the control task: cost of a tick in a scene, and highest possible control rate.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use haptic_control::SceneKind;
use terminal::failure::Failure;

use crate::board::CORE_HZ;
use crate::fetch::Fetches;
use crate::image::Image;
use crate::run::{ControlTick, Outcome, Setup, on_board};
use crate::score::Range;

/// Share of the processor's cycles that the control task may use.
pub const LOAD: f64 = 0.5;

/// Time for boot, arming and settling, s: scores and costs are those of later ticks.
pub(crate) const SETTLED_S: f64 = 0.4;

/// Numbers of ticks whose cycles are estimated: the longest by instructions, and groups of
/// consecutive ticks spread over the run, each as long as the time between two telemetry frames.
const LONGEST: usize = 2;
const ROWS: usize = 2;
const ROW: usize = 10;

/// Time that a tick is followed for at most, s: after it nothing is looked at.
const AFTER_S: f64 = 0.01;

/// Cost of the control task in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Instructions, from the first of the handler to its return.
    pub instructions: Range,
    /// Estimated cycles, from the interrupt to the interrupted instruction: mean.
    pub cycles_mean: f64,
    /// Largest number of estimated cycles, over the ticks that were followed instruction by
    /// instruction. These ticks include the longest ones.
    pub cycles_most: u32,
    /// Of the ticks that were followed, the largest number of lines of flash, and of cycles in which the core
    /// waits for one. These cycles are not in the others.
    pub fetches_most: Fetches,
}

/// Control rate at which ticks of this many cycles use [`LOAD`] of the processor, Hz.
#[must_use]
pub fn highest_rate_hz(cycles: f64) -> f64 {
    LOAD * CORE_HZ as f64 / cycles
}

/// Ticks with both amplifiers enabled, after the first ones in a scene.
fn settled(outcome: &Outcome) -> impl Iterator<Item = (usize, &ControlTick)> {
    let late = |tick: &ControlTick| tick.at_ns as f64 * 1e-9 >= SETTLED_S;
    let ticks = outcome.ticks.iter().enumerate();
    ticks.filter(move |(_, tick)| late(tick) && tick.enabled == [true; 2])
}

/// Runs `setup` twice, the second time following the instructions of some ticks, until the last of them.
///
/// # Errors
/// As [`on_board`] and [`Outcome::check`]; one line if the amplifiers are never enabled long
/// enough, or a tick cannot be followed.
pub fn measure(image: &Image, setup: &Setup) -> Result<Budget, Failure> {
    let first = on_board(image, setup, |_| ())?;
    first.check()?;
    let ticks: Vec<_> = settled(&first).collect();
    let counts = ticks.iter().map(|(_, tick)| u64::from(tick.instructions));
    let instructions = Range::of(counts).ok_or_else(|| {
        format!("the amplifiers are not enabled after {SETTLED_S} s; give a longer --seconds")
    })?;
    let every = ticks.chunks(ticks.len().div_ceil(ROWS));
    let rows = every.flat_map(|part| &part[..ROW.min(part.len())]);
    let spread: Vec<usize> = rows.map(|(k, _)| *k).collect();
    let mut longest = ticks;
    longest.sort_by_key(|(k, tick)| (std::cmp::Reverse(tick.instructions), *k));
    let longest = longest.iter().take(LONGEST).map(|(k, _)| *k);
    let follow: BTreeSet<usize> = longest.chain(spread.iter().copied()).collect();
    let last = follow.last().map_or(0, |k| first.ticks[*k].at_ns);
    let setup = Setup {
        follow: follow.clone(),
        seconds: (last as f64 * 1e-9 + AFTER_S).min(setup.seconds),
        ..setup.clone()
    };
    let second = on_board(image, &setup, |_| ())?;
    let followed = |k: usize| -> Result<(f64, u32, Fetches), String> {
        let tick = second.ticks.get(k).ok_or("a run that ended early")?;
        let same = tick.instructions == first.ticks[k].instructions;
        let both = tick.cycles.zip(tick.fetches).filter(|_| same);
        let both = both.ok_or_else(|| format!("tick {k} was not followed to its end"));
        both.map(|(cycles, fetches)| (f64::from(tick.instructions), cycles, fetches))
    };
    let (mut most, mut fetches_most) = (0, Fetches::default());
    for k in follow {
        let (_, cycles, fetches) = followed(k)?;
        most = most.max(cycles);
        fetches_most.lines = fetches_most.lines.max(fetches.lines);
        fetches_most.waits = fetches_most.waits.max(fetches.waits);
    }
    let (mut of_spread, mut cycles) = (0.0, 0.0);
    for k in spread {
        let (own, its, _) = followed(k)?;
        of_spread += own;
        cycles += f64::from(its);
    }
    Ok(Budget {
        instructions,
        cycles_mean: instructions.mean * cycles / of_spread,
        cycles_most: most,
        fetches_most,
    })
}

/// Mean and largest share of a period as text, at a control rate.
pub(crate) fn share(cost: Range, rate_hz: f64) -> String {
    let period = CORE_HZ as f64 / rate_hz;
    let [mean, most] = [cost.mean, cost.max as f64].map(|n| 100.0 * n / period);
    format!("{mean:.1} % in the mean, {most:.1} % at most, at one cycle an instruction")
}

/// Table with one line per scene, each run for `seconds` with the scene's hand.
///
/// # Errors
/// As [`measure`].
pub(crate) fn table(image: &Image, seconds: f64, seed: u64) -> Result<String, Failure> {
    let mut text = format!(
        "{:<16}{:>23}{:>19}{:>18}{:>14}\n{:<16}{:>7}{:>8}{:>8}{:>11}{:>8}{:>10}{:>8}{:>7}{:>7}\n",
        "",
        "instructions",
        "estimated cycles",
        "kHz at 50 % load",
        "flash, most",
        "scene",
        "least",
        "mean",
        "most",
        "mean",
        "most",
        "mean",
        "most",
        "lines",
        "waits"
    );
    for scene in SceneKind::ALL {
        let setup = Setup {
            seed,
            ..Setup::playing(scene, seconds)
        };
        let budget = measure(image, &setup)?;
        let Range { min, mean, max } = budget.instructions;
        let cycles = [budget.cycles_mean, f64::from(budget.cycles_most)];
        let [often, always] = cycles.map(|cycles| highest_rate_hz(cycles) * 1e-3);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<16}{min:>7}{mean:>8.0}{max:>8}{:>11.0}{:>8.0}{often:>10.1}{always:>8.1}{:>7}{:>7}",
            scene.name(),
            cycles[0],
            cycles[1],
            budget.fetches_most.lines,
            budget.fetches_most.waits
        );
    }
    Ok(text)
}
