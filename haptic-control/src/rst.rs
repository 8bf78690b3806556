//! The velocity loop of the large motor: an RST compensator.

use crate::rst_design::RstDesign;
use crate::units::RadPerS;

/// RST compensator (section II-B of the paper), `S u = T ω_f - R ω` with `T = P / B(1)`.
///
/// Since `P = A S + B R`, this is the plant's inverse fed forward plus a regulator of the remaining
/// error. The implementation has this form:
/// ```text
/// u = A ω_f / B(1) + c          S c = R (B ω_f / B(1) - ω)
/// ```
/// In the printed form, T is a small difference of large coefficients (at 10 kHz its sum is 10⁻⁶ of
/// them), below the resolution of f32. In this form every small quantity is a difference of
/// signals. `A` is applied as `1 - e^(-T/τm) z⁻¹ = (1 - z⁻¹) + (1 - e^(-T/τm)) z⁻¹`. The integrator
/// of S is exact as `c₁ - s1 (c₁ - c₂)`, and the rounding error of a sum is added to the next sum:
/// at 11.6 kHz the integrator changes by 10⁻⁶ A per rad/s and tick, less than the resolution of an
/// f32 at 1 A.
///
/// Anti-windup: with `d` the applied current minus the commanded current, the regulator is
/// `S c = R (B ω_f / B(1) - ω) + (Q - S) d`, which is `Q c = R (..) + (Q - S) (c + d)` with both
/// poles of Q at the regulation bandwidth. A limit that lasts makes the regulator follow the
/// limited current. A limit of a few ticks, as a slew limit, hardly changes the regulator. (With Q
/// = 1 the regulator would integrate the current that a slew limit removes, and S, whose second
/// pole is close to 1 at high rates, would extend it to a ramp: a step of the commanded velocity
/// would first move the motor in the opposite direction.) Current in A, velocities in rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rst {
    r: [f32; 3],
    s1: f32,
    /// B / B(1): weights of the values one and two ticks ago.
    share: [f32; 2],
    /// 1 - e^(-T/τm).
    mechanical_gain: f32,
    /// e^(-T/τa).
    electrical_pole: f32,
    /// 1 / B(1), A per rad/s.
    amps_per_rad_per_s: f32,
    /// 1 - m, the gain of each half of the tracking filter.
    tracking_gain: f32,
    /// Q - S, for one and two ticks ago.
    relief: [f32; 2],
}

/// State of an [`Rst`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RstState {
    /// First half of the tracking filter.
    lag: f32,
    /// ω_f at this tick and the one before.
    wanted: [f32; 2],
    /// (1 - e^(-T/τm) z⁻¹) ω_f.
    mechanical: f32,
    /// Errors one and two ticks ago.
    errors: [f32; 2],
    /// c one and two ticks ago.
    regulated: [f32; 2],
    /// Applied minus commanded current, one and two ticks ago.
    cut: [f32; 2],
    /// Rounding error of the last sum for c.
    carry: f32,
    /// A ω_f / B(1) of this tick.
    forward: f32,
}

impl Rst {
    /// The compensator of a design.
    #[must_use]
    pub const fn new(design: &RstDesign) -> Self {
        let at_one = design.b[1] + design.b[2];
        Self {
            r: [design.r[0] as f32, design.r[1] as f32, design.r[2] as f32],
            s1: -design.s[2] as f32,
            share: [(design.b[1] / at_one) as f32, (design.b[2] / at_one) as f32],
            mechanical_gain: (1.0 - design.mechanical_pole) as f32,
            electrical_pole: design.electrical_pole as f32,
            amps_per_rad_per_s: (1.0 / at_one) as f32,
            tracking_gain: (1.0 - design.tracking_pole) as f32,
            relief: [
                (-2.0 * design.regulation_pole - design.s[1]) as f32,
                (design.regulation_pole * design.regulation_pole - design.s[2]) as f32,
            ],
        }
    }

    /// State at a constant velocity, commanded and measured, without current.
    #[must_use]
    pub const fn start(&self, at: RadPerS) -> RstState {
        RstState {
            lag: at.0,
            wanted: [at.0; 2],
            mechanical: self.mechanical_gain * at.0,
            errors: [0.0; 2],
            regulated: [0.0; 2],
            cut: [0.0; 2],
            carry: 0.0,
            forward: 0.0,
        }
    }

    /// One tick: the commanded current, A. Call [`RstState::limited`] with the applied current.
    #[must_use]
    // As ContinuousStage::update.
    #[inline(always)]
    pub fn update(&self, state: &mut RstState, wanted: RadPerS, measured: RadPerS) -> f32 {
        let [w1, w2] = state.wanted;
        let error = self.share[0] * w1 + self.share[1] * w2 - measured.0;

        state.lag += self.tracking_gain * (wanted.0 - state.lag);
        let step = self.tracking_gain * (state.lag - w1);
        state.wanted = [w1 + step, w1];
        let mechanical = step + self.mechanical_gain * w1;
        let forward = mechanical - self.electrical_pole * state.mechanical;
        state.forward = self.amps_per_rad_per_s * forward;
        state.mechanical = mechanical;

        let [e1, e2] = state.errors;
        state.errors = [error, e1];
        let [c1, c2] = state.regulated;
        let change = self.r[0] * error + self.r[1] * e1 + self.r[2] * e2 - self.s1 * (c1 - c2);
        // Nearly every tick: no limit acted in the two ticks before.
        let relief = if state.cut.map(f32::to_bits) == [0; 2] {
            0.0
        } else {
            self.relieved(state)
        };
        let change = change + relief + state.carry;
        let regulated = c1 + change;
        state.carry = change - (regulated - c1);
        state.regulated = [regulated, c1];
        state.forward + regulated
    }

    /// What currents that were cut add, which become a tick older.
    #[cold]
    #[inline(never)]
    fn relieved(&self, state: &mut RstState) -> f32 {
        let [d1, d2] = state.cut;
        state.cut = [0.0, d1];
        self.relief[0] * d1 + self.relief[1] * d2
    }
}

impl RstState {
    /// The commanded velocity after the tracking filter.
    #[must_use]
    pub const fn filtered(&self) -> RadPerS {
        RadPerS(self.wanted[0])
    }

    /// Updates the anti-windup by the current that was applied after all limits, A.
    pub fn limited(&mut self, current: f32) {
        self.cut[0] = current - (self.forward + self.regulated[0]);
    }
}
