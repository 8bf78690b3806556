//! Sections of the closed loop: parasitic force, rendered force and torque, margins.

mod causes;
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
use catalogue::estimators::DIFFERENCE;
use catalogue::parameters::PlantKind;
use experiments::distinct::distinct;
use experiments::transparency::{Design, Outcome, REFERENCE, Run, Swept};
use haptic_control::SceneKind;
use maud::html;

/// Results of the closed loop.
#[derive(Clone, Debug, Default)]
pub struct ClosedLoop {
    /// Results of each scene at each rate; the figures need their signals.
    pub outcomes: Vec<Outcome>,
    /// Frequency responses of the torque at a clamped handle, one for each rate.
    pub swept: Vec<Swept>,
    /// Designs of the velocity loop, one for each rate.
    pub designs: Vec<Design>,
}

const OVERVIEW: &str = "In this and the following sections the loop is closed: the controller \
    drives both motors, and each estimator in turn is its only source of the large \
    motor\u{2019}s velocity. \u{201c}reference\u{201d} uses the reference encoder instead, as \
    the paper did: it shows the effect of a finer encoder. The parasitic force is the force \
    that the hand feels minus the force that the scene commands, at the fingertip. It includes \
    the inertia and the friction of the handle, which no estimator can remove. \
    \u{201c}any\u{201d} stands for all estimators where the scene does not use the velocity of \
    the large motor.";
const SHARES: &str = "Share of time in which the parasitic force is below the threshold of a \
    fingertip. Longer bars are better.";
const MOTION: &str = "An ideal device adds no force. The figure shows the parasitic force \
    against the velocity (top) and the acceleration (bottom) of the handle. In the green area \
    the force is below the threshold of a fingertip. The peak at rest is the friction of the \
    handle: its feed-forward compensation fades out where the direction of motion is uncertain. \
    The solid black line is the device with both motors off. The dashed black line is the \
    inertia of the handle, which is not compensated. Kalman filters with a preset steady gain \
    coincide with those with full covariance and are not drawn.";
const SPECTRUM: &str = "Amplitude spectral density of the parasitic force while the hand moves \
    in free air. Force in the green band is felt as roughness. Friction and inertia lie below \
    the band. Force above the band is not felt but loads the motors.";
const RENDERED: &str = "Force that the scene commands (black) with the threshold of a fingertip \
    around it (green), and force that the hand feels (coloured), in the part of the run where \
    the command varies most. Each rate shows finite difference, the other estimator with the \
    smallest parasitic force in this scene, and the reference encoder. The number is the RMS \
    parasitic force of the run. Delay appears as a shift, friction as steps at each reversal, \
    velocity noise as a coloured band. If one count exceeds the slew limit of a tick, as for \
    finite difference at high rates, the spikes are clipped on one side: an offset replaces the \
    band.";
const TORQUE: &str = "A multisine torque is added to a constant torque while the handle is \
    clamped; its RMS is the threshold of a fingertip. Gain and phase are those of the torque at \
    the handle relative to the commanded torque. The large motor provides the low frequencies \
    and the small motor the remainder, so their sum is flat up to the limits of the amplifiers, \
    of the tick and of half a tick of hold. A late or noisy velocity makes the sum uneven and \
    reduces the coherence, the part of the power that repeats. Gain and phase are uncertain \
    where the coherence is low.";
const MARGINS: &str = "Open loop of the velocity controller as designed, including an estimator \
    with the delay given in the table. The loop is more robust the further its curve stays from \
    \u{2212}1. The modulus margin is the smallest distance from \u{2212}1 (the circle), the \
    gain margin the factor by which the gain may grow. The phase and delay margins are the \
    additional phase lag and delay that the loop tolerates at the crossover frequency.";

impl ClosedLoop {
    /// Estimators and encoders that provide the velocity of a closed loop, in order of appearance.
    pub(super) fn velocity_sources(&self) -> Vec<&str> {
        let runs = self
            .outcomes
            .iter()
            .filter(|o| uses_velocity(o))
            .flat_map(|o| &o.runs);
        let swept = self.swept.iter().flat_map(|swept| &swept.runs);
        let names = runs.map(|run| run.controlled_by);
        distinct(names.chain(swept.map(|(name, _)| *name)))
    }

    /// Velocity sources of figures with many curves: without the steady-state filters, whose curves
    /// coincide with those of the filters with full covariance.
    fn drawn_sources(&self) -> Vec<&str> {
        let mut names = self.velocity_sources();
        let all = names.clone();
        names.retain(|name| {
            let full = name.strip_suffix("-steady");
            full.is_none_or(|full| !all.contains(&full))
        });
        names
    }

    /// The outcomes of a scene at the lowest and at the highest rate.
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

fn uses_velocity(outcome: &Outcome) -> bool {
    outcome.case.scene.facts().needs.continuous
}

fn find<'a>(outcome: &'a Outcome, controlled_by: &str) -> Option<&'a Run> {
    outcome
        .runs
        .iter()
        .find(|run| run.controlled_by == controlled_by)
}

/// The run of the estimator with the smallest RMS parasitic force, among those that `competes`
/// accepts.
fn best(outcome: &Outcome, competes: impl Fn(&str) -> bool) -> Option<&Run> {
    let runs = outcome
        .runs
        .iter()
        .filter(|run| run.controlled_by != REFERENCE && competes(run.controlled_by));
    let rms = |run: &Run| run.parasitic.parasitic_mn_rms.unwrap_or(f64::INFINITY);
    runs.min_by(|a, b| rms(a).total_cmp(&rms(b)))
}

