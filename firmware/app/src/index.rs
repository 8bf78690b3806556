//! Index pulses of both encoders, in an image with `index-pulse`.

use estimator_core::{Count, Counts, Sample, Skip};
use haptic_control::{Index, IndexState, Stop};

use crate::config::DEVICE;

const LARGE: Index = Index::new(&DEVICE.large);
const SMALL: Index = Index::new(&DEVICE.small);

/// The indices of the image.
#[cfg(feature = "index-pulse")]
pub type Indices = Pair;
/// The indices of the image.
#[cfg(not(feature = "index-pulse"))]
pub type Indices = Skip;

/// Index pulses of a tick, or [`Skip`] in an image that captures none.
pub type Pulses = <Indices as Indexing>::Pulses;
/// What is reported of index pulses, or [`Skip`].
pub type Reported = <Indices as Indexing>::Reported;

/// Indices of both encoders, or nothing in their place.
pub trait Indexing {
    /// Whether index pulses are captured.
    const WANTED: bool;
    /// Counts of both encoders at their latest pulses.
    type Pulses: Copy;
    /// No pulse.
    const NONE: Self::Pulses;
    /// What is reported.
    type Reported: Indications;

    /// Indices without a pulse.
    fn start() -> Self;

    /// Takes the mechanical zeros, counts after the index of the large and of the small encoder.
    fn offset(&mut self, offsets: [Counts; 2]);

    /// One tick, with the pulses since the tick before.
    fn check(&mut self, pulses: &Self::Pulses) -> Option<Stop>;

    /// Forgets a finding.
    fn forget(&mut self);

    /// The state at a sample.
    fn take_reported(&mut self, sample: &Sample) -> Self::Reported;
}

/// A report of index pulses, or nothing in its place.
pub trait Indications: Copy {
    /// The large and the small encoder, if a pulse came since the report before, or if `due`.
    fn pair(self, due: bool) -> Option<[Indication; 2]>;
}

/// What is reported of the index of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indication {
    /// Pulses since the reference was taken, the reference included; 0 without a reference.
    pub pulses: u32,
    /// Count of the latest pulse.
    pub count: Count,
    /// Distance of the latest pulse from whole turns after the reference, counts.
    pub deviation: i32,
    /// Displacement of the sample from the mechanical zero of the settings, counts; 0 without a reference.
    pub position: Counts,
}

/// The indices of both encoders.
pub struct Pair {
    large: IndexState,
    small: IndexState,
    /// From the reference to the mechanical zero.
    offsets: [Counts; 2],
    /// Whether a pulse came since the last report.
    fresh: bool,
}

/// A report of both.
#[derive(Clone, Copy)]
pub struct Report {
    pair: [Indication; 2],
    fresh: bool,
}

impl Indication {
    fn of(state: &IndexState, count: Count, offset: Counts) -> Self {
        Self {
            pulses: state.pulses(),
            count: state.latest(),
            deviation: state.deviation(),
            position: state.position(count, offset).unwrap_or_default(),
        }
    }
}

impl Indexing for Pair {
    const WANTED: bool = true;
    type Pulses = [Option<Count>; 2];
    const NONE: Self::Pulses = [None; 2];
    type Reported = Report;

    fn start() -> Self {
        Self {
            large: IndexState::START,
            small: IndexState::START,
            offsets: [Counts(0); 2],
            fresh: false,
        }
    }

    fn offset(&mut self, offsets: [Counts; 2]) {
        self.offsets = offsets;
    }

    fn check(&mut self, [large, small]: &Self::Pulses) -> Option<Stop> {
        self.fresh |= large.is_some() || small.is_some();
        let found = LARGE.check(&mut self.large, *large);
        SMALL.check(&mut self.small, *small).or(found)
    }

    fn forget(&mut self) {
        self.large.restart();
        self.small.restart();
    }

    fn take_reported(&mut self, sample: &Sample) -> Report {
        let [large, small] = self.offsets;
        Report {
            pair: [
                Indication::of(&self.large, sample.count, large),
                Indication::of(&self.small, sample.coupled, small),
            ],
            fresh: core::mem::take(&mut self.fresh),
        }
    }
}

impl Indications for Report {
    fn pair(self, due: bool) -> Option<[Indication; 2]> {
        (self.fresh || due).then_some(self.pair)
    }
}

/// No indices: no state and no code.
impl Indexing for Skip {
    const WANTED: bool = false;
    type Pulses = Self;
    const NONE: Self = Self;
    type Reported = Self;

    fn start() -> Self {
        Self
    }

    fn offset(&mut self, _: [Counts; 2]) {}

    fn check(&mut self, _: &Self) -> Option<Stop> {
        None
    }

    fn forget(&mut self) {}

    fn take_reported(&mut self, _: &Sample) -> Self {
        Self
    }
}

impl Indications for Skip {
    fn pair(self, _: bool) -> Option<[Indication; 2]> {
        None
    }
}
