//! How counts, with or without time stamps, correct an observer.

use core::borrow::Borrow;

use super::design::Gain;
use super::table::Table;
use crate::const_math::limited;
use crate::design_error::DesignError;
use crate::edge_clock::EdgeClock;
use crate::sample::{Sample, Signals};
use crate::units::Hertz;

/// How far a tick leads, for the edge inside it.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Position at the last sample, from the middle of the newest cell.
    pub(super) from: f32,
    /// Predicted displacement since, counts.
    pub(super) lead: f32,
    /// Change of velocity over the tick, counts.
    pub(super) gained: f32,
    /// Whether the rotor rests.
    pub(super) rests: bool,
}

/// What a tick's counts say against the prediction.
#[derive(Clone, Copy, Debug)]
pub struct Innovation {
    /// Where the rotor was, less where it was predicted, counts.
    pub(super) error: f32,
    /// The part of the tick that had passed since, 0 to 1.
    pub(super) age: f32,
    /// Gain of the position, 0 to 1.
    pub(super) position: f32,
    /// Ticks since the last one.
    pub(super) gap: f32,
}

/// What is measured: [`Cells`], [`SoftCells`](super::SoftCells) or [`Edges`].
pub trait Correction: Copy {
    /// What is carried from tick to tick.
    type State: Clone + PartialEq;
    /// A gain of its own, or one of a table's.
    type Gain<'a>: Borrow<Gain>
    where
        Self: 'a;
    /// What it reads of a sample.
    const NEEDS: Signals;
    /// Whether every tick may have an innovation, or few have.
    const DENSE: bool;

    /// The state at the first sample.
    fn start(&self) -> Self::State;

    /// Variance of the velocity, (counts a tick)², the parameters being right.
    fn velocity_variance(&self, state: &Self::State) -> f32;

    /// The innovation of this tick and its gain, if it has one.
    fn innovation<'a>(
        &'a self,
        state: &mut Self::State,
        path: Path,
        sample: &Sample,
    ) -> Option<(Innovation, Self::Gain<'a>)>;
}

/// Counts alone: nothing is known but that the rotor is inside the newest count's cell. While the
/// prediction is too, it stands; once it has left, it is put back on the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    pub(super) table: Table,
}

/// Distance back to the cell, 0 inside it.
#[inline(always)]
fn excess(position: f32) -> Option<f32> {
    if position.abs() > 0.5 {
        let boundary = if position > 0.0 { 0.5 } else { -0.5 };
        Some(boundary - position)
    } else {
        None
    }
}

impl Correction for Cells {
    /// Ticks since the last correction.
    type State = f32;
    type Gain<'a> = &'a Gain;
    const NEEDS: Signals = Signals::COUNT;
    const DENSE: bool = false;

    fn start(&self) -> f32 {
        0.0
    }

    fn velocity_variance(&self, gap: &f32) -> f32 {
        self.table.velocity_variance(*gap)
    }

    #[inline(always)]
    fn innovation<'a>(
        &'a self,
        gap: &mut f32,
        path: Path,
        _: &Sample,
    ) -> Option<(Innovation, &'a Gain)> {
        *gap += 1.0;
        let error = excess(path.from + path.lead)?;
        let innovation = Innovation {
            error,
            age: 0.0,
            position: 1.0,
            gap: *gap,
        };
        *gap = 0.0;
        Some((innovation, self.table.gain(innovation.gap)))
    }
}

/// Counts with the instant of each tick's latest edge. The rotor is corrected where it was then;
/// at a tick without an edge it is kept inside its cell, as with [`Cells`], but for the gain: when it
/// got to the boundary nobody knows, so the gap since the last correction counts 3 ms more.
///
/// The four phases of a line are not where they should be: the offset of each is learned from its
/// innovations, `o += μ e` (μ = 0.02, within a quarter of a count). Nothing is learned without an
/// edge, so not at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edges {
    pub(super) clock: EdgeClock,
    pub(super) table: Table,
    /// What a gap that no edge ends counts more, ticks.
    pub(super) unstamped: f32,
}

/// State of [`Edges`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgesState {
    /// Time since the last edge, ticks.
    since: f32,
    /// Time since the last correction, ticks.
    alone: f32,
    /// Where each phase's boundary really is, counts.
    offsets: [f32; 4],
}

/// Share of an innovation that a phase's offset takes.
const OFFSET_GAIN: f32 = 0.02;

/// Largest offset, counts: four within it keep their order.
const LARGEST_OFFSET: f32 = 0.25;

/// What a gap that no edge ends counts more, s.
const UNSTAMPED: f64 = 3e-3;

impl Edges {
    pub(super) const fn new(clock: Hertz, rate: Hertz, cells: Cells) -> Result<Self, DesignError> {
        match EdgeClock::new(clock, rate) {
            Ok(clock) => Ok(Self {
                clock,
                table: cells.table,
                unstamped: (UNSTAMPED * rate.0) as f32,
            }),
            Err(error) => Err(error),
        }
    }
}

impl Correction for Edges {
    type State = EdgesState;
    type Gain<'a> = &'a Gain;
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };
    const DENSE: bool = true;

    fn start(&self) -> EdgesState {
        EdgesState {
            since: 0.0,
            alone: 0.0,
            offsets: [0.0; 4],
        }
    }

    fn velocity_variance(&self, state: &EdgesState) -> f32 {
        self.table.velocity_variance(state.since)
    }

    #[inline(always)]
    fn innovation<'a>(
        &'a self,
        state: &mut EdgesState,
        path: Path,
        sample: &Sample,
    ) -> Option<(Innovation, &'a Gain)> {
        let since = state.since + 1.0;
        let Some(edge) = self.clock.fresh(sample) else {
            state.since = since;
            state.alone += 1.0;
            let error = excess(path.from + path.lead)?;
            let gap = state.alone + self.unstamped;
            state.alone = 0.0;
            let innovation = Innovation {
                error,
                age: 0.0,
                position: 1.0,
                gap: 0.0,
            };
            return Some((innovation, self.table.gain(gap)));
        };
        state.since = edge.age;
        state.alone = edge.age;
        let passed = 1.0 - edge.age;
        let there = path.from + passed * (path.lead - 0.5 * path.gained * edge.age);
        let offset = &mut state.offsets[edge.phase % 4];
        let error = edge.position + *offset - there;
        *offset = limited(*offset - OFFSET_GAIN * error, LARGEST_OFFSET);
        let gap = since - edge.age;
        let gain = self.table.gain(gap);
        let innovation = Innovation {
            error,
            age: edge.age,
            position: gain.position,
            gap,
        };
        Some((innovation, gain))
    }
}
