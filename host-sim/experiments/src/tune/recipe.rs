//! Tuning sets of filters and of observers.

use catalogue::estimators::Kind;
use simulation::scenario::{Role, ScenarioName};

use super::Group;

/// Number of tuning seeds of filters.
pub const FILTER_SEEDS: u64 = 3;
/// Duration of each run on which filters are tuned, s.
pub const FILTER_SECONDS: f64 = 10.0;

/// Defaults of the tuning options for one kind of estimators.
#[derive(Clone, Copy, Debug)]
struct Recipe {
    /// Roles of the scenarios.
    roles: &'static [Role],
    /// Number of tuning seeds.
    seeds: u64,
    /// Duration of each run, s.
    seconds: f64,
    /// Whether the cost is averaged over wrong constants of the device too.
    perturbed: bool,
}

impl Recipe {
    /// For filters: the paper's experiment.
    const PLAIN: Self = Self {
        roles: &[Role::Tuning],
        seeds: FILTER_SEEDS,
        seconds: FILTER_SECONDS,
        perturbed: false,
    };
    /// For observers. Their error never leaves the haptic interval in the paper's experiment, so
    /// that experiment does not discriminate between parameters. Observers use constants of the
    /// device, which may be wrong.
    const OBSERVER: Self = Self {
        roles: &[Role::Tuning, Role::Judging],
        seeds: 1,
        seconds: 4.0,
        perturbed: true,
    };
}

/// What a user changes in the tuning sets.
#[derive(Clone, Debug, Default)]
pub struct Wishes {
    /// Scenarios; those of the recipe if there is none.
    pub scenarios: Vec<ScenarioName>,
    /// Number of tuning seeds.
    pub seeds: Option<u64>,
    /// Duration of each run, s.
    pub seconds: Option<f64>,
    /// Whether the cost is averaged over wrong constants of the device too. Without scenarios of the user it
    /// is that of the recipe by default, else `false`.
    pub perturbed: Option<bool>,
}

impl Wishes {
    /// The estimators `kinds` with their tuning sets: filters, then observers.
    #[must_use]
    pub fn groups(&self, kinds: &[&Kind]) -> Vec<Group> {
        let (observers, others): (Vec<_>, Vec<_>) =
            kinds.iter().copied().partition(|kind| kind.is_observer());
        let groups = [(others, Recipe::PLAIN), (observers, Recipe::OBSERVER)].into_iter();
        groups
            .filter(|(kinds, _)| !kinds.is_empty())
            .map(|(kinds, recipe): (Vec<&Kind>, Recipe)| {
                let usual = ScenarioName::of(recipe.roles);
                let scenarios = match self.scenarios.as_slice() {
                    [] => &usual,
                    own => own,
                };
                Group {
                    estimators: kinds.iter().map(|kind| kind.name.to_owned()).collect(),
                    scenarios: scenarios.iter().map(ToString::to_string).collect(),
                    seeds: self.seeds.unwrap_or(recipe.seeds),
                    seconds: self.seconds.unwrap_or(recipe.seconds),
                    perturbed: self
                        .perturbed
                        .unwrap_or(recipe.perturbed && self.scenarios.is_empty()),
                }
            })
            .collect()
    }
}
