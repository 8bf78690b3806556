//! The velocity loop of the large motor: an RST compensator.

use crate::rst_design::RstDesign;
use crate::units::RadPerS;

/// RST compensator (section II-B of the paper): `u = (T ω_f - R ω - s1 u₁ - s2 u₂)`, with
/// `ω_f` the wanted velocity behind two first-order lags.
///
/// The past currents u₁, u₂ are those applied after every limit, so the integral action in S
/// stops where the current does (anti-windup). Current in A, velocities in rad/s; design and
/// derivation in [`RstDesign`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rst {
    r: [f32; 3],
    /// S without its leading 1.
    s: [f32; 2],
    t: [f32; 5],
    /// 1 - m, the gain of each half of the tracking filter.
    tracking_gain: f32,
}

/// State of an [`Rst`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RstState {
    lag: f32,
    wanted: [f32; 5],
    measured: [f32; 2],
    applied: [f32; 2],
}

impl Rst {
    /// The compensator of a design.
    #[must_use]
    pub const fn new(design: &RstDesign) -> Self {
        Self {
            r: [design.r[0] as f32, design.r[1] as f32, design.r[2] as f32],
            s: [design.s[1] as f32, design.s[2] as f32],
            t: [
                design.t[0] as f32,
                design.t[1] as f32,
                design.t[2] as f32,
                design.t[3] as f32,
                design.t[4] as f32,
            ],
            tracking_gain: (1.0 - design.tracking_pole) as f32,
        }
    }

    /// State at rest at a velocity: wanted and measured are the same, no current flows.
    #[must_use]
    pub const fn start(&self, at: RadPerS) -> RstState {
        RstState {
            lag: at.0,
            wanted: [at.0; 5],
            measured: [at.0; 2],
            applied: [0.0; 2],
        }
    }

    /// One tick: the current wanted, A. Tell [`RstState::apply`] what became of it.
    #[must_use]
    pub fn update(&self, state: &mut RstState, wanted: RadPerS, measured: RadPerS) -> f32 {
        state.lag += self.tracking_gain * (wanted.0 - state.lag);
        let [w1, w2, w3, w4, _] = state.wanted;
        let w0 = w1 + self.tracking_gain * (state.lag - w1);
        state.wanted = [w0, w1, w2, w3, w4];
        let [y1, y2] = state.measured;
        state.measured = [measured.0, y1];
        let mut current = 0.0;
        for (t, w) in self.t.iter().zip(&state.wanted) {
            current += t * w;
        }
        for (r, y) in self.r.iter().zip(&[measured.0, y1, y2]) {
            current -= r * y;
        }
        for (s, u) in self.s.iter().zip(&state.applied) {
            current -= s * u;
        }
        current
    }
}

impl RstState {
    /// The velocity wanted behind the tracking filter.
    #[must_use]
    pub const fn filtered(&self) -> RadPerS {
        RadPerS(self.wanted[0])
    }

    /// Takes the current that was applied after all limits, A, less what was fed forward.
    pub fn apply(&mut self, current: f32) {
        self.applied = [current, self.applied[0]];
    }
}
