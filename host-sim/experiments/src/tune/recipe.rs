//! Tuning sets of filters and of observers.

use simulation::scenario::Role;

/// Defaults of the tuning options for one kind of estimators.
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    /// Roles of the scenarios.
    pub roles: &'static [Role],
    /// Number of tuning seeds.
    pub seeds: u64,
    /// Duration of each run, s.
    pub seconds: f64,
    /// Whether the cost is averaged over wrong constants of the device too.
    pub perturbed: bool,
}

impl Recipe {
    /// For filters: the paper's experiment.
    pub const PLAIN: Self = Self {
        roles: &[Role::Tuning],
        seeds: 3,
        seconds: 10.0,
        perturbed: false,
    };
    /// For observers. Their error never leaves the haptic interval in the paper's experiment, so
    /// that experiment does not discriminate between parameters. Observers use constants of the
    /// device, which may be wrong.
    pub const OBSERVER: Self = Self {
        roles: &[Role::Tuning, Role::Judging],
        seeds: 1,
        seconds: 4.0,
        perturbed: true,
    };
}
