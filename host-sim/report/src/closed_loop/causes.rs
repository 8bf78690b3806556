//! Causes of the parasitic force: stacked bars for each scene, rates one below the other.

use maud::{Markup, html};

use super::super::canvas::Svg;
use super::super::causes::{Bar, Block, EXPLANATION, stacked};
use super::super::section::explanation;
use super::super::text::rate;
use super::{ClosedLoop, uses_velocity};
use experiments::distinct::distinct;
use haptic_control::SceneKind;

/// The figure of free air, and those of the other scenes to unfold; `None` without attribution.
pub(super) fn markup(closed: &ClosedLoop, threshold_mn: f64) -> Result<Option<Markup>, String> {
    let scenes = distinct(closed.outcomes.iter().map(|outcome| outcome.case.scene));
    let mut figures: Vec<(SceneKind, Svg)> = Vec::new();
    for scene in scenes {
        figures.extend(of_scene(closed, scene, threshold_mn)?.map(|svg| (scene, svg)));
    }
    if figures.is_empty() {
        return Ok(None);
    }
    // Free air, where every force is parasitic, or else the first scene.
    let shown = figures
        .iter()
        .position(|(scene, _)| *scene == SceneKind::FreeAir);
    let (_, first) = figures.remove(shown.unwrap_or(0));
    Ok(Some(html! {
        (first)
        (explanation(EXPLANATION))
        @for (scene, figure) in &figures {
            details {
                summary { "Scene " (scene.name()) }
                (figure)
            }
        }
    }))
}

fn of_scene(
    closed: &ClosedLoop,
    scene: SceneKind,
    threshold_mn: f64,
) -> Result<Option<Svg>, String> {
    let names = closed.drawn_sources();
    let blocks: Vec<Block> = (closed.of(scene.name()).into_iter())
        .map(|outcome| Block {
            heading: rate(outcome.case.rate_hz),
            bars: (outcome.runs.iter())
                .filter(|run| !uses_velocity(outcome) || names.contains(&run.controlled_by))
                .filter_map(|run| {
                    Some(Bar {
                        label: run.controlled_by,
                        attribution: run.attribution.as_ref()?,
                    })
                })
                .collect(),
        })
        .filter(|block: &Block| !block.bars.is_empty())
        .collect();
    let title = format!("Causes of the parasitic force in scene {scene}");
    stacked(&title, &blocks, threshold_mn)
}
