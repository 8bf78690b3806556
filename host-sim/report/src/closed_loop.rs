//! The closed loop on the page: what the hand feels.

mod charts;
mod force_by_motion;
mod margins;
mod rendered_force;
mod score_table;
mod spectrum;
mod torque_response;
mod unnoticed_share;

use super::ReportInput;
use super::palette::Palette;
use super::section::{Section, explained, explanation, joined};
use super::text::{number, plant, rate, share};
use catalogue::parameters::PlantKind;
use experiments::transparency::{Design, Outcome, REFERENCE, Run, Swept};
use haptic_control::SceneKind;
use maud::html;

/// What was run with the loop closed.
#[derive(Clone, Debug, Default)]
pub struct ClosedLoop {
    /// Scenes and rates; figures need their signals.
    pub outcomes: Vec<Outcome>,
    /// Torque rendered into a clamped handle, one a rate.
    pub swept: Vec<Swept>,
    /// The designed velocity loop, one a rate.
    pub designs: Vec<Design>,
}

const FELT: &str = "From here on the loop is closed: the controller moves both motors, with each \
    estimator in turn as its only knowledge of the large motor\u{2019}s velocity. \u{201c}reference\u{201d} \
    closes it on the reference encoder, as the paper did: what a finer encoder would bring. \
    Parasitic force is the torque felt minus the torque that the scene wanted, at the \
    fingertip. It includes the inertia and the friction of the handle itself, which no estimator \
    takes away. \u{201c}any\u{201d}: the scene does not ask for the large motor\u{2019}s velocity.";
const BARS: &str = "Share of time in which the parasitic force is smaller than a fingertip notices; \
    longer is better.";
const SPEED: &str = "An ideal device adds no force. Parasitic force against the velocity of the \
    handle (top) and against its acceleration (bottom). In the green area the force is below the \
    threshold of a fingertip. The peak at rest is the friction of the handle: its feed-forward fades \
    out where the direction of motion is uncertain. The solid black line is the device with both motors \
    off. The dashed black line is the inertia of the handle, which is not compensated. Kalman filters \
    with a preset steady gain lie on those with full covariance and are not drawn.";
const SPECTRUM: &str = "Where in frequency the parasitic force lies, hand moving in free air. In \
    the green band it is felt as roughness; left of it lie friction and inertia, right of it \
    what no finger feels but the motors still suffer.";
const RENDERED: &str = "Force wanted by the scene (black), give or take what a fingertip notices \
    (green), and force felt (coloured), in the part of the run in which most happens. For each \
    rate finite difference, the other estimator with the least parasitic force in this scene, and \
    the reference encoder; the number is that force, RMS over the run. Delay shows as a shift, friction as steps at each reversal, a bad velocity \
    as a coloured band. Where a count is worth more than the slew limit lets through within a \
    tick, as for finite difference at high rates, its spikes are clipped on one side and their \
    mean is lost with them: an offset, not a band.";
const TORQUE: &str = "Many sines at once, together (RMS) as strong as a fingertip just notices, on a \
    constant torque, into a clamped handle. Gain and phase of the torque felt against the torque wanted; \
    the large motor brings the low frequencies, the small motor what is missing, so their sum is \
    flat until the amplifiers, the tick and half a tick of holding end it. Where the velocity is \
    late or noisy the sum is uneven and coherence, the part of the power that repeats, falls. A \
    point of low coherence is itself uncertain.";
const MARGINS: &str = "The velocity loop as it was designed, an estimator late by the delay below \
    included: the further its curve passes from \u{2212}1 the better. Modulus margin is that distance \
    (the circle), gain margin the factor that the gain may grow, phase and delay margin what may \
    be lost at the crossover.";

impl ClosedLoop {
    /// Everybody who closes a loop, in order of appearance.
    pub(super) fn closers(&self) -> Vec<&str> {
        let runs = self
            .outcomes
            .iter()
            .filter(|o| has_loop(o))
            .flat_map(|o| &o.runs);
        let swept = self.swept.iter().flat_map(|swept| &swept.runs);
        let mut names: Vec<&str> = Vec::new();
        for name in runs
            .map(|run| run.controlled_by)
            .chain(swept.map(|(name, _)| *name))
        {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// The same for figures full of curves: without those that lie on others.
    fn drawn(&self) -> Vec<&str> {
        let mut names = self.closers();
        let all = names.clone();
        names.retain(|name| {
            let full = name.strip_suffix("-steady");
            full.is_none_or(|full| !all.contains(&full))
        });
        names
    }

    /// The outcomes of a scene, lowest and highest rate.
    fn of(&self, scene: &str) -> Vec<&Outcome> {
        let of_scene = self
            .outcomes
            .iter()
            .filter(|o| o.case.scene.name() == scene);
        let mut outcomes: Vec<_> = of_scene.collect();
        outcomes.sort_by(|a, b| a.case.rate_hz.total_cmp(&b.case.rate_hz));
        outcomes.dedup_by_key(|o| o.case.rate_hz.to_bits());
        if outcomes.len() > 2 {
            outcomes.drain(1..outcomes.len() - 1);
        }
        outcomes
    }
}

fn has_loop(outcome: &Outcome) -> bool {
    outcome.case.scene.facts().needs.continuous
}

fn find<'a>(outcome: &'a Outcome, controlled_by: &str) -> Option<&'a Run> {
    outcome
        .runs
        .iter()
        .find(|run| run.controlled_by == controlled_by)
}

