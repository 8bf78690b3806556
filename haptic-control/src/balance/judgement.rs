//! From the terms of a window to findings, and to narrower ranges.

use super::range::{Range, larger};
use super::window::{Block, Terms};
use super::{ALPHA, BETA, Balance, BalanceState, PAST, TIGHT};

impl Balance {
    /// The terms from the middle of one window to that of the next, averaged over the length of a window.
    pub(super) fn terms(&self, before: &Block, now: &Block) -> Terms {
        let [charge, large, small] =
            [0, 1, 2].map(|i| before.end[i] - before.mean[i] + now.mean[i]);
        let moved = [before.end[1], now.end[1]];
        let direction = if before.direction == now.direction {
            now.direction
        } else {
            0
        };
        let later = (now.end[0] - before.end[0]) * self.per_window;
        Terms {
            current: charge * self.per_window,
            inertia: self.inertia * (moved[1] - moved[0]),
            slip: self.drag[0] * large - self.drag[1] * small,
            error: self.rounding + self.lag * larger(later, -later),
            direction,
        }
    }

    /// What the friction of the window has to be.
    pub(super) fn remainder(state: &BalanceState) -> Range {
        let now = &state.now;
        let known = ALPHA.times(now.inertia).plus(state.damping.times(now.slip));
        known.below(now.current, now.error)
    }

    /// What the friction of the window can be.
    pub(super) fn friction(state: &BalanceState) -> Range {
        let [forwards, backwards] = state.friction;
        match state.now.direction {
            1 => forwards,
            -1 => backwards.negative(),
            _ => Range {
                low: -backwards.high,
                high: forwards.high,
            },
        }
    }

    /// Whether the window goes on as the latest one.
    pub(super) fn follows(&self, state: &BalanceState) -> bool {
        let BalanceState { now, past, .. } = state;
        let last = &past[PAST - 1];
        if now.direction == 0 || now.direction != last.direction {
            return true;
        }
        let known = ALPHA
            .times(now.inertia - last.inertia)
            .plus(state.damping.times(now.slip - last.slip));
        let varies = Range {
            low: -self.variation,
            high: self.variation,
        };
        known
            .below(now.current - last.current, now.error + last.error)
            .meets(varies)
    }

    pub(super) fn learn_damping(&self, state: &mut BalanceState) {
        let now = state.now;
        let friction = Self::friction(state);
        state.damping = state.damping.widened(self.damping_drift, BETA);
        if larger(now.slip, -now.slip) > self.friction.high {
            let drag = ALPHA
                .times(now.inertia)
                .plus(friction)
                .below(now.current, now.error)
                .times(1.0 / now.slip);
            state.damping = state
                .damping
                .narrowed(TIGHT.0 * drag.low, TIGHT.1 * drag.high);
        }
    }

    /// Uses the remainder with the range of β before this window.
    pub(super) fn learn_friction(&self, state: &mut BalanceState) {
        let [forwards, backwards] = &mut state.friction;
        for side in [&mut *forwards, &mut *backwards] {
            *side = side.widened(self.friction_drift, self.friction);
        }
        let (side, along) = match state.now.direction {
            1 => (forwards, state.remainder),
            -1 => (backwards, state.remainder.negative()),
            _ => return,
        };
        *side = side.narrowed(along.low - self.variation, along.high + self.variation);
    }
}
