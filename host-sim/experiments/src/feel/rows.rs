//! Rows of the JSON and CSV.

use serde::Serialize;

use super::{Felt, Settings};
use crate::transparency::{Cause, Parasitic, Part};

/// The case of a row.
#[derive(Clone, Debug, Serialize)]
pub struct Of {
    /// Name of the scene.
    pub scenario: &'static str,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Seed.
    pub seed: u64,
    /// Estimator of the large motor's velocity, or "any".
    pub controlled_by: &'static str,
    /// Estimator of the handle's velocity.
    pub handle_estimator: &'static str,
}

/// One cause in one case.
#[derive(Clone, Debug, Serialize)]
pub struct CauseRow {
    /// The case.
    #[serde(flatten)]
    pub of: Of,
    /// Name of the cause.
    pub cause: &'static str,
    /// Its size.
    #[serde(flatten)]
    pub part: Part,
}

/// One case with one cause switched off.
#[derive(Clone, Debug, Serialize)]
pub struct WithoutRow {
    /// The case.
    #[serde(flatten)]
    pub of: Of,
    /// What is switched off; "nothing" for the device as it is.
    pub without: &'static str,
    /// Scores of the parasitic force.
    #[serde(flatten)]
    pub parasitic: Parasitic,
}

/// A row of either kind.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum FeelRow {
    /// One cause.
    Cause(CauseRow),
    /// One cause switched off.
    Without(WithoutRow),
}

fn of(felt: &Felt, settings: &Settings) -> Of {
    Of {
        scenario: felt.case.scene.name(),
        rate_hz: felt.case.rate_hz,
        seed: settings.seed,
        controlled_by: felt.case.estimator_name(),
        handle_estimator: settings.handle.name,
    }
}

/// One row for each case and cause.
#[must_use]
pub fn causes(all: &[Felt], settings: &Settings) -> Vec<CauseRow> {
    let of_case = |felt: &Felt| {
        let parts = felt.attribution.as_ref().map(|found| found.parts);
        let parts = Cause::ALL.into_iter().zip(parts.into_iter().flatten());
        let row = |(cause, part): (Cause, Part)| CauseRow {
            of: of(felt, settings),
            cause: cause.name(),
            part,
        };
        parts.map(row).collect::<Vec<_>>()
    };
    all.iter().flat_map(of_case).collect()
}

/// One row for each case and what is switched off.
#[must_use]
pub fn without(all: &[Felt], settings: &Settings) -> Vec<WithoutRow> {
    let of_case = |felt: &Felt| {
        let first = std::iter::once(("nothing", felt.parasitic));
        let others = felt
            .without
            .iter()
            .map(|(without, parasitic)| (without.name(), *parasitic));
        let row = |(without, parasitic)| WithoutRow {
            of: of(felt, settings),
            without,
            parasitic,
        };
        first.chain(others).map(row).collect::<Vec<_>>()
    };
    all.iter().flat_map(of_case).collect()
}