/// The estimator of an outcome with the least parasitic force, among those that count.
fn best(outcome: &Outcome, counts: impl Fn(&str) -> bool) -> Option<&Run> {
    let runs = outcome
        .runs
        .iter()
        .filter(|run| run.controlled_by != REFERENCE && counts(run.controlled_by));
    let rms = |run: &Run| run.parasitic.parasitic_mn_rms.unwrap_or(f64::INFINITY);
    runs.min_by(|a, b| rms(a).total_cmp(&rms(b)))
}

/// Every section that has something to show.
pub(super) fn sections(report: &ReportInput, palette: &Palette) -> Result<Vec<Section>, String> {
    let closed = &report.closed_loop;
    if closed.outcomes.is_empty() {
        return Ok(Vec::new());
    }
    let threshold_mn = 1e3 * report.device.interval.threshold_n;
    let overview = html! {
        @if let Some(text) = in_words(closed) { p.verdict { (text) } }
        (explanation(FELT))
        (unnoticed_share::shares(closed, palette)?)
        (explanation(BARS))
    };
    let transparency = [
        explained(
            force_by_motion::figures(closed, palette, &report.device)?,
            SPEED,
        ),
        explained(spectrum::figure(closed, palette)?, SPECTRUM),
    ];
    let rendered = explained(
        rendered_force::figures(closed, palette, threshold_mn)?,
        RENDERED,
    );
    let torque = [
        explained(torque_response::figures(closed, palette)?, TORQUE),
        torque_response::table(closed, palette),
    ];
    let margins = [
        explained(margins::figure_or_none(&closed.designs)?, MARGINS),
        margins::table(&closed.designs),
    ];
    let scores = score_table::tables(closed, palette);
    let sections = [
        Section::new("felt", "What the hand feels", Some(overview)),
        Section::new("transparency", "Transparency", joined(transparency)),
        Section::new("rendered", "Wanted and felt", rendered),
        Section::new("torque", "Torque bandwidth", joined(torque)),
        Section::new("margins", "Velocity loop", joined(margins)),
        Section::new("felt-scores", "Closed-loop scores", Some(scores)),
    ];
    Ok(sections.into_iter().flatten().collect())
}

/// The gist, from free air or else from the first scene with a loop.
fn in_words(closed: &ClosedLoop) -> Option<String> {
    let with_loop = closed.outcomes.iter().find(|o| has_loop(o))?;
    let scene = closed
        .outcomes
        .iter()
        .find(|o| o.case.scene == SceneKind::FreeAir);
    let scene = scene.unwrap_or(with_loop).case.scene.name();
    let clauses: Vec<String> = (closed.of(scene).into_iter())
        .filter_map(|outcome| {
            let says = |run: &Run| run.parasitic.parasitic_mn_rms.map(number);
            let best = best(outcome, |_| true)?;
            let mut text = format!(
                "at {} {}\u{a0}mN with {}, below the threshold {} of the time",
                rate(outcome.case.rate_hz),
                says(best)?,
                best.controlled_by,
                share(best.parasitic.below_threshold?),
            );
            let others = [
                ("finite-difference", "finite difference"),
                (REFERENCE, "the reference encoder"),
            ];
            let others: Vec<String> = (others.into_iter())
                .filter(|(name, _)| *name != best.controlled_by)
                .filter_map(|(name, shown)| {
                    Some(format!("{shown} {}", says(find(outcome, name)?)?))
                })
                .collect();
            if !others.is_empty() {
                text += &format!(" ({})", others.join(", "));
            }
            Some(text)
        })
        .collect();
    let friction = with_loop.case.plant == PlantKind::Friction;
    (!clauses.is_empty()).then(|| {
        let (plant, clauses) = (plant(friction), clauses.join("; "));
        format!("RMS parasitic force in closed loop, scene {scene}, plant {plant}: {clauses}.")
    })
}
