//! The page of `feel`: stacked bars for each scene.

use super::causes::{Bar, Block, EXPLANATION, stacked};
use super::page::Printout;
use super::text::rate;
use experiments::distinct::distinct;
use experiments::feel::Felt;

/// The page: a figure for each scene, then the printed tables.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn feel(all: &[Felt], threshold_mn: f64, printout: &Printout) -> Result<String, String> {
    let mut figures = Vec::new();
    for scene in distinct(all.iter().map(|felt| felt.case.scene)) {
        let of: Vec<&Felt> = all.iter().filter(|felt| felt.case.scene == scene).collect();
        let blocks = of.chunk_by(|a, b| a.case.rate_hz == b.case.rate_hz);
        let blocks: Vec<Block> = blocks
            .map(|block| Block {
                heading: rate(block[0].case.rate_hz),
                bars: (block.iter().copied())
                    .filter_map(|felt| {
                        Some(Bar {
                            label: felt.case.estimator_name(),
                            attribution: felt.attribution.as_ref()?,
                        })
                    })
                    .collect(),
            })
            .collect();
        let title = format!("Causes of the parasitic force in scene {scene}");
        figures.extend(stacked(&title, &blocks, threshold_mn)?);
    }
    Ok(printout.page("What the hand feels", EXPLANATION, &figures))
}