/// The sections that have content.
pub(super) fn sections(report: &ReportInput, palette: &Palette) -> Result<Vec<Section>, String> {
    let closed = &report.closed_loop;
    if closed.outcomes.is_empty() {
        return Ok(Vec::new());
    }
    let threshold_mn = 1e3 * report.device.interval.threshold_n;
    let overview = html! {
        @if let Some(text) = in_words(closed) { p.verdict { (text) } }
        (explanation(OVERVIEW))
        (unnoticed_share::shares(closed, palette)?)
        (explanation(SHARES))
    };
    let transparency = [
        explained(
            force_by_motion::figures(closed, palette, &report.device)?,
            MOTION,
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
        Section::new("closed-loop", "Closed loop", Some(overview)),
        Section::new("causes", "Causes", causes::markup(closed, threshold_mn)?),
        Section::new("transparency", "Transparency", joined(transparency)),
        Section::new("rendered", "Rendered force", rendered),
        Section::new("torque", "Torque bandwidth", joined(torque)),
        Section::new("margins", "Velocity loop", joined(margins)),
        Section::new("closed-loop-scores", "Closed-loop scores", Some(scores)),
    ];
    Ok(sections.into_iter().flatten().collect())
}

/// Summary of the parasitic force in free air, or else in the first scene that uses the velocity.
fn in_words(closed: &ClosedLoop) -> Option<String> {
    let with_loop = closed.outcomes.iter().find(|o| uses_velocity(o))?;
    let scene = closed
        .outcomes
        .iter()
        .find(|o| o.case.scene == SceneKind::FreeAir);
    let scene = scene.unwrap_or(with_loop).case.scene.name();
    let clauses: Vec<String> = (closed.of(scene).into_iter())
        .filter_map(|outcome| {
            let force = |run: &Run| {
                run.parasitic
                    .parasitic_mn_rms
                    .map(|mn| format!("{}\u{a0}mN", number(mn)))
            };
            let best = best(outcome, |_| true)?;
            let mut text = format!(
                "at {} {} with {}, below the threshold of a fingertip {} of the time",
                rate(outcome.case.rate_hz),
                force(best)?,
                best.controlled_by,
                share(best.parasitic.below_threshold?),
            );
            let others = [
                (DIFFERENCE, "finite difference"),
                (REFERENCE, "reference encoder"),
            ];
            let others: Vec<String> = (others.into_iter())
                .filter(|(name, _)| *name != best.controlled_by)
                .filter_map(|(name, shown)| {
                    Some(format!("{shown}: {}", force(find(outcome, name)?)?))
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

#[cfg(test)]
mod tests {
    use super::*;
    use experiments::compare::Cost;
    use experiments::transparency::{Fingertip, LoopCase, Parasitic, Signals};
    use simulation::device::Device;

    /// A run with this RMS parasitic force, mN, and share of time below the threshold.
    pub(super) fn run(controlled_by: &'static str, rms_mn: f64, below: f64) -> Run {
        Run {
            controlled_by,
            parasitic: Parasitic {
                parasitic_mn_rms: Some(rms_mn),
                below_threshold: Some(below),
                ..Parasitic::default()
            },
            velocity: None,
            stopped: None,
            attribution: None,
            signals: Some(Signals::default()),
        }
    }

    pub(super) fn outcome(scene: SceneKind, rate_hz: f64, runs: Vec<Run>) -> Outcome {
        Outcome {
            case: LoopCase {
                scene,
                rate_hz,
                plant: PlantKind::Friction,
                seed: 1,
                seconds: 1.0,
                keep: true,
                attribute: false,
            },
            fingertip: Fingertip::new(&Device::default()),
            runs,
            rows: Vec::new(),
            cost: Cost::default(),
        }
    }

    fn runs(rms_mn: f64) -> Vec<Run> {
        vec![
            run("finite-difference", 3.0 * rms_mn, 0.25),
            run("kalman-triple", rms_mn, 0.75),
            run("kalman-triple-steady", 2.0 * rms_mn, 0.5),
            run(REFERENCE, 0.5 * rms_mn, 0.875),
        ]
    }

    fn closed(rates_hz: &[f64]) -> ClosedLoop {
        let outcomes = rates_hz
            .iter()
            .map(|&hz| outcome(SceneKind::FreeAir, hz, runs(1e4 / hz)));
        ClosedLoop {
            outcomes: outcomes.collect(),
            ..ClosedLoop::default()
        }
    }

    #[test]
    fn best_estimator_is_named_and_the_reference_does_not_compete() {
        let said = in_words(&closed(&[2000.0])).unwrap();
        assert_eq!(
            said,
            "RMS parasitic force in closed loop, scene free-air, plant with friction: at 2 kHz \
             5.00\u{a0}mN with kalman-triple, below the threshold of a fingertip 75\u{a0}% of the time \
             (finite difference: 15.0\u{a0}mN, reference encoder: 2.50\u{a0}mN)."
        );
        assert_eq!(in_words(&ClosedLoop::default()), None);
    }

    #[test]
    fn figures_have_the_lowest_and_the_highest_rate_and_one_form_of_a_filter() {
        let closed = closed(&[2000.0, 5000.0, 1000.0, 10_000.0]);
        let rates: Vec<_> = closed
            .of("free-air")
            .iter()
            .map(|o| o.case.rate_hz)
            .collect();
        assert_eq!(rates, [1000.0, 10_000.0]);
        let drawn = ["finite-difference", "kalman-triple", REFERENCE];
        assert_eq!(closed.drawn_sources(), drawn);
        // A steady filter without the full one has a curve.
        let alone = runs(1.0)
            .into_iter()
            .filter(|run| run.controlled_by != "kalman-triple");
        let closed = ClosedLoop {
            outcomes: vec![outcome(SceneKind::FreeAir, 1e3, alone.collect())],
            ..ClosedLoop::default()
        };
        assert!(closed.drawn_sources().contains(&"kalman-triple-steady"));
    }
}
