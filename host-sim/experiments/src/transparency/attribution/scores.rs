//! Size of each cause over a run.

use scoring::score::{TACTILE_BAND_HZ, skipped};
use scoring::spectrum::{Density, Welch};
use serde::Serialize;

use super::CAUSES;

/// Size of one cause.
///
/// A share is the mean product of the cause's force and the parasitic force, relative to the mean
/// square of the parasitic force. The shares of all causes have the sum 1. A share is negative where
/// the cause opposes the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Part {
    /// RMS of the force, mN.
    pub rms_mn: f64,
    /// Share of the parasitic force's mean square; `None` if that is zero.
    pub share: Option<f64>,
    /// RMS from 50 to 500 Hz, mN; `None` for less than 0.25 s.
    pub tactile_mn: Option<f64>,
    /// Share of the parasitic force's mean square from 50 to 500 Hz.
    pub tactile_share: Option<f64>,
}

/// The parasitic force of a run after the first [`SKIP_S`](scoring::score::SKIP_S) seconds, by cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribution {
    /// RMS of the parasitic force, mN.
    pub rms_mn: f64,
    /// RMS of the parasitic force from 50 to 500 Hz, mN; `None` for less than 0.25 s.
    pub tactile_mn: Option<f64>,
    /// The parts in the order of [`Cause::ALL`](super::Cause::ALL).
    pub parts: [Part; CAUSES],
}

impl Attribution {
    /// The parts of a parasitic force of which `terms_mn` are the causes' forces by tick, mN. `None` for
    /// a series without scored ticks or with a force that is not finite.
    #[must_use]
    pub fn of(terms_mn: &[Vec<f64>; CAUSES], rate_hz: f64) -> Option<Self> {
        let ticks = terms_mn[0].len();
        let skip = skipped(rate_hz).min(ticks);
        let terms = terms_mn.each_ref().map(|term| &term[skip..]);
        let mut total = vec![0.0; ticks - skip];
        for term in terms {
            for (sum, part) in total.iter_mut().zip(term) {
                *sum += part;
            }
        }
        if total.is_empty() || total.iter().any(|force| !force.is_finite()) {
            return None;
        }
        let mean_product = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / total.len() as f64
        };
        let welch = Welch::new(rate_hz);
        let band = |signal: &[f64]| welch.density(signal).and_then(|density| power(&density));
        let power = mean_product(&total, &total);
        let tactile_power = band(&total);
        let ratio = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
        let parts = terms.map(|term| {
            let own = band(term);
            let sum: Vec<f64> = term.iter().zip(&total).map(|(a, b)| a + b).collect();
            // The mean product in the band: of the square of a sum, the part that is in neither square.
            let product = || Some(0.5 * (band(&sum)? - own? - tactile_power?));
            Part {
                rms_mn: mean_product(term, term).sqrt(),
                share: ratio(mean_product(term, &total), power),
                tactile_mn: own.map(f64::sqrt),
                tactile_share: product().and_then(|product| ratio(product, tactile_power?)),
            }
        });
        Some(Self {
            rms_mn: power.sqrt(),
            tactile_mn: tactile_power.map(f64::sqrt),
            parts,
        })
    }
}

/// Mean square from 50 to 500 Hz.
fn power(density: &Density) -> Option<f64> {
    Some(density.rms_within(TACTILE_BAND_HZ)?.powi(2))
}
